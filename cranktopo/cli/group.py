"""Groups of commands that load late and suggest the right name."""

from __future__ import annotations

import importlib
from collections.abc import Mapping
from typing import Any

import click

from cranktopo.errors import suggest


class SuggestingGroup(click.Group):
    """A click group that suggests the right name of a misspelt command."""

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """As click does, with a suggestion for a misspelt command.

        Args:
            args: the words of the command line from the command on.

        Raises:
            click.UsageError: no such command.
        """
        name, valid = args[0], self.list_commands(ctx)
        if name not in valid and not name.startswith("-"):
            raise click.UsageError(f"No such command '{name}'. {suggest(name, valid)}", ctx)
        return super().resolve_command(ctx, args)


class LazyGroup(SuggestingGroup):
    """A click group that imports a command's module when the command is used.

    Args:
        entries: help line of each command by name.
        package: where the modules are, named after the commands; each holds a click command `command`.
    """

    def __init__(self, *args: Any, entries: Mapping[str, str], package: str, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._entries, self._package = dict(entries), package

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Names of the commands."""
        return list(self._entries)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command of a name, imported now; None when there is none."""
        if cmd_name not in self._entries:
            return None
        command: click.Command = importlib.import_module(f"{self._package}.{cmd_name}").command
        return command

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """The command list, from the table and not from the modules."""
        with formatter.section("Commands"):
            formatter.write_dl(list(self._entries.items()))
