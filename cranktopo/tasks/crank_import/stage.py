"""A crank from CAD: recognised, cut into its distinct half throws, and written as designs with a page."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import as_path, write_json, write_text
from cranktopo.base.notes import note
from cranktopo.bodies.solid.step import KERNEL_SUFFIXES, by_kernel
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.design.writing import design_name
from cranktopo.report.report_file import write_report
from cranktopo.runs.destination import check_folder, moved, unfinished_folder
from cranktopo.tasks.crank_import.choices import DEFAULT_MATERIAL, EndJournals, Unit
from cranktopo.tasks.crank_import.design_text import design_text
from cranktopo.tasks.crank_import.faces import DIGITS, from_line_mm, parallel
from cranktopo.tasks.crank_import.found_crank import FoundCrank, FoundHalf, FoundJournal
from cranktopo.tasks.crank_import.half_body import FoundBody, HalfBody
from cranktopo.tasks.crank_import.kernel_halves import crank_by_kernel
from cranktopo.tasks.crank_import.mesh_halves import crank_of_mesh
from cranktopo.tasks.crank_import.meshes import MESH_SUFFIXES
from cranktopo.tasks.crank_import.pockets import unread_holes
from cranktopo.tasks.crank_import.result import (
    CrankImport,
    ImportedHalf,
    ImportedJournal,
    ImportedSolid,
    ImportedThrow,
)
from cranktopo.tasks.crank_import.web_reading import ImportedWeb, read_web
from cranktopo.tasks.importing.placement import ring_misfits

_TANGENT = 1e-5
"""Allowed distance of a fillet from the journal's cylinder, over its radius."""


def import_crank(
    path: Path | str,
    name: str | None = None,
    out: Path | str | None = None,
    solid: str | None = None,
    ends: EndJournals = "auto",
    material: str = DEFAULT_MATERIAL,
    unit: Unit | None = None,
) -> CrankImport:
    """Recognise the crank in a file from CAD; write its half throws, a design of each, and a page.

    Args:
        name: of the design; by default that of the file.
        out: folder for all of it; by default named after the design.
        solid: name of the solid in the file.
        ends: what the outermost main journals are, where the body leaves it open.
        material: name of a built-in material.
        unit: of the numbers in the file; by default what it tells, mm where it tells none.

    Raises:
        CranktopoError: no body from CAD, no crank in it, or a web that no design can say.
    """
    path = as_path(path)
    out = as_path(out)
    suffix = path.suffix.lower()
    if suffix not in (*KERNEL_SUFFIXES, *MESH_SUFFIXES):
        raise CranktopoError(
            f"'{path}': is no body from CAD by its name.",
            hint="Export the crank as STEP (.step or .stp): its exact faces tell most. "
            "STL, 3MF, OBJ and BREP are read as well.",
        )
    name = design_name(Path(name or path.name).with_suffix(".toml"))
    folder = out or Path(name)
    check_folder(folder)
    if folder.exists() and any(folder.iterdir()):
        raise CranktopoError(
            f"output '{folder}': is not empty.", hint="Choose another --out.", code=ExitCode.USAGE
        )
    with unfinished_folder(folder.parent) as unfinished:
        result = _imported((path, solid, ends, unit, unfinished), name, folder, material)
        moved(unfinished, folder)
    return result


def _imported(
    find: tuple[Path, str | None, EndJournals, Unit | None, Path], name: str, folder: Path, material: str
) -> CrankImport:
    """Write everything into the last of the arguments of the search, which is to become the folder."""
    path, *_, unfinished = find
    note(f"{path}: reading, finding axes and journals")
    found = (
        crank_of_mesh(*find)
        if path.suffix.lower() in MESH_SUFFIXES
        else by_kernel(f"'{path}'", crank_by_kernel, *find)
    )
    webs = []
    for number, body in enumerate(found.halves, 1):
        own = name if number == 1 else f"{name}-{number}"
        note(f"half {number} of {len(found.halves)}: reading its web")
        webs.append(_web(body, found.crank, own, material))
    page = folder / "import.html"
    result = _result(path, found, webs, folder, material, page)
    for web, entry in zip(webs, result.halves, strict=True):
        text = design_text(web.read.scene, found.crank, web.body.file, _heading(path, entry))
        write_text(unfinished / f"{web.name}.toml", text)
    write_json(unfinished / "import.json", result.as_json())
    from cranktopo.tasks.crank_import.page import import_page

    write_report(import_page(result, webs), unfinished / page.name)
    return result


def _web(body: HalfBody, crank: FoundCrank, name: str, material: str) -> ImportedWeb:
    read = read_web(body, throw_table(body, crank), {"name": material}, name)
    wrong = ring_misfits(read.solid, read.scene)
    if wrong:
        raise CranktopoError(
            f"{web_words(body.half)}: is no web between two journals: {wrong[0]}.",
            hint="Is it a crank? Other parts, or a sheared body, are not taken.",
        )
    return ImportedWeb(body, read, name)


def throw_table(body: HalfBody, crank: FoundCrank) -> dict[str, Any]:
    """Return the throw table of a half throw, with the fillets found on its faces."""
    half = body.half
    return {
        "radius_mm": round(crank.throw_radius_mm(half.pin), DIGITS),
        "main_journal": _journal(body, half.main, half.main_length_mm, 0.0),
        "crankpin": _journal(body, half.pin, half.pin_length_mm, crank.throw_radius_mm(half.pin)),
    }


def _journal(body: HalfBody, found: FoundJournal, length_mm: float, y_mm: float) -> dict[str, float]:
    table = {
        "outer_diameter_mm": round(2 * found.radius_mm, DIGITS),
        "bore_diameter_mm": round(found.bore_mm, DIGITS),
        "length_mm": round(length_mm, DIGITS),
    }
    fillet = _fillet_mm(body, found, y_mm)
    return table | ({"fillet_mm": round(fillet, DIGITS)} if fillet else {})


def _fillet_mm(body: HalfBody, journal: FoundJournal, y_mm: float) -> float:
    """Return the radius of the torus that runs from a journal's cylinder into the web; 0 without one."""
    on, z = np.array([0.0, y_mm, 0.0]), np.array([0.0, 0.0, 1.0])
    near = _TANGENT * journal.radius_mm
    for torus in body.faces.tori:
        about = parallel(torus.axis, z) and from_line_mm(torus.centre_mm, on, z) < near
        if about and abs(torus.ring_mm - torus.tube_mm - journal.radius_mm) < near:
            return torus.tube_mm
    return 0.0


def _result(
    path: Path,
    found: FoundBody,
    webs: Sequence[ImportedWeb],
    folder: Path,
    material: str,
    page: Path,
) -> CrankImport:
    crank, taken = found.crank, found.taken
    x, y, z = (float(v) for v in crank.origin_mm)
    along = tuple(float(v) for v in crank.axis)
    return CrankImport(
        file=str(path),
        solids=tuple(
            ImportedSolid(**{k: v for k, v in vars(one).items() if k != "tag"}) for one in found.solids
        ),
        solid=taken.name,
        origin_mm=(x, y, z),
        axis=(along[0], along[1], along[2]),
        throws=tuple(
            ImportedThrow(
                number=number,
                angle_deg=crank.angle_deg(pin),
                radius_mm=crank.throw_radius_mm(pin),
                diameter_mm=2 * pin.radius_mm,
                bore_mm=pin.bore_mm,
                length_mm=pin.length_mm,
                middle_mm=pin.middle_mm,
            )
            for number, pin in enumerate(crank.pins, 1)
        ),
        main_journals=tuple(
            ImportedJournal(
                number=number,
                diameter_mm=2 * journal.radius_mm,
                bore_mm=journal.bore_mm,
                length_mm=journal.length_mm,
                middle_mm=journal.middle_mm,
            )
            for number, journal in enumerate(crank.journals, 1)
        ),
        halves=tuple(_half(number, web, folder) for number, web in enumerate(webs, 1)),
        material=material,
        assumed=(*found.assumed, *crank.assumed, f"material = {material}: CAD does not tell it"),
        unread=crank.unread,
        page=str(page),
    )


def _half(number: int, web: ImportedWeb, folder: Path) -> ImportedHalf:
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
        missing_mm3=web.read.missing_mm3,
        extra_mm3=web.read.extra_mm3,
        dimensions_mm=dict(_dimensions(scene)),
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
    yield from web.read.told
    for key, name in (("main_journal", "main journal"), ("crankpin", "crankpin")):
        if not getattr(scene.throw, key).fillet_mm:
            yield f"no round fillet was found at the {name}: its corner is sharp in the design"
    for index, drilling in enumerate(scene.throw.drilling):
        if drilling.outlet_radius_mm:
            yield (
                f"throw.drilling[{index}].outlet_radius_mm = {drilling.outlet_radius_mm:g} follows from the "
                "volume: no face tells it, check it against the drawing"
            )
    for hole in unread_holes(web.body, scene):
        yield f"{hole}: it is not in the design"
    cones = sum(other == "Cone" for other in faces.others)
    if cones:
        yield f"{cones} conical faces: chamfers and countersinks are not in the design"
    kinds = sorted({other for other in faces.others if other != "Cone"})
    if kinds:
        yield f"faces that are no plane, cylinder or torus: {', '.join(kinds).lower()}"


def _heading(path: Path, entry: ImportedHalf) -> tuple[str, ...]:
    share = 100 * (entry.design_volume_mm3 / entry.volume_mm3 - 1)
    return (
        path.name,
        f"Read from {path.name}: {', '.join(entry.webs)}.",
        f"Outline: {entry.outline}, within {entry.outline_deviation_mm:.3g} mm of the body.",
        f"Volume: {share:+z.2f} % of the body's.",
        *(f"Not read: {line}." for line in entry.unread),
    )
