"""A crank from CAD: recognised, cut into its distinct half throws, and written as designs with a page."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from cranktopo.base.child import in_child
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import as_path, as_path_if_any, write_json
from cranktopo.base.notes import note
from cranktopo.bodies.solid.step import KERNEL_SUFFIXES, in_cad_kernel
from cranktopo.design.schema import Scene
from cranktopo.design.writing import design_name
from cranktopo.report.report_file import write_report
from cranktopo.runs.destination import check_folder, moved, unfinished_folder
from cranktopo.tasks.crank_import.choices import DEFAULT_MATERIAL, EndJournals, Unit
from cranktopo.tasks.crank_import.design_files import half_names, write_designs
from cranktopo.tasks.crank_import.distortion import noise_named
from cranktopo.tasks.crank_import.fillets import fillet_keys
from cranktopo.tasks.crank_import.found_crank import FoundCrank, FoundHalf, FoundJournal
from cranktopo.tasks.crank_import.half_body import FoundBody, HalfBody
from cranktopo.tasks.crank_import.kernel_halves import crank_by_kernel
from cranktopo.tasks.crank_import.mesh_halves import crank_of_mesh
from cranktopo.tasks.crank_import.meshes import MESH_SUFFIXES
from cranktopo.tasks.crank_import.result import CrankImport, ImportedHalf
from cranktopo.tasks.crank_import.summary import PAGE, PICTURE, half_of, result_of, web_words
from cranktopo.tasks.crank_import.web_reading import ImportedWeb, read_web
from cranktopo.tasks.importing.faces import DIGITS
from cranktopo.tasks.importing.placement import ring_misfits


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
    out = as_path_if_any(out)
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
        in_child(f"'{path}'", crank_of_mesh, *find, by="reader of triangles")
        if path.suffix.lower() in MESH_SUFFIXES
        else in_cad_kernel(f"'{path}'", crank_by_kernel, *find)
    )
    read = _read(found, name, material)
    names = half_names(read, found.crank, name)
    webs = [_named(web, own) for web, own in zip(read, names, strict=True)]
    halves = tuple(half_of(number, web, folder) for number, web in enumerate(webs, 1))
    headings = [_heading(path, entry) for entry in halves]
    files = write_designs(unfinished, webs, found.crank, name, headings)
    result = result_of((path, find[3]), found, webs, halves, files, folder, material)
    write_json(unfinished / "import.json", result.as_json())
    from cranktopo.tasks.crank_import.page import import_page, import_picture

    write_report(import_page(result, webs), unfinished / PAGE)
    import_picture(halves, webs, unfinished / PICTURE)
    return result


def _read(found: FoundBody, name: str, material: str) -> list[ImportedWeb]:
    """Return the webs of all half throws, those read first that have lost nothing to their neighbours'."""
    webs: dict[int, ImportedWeb] = {}
    for number, body in sorted(enumerate(found.halves, 1), key=lambda one: -one[1].solid.volume_mm3):
        note(f"half {number} of {len(found.halves)}: reading its web")
        others = [web.read.scene for web in webs.values()]
        try:
            webs[number] = _web(body, found.crank, f"{name}-{number}", material, others)
        except CranktopoError as error:
            raise noise_named(error, found.crank.unread) from None
    return [webs[number] for number in sorted(webs)]


def _named(web: ImportedWeb, name: str) -> ImportedWeb:
    scene = web.read.scene.model_copy(update={"name": name})
    return replace(web, name=name, read=replace(web.read, scene=scene))


def _web(body: HalfBody, crank: FoundCrank, name: str, material: str, others: Sequence[Scene]) -> ImportedWeb:
    read = read_web(body, throw_table(body, crank), {"name": material}, name, others)
    wrong = ring_misfits(read.compared.solid, read.scene)
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


def _journal(body: HalfBody, journal: FoundJournal, length_mm: float, y_mm: float) -> dict[str, float]:
    table = {
        "outer_diameter_mm": round(2 * journal.radius_mm, DIGITS),
        "bore_diameter_mm": round(journal.bore_mm, DIGITS),
        "length_mm": round(length_mm, DIGITS),
    }
    fillet = fillet_keys(
        body.faces, journal.radius_mm, y_mm, _web_face(body.half, y_mm), body.near.outline_mm
    )
    return table | {key: round(value, DIGITS) for key, value in fillet.items()}


def _web_face(half: FoundHalf, y_mm: float) -> tuple[float, int]:
    """Return the web's face at a journal, in the frame of the half throw, and the way into the web."""
    start = half.main_length_mm / 2
    return (start + half.thickness_mm, -1) if y_mm else (start, 1)


def _heading(path: Path, entry: ImportedHalf) -> tuple[str, ...]:
    share = 100 * (entry.design_volume_mm3 / entry.volume_mm3 - 1)
    return (
        path.name,
        f"Read from {path.name}: {', '.join(entry.webs)}.",
        f"Outline: {entry.outline}, within {entry.outline_deviation_mm:.3g} mm of the body.",
        f"Volume: {share:+z.2f} % of the body's.",
        *(f"Not read: {line}." for line in entry.unread),
    )
