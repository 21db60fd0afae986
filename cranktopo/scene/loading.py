"""From a TOML path or the name of a built-in design to a validated scene."""

from __future__ import annotations

import tomllib
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from cranktopo.errors import CranktopoError, suggest
from cranktopo.scene.checks import check_scene
from cranktopo.scene.messages import explain
from cranktopo.scene.schema import Scene

# Keys of the scene that name a file, relative to the design.
FILE_KEYS = (("engine", "gas", "indicator_csv"), ("envelope", "file"))
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
    path = Path(design)
    if path.is_file():
        return path
    builtin = designs_folder() / f"{design}.toml"
    if builtin.is_file():
        return builtin
    what = "is a folder, not a TOML file" if path.is_dir() else "no such file or built-in design"
    raise CranktopoError(f"design '{design}': {what}.", hint=suggest(design, builtin_designs()))


def design_text(design: str) -> str:
    """Text of a design.

    Args:
        design: TOML path or name of a built-in design.

    Raises:
        CranktopoError: no such design, or none that can be read.
    """
    path = resolve_design(design)
    try:
        return path.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise CranktopoError(f"design '{design}': cannot be read: {error}.") from None


def parse_scene(text: str, source: str = "scene", folder: Path | None = None) -> Scene:
    """A validated scene from TOML text.

    Args:
        text: the TOML document.
        source: name shown in messages.
        folder: folder that relative file names in the scene refer to; the current one by default.

    Raises:
        CranktopoError: malformed TOML, unknown key, value outside its range, inconsistent geometry.
    """
    try:
        data = tomllib.loads(text)
    except tomllib.TOMLDecodeError as error:
        raise CranktopoError(f"{source}: not valid TOML: {error}.", hint="Fix that line.") from None
    return scene_from_dict(_with_resolved_files(data, folder or Path.cwd()), source)


def _with_resolved_files(data: dict[str, Any], folder: Path) -> dict[str, Any]:
    """The data with every file name made absolute; data of a wrong type is left for validation."""
    for keys in FILE_KEYS:
        data = _resolved(data, keys, folder)
    return data


def _resolved(data: Any, keys: tuple[str, ...], folder: Path) -> Any:
    if not keys:
        return str((folder / data).resolve()) if isinstance(data, str) else data
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


def scene_from_dict(data: dict[str, Any], source: str = "scene") -> Scene:
    """A validated scene from plain data.

    Args:
        data: the tables of the scene, file names absolute.
        source: name shown in messages.

    Raises:
        CranktopoError: unknown key, value outside its range, inconsistent geometry.
    """
    try:
        scene = Scene.model_validate(data)
    except ValidationError as error:
        raise explain(error, source) from None
    check_scene(scene)
    return scene


def load_scene(design: str) -> Scene:
    """A validated scene from a TOML path or the name of a built-in design; raises CranktopoError."""
    path = resolve_design(design)
    return parse_scene(design_text(design), str(path), path.resolve().parent)
