"""Every option of every command does something: it changes what the command gives, or is refused with a line.

A new option fails `test_every_option_is_declared` until tests/option_cases.py says in which case it acts.
"""

from __future__ import annotations

import hashlib
import importlib
import inspect
import json
import pkgutil
import re
import shlex
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Any

import click
import pytest

import cranktopo
from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import designs_folder
from cranktopo.runs.directories import create_run
from tests.every_command import every_command
from tests.option_cases import MIKRON, QUIET, TABLE, Case, Refused, Shown

ROOT = Path(__file__).parents[2]
Given = tuple[int, str, dict[str, str]]
"""Outcome of a command: its code, what it says, and its files by name, each with a digest."""


LONG = (
    "optimise.stage.optimise_design",
    "iterate.loop.start_loop",
    "web_shape.run.shape_design",
    "web_shape.each_web.run.shape_each_web",
    "bound.stage.bound_of",
    "sweep.run.run_sweep",
    "refit.stage.remodel_run",
    "accuracy.stage.study_accuracy",
    "throw_fatigue.stage.assess_fatigue",
    "throw_fea.stage.evaluate_targets",
    "compare.stage.compare_targets",
    "report.stage.report_run",
    "shaft_safety.stage.assess_shaft",
    "modes.stage.shaft_modes",
    "export.reduced.export_reduced",
)
"""Work that takes long: the command ends there with a line of what that was given."""
_NOT_GIVEN = ("progress", "began", "command")
DECLARED = [
    pytest.param(name, option, id=f"{name} {option}")
    for name, options in TABLE.items()
    for option, case in options.items()
    if not isinstance(case, Shown)
]


def options(command: click.Command) -> Iterator[str]:
    for parameter in command.params:
        if isinstance(parameter, click.Option):
            yield next(name for name in parameter.opts if name.startswith("--"))


def cases(name: str, command: click.Command) -> dict[str, Case]:
    long = {option: QUIET for option in ("--quiet", "--verbose") if option in options(command)}
    return {**TABLE.get(name, {}), **long}


def test_every_option_is_declared() -> None:
    declared = {name: set(cases(name, command)) for name, command in every_command().items()}
    assert declared == {name: set(options(command)) for name, command in every_command().items()}


def test_tests_that_show_an_option_exist() -> None:
    shown = {case.test for own in TABLE.values() for case in own.values() if isinstance(case, Shown)}
    for place in {*shown, QUIET.test}:
        file, name = place.split("::")
        assert f"def {name}(" in (ROOT / "tests" / file).read_text(encoding="utf-8"), place


@pytest.fixture(scope="module")
def known() -> dict[tuple[str, str], Given]:
    """Outcomes of commands with words that several options add to."""
    return {}


@pytest.mark.parametrize(("name", "option"), DECLARED)
def test_it_acts_or_is_refused(
    name: str,
    option: str,
    run: Path,
    known: dict[tuple[str, str], Given],
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1700000000")
    case = TABLE[name][option]
    assert not isinstance(case, Shown)

    def given(words: str) -> Given:
        shutil.rmtree(tmp_path / "work", ignore_errors=True)
        folder(tmp_path / "work", run)
        monkeypatch.chdir(tmp_path / "work")
        capsys.readouterr()
        code = main([*name.split(), *shlex.split(words)])
        said = capsys.readouterr()
        return code, plain(said.out + said.err), files(tmp_path / "work")

    if isinstance(case, Refused):
        code, said, _ = given(case.words)
        assert code in (2, 3), said
        assert case.line in said
        return
    with told_instead_of_done(monkeypatch):
        if (name, case.words) not in known:
            without = given(case.words)
            assert given(case.words) == without, "the same words give the same, or a difference says nothing"
            known[name, case.words] = without
        assert given(f"{case.words} {case.option}") != known[name, case.words]


@pytest.fixture(scope="module", autouse=True)
def everything_imported() -> None:
    """No module is imported while work is replaced: it would keep the stand-in for good."""
    for module in pkgutil.walk_packages(cranktopo.__path__, "cranktopo."):
        importlib.import_module(module.name)


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A run that was interrupted."""
    path = tmp_path_factory.mktemp("made") / "run"
    made = create_run(
        design="made", design_toml="", scene={"name": "made"}, options={}, command=["cranktopo"], out=path
    )
    made.set_status("interrupted")
    return path


def folder(path: Path, run: Path) -> None:
    """Make a folder with designs, a run that was interrupted, and a file that is in the way."""
    shutil.copytree(run, path / "run")
    mikron = (designs_folder() / f"{MIKRON}.toml").read_text(encoding="utf-8")
    shaft = "[shaft]\nthrow_stiffness_Nm_per_rad = 1.4e5\nspeed_min_rpm = 2000.0\nspeed_max_rpm = 2200.0\n\n"
    given = mikron.replace("[engine]\n", f"{shaft}[engine]\n", 1)
    given = given.replace("[effects]\n", "[effects]\nthreshold = 0.5\n", 1)  # no varying inertia: faster
    (path / "given.toml").write_text(given, encoding="utf-8")
    other = mikron.replace("thickness_mm = 19.0", "thickness_mm = 17.0", 1)
    (path / "thinner.toml").write_text(other, encoding="utf-8")
    # Room for every counterweight: faster.
    single = mikron[: mikron.index("[envelope]")].replace("cylinders = 4", "cylinders = 1", 1)
    single = single.replace("firing_order = [1, 3, 4, 2]", "firing_order = [1]", 1)
    (path / "single.toml").write_text(single, encoding="utf-8")
    (path / "taken.svg").touch()


def files(path: Path) -> dict[str, str]:
    found = (file for file in sorted(path.rglob("*")) if file.is_file())
    return {str(file.relative_to(path)): hashlib.sha256(file.read_bytes()).hexdigest() for file in found}


def plain(said: str) -> str:
    """Return an output without the seconds that it took and the places of objects in memory."""
    with suppress(ValueError):
        said = json.dumps({k: v for k, v in json.loads(said).items() if k != "seconds"})
    return re.sub(r" at 0x[0-9a-f]+|\d+\.\d+ s\b|\d+(\.\d+)? (MiB|GiB)", "", said)


@contextmanager
def told_instead_of_done(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    with monkeypatch.context() as patched:
        for place in LONG:
            module, name = f"cranktopo.tasks.{place}".rsplit(".", 1)
            patched.setattr(f"{module}.{name}", told(getattr(importlib.import_module(module), name)))
        yield


def told(work: Callable[..., Any]) -> Callable[..., Any]:
    signature = inspect.signature(work)

    def instead(*arguments: Any, **named: Any) -> Any:
        bound = signature.bind(*arguments, **named).arguments
        raise CranktopoError(str({k: v for k, v in bound.items() if k not in _NOT_GIVEN}))

    return instead
