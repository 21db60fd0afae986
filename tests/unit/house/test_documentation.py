"""The pages of docs/: what they name exists, their examples run and print what is shown."""

from __future__ import annotations

import doctest
import inspect
import os
import re
import shlex
import subprocess
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib import import_module
from pathlib import Path

import pytest

import cranktopo
from cranktopo.app.main import COMMANDS, main
from cranktopo.base.result import Result
from tests.unit.house.test_structure import FLOORS, TASKS

ROOT = Path(__file__).resolve().parents[3]
PAGES = ROOT / "docs" / "pages"
PACKAGE = ROOT / "cranktopo"
ALL_PAGES = sorted(PAGES.rglob("*.md"))
TEXT = "\n".join(page.read_text(encoding="utf-8") for page in ALL_PAGES)
ALIKE = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


@dataclass(frozen=True)
class Block:
    """A fenced block: its language, its title, its text, and whether it takes long."""

    language: str
    title: str
    text: str
    slow: bool


def blocks(page: str) -> list[Block]:
    text = (PAGES / page).read_text(encoding="utf-8")
    pattern = r'(?ms)^(<!-- slow -->\n)?```(\w+)(?: title="([^"]*)")?\n(.*?)^```$'
    return [Block(found[1], found[2], found[3], bool(found[0])) for found in re.findall(pattern, text)]


Said = tuple[int, str, str]
"""Exit code, stdout and stderr."""


def run_tutorial(folder: Path, given: Callable[[str], Said], *, slow: bool) -> None:
    """Give every command in order in one folder; those of slow blocks too, or only the others."""
    for block in blocks("tutorial.md"):
        if block.title:
            (folder / block.title).write_text(block.text, encoding="utf-8")
        if block.language != "console" or (block.slow and not slow):
            continue
        for command, shown in re.findall(r"(?ms)^\$ ([^\n]*)\n(.*?)(?=^\$ |\Z)", block.text):
            code, out, err = given(command)
            assert code == 0, f"{command}\n{err}"
            if not block.slow:  # what is meshed or compiled differs in the last digits between machines
                assert doctest.OutputChecker().check_output(shown, out, ALIKE), out


def run_python(folder: Path, capsys: pytest.CaptureFixture[str], *, slow: bool) -> None:
    """The examples one after the other in one namespace, as in a notebook."""
    names: dict[str, object] = {}
    for block in blocks("python.md"):
        if block.slow and not slow:
            continue
        exec(compile(block.text, "python.md", "exec"), names)
        assert capsys.readouterr().out.splitlines() == re.findall(r"(?m)^# (.*)$", block.text)


def test_tutorial_begins_as_shown(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """In this process; the whole of it below in a shell, as a reader does it."""
    monkeypatch.chdir(tmp_path)

    def given(command: str) -> Said:
        program, *words = shlex.split(command)
        assert program == "cranktopo"
        capsys.readouterr()
        return main(words), *capsys.readouterr()

    run_tutorial(tmp_path, given, slow=False)
    assert (tmp_path / "throw.step").is_file()


def test_results_that_the_python_page_names_are_as_it_says() -> None:
    """Every public model is named; what is to go on with gives its model in the way that is told."""
    text = (PAGES / "python.md").read_text(encoding="utf-8").split("## Results")[1].split("## ")[0]
    named = re.findall(r"`(\w+)`", text.split("for annotations:")[1].split("\n\n")[0])
    public = {name: getattr(cranktopo, name) for name in cranktopo.__all__}
    models = {name for name, kind in public.items() if inspect.isclass(kind) and issubclass(kind, Result)}
    assert named == sorted(models)
    members = re.findall(r"`([A-Z]\w+)\.(\w+)", text)
    functions = re.findall(r"`(\w+)\(([A-Z]\w+)\)`", text)
    assert (len(members), len(functions)) == (3, 2)
    assert all(hasattr(getattr(cranktopo, owner), name) for owner, name in members)
    for function, given in functions:
        first = next(iter(inspect.signature(getattr(cranktopo, function)).parameters.values()))
        assert first.annotation == given, function


@pytest.mark.slow
def test_whole_tutorial_runs(tmp_path: Path) -> None:
    path = f"{Path(sys.executable).parent}{os.pathsep}{os.environ['PATH']}"

    def given(command: str) -> Said:
        done = subprocess.run(
            ["bash", "-c", command],
            cwd=tmp_path,
            env={**os.environ, "PATH": path},
            capture_output=True,
            text=True,
            check=False,
        )
        return done.returncode, done.stdout, done.stderr

    run_tutorial(tmp_path, given, slow=True)
    assert "torsion per mass" in (tmp_path / "table.md").read_text(encoding="utf-8")
    assert (tmp_path / "web.step").is_file()


def test_quick_python_examples_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    run_python(tmp_path, capsys, slow=False)


@pytest.mark.slow
def test_all_python_examples_run(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    run_python(tmp_path, capsys, slow=True)
    assert (tmp_path / "web.stl").is_file()


def test_every_room_is_explained_in_the_order_of_imports() -> None:
    text = (PAGES / "rooms.md").read_text(encoding="utf-8")
    storeys = re.findall(r"(?m)^\| (\d?) ?\| `(\w+)/` \| (.+) \|$", text)
    floors: list[set[str]] = []
    for number, room, said in storeys:
        assert len(said) > 20
        floors = [{room}, *floors] if number else [floors[0] | {room}, *floors[1:]]
    assert floors == list(FLOORS)
    tasks = re.findall(r"(?m)^\| `(\w+)/` \| (.+) \| (?:`(\w+)` )?\|$", text)
    assert [name for name, _, _ in tasks] == list(TASKS)
    assert {command for _, _, command in tasks if command} == set(COMMANDS)


@pytest.mark.parametrize("module", sorted(set(re.findall(r"python -m (tests\.benchmarks\.\w+)", TEXT))))
def test_benchmarks_exist(module: str) -> None:
    path = ROOT / module.replace(".", "/")
    assert path.with_suffix(".py").is_file() or (path / "__main__.py").is_file()


def test_commands_exist() -> None:
    used = set(re.findall(r"(?:^\$ |^|`)cranktopo ([a-z]+)", TEXT, re.M))
    assert used <= set(COMMANDS)
    assert len(used) > 12


IMPORTED = re.findall(r"(?m)^from (cranktopo[\w.]*) import (\([^)]*\)|[\w, ]+)$", TEXT)
"""Of the examples, slow ones too."""


@pytest.mark.parametrize(("module", "names"), IMPORTED, ids=[module for module, _ in IMPORTED])
def test_what_the_examples_import_exists(module: str, names: str) -> None:
    found = import_module(module)
    assert [name for name in re.findall(r"\w+", names) if not hasattr(found, name)] == []


@pytest.mark.parametrize("path", sorted(set(re.findall(r"`((?:\w+/)+\w+\.py)`", TEXT))))
def test_named_files_exist(path: str) -> None:
    assert (ROOT / path).is_file() or (PACKAGE / path).is_file()


def test_the_glossary_says_each_word_once_in_one_or_two_sentences() -> None:
    text = (PAGES / "glossary.md").read_text(encoding="utf-8")
    words = re.findall(r"(?m)^\| (?!word|-)(.+?) \| (.+) \|$", text)
    assert len({word.lower() for word, _ in words}) == len(words) >= 60
    assert all(1 <= len(re.findall(r"\.(?: |$)", meaning)) <= 2 for _, meaning in words)


def test_every_benchmark_table_names_its_command_date_and_machine() -> None:
    """In the form that docs/record.py writes, so that it finds and replaces them."""
    marked = re.findall(r"(?ms)^<!-- benchmark: (\S[^\n]*) -->\n(.*?)\n\n(.*?)\n<!-- end -->", TEXT)
    assert len(marked) == TEXT.count("<!-- benchmark:") == TEXT.count("<!-- end -->") > 8
    for command, heading, table in marked:
        found = re.fullmatch(
            r"Measured \d{4}-\d\d-\d\d, \d+ cores of .+: `python -m tests\.benchmarks\.(.+)`", heading
        )
        assert found is not None, command
        assert found[1] == command
        assert all(line.startswith("|") for line in table.splitlines())
