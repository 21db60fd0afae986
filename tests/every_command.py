"""Every command of the command line with its parameters, as its own registry has them."""

from __future__ import annotations

from collections.abc import Iterator

import click

from cranktopo.app.main import cli


def every_command() -> dict[str, click.Command]:
    """Return the commands that do something by the words that call them: `plan`, `runs list`."""
    return dict(_leaves(cli, ""))


def _leaves(group: click.Group, before: str) -> Iterator[tuple[str, click.Command]]:
    context = click.Context(group)
    for name in group.list_commands(context):
        command = group.get_command(context, name)
        assert command is not None
        if isinstance(command, click.Group):
            yield from _leaves(command, f"{before}{name} ")
        else:
            yield before + name, command
