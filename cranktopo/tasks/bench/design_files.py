"""Files that designs on the bench name: inside its folder, made absolute."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.design.edits import changed_text
from cranktopo.design.scene_files import input_files, with_resolved_files
from cranktopo.design.toml_text import parse_toml


def check_files_inside(data: Mapping[str, Any], folder: Path, trusted: Mapping[str, Any]) -> None:
    """Refuse a design that names a file outside the folder, unless the opened design names it as well."""
    root = folder.resolve()
    known, files = set(input_files(trusted).values()), input_files(data)
    for key, name in input_files(with_resolved_files(dict(data), root)).items():
        if name not in known and not name.is_relative_to(root):
            raise CranktopoError(
                f"{key} = {quoted(str(files[key]))}: lies outside the folder of the bench.",
                hint="Put the file into that folder.",
            )


def changed_files(text: str, folder: Path) -> str:
    """Return the text of a design with absolute names of the files that it names."""
    data = parse_toml(text, "design")
    absolute = {key: str((folder / name).resolve()) for key, name in input_files(data).items()}
    return changed_text(text, absolute, "design") if absolute else text
