"""From a TOML path or a built-in name to a validated scene, with other values or one web if asked."""

from __future__ import annotations

import os
import re
import shlex
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cranktopo.base.errors import CranktopoError, ExitCode, invalid, quoted, suggest
from cranktopo.base.files import read_text_file
from cranktopo.base.notes import detail, note
from cranktopo.design.checks.bolt_holes import check_bolt_places
from cranktopo.design.checks.bolts import check_bolt_dimensions
from cranktopo.design.checks.crank import check_crank
from cranktopo.design.checks.rod import check_rod
from cranktopo.design.checks.scene import check_scene
from cranktopo.design.halves import WebName, difference, halves, of_second, require_equal_halves, usual_scale
from cranktopo.design.idle_keys import idle_keys
from cranktopo.design.messages import explain, explain_unknown
from cranktopo.design.origins import origins
from cranktopo.design.rod_body import rod_mass
from cranktopo.design.scene_files import with_resolved_files
from cranktopo.design.schema import Original, Scene
from cranktopo.design.toml_text import parse_toml
from cranktopo.runs.directories import RUNS, open_run, runs_named
from cranktopo.runs.kind import RESULT_FILES, SHAPE
from cranktopo.runs.stored import told_where_changed, unchanged

_PART = re.compile(r"([A-Za-z_]\w*)((?:\[\d+\])*)")


def with_value(data: dict[str, Any], key: str, value: object) -> dict[str, Any]:
    """Return the tables of a scene with a value at a key path such as `web.pocket[0].diameter_mm`.

    A table that is not there yet is made; an entry of an array must be there.
    """
    return _changed(data, key_parts(key), value, key)


def value_at(data: Any, key: str) -> Any:
    """Return the value at a key path; None where there is none."""
    for part in key_parts(key):
        if isinstance(part, int):
            data = data[part] if isinstance(data, list) and part < len(data) else None
        else:
            data = data.get(part) if isinstance(data, dict) else None
    return data


def check_keys(data: dict[str, Any], source: str) -> None:
    """Refuse keys that no scene has; values are not looked at."""
    try:
        Scene.model_validate(data)
    except ValidationError as error:
        unknown = explain_unknown(error, source)
        if unknown is not None:
            raise unknown from None


def key_parts(key: str) -> list[str | int]:
    """Return the names and places of a key path; raises CranktopoError where it is none."""
    parts: list[str | int] = []
    for word in key.split("."):
        found = _PART.fullmatch(word)
        if found is None:
            raise invalid(
                "key", key, "must be names joined by dots, such as throw.radius_mm or web.pocket[0].y_mm"
            )
        parts += [found[1], *(int(place) for place in re.findall(r"\d+", found[2]))]
    return parts


def _changed(data: Any, parts: list[str | int], value: object, key: str) -> Any:
    if not parts:
        return value
    first, *rest = parts
    if isinstance(first, int):
        if not isinstance(data, list) or first >= len(data):
            count = len(data) if isinstance(data, list) else 0
            raise CranktopoError(
                f"{key}: there is no entry [{first}]; the design has {count}.",
                hint="Entries count from 0; add it to the design first.",
            )
        return [_changed(item, rest, value, key) if n == first else item for n, item in enumerate(data)]
    if data is None:
        data = {}
    if not isinstance(data, dict):
        raise CranktopoError(
            f"{key}: '{first}' is asked of {quoted(data)}, which is no table.", hint="Check the key."
        )
    return {**data, first: _changed(data.get(first), rest, value, key)}


def one_web(scene: Scene, web: WebName | None) -> Scene:
    """Return the throw that has one web of a scene twice; the scene itself where its halves are alike.

    A drilling in that half alone has a mirror image there. The web must be given where the halves differ, and
    only there.
    """
    key = difference(scene)
    if web is None and key:
        raise CranktopoError(
            f"{key}: the halves of the throw differ, and one web is optimised at a time.",
            hint="Give optimise, bound, shape, iterate or evaluate --sensitivities --web first or "
            "--web second: the other half is then taken as its mirror image.",
        )
    if web is None:
        return scene
    if not key:
        raise CranktopoError(
            f"--web {web}: both halves of the throw are alike.", hint="Leave it out.", code=ExitCode.USAGE
        )
    half = halves(scene)[web == "second"].model_copy(update={"original": _original_of(scene, web)})
    drilling = tuple(one.model_copy(update={"web": "both"}) for one in half.throw.drilling)
    throw = half.throw.model_copy(update={"drilling": drilling, "mirrored_web": web})
    half = half.model_copy(update={"throw": throw, "name": f"{half.name}-{web}-web"})
    try:
        check_scene(half)
    except CranktopoError as error:
        raise of_second(error, scene) if web == "second" else error from None
    return half


def _original_of(scene: Scene, web: WebName) -> Original | None:
    """Return the original of one half throw; raises CranktopoError where only the other's is named."""
    if scene.original is None:
        return None
    file = scene.original.file if web == "first" else scene.original.second_file
    if file is None:
        raise CranktopoError(
            "--web second: original.file is one half throw, the first one, and the halves differ.",
            hint="Name the body of the other in original.second_file, or take [original] out: gains are then "
            "measured against the web of the design.",
        )
    return Original(file=file)


_BODIES = {".stl": "an STL", ".step": "a STEP", ".stp": "a STEP"}
"""Kinds of files that a command takes as a target."""
_IMPORTED = {".brep": "a BREP", ".brp": "a BREP", ".3mf": "a 3MF", ".obj": "an OBJ"}
_FOREIGN = {
    ".iges": "an IGES",
    ".igs": "an IGES",
    ".fcstd": "a FreeCAD",
    ".f3d": "a Fusion",
    ".sldprt": "a SolidWorks",
    ".sldasm": "a SolidWorks",
    ".ipt": "an Inventor",
    ".catpart": "a CATIA",
    ".prt": "an NX or Creo",
    ".x_t": "a Parasolid",
    ".sat": "an ACIS",
}
_GEOMETRY = {**_BODIES, **_IMPORTED, **_FOREIGN}
_HEADS = {"ISO-10303-21": "a STEP", "solid ": "an STL", "{": "a JSON"}
_SHAPED = "web.toml"
"""Name of the design in a run of `shape`."""
_PACKAGE = Path(__file__).resolve().parents[1]


def designs_folder() -> Path:
    """Folder of the built-in designs: inside an installed package, or beside it in a checkout."""
    packaged = _PACKAGE / "designs"
    return packaged if packaged.is_dir() else _PACKAGE.parent / "designs"


def builtin_designs() -> list[str]:
    """Names of the built-in designs."""
    return sorted(path.stem for path in designs_folder().glob("*.toml"))


def resolve_design(design: str) -> Path:
    """Return the path of a design: a TOML path, a built-in name, or a run of `shape`, which ends with one."""
    if os.path.exists(design) and not os.path.isdir(design):
        return Path(design)
    if design in builtin_designs():
        return designs_folder() / f"{design}.toml"
    if (shaped := shaped_web(design)) is not None:
        return shaped
    named = f"design {quoted(design, 400)}"
    if os.path.isfile(os.path.join(design, "manifest.json")) or (design and runs_named(design)):
        raise CranktopoError(
            f"{named}: is a run, not a design.",
            hint="`cranktopo remodel RUN` makes a design of it (TOML, STEP, STL, drawing), "
            "`cranktopo extract RUN` writes its surface.",
        )
    if os.path.isdir(design):
        raise CranktopoError(f"{named}: is a folder, not a TOML file.", hint="Name the file in it.")
    raise CranktopoError(
        f"{named}: no such file or built-in design.", hint=suggest(design[:100], builtin_designs())
    )


def shaped_web(reference: str) -> Path | None:
    """Return the design that a finished run of `shape` ends with; None where it is something else."""
    names = [] if os.path.isdir(reference) else runs_named(reference)
    folder = RUNS / names[0] if len(names) == 1 else Path(reference)
    web = folder / _SHAPED
    if not (reference and (folder / RESULT_FILES[SHAPE]).is_file() and web.is_file()):
        return None
    return open_run(folder).unchanged(_SHAPED)


def design_text(design: str) -> str:
    """Return the text of a design given as a TOML path or a built-in name."""
    path = told_where_changed(resolve_design(design))
    kind = _GEOMETRY.get(path.suffix.lower())
    text = "" if kind else read_text_file(path, f"design {quoted(str(path), 400)}")
    kind = kind or next((kind for head, kind in _HEADS.items() if text.startswith(head)), None)
    if kind:
        raise CranktopoError(
            f"design {quoted(str(path), 400)}: is {kind} file; a design is a TOML file.",
            hint=_instead(path, kind),
        )
    return text


def _instead(path: Path, kind: str) -> str:
    """Return what to do with a file of another kind than a design."""
    if kind in _BODIES.values():
        return f"Give it as a target: cranktopo evaluate {shlex.quote(str(path))} --design DESIGN"
    if kind in _IMPORTED.values():
        return f"Make a design of it: cranktopo import {shlex.quote(str(path))}"
    if kind in _FOREIGN.values():
        return "Export the body as STEP."
    return "`cranktopo designs new FILE` writes one."


def parse_scene(
    text: str, source: str = "scene", folder: Path | None = None, *, whole: bool = False
) -> Scene:
    """Return a validated scene from TOML text; source and `whole` as in `scene_from_dict`.

    Args:
        folder: folder that relative file names in the scene refer to; the current one by default.
    """
    data = with_resolved_files(parse_toml(text, source), folder or Path.cwd())
    return scene_from_dict(data, source, whole=whole)


def scene_from_dict(data: dict[str, Any], source: str = "scene", *, whole: bool = False) -> Scene:
    """Return a validated scene from plain data with absolute file names; the source is named in messages.

    Args:
        whole: the halves of the throw may differ; else, what models half of it is safe with the scene.

    Raises:
        CranktopoError: unknown key, value outside its range, inconsistent geometry, halves that differ.
    """
    scene = _of_tables(data, source)
    check_scene(scene)
    check_crank(scene)
    check_bolt_dimensions(scene)
    check_bolt_places(scene)
    check_rod(scene)
    if not whole:
        require_equal_halves(scene)
    return _with_rod_masses(scene)


def unchecked_scene(data: dict[str, Any], source: str = "scene") -> Scene:
    """Return what `scene_from_dict` does, its parts not checked to fit together: another process does that.

    Raises:
        CranktopoError: unknown key, value outside its range.
    """
    return _with_rod_masses(_of_tables(data, source))


def _of_tables(data: dict[str, Any], source: str) -> Scene:
    try:
        return _with_usual_cells(Scene.model_validate(data))
    except ValidationError as error:
        raise explain(error, source) from None


def _with_usual_cells(scene: Scene) -> Scene:
    """Return the scene with cells in proportion to its journals, where it gives no size of cells itself."""
    scale = usual_scale(scene)
    if scale == 1 or "resolution_mm" in scene.optimise.model_fields_set:
        return scene
    return scene.with_optimise(resolution_mm=float(f"{scene.optimise.resolution_mm / scale:.3g}"))


def _with_rod_masses(scene: Scene) -> Scene:
    """Return the scene with the masses of its rod in the engine, in place of those given there."""
    if scene.rod is None or scene.engine is None:
        return scene
    found = rod_mass(scene.rod, scene.engine.rod_length_mm, scene.material)
    parts: dict[str, float | None] = {
        "rod_reciprocating_kg": found.reciprocating_kg,
        "rod_rotating_kg": found.rotating_kg,
        "rod_kg": None,
        "rod_centre_from_big_end_mm": None,
    }
    masses = scene.engine.masses.model_copy(update=parts)
    return scene.model_copy(update={"engine": scene.engine.model_copy(update={"masses": masses})})


def load_scene(design: str | Path, *, whole: bool = False) -> Scene:
    """Return a validated scene from a TOML path or a built-in name; `whole` as in `scene_from_dict`.

    A line names each key that changes nothing beside the others; more tell where values are from.
    """
    design = str(design)
    path = resolve_design(design)
    data = with_resolved_files(parse_toml(design_text(design), str(path)), path.resolve().parent)
    scene = scene_from_dict(data, str(path), whole=whole)
    for line in idle_keys(scene, data):
        note(f"{scene.name}: changes nothing as the design stands: {line}")
    for line in origins(scene):
        detail(f"{scene.name}: {line}")
    return scene


def stored_scene(path: Path) -> Scene:
    """Return a design that a run reads as its own; raises CranktopoError where it was changed since."""
    return load_scene(unchanged(path))
