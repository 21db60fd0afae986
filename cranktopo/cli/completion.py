"""Values that a shell offers for arguments: designs, runs, files."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem


def designs(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Names of built-in designs, and files, for an argument's `shell_complete`."""
    from click.shell_completion import CompletionItem

    from cranktopo.design.loading import builtin_designs

    names = [CompletionItem(name) for name in builtin_designs() if name.startswith(incomplete)]
    return [*names, CompletionItem(incomplete, type="file")]


def designs_and_runs(
    context: click.Context, parameter: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Both, for an argument's `shell_complete`."""
    return [*runs(context, parameter, incomplete)[:-1], *designs(context, parameter, incomplete)]


def runs(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Names of runs under runs/, and folders, for an argument's `shell_complete`."""
    from click.shell_completion import CompletionItem

    from cranktopo.runs.directories import list_runs

    names = [CompletionItem(run.name) for run in list_runs() if run.name.startswith(incomplete)]
    return [*names, CompletionItem(incomplete, type="dir")]
