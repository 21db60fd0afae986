"""Options that messages advise: their own command has them, or they name the one that does."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Iterator
from pathlib import Path

import click
import pytest

import cranktopo
from cranktopo.app.main import cli as group

TASKS = Path(cranktopo.__file__).parent / "tasks"
REACHED_BY = {
    "throw_fatigue/text.py": ("fatigue", "compare"),
    "throw_fatigue/rule_text.py": ("fatigue", "compare"),
    "throw_fatigue/verdicts.py": ("fatigue", "compare"),
    "throw_fatigue/remarks.py": ("fatigue", "compare", "shaft"),
    "accuracy/optimiser_levels.py": ("optimise",),
    "designs/run_webs.py": ("evaluate",),
}
"""Files whose messages are those of other commands than their folder's."""
QUIET = ("bench", "designs/command.py")
"""Those that hold command lines, not messages."""


def commands() -> dict[str, click.Command]:
    context = click.Context(group)
    found = {name: group.get_command(context, name) for name in group.list_commands(context)}
    return {name: command for name, command in found.items() if command}


def options(command: click.Command) -> set[str]:
    own = {name for one in command.params for name in (*one.opts, *one.secondary_opts)} | {"--help"}
    subcommands = command.commands.values() if isinstance(command, click.Group) else ()
    return own.union(*map(options, subcommands))


def messages(text: str) -> Iterator[str]:
    """Strings of a module that are no docstring, their parts joined."""
    tree = ast.parse(text)
    parts = {
        id(part)
        for node in ast.walk(tree)
        if isinstance(node, ast.JoinedStr | ast.Expr)
        for part in ast.walk(node)
        if part is not node and (isinstance(node, ast.JoinedStr) or part is node.value)
    }
    for node in ast.walk(tree):
        if isinstance(node, ast.JoinedStr):
            yield "".join(str(one.value) if isinstance(one, ast.Constant) else "{}" for one in node.values)
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in parts:
            yield node.value


def strays(path: Path, told_by: tuple[str, ...], known: dict[str, set[str]]) -> Iterator[str]:
    """Options in messages that not every command which tells them has, and that name no other."""
    for message in messages(path.read_text(encoding="utf-8")):
        named = [known[name] for name in known if re.search(rf"\b{name}\b", message)]
        allowed = set.intersection(*(known[name] for name in told_by)).union(*named)
        for option in set(re.findall(r"(?<![\w-])--[a-z][A-Za-z-]+", message)) - allowed:
            yield f"{path.name}: {option}: {message}"


def test_a_message_advises_no_option_that_its_command_does_not_have() -> None:
    """`compare` advised --fillet-fraction, which `fatigue` alone had."""
    known = {name: options(command) for name, command in commands().items()}
    folders: dict[str, set[str]] = {}
    for name, command in commands().items():
        callback = command.callback
        if callback is not None:
            file = Path(inspect.unwrap(callback).__code__.co_filename)
            folders.setdefault(file.parent.name, set()).add(name)
    found = []
    for path in sorted(TASKS.rglob("*.py")):
        key = path.relative_to(TASKS).as_posix()
        told_by = REACHED_BY.get(key) or tuple(folders.get(key.partition("/")[0], ()))
        if told_by and not key.startswith(QUIET):
            found += strays(path, told_by, known)
    assert found == []


@pytest.mark.parametrize(
    ("message", "strayed"),
    [("a smaller --fillet-fraction helps", True), ("`cranktopo fatigue --fillet-fraction` helps", False)],
)
def test_a_stray_option_is_found(message: str, strayed: bool, tmp_path: Path) -> None:
    path = tmp_path / "text.py"
    path.write_text(f"TEXT = {message!r}\n", encoding="utf-8")
    known = {"loads": {"--json"}, "fatigue": {"--fillet-fraction"}}
    assert bool(list(strays(path, ("loads",), known))) == strayed
