"""Groups of commands that load late and suggest the right name."""

from __future__ import annotations

import importlib
import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import Any

import click

from cranktopo.base.errors import suggest

_COMMAND = re.compile(r'"""`cranktopo (?P<name>[a-z-]+)`\n\n(?P<help>.+)\n"""')


class SuggestingGroup(click.Group):
    """A click group that suggests the right name of a misspelt command."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return what click finds; raises click.UsageError with a suggestion for a misspelt command."""
        name, valid = args[0], self.list_commands(ctx)
        if name not in valid and not name.startswith("-"):
            raise click.UsageError(f"No such command '{name}'. {suggest(name, valid)}", ctx)
        return super().resolve_command(ctx, args)


@dataclass(frozen=True)
class _Found:
    """A command of a task: the folder that holds it, and its line in the help."""

    folder: str
    help: str


def found_commands(tasks: Path, first: Sequence[str]) -> dict[str, _Found]:
    """Find the commands of the tasks, none of them imported, so that `--help` stays fast.

    A task with a command has a `command.py` that begins with its name and its line in the help. Names in
    `first` are listed first; others follow by name.
    """
    found = {}
    for file in tasks.glob("*/command.py"):
        with file.open(encoding="utf-8") as text:
            named = _COMMAND.match("".join(islice(text, 4)))
        if named is None:
            raise ValueError(f"{file}: begins without the name of its command")
        found[named["name"]] = _Found(file.parent.name, named["help"])
    order = {name: place for place, name in enumerate(first)}
    return dict(sorted(found.items(), key=lambda item: (order.get(item[0], len(order)), item[0])))


class LazyGroup(SuggestingGroup):
    """A click group that imports a command's module when the command is used.

    Entries are folders of a package by the name of their command; each `command.py` there holds a `command`.
    """

    def __init__(self, *args: Any, entries: Mapping[str, _Found], package: str, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._entries, self._package = dict(entries), package

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names of the commands."""
        return list(self._entries)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return the command of a name, imported now; None when there is none."""
        if cmd_name not in self._entries:
            return None
        module = f"{self._package}.{self._entries[cmd_name].folder}.command"
        command: click.Command = importlib.import_module(module).command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the command list, from what was found and not from the modules."""
        with formatter.section("Commands"):
            formatter.write_dl([(name, entry.help) for name, entry in self._entries.items()])
