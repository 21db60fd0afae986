"""What every command has in common: help with an example, suggestions, verbosity, colour, completion."""

from __future__ import annotations

import os
import pty
import re
import shlex
import subprocess
import sys
from pathlib import Path

import click
import pytest

from cranktopo.app.main import COMMANDS, cli, main
from cranktopo.design.loading import designs_folder

SHORT = {"bench", "completion", "doctor", "runs list", "runs show", "runs clean"}
SHORT |= {"designs list", "designs copy", "designs new", "designs pair", "designs sketch"}
"""Commands that take no time and tell nothing beside their answer, or that go on until they are ended."""
PROGRAM = [sys.executable, "-c", "from cranktopo.app.main import main; main()"]


def commands() -> dict[str, click.Command]:
    """Every command and subcommand by its path."""
    found: dict[str, click.Command] = {"": cli}
    context = click.Context(cli)
    for name in COMMANDS:
        command = cli.get_command(context, name)
        assert command is not None
        found[name] = command
        if isinstance(command, click.Group):
            found |= {f"{name} {sub}": child for sub, child in command.commands.items()}
    return found


@pytest.mark.parametrize("path", commands(), ids=lambda path: path or "cranktopo")
def test_help_has_an_example_that_parses(path: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([*path.split(), "--help"]) == 0
    text = " ".join(capsys.readouterr().out.split("Options:")[0].split())
    example = re.search(r"Example: (?:eval \"\$\()?cranktopo ([^)]*)", text)
    assert example, text
    words = shlex.split(example.group(1))
    every = commands()
    name = next(n for n in (" ".join(words[:2]), words[0]) if n in every)
    assert name.startswith(path), "the example is of this command"
    arguments = words[len(name.split()) :]
    command = every[name]
    with click.Context(command, resilient_parsing=True) as context:
        _, left, _ = command.make_parser(context).parse_args(args=arguments)
    assert not [word for word in left if word.startswith("-")]


def test_every_command_that_tells_notes_can_be_quiet_or_verbose() -> None:
    names = {
        path: {option for parameter in command.params for option in parameter.opts}
        for path, command in commands().items()
        if not isinstance(command, click.Group)
    }
    without = {path for path, found in names.items() if not {"--quiet", "-q", "--verbose", "-v"} <= found}
    assert without == SHORT


@pytest.mark.parametrize("name", ["evaluate", "film", "loads", "plan", "vibration"])
def test_quiet_and_verbose_exclude_each_other(name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main([name, "-q", "-v"]) == 2
    assert "exclude each other" in capsys.readouterr().err


@pytest.mark.parametrize(
    "words",
    [
        pytest.param(["film", "car-diesel"], marks=pytest.mark.slow),
        ["loads"],
        ["plan"],
        pytest.param(["export", "mikron-iiic"], marks=pytest.mark.slow),
        pytest.param(["drawing", "mikron-iiic"], marks=pytest.mark.slow),
    ],
)
def test_a_quick_command_that_is_quiet_tells_its_answer_alone(
    words: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = [str(tmp_path / "sheet.svg"), "--force"] if words[0] in ("export", "drawing") else []
    found = []
    for quiet in ([], ["-q"]):
        assert main([*words, *file, *quiet]) == 0
        found.append(capsys.readouterr())
    assert found[0].out == found[1].out
    assert ("assumed" in found[0].err) == (not file), "the drawing of this design assumes nothing"
    assert found[1].err == ""


@pytest.mark.parametrize(
    ("arguments", "expected"),
    [
        (["optimize"], "'optimise'"),
        (["raport"], "'report'"),
        (["runs", "lisst"], "'list'"),
        (["evaluate", "--acuracy", "1"], "--accuracy"),
        (["optimise", "--volum-fraction", "0.3"], "--volume-fraction"),
        (["runs", "list", "--jsn"], "--json"),
        (["plan", "mikron-iic"], "'mikron-iiic'"),
        (["compare", "mikron-iiic-plain", "--baseline", "opposed-pistn"], "'opposed-piston'"),
    ],
    ids=" ".join,
)
def test_a_misspelt_name_suggests_the_right_one(
    arguments: list[str], expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(arguments) in (2, 3)
    line = capsys.readouterr().err
    assert "Did you mean" in line
    assert expected in line.split("Did you mean")[1]


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("thickness_mm", "thicknes_mm", "'thickness_mm'"),
        ("31CrMoV9", "31CrMov9", "'31CrMoV9'"),
        ("[supports]", "[suports]", "'supports'"),
    ],
)
def test_a_misspelt_key_or_material_suggests_the_right_one(
    tmp_path: Path, old: str, new: str, expected: str, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    (tmp_path / "mine.toml").write_text(text.replace(old, new, 1), encoding="utf-8")
    assert main(["plan", str(tmp_path / "mine.toml")]) == 3
    assert expected in capsys.readouterr().err.split("Did you mean")[1]


def on_a_terminal(environment: dict[str, str]) -> bytes:
    """What a wrong command prints on a stderr that is a terminal."""
    reader, writer = pty.openpty()
    plain = {key: value for key, value in os.environ.items() if key != "NO_COLOR"}
    subprocess.run(
        [*PROGRAM, "optimize"], stderr=writer, env={**plain, **environment, "TERM": "xterm"}, check=False
    )
    os.close(writer)
    said = os.read(reader, 10_000)
    os.close(reader)
    return said


def test_colour_only_where_it_is_wanted(capsys: pytest.CaptureFixture[str]) -> None:
    assert b"\x1b[" in on_a_terminal({})
    assert b"\x1b[" not in on_a_terminal({"NO_COLOR": "1"})
    main(["optimize"])
    assert "\x1b[" not in capsys.readouterr().err


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion_script(shell: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["completion", shell]) == 0
    assert "_CRANKTOPO_COMPLETE" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "expected"),
    [
        ("cranktopo opt", "plain,optimise"),
        ("cranktopo runs cl", "plain,clean"),
        ("cranktopo optimise --vol", "plain,--volume-fraction"),
        ("cranktopo plan mik", "plain,mikron-iiic"),
        ("cranktopo compare --format mark", "plain,markdown"),
    ],
)
def test_bash_completes(words: str, expected: str) -> None:
    found = subprocess.run(
        PROGRAM,
        env={
            **os.environ,
            "_CRANKTOPO_COMPLETE": "bash_complete",
            "COMP_WORDS": words,
            "COMP_CWORD": str(len(words.split()) - 1),
        },
        capture_output=True,
        text=True,
        check=False,
    )
    assert expected in found.stdout.splitlines()
