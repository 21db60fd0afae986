"""Result of an import: journals, throws, distinct half throws, what no design says."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.choices import Unit
from cranktopo.tasks.crank_import.design_files import DesignFiles, volume_words
from cranktopo.tasks.crank_import.deviations import deviation_mm
from cranktopo.tasks.crank_import.fillets import unread_patches
from cranktopo.tasks.crank_import.found_crank import FoundCrank, FoundHalf, FoundJournal
from cranktopo.tasks.crank_import.half_body import FoundBody
from cranktopo.tasks.crank_import.pockets import corner_cones, unread_holes
from cranktopo.tasks.crank_import.result import (
    CrankImport,
    ImportDeviation,
    ImportedAxis,
    ImportedHalf,
    ImportedJournal,
    ImportedLack,
    ImportedPin,
    ImportedSolid,
    ImportedThrow,
    ImportFiles,
    ImportSource,
)
from cranktopo.tasks.crank_import.web_reading import ImportedWeb

PAGE, PICTURE = "import.html", "import.png"
_Webs = Sequence[ImportedWeb]


def result_of(
    source: tuple[Path, Unit | None],
    body: FoundBody,
    webs: _Webs,
    halves: tuple[ImportedHalf, ...],
    files: DesignFiles,
    folder: Path,
    material: str,
) -> CrankImport:
    """Return the result of an import into a folder; `source` is the file, and the unit asked for."""
    crank, taken = body.crank, body.taken
    x, y, z = (float(v) for v in crank.origin_mm)
    along = tuple(float(v) for v in crank.axis)
    losses = (*crank.unread, *files.omissions, *volume_words(taken.volume_mm3, files, webs))
    lacks = [ImportedLack(where="crank", what=line) for line in losses]
    lacks += [ImportedLack(where=f"half {half.number}", what=line) for half in halves for line in half.unread]
    return CrankImport(
        source=ImportSource(
            file=str(source[0]),
            solid=taken.name,
            unit=source[1] or "file",
            faces=body.faces,
            triangles=body.triangles,
        ),
        file=str(source[0]),
        solids=tuple(
            ImportedSolid(**{k: v for k, v in vars(one).items() if k != "tag"}) for one in body.solids
        ),
        solid=taken.name,
        origin_mm=(x, y, z),
        axis=ImportedAxis(point_mm=(x, y, z), direction=(along[0], along[1], along[2])),
        throws=tuple(_throw(crank, index, webs, files) for index in range(len(crank.pins))),
        main_journals=tuple(
            _journal(number, one, _fillet_mm(webs, one, "main"))
            for number, one in enumerate(crank.journals, 1)
        ),
        halves=halves,
        material=material,
        assumed=(*body.assumed, *crank.assumed, f"material = {material}: CAD does not tell it"),
        volume_mm3=taken.volume_mm3,
        design_volume_mm3=files.volume_mm3,
        volume_within=body.volume_within,
        deviation_mm=ImportDeviation(
            max=max(web.read.outline_mm for web in webs),
            rms=math.sqrt(sum(web.read.outline_rms_mm**2 for web in webs) / len(webs)),
        ),
        unread=tuple(lacks),
        page=str(folder / PAGE),
        files=ImportFiles(
            design=str(folder / files.design),
            throws=tuple(str(folder / name) for name in files.throws),
            bodies=tuple(half.body for half in halves),
            page=str(folder / PAGE),
            picture=str(folder / PICTURE),
        ),
    )


def _throw(crank: FoundCrank, index: int, webs: _Webs, files: DesignFiles) -> ImportedThrow:
    pin, number = crank.pins[index], index + 1
    same = files.same_as[index] + 1 if files.same_as else number
    own = [
        (half.toward < 0, group)
        for group, web in enumerate(webs, 1)
        for half in web.body.others
        if half.throw == number
    ]
    return ImportedThrow(
        number=number,
        angle_deg=crank.angle_deg(pin),
        radius_mm=crank.throw_radius_mm(pin),
        diameter_mm=2 * pin.radius_mm,
        bore_mm=pin.bore_mm,
        length_mm=pin.length_mm,
        middle_mm=pin.middle_mm,
        pin=ImportedPin(
            z_mm=pin.middle_mm,
            outer_diameter_mm=2 * pin.radius_mm,
            bore_diameter_mm=pin.bore_mm,
            length_mm=pin.length_mm,
            fillet_mm=_fillet_mm(webs, pin, "pin"),
        ),
        webs=tuple(group for _, group in sorted(own)),
        same_as=None if same == number else same,
    )


def _journal(number: int, journal: FoundJournal, fillet_mm: float) -> ImportedJournal:
    return ImportedJournal(
        number=number,
        diameter_mm=2 * journal.radius_mm,
        bore_mm=journal.bore_mm,
        length_mm=journal.length_mm,
        middle_mm=journal.middle_mm,
        z_mm=journal.middle_mm,
        outer_diameter_mm=2 * journal.radius_mm,
        bore_diameter_mm=journal.bore_mm,
        fillet_mm=fillet_mm,
    )


def _fillet_mm(webs: _Webs, journal: FoundJournal, kind: str) -> float:
    """Return the largest fillet of a journal in the designs of the webs beside it."""
    beside = (
        web.read.scene.throw
        for web in webs
        if any(getattr(half, kind) is journal for half in web.body.others)
    )
    return max(
        ((throw.main_journal if kind == "main" else throw.crankpin).fillet_mm for throw in beside),
        default=0.0,
    )


def half_of(number: int, web: ImportedWeb, folder: Path) -> ImportedHalf:
    """Return a distinct half throw with how near its design comes to its body."""
    scene, body = web.read.scene, web.body
    return ImportedHalf(
        number=number,
        body=str(folder / body.file),
        design=str(folder / f"{web.name}.toml"),
        webs=tuple(web_words(half, half in body.mirrored) for half in body.others),
        outline=web.read.outline,
        outline_deviation_mm=web.read.outline_mm,
        volume_mm3=body.solid.volume_mm3,
        design_volume_mm3=half_throw_volume_mm3(scene),
        missing_mm3=web.read.compared.missing_mm3,
        extra_mm3=web.read.compared.extra_mm3,
        dimensions_mm=dict(_dimensions(scene)),
        deviations_mm={key: deviation_mm(web, key) for key, _ in _dimensions(scene)},
        unread=tuple(_unread(web)),
    )


def web_words(half: FoundHalf, mirrored: bool = False) -> str:
    """Return a web in words: its throw, on which side of the pin it lies, and if it is a mirror image."""
    word = f"throw {half.throw}, {'first' if half.toward > 0 else 'second'} web"
    return f"{word} (mirrored)" if mirrored else word


def _dimensions(scene: Scene) -> Iterator[tuple[str, float]]:
    data = scene.model_dump(mode="json", include={"throw", "web"}, exclude_none=True, exclude_defaults=True)
    yield from _numbers(data, "")


def _numbers(data: Any, key: str) -> Iterator[tuple[str, float]]:
    if isinstance(data, Mapping):
        for name, value in data.items():
            yield from _numbers(value, f"{key}.{name}" if key else name)
    elif isinstance(data, list):
        for index, value in enumerate(data):
            yield from _numbers(value, f"{key}[{index}]")
    elif isinstance(data, float | int) and not isinstance(data, bool):
        yield key, float(data)


def _unread(web: ImportedWeb) -> Iterator[str]:
    """Yield what a body has that its design does not say."""
    scene, faces = web.read.scene, web.body.faces
    yield from web.read.differences_from(web.body)
    for key, name in (("main_journal", "main journal"), ("crankpin", "crankpin")):
        if not getattr(scene.throw, key).fillet_mm:
            yield f"no round fillet was found at the {name}: its corner is sharp in the design"
    for index, drilling in enumerate(scene.throw.drilling):
        if drilling.outlet_radius_mm:
            yield (
                f"throw.drilling[{index}].outlet_radius_mm = {drilling.outlet_radius_mm:g} is fitted to the "
                "corners of triangles: CAD approximates its surface, check it against the drawing"
            )
    for hole in unread_holes(web.body, scene):
        yield f"{hole}: it is not in the design"
    cones = sum(other == "Cone" for other in faces.others) - corner_cones(web.body, scene)
    if cones:
        yield f"{cones} conical faces: chamfers and countersinks are not in the design"
    kinds = sorted({other for other in faces.others if other != "Cone"})
    if kinds and (not faces.patches_mm or unread_patches(faces, scene.throw.radius_mm)):
        yield f"faces that are no plane, cylinder or torus: {', '.join(kinds).lower()}"
