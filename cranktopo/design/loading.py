"""From a TOML path or the name of a built-in design to a validated scene."""

from __future__ import annotations

import os
import re
import shlex
import tomllib
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cranktopo.base.errors import CranktopoError, quoted, suggest
from cranktopo.base.files import read_text_file
from cranktopo.design.checks.scene import check_scene
from cranktopo.design.halves import require_equal_halves
from cranktopo.design.messages import explain
from cranktopo.design.schema import Scene
from cranktopo.runs.directories import runs_named

# Keys of the scene that name a file, relative to the design.
FILE_KEYS = (("engine", "gas", "indicator_csv"), ("envelope", "file"), ("original", "file"))
_GEOMETRY = {".stl": "an STL", ".step": "a STEP", ".stp": "a STEP", ".iges": "an IGES", ".igs": "an IGES"}
_BODIES = ("an STL", "a STEP")
"""Kinds of files that a command takes as a target."""
_HEADS = {"ISO-10303-21": "a STEP", "solid ": "an STL", "{": "a JSON"}
_TOML_HINT = "Fix that line; `cranktopo designs new FILE` writes a design to start from."
_TOML_PLACE = re.compile(r"at line (\d+), column")
_PACKAGE = Path(__file__).resolve().parents[1]


def designs_folder() -> Path:
    """Folder of the built-in designs: inside an installed package, or beside it in a checkout."""
    packaged = _PACKAGE / "designs"
    return packaged if packaged.is_dir() else _PACKAGE.parent / "designs"


def builtin_designs() -> list[str]:
    """Names of the built-in designs."""
    return sorted(path.stem for path in designs_folder().glob("*.toml"))


def resolve_design(design: str) -> Path:
    """Path of a design given as a TOML path or a built-in name.

    Raises:
        CranktopoError: neither a file nor a built-in design.
    """
    if os.path.exists(design) and not os.path.isdir(design):
        return Path(design)
    if design in builtin_designs():
        return designs_folder() / f"{design}.toml"
    given = f"design {quoted(design, 400)}"
    if os.path.isfile(os.path.join(design, "manifest.json")) or (design and runs_named(design)):
        raise CranktopoError(
            f"{given}: is a run, not a design.",
            hint="`cranktopo remodel RUN` makes a design of it (TOML, STEP, STL, drawing), "
            "`cranktopo extract RUN` writes its surface.",
        )
    if os.path.isdir(design):
        raise CranktopoError(f"{given}: is a folder, not a TOML file.", hint="Name the file in it.")
    raise CranktopoError(
        f"{given}: no such file or built-in design.", hint=suggest(design[:100], builtin_designs())
    )


def design_text(design: str) -> str:
    """Text of a design.

    Args:
        design: TOML path or name of a built-in design.

    Raises:
        CranktopoError: no such design, or none that can be read.
    """
    path = resolve_design(design)
    kind = _GEOMETRY.get(path.suffix.lower())
    text = "" if kind else read_text_file(path, f"design {quoted(str(path), 400)}")
    kind = kind or next((kind for head, kind in _HEADS.items() if text.startswith(head)), None)
    if kind:
        target = f"Give it as a target: cranktopo evaluate {shlex.quote(str(path))} --design DESIGN"
        other = (
            "Export the body as STEP." if kind == "an IGES" else "`cranktopo designs new FILE` writes one."
        )
        raise CranktopoError(
            f"design {quoted(str(path), 400)}: is {kind} file; a design is a TOML file.",
            hint=target if kind in _BODIES else other,
        )
    return text


def parse_scene(
    text: str, source: str = "scene", folder: Path | None = None, *, whole: bool = False
) -> Scene:
    """Return a validated scene from TOML text.

    Args:
        text: the TOML document.
        source: name shown in messages.
        folder: folder that relative file names in the scene refer to; the current one by default.
        whole: as `scene_from_dict`.

    Raises:
        CranktopoError: malformed TOML, unknown key, value outside its range, inconsistent geometry.
    """
    data = with_resolved_files(parse_toml(text, source), folder or Path.cwd())
    return scene_from_dict(data, source, whole=whole)


def parse_toml(text: str, source: str) -> dict[str, Any]:
    """The tables of a TOML document as they are written; raises CranktopoError where it is malformed."""
    try:
        return tomllib.loads(text)
    except (ValueError, RecursionError) as error:  # ValueError: also an integer of thousands of digits
        reason = _toml_reason(error, text)
        raise CranktopoError(f"{source}: not valid TOML: {reason}.", hint=_TOML_HINT) from None


def _toml_reason(error: Exception, text: str) -> str:
    """Return what the parser says, with the line that it is about."""
    if isinstance(error, tomllib.TOMLDecodeError):
        reason, place = quoted(str(error))[1:-1], _TOML_PLACE.search(str(error))
        lines = text.splitlines()[int(place[1]) - 1 :] if place else []
        return f"{reason}: {quoted(lines[0].strip())}" if lines else reason
    return "its arrays are too deep" if isinstance(error, RecursionError) else "a number has too many digits"


def with_resolved_files(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The tables of a scene with file names made absolute; data of a wrong type is left for validation."""
    for keys in FILE_KEYS:
        data = _resolved(data, keys, folder)
    return data


def _resolved(data: Any, keys: tuple[str, ...], folder: Path) -> Any:
    if not keys:
        return os.path.realpath(folder / data) if isinstance(data, str) and "\0" not in data else data
    if not isinstance(data, dict) or keys[0] not in data:
        return data
    return {**data, keys[0]: _resolved(data[keys[0]], keys[1:], folder)}


def input_files(scene: Scene) -> dict[str, Path]:
    """Files that a scene refers to, by dotted key."""
    found: dict[str, Path] = {}
    for keys in FILE_KEYS:
        value: Any = scene
        for key in keys:
            value = getattr(value, key, None)
        if value is not None:
            found[".".join(keys)] = Path(value)
    return found


def scene_from_dict(data: dict[str, Any], source: str = "scene", *, whole: bool = False) -> Scene:
    """Return a validated scene from plain data.

    Args:
        data: the tables of the scene, file names absolute.
        source: name shown in messages.
        whole: the halves of the throw may differ; else, what models half of it is safe with the scene.

    Raises:
        CranktopoError: unknown key, value outside its range, inconsistent geometry, halves that differ.
    """
    try:
        scene = Scene.model_validate(data)
    except ValidationError as error:
        raise explain(error, source) from None
    check_scene(scene)
    if not whole:
        require_equal_halves(scene)
    return scene


def load_scene(design: str, *, whole: bool = False) -> Scene:
    """Return a validated scene from a TOML path or the name of a built-in design.

    Args:
        whole: as `scene_from_dict`.

    Raises:
        CranktopoError: as `parse_scene`, or no such design.
    """
    path = resolve_design(design)
    return parse_scene(design_text(design), str(path), path.resolve().parent, whole=whole)
