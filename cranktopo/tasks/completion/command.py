"""`cranktopo completion`

Print the line that makes a shell complete commands, options and designs.
"""

from __future__ import annotations

import click

from cranktopo.cli.options import Choice
from cranktopo.cli.output import pass_on

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

    kind = get_completion_class(shell)
    if kind is None:
        raise click.UsageError(f"click knows no completion for {shell}")
    pass_on(kind(click.get_current_context().find_root().command, {}, "cranktopo", _VARIABLE).source())
