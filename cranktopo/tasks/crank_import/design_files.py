"""Designs of an imported crank as files: of each distinct half throw, and of a crank of unlike throws."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import write_text
from cranktopo.bodies.crank_drillings import taken_beyond
from cranktopo.bodies.crank_ends import crank_end
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.arrangement import Arrangement
from cranktopo.design.crank import OWN_THROW
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.engine import Engine
from cranktopo.design.halves import halves
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.design_text import crank_table, design_text, throw_text
from cranktopo.tasks.crank_import.found_crank import FoundCrank
from cranktopo.tasks.crank_import.half_body import EXACT
from cranktopo.tasks.crank_import.throw_designs import (
    Throws,
    different,
    second_body,
    throws_of,
    uneven,
    unsaid,
)
from cranktopo.tasks.crank_import.web_reading import ImportedWeb

_TOLD, _TOLD_FACETED = 2e-5, 2e-3
"""Share of the volume in which body and designs differ that is told, of exact faces and of triangles."""


@dataclass(frozen=True)
class DesignFiles:
    """Names of the files written.

    Attributes:
        throws: designs of the throws that differ from the first one's.
        same_as: of each throw the index of the first one that is alike.
        volume_mm3: of the crank of the designs; None where they are no whole crank.
        omissions: what the designs do not say, in words.
    """

    design: str
    throws: tuple[str, ...]
    same_as: tuple[int, ...]
    volume_mm3: float | None
    omissions: tuple[str, ...]


def half_names(webs: Sequence[ImportedWeb], crank: FoundCrank, name: str) -> list[str]:
    """Return the names of the designs of the half throws; the first is the crank's where throws are alike."""
    if uneven(throws_of(webs, crank)):
        return [f"{name}-half-{number}" for number in range(1, len(webs) + 1)]
    return [name if number == 1 else f"{name}-{number}" for number in range(1, len(webs) + 1)]


def write_designs(
    folder: Path,
    webs: Sequence[ImportedWeb],
    crank: FoundCrank,
    name: str,
    headings: Sequence[tuple[str, ...]],
) -> DesignFiles:
    """Write the designs of half throws, and of a crank of unlike throws one of it and one of each throw."""
    throws, near = throws_of(webs, crank), webs[0].body.near
    for web, heading in zip(webs, headings, strict=True):
        bodies = web.body.file, second_body(webs, crank) if web is webs[0] else None
        text = design_text(web.read.scene, crank, bodies, heading, near, throws)
        write_text(folder / f"{web.name}.toml", text)
    same, omissions = different(throws), list(unsaid(throws))
    design, others = f"{webs[0].name}.toml", list[str]()
    if uneven(throws):
        design, others = f"{name}.toml", _write_throws(folder, throws, webs, crank, name, headings[0][0])
    volume: float | None = None
    try:
        if throws:
            volume = _crank_volume_mm3(load_scene(folder / design, whole=True), crank)
    except CranktopoError as error:
        omissions.append(f"the crank of the designs: {error.message}")
    return DesignFiles(design, tuple(others), tuple(same), volume, tuple(omissions))


def _write_throws(
    folder: Path, throws: Throws, webs: Sequence[ImportedWeb], crank: FoundCrank, name: str, file: str
) -> list[str]:
    """Write the design of a crank whose throws or webs differ; return the files of its further throws."""
    same, near = different(throws), webs[0].body.near
    files = {first: f"{name}-throw-{first + 1}.toml" for first in dict.fromkeys(same) if first}
    heading = (file, f"Read from {file}: the crank, its own throw the first one.")
    order = [files.get(first, OWN_THROW) for first in same] if files else []
    table = crank_table(throws[0][0], crank, near, throws, order)
    write_text(folder / f"{name}.toml", throw_text(throws[0], crank, table, name, heading))
    for first, own in files.items():
        heading = (file, f"Read from {file}: throw {first + 1}.")
        radius = throws[0][0].throw.radius_mm
        one, other = (
            scene.model_copy(update={"throw": scene.throw.model_copy(update={"radius_mm": radius})})
            for scene in throws[first]
        )
        write_text(folder / own, throw_text((one, other), crank, {}, Path(own).stem, heading))
    return list(files.values())


def _crank_volume_mm3(scene: Scene, crank: FoundCrank) -> float:
    """Return the volume of a crank, its ends included, with its throws turned as the body has them.

    Where drillings go on in a neighbouring throw, that depends on their angles; a design without its engine
    has none.
    """
    turned = scene.model_copy(update={"engine": _stand_in_engine(crank, scene.throw.radius_mm)})
    ends = sum(piece.moments.volume for side in ("free", "output") for piece in crank_end(turned, side))
    bodies = sum(half_throw_volume_mm3(half) for throw in throw_scenes(turned) for half in halves(throw))
    return ends + bodies - taken_beyond(turned).volume


def _stand_in_engine(crank: FoundCrank, radius_mm: float) -> Engine:
    """Return an engine in line with the throws of a crank; nothing else of it is taken."""
    numbers = range(1, len(crank.pins) + 1)
    angles = tuple(crank.angle_deg(pin) for pin in crank.pins)
    return Engine(
        bore_mm=radius_mm,
        rod_length_mm=4 * radius_mm,
        speed_rpm=1.0,
        cylinders=len(numbers),
        firing_order=tuple(numbers),
        arrangement=Arrangement(throw_angles_deg=angles),
    )


def volume_words(body_mm3: float, files: DesignFiles, webs: Sequence[ImportedWeb]) -> list[str]:
    """Tell how much more or less the crank of the designs has than the body, where that is to be told."""
    if files.volume_mm3 is None:
        return []
    off = files.volume_mm3 - body_mm3
    if abs(off) <= (_TOLD if webs[0].body.near == EXACT else _TOLD_FACETED) * body_mm3:
        return []
    more = "more" if off > 0 else "less"
    return [
        f"the crank of the designs has {abs(off):.4g} mm3 {more} than the body, {off / body_mm3:+.3%} of it"
    ]
