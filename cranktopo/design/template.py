"""A design with every key: what is needed has a value to replace, all else is switched off and explained."""

from __future__ import annotations

import json
import textwrap
from collections.abc import Iterator
from itertools import groupby
from typing import Any

from cranktopo.design.reference import KeyReference, TableReference, scene_reference

_WIDTH = 110
_HEADING = """\
{name}: a crank throw, with every key that a design may have.
Replace the values. A line that begins with "#" and a key is switched off and shows the default, or an \
example where there is none. Take one "#" off each line of a block to switch the block on; what is optional \
in it has another.
"""


def template(name: str) -> str:
    """TOML text of a design of that name with every key of a scene; it is a valid design as it stands."""
    heading = "\n".join(_prose(line) for line in _HEADING.format(name=name).splitlines())
    off: set[str] = set()
    blocks = [heading]
    for path, group in groupby(scene_reference(), key=lambda table: table.path):
        tables = list(group)
        first = tables[0]
        if first.path.rpartition(".")[0] in off or not (first.required or first.empty):
            off.add(path)
        blocks += _blocks(tables, name, "#" if path in off else "")
    return "\n\n".join(blocks) + "\n"


def _blocks(tables: list[TableReference], name: str, off: str) -> Iterator[str]:
    """Yield the block of a table; of a repeated one with choices, a block for each choice."""
    common, *choices = tables
    header = f"[[{common.path}]]" if common.repeated else f"[{common.path}]"
    top = [_prose(common.meaning), off + header] if common.path else []
    if common.repeated and choices:
        for choice in choices:
            keys = [*_lines(choice.keys, off), *_lines(common.keys, off)]
            yield "\n".join([off + header, *keys])
        return
    named = {"name": name} if not common.path else {}
    lines = [*top, *_lines(common.keys, off, named)]
    for number, choice in enumerate(choices):
        if number:
            lines.append(_prose(f"Instead of {choice.choice} and the keys that follow it above:"))
        lines += _lines(choice.keys, off + "#" * bool(number))
    yield "\n".join(lines)


def _lines(keys: tuple[KeyReference, ...], off: str, values: dict[str, Any] | None = None) -> Iterator[str]:
    """Yield the lines of keys: meaning, then the key, one `#` more when it is optional."""
    for key in keys:
        on = (key.required and not key.unless) or key.shown
        use_example = on or key.default is None
        value = (values or {}).get(key.name, key.example if use_example else key.default)
        yield _prose(f"{key.meaning} ({_facts(key)})")
        yield f"{off}{'' if on else '#'}{key.name} = {json.dumps(value, ensure_ascii=False)}"


def _facts(key: KeyReference) -> str:
    """Unit, range and whether a key is needed, in one phrase."""
    needed = f"required unless {key.unless}" if key.unless else "required" if key.required else "optional"
    kind = "" if key.kind == "number" and key.unit else key.kind
    return ", ".join(filter(None, (kind, key.unit, key.allowed, needed)))


def _prose(text: str) -> str:
    """Return the first paragraph of a text as comment lines."""
    words = " ".join(text.split("\n\n")[0].split())
    return "\n".join(textwrap.wrap(words, _WIDTH, initial_indent="# ", subsequent_indent="# "))
