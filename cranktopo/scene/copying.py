"""A design's text as another design: its own name, its files found from its own folder."""

from __future__ import annotations

import json
import re
import tomllib
from pathlib import Path

from cranktopo.errors import CranktopoError, ExitCode
from cranktopo.scene.loading import design_text, input_files, load_scene, parse_scene, resolve_design

_STRING = r"""("(?:[^"\\\n]|\\.)*"|'[^'\n]*')"""


def copy_of(design: str, file: Path) -> str:
    """Text of a design for another file, comments kept, without what was published about it.

    Args:
        design: TOML path or name of a built-in design.
        file: where the copy will be; it gives the name.

    Raises:
        CranktopoError: no such design or an invalid one, or a file name that no name can be made of.
    """
    original, name = load_scene(design), design_name(file)
    text = re.sub(r"(?ms)^\[published\].*?(?=^\[|\Z)", "", design_text(design)).rstrip() + "\n"
    text = _renamed(text, name)
    source = resolve_design(design).resolve().parent
    for key, path in input_files(original).items():
        text = _found_from(text, key.rpartition(".")[2], path, source, file.resolve().parent)
    copy = parse_scene(text, str(file), file.resolve().parent)
    if copy != original.model_copy(update={"name": name, "published": None}):
        raise CranktopoError(
            f"design '{design}': its name, its files or [published] are written in a way that cannot be "
            "copied.",
            hint='Write them as key = "text" and [published] as a table of its own, or copy it by hand.',
        )
    return text


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


def _renamed(text: str, name: str) -> str:
    """The text with another top-level name; tables have names of their own."""
    tables = re.search(r"(?m)^\s*\[", text)
    end = tables.start() if tables else len(text)
    head = re.sub(rf"(?m)^(\s*name\s*=\s*){_STRING}", lambda m: m[1] + json.dumps(name), text[:end], count=1)
    return head + text[end:]


def _found_from(text: str, key: str, path: Path, source: Path, target: Path) -> str:
    """The text with the values of `key` that lead to `path` from `source` leading there from `target`."""

    def moved(match: re.Match[str]) -> str:
        value = tomllib.loads(f"value = {match[2]}")["value"]
        here, there = (source / value).resolve(), (target / value).resolve()
        if here != path or there == path:
            return match[0]
        return match[1] + json.dumps(str(path), ensure_ascii=False)

    return re.sub(rf"(\b{key}\s*=\s*){_STRING}", moved, text)
