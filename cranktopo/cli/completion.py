"""`cranktopo completion`: what a shell needs to complete the command line."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from cranktopo.cli.parameters import Choice

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

_SHELLS = ("bash", "zsh", "fish")
_VARIABLE = "_CRANKTOPO_COMPLETE"


@click.command("completion")
@click.argument("shell", type=Choice(_SHELLS))
def command(shell: str) -> None:
    """Print the completion script of SHELL; the shell's start-up file evaluates it.

    \b
    bash  echo 'eval "$(cranktopo completion bash)"' >> ~/.bashrc
    zsh   echo 'eval "$(cranktopo completion zsh)"' >> ~/.zshrc
    fish  cranktopo completion fish > ~/.config/fish/completions/cranktopo.fish

    Example: eval "$(cranktopo completion bash)"
    """
    from click.shell_completion import get_completion_class

    from cranktopo.cli.main import cli

    kind = get_completion_class(shell)
    if kind is None:
        raise click.UsageError(f"click knows no completion for {shell}")
    click.echo(kind(cli, {}, "cranktopo", _VARIABLE).source())


def designs(context: click.Context, parameter: click.Parameter, incomplete: str) -> list[CompletionItem]:
    """Names of built-in designs, and files, for an argument's `shell_complete`."""
    from click.shell_completion import CompletionItem

    from cranktopo.scene.loading import builtin_designs

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

    from cranktopo.store import list_runs

    names = [CompletionItem(run.name) for run in list_runs() if run.name.startswith(incomplete)]
    return [*names, CompletionItem(incomplete, type="dir")]
