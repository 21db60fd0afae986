"""A design's text as another design: its own name, its files found from its own folder."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.loading import FILE_KEYS, design_text, load_scene, resolve_design


def copy_of(design: str, file: Path) -> str:
    """Text of a design for another file, comments and order kept, without what was published about it.

    Args:
        design: TOML path or name of a built-in design.
        file: where the copy will be; it gives the name.

    Raises:
        CranktopoError: no such design or an invalid one, or a file name that no name can be made of.
    """
    import tomlkit

    load_scene(design, whole=True)
    document = tomlkit.parse(design_text(design))
    document["name"] = design_name(file)
    document.pop("published", None)
    source, target = resolve_design(design).resolve().parent, file.resolve().parent
    for keys in FILE_KEYS:
        _find_from(document, keys, source, target)
    return tomlkit.dumps(document).rstrip() + "\n"


def design_name(file: Path) -> str:
    """The name of a design that is kept in a file: the file's, with a hyphen for what no name may hold.

    Raises:
        CranktopoError: nothing is left of it.
    """
    name = re.sub(r"[^A-Za-z0-9._-]+", "-", file.stem).strip("-._")
    if not name:
        raise CranktopoError(
            f"'{file}': no name of a design can be made of '{file.stem}'.",
            hint="Use letters or digits in the file's name.",
            code=ExitCode.USAGE,
        )
    return name


def _find_from(document: Any, keys: tuple[str, ...], source: Path, target: Path) -> None:
    """Let the file that a key names relative to `source` be found from `target`."""
    *tables, key = keys
    for name in tables:
        document = document.get(name, {})
    if key in document and (source / document[key]).resolve() != (target / document[key]).resolve():
        document[key] = str((source / document[key]).resolve())
