"""A run killed between a result and its hash, or the other way round, goes on to the same files."""

from __future__ import annotations

import json
import shutil
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import write_bytes
from cranktopo.design.loading import load_scene
from cranktopo.runs.checkpoint import load_checkpoint, save_checkpoint
from cranktopo.runs.directories import RunStore
from tests.cli.test_iterate import ARGUMENTS, with_stand_ins
from tests.plain_runs import plain_loops

HASH, FILE = "cranktopo.runs.directories.RunStore.record", "cranktopo.runs.stored.write_bytes"
DONE_STEPS = 3
"""The original web and two steps."""


class Killed(BaseException):
    """What no block of the program catches, as a SIGKILL: nothing is cleared or recorded after it."""


@contextmanager
def killed_at(target: str, number: int, real: Callable[..., Any]) -> Iterator[None]:
    """A block in which so many calls of a function end well, and none after them begins."""
    calls = []

    def call(*arguments: Any) -> Any:
        calls.append(arguments)
        if len(calls) > number:
            raise Killed
        return real(*arguments)

    with patch(target, call):
        yield


def lasting(run: Path) -> dict[str, Any]:
    """What a loop ends with, without the times that its steps took."""
    found: dict[str, Any] = {str(file.relative_to(run)): file.read_bytes() for file in run.rglob("*.stl")}
    for file in run.glob("step-*/web.toml"):  # a run that goes on writes the defaults out, too
        found[str(file.relative_to(run))] = load_scene(file).model_dump()
    for file in run.rglob("step.json"):
        step = json.loads(file.read_text())
        step["step"].pop("seconds")
        found[str(file.relative_to(run))] = step
    return found


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    run = tmp_path_factory.mktemp("whole") / "run"
    with pytest.MonkeyPatch.context() as patched, plain_loops():
        with_stand_ins(patched)
        assert main([*ARGUMENTS, "--out", str(run), "--quiet"]) == 0
    return lasting(run)


SLOW = pytest.mark.slow
CASES = [(target, number) for target in (HASH, FILE) for number in range(DONE_STEPS)]


@pytest.mark.parametrize(
    ("target", "number"), [pytest.param(*case, marks=[SLOW] * (case != (HASH, 1))) for case in CASES]
)
def test_a_loop_killed_between_the_hash_and_the_file_of_a_step(
    target: str, number: int, whole: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_stand_ins(monkeypatch)
    run, real = tmp_path / "run", RunStore.record if target == HASH else write_bytes
    with plain_loops(), killed_at(target, number, real), pytest.raises(Killed):
        main([*ARGUMENTS, "--out", str(run), "--quiet"])
    assert json.loads((run / "manifest.json").read_text())["status"] == "running"
    assert len(list(run.rglob("step.json"))) == number
    with plain_loops():
        assert main(["iterate", "--resume", str(run), "--quiet"]) == 0
    assert lasting(run) == whole
    assert main(["report", str(run)]) == 0


@SLOW
def test_a_file_without_its_hash_is_read_with_a_line(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """A manifest that an older version wrote: the loop goes on, and says what it could not check."""
    with_stand_ins(monkeypatch)
    run = tmp_path / "run"
    with killed_at(FILE, 2, write_bytes), pytest.raises(Killed):
        main([*ARGUMENTS, "--out", str(run), "--quiet"])
    manifest = json.loads((run / "manifest.json").read_text())
    del manifest["recorded_sha256"]
    (run / "manifest.json").write_text(json.dumps(manifest))
    assert main(["iterate", "--resume", str(run)]) == 0
    assert "the run has no hash of it" in " ".join(capsys.readouterr().err.split())


@SLOW
def test_an_envelope_of_a_step_that_has_not_begun_is_written_again(
    whole: dict[str, Any], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    with_stand_ins(monkeypatch)
    run = tmp_path / "run"
    with killed_at(FILE, 2, write_bytes), pytest.raises(Killed):
        main([*ARGUMENTS, "--out", str(run), "--quiet"])
    (run / "step-01" / "envelope.stl").write_bytes(whole["original/web.stl"])
    assert main(["iterate", "--resume", str(run), "--quiet"]) == 0
    assert lasting(run) == whole


def test_a_checkpoint_and_its_hash_are_one_file(tmp_path: Path) -> None:
    """A kill before the rename leaves the old one whole: there is no moment between values and hash."""
    path = tmp_path / "state.npz"
    first, second = ({"x": np.full(3, value)} for value in (1.0, 2.0))
    save_checkpoint(path, first, {"iteration": 1})
    with patch("cranktopo.base.files.os.replace", side_effect=Killed), pytest.raises(Killed):
        save_checkpoint(path, second, {"iteration": 2})
    assert load_checkpoint(path).state == {"iteration": 1}
    whole = shutil.copy(path, tmp_path / "whole.npz")
    save_checkpoint(path, second, {"iteration": 2})
    with np.load(whole) as old, np.load(path) as new:
        mixed = {**dict(new), "x": old["x"]}
    np.savez(path, **mixed)
    with pytest.raises(CranktopoError, match="changed since it was written") as raised:
        load_checkpoint(path)
    assert raised.value.code == ExitCode.INVALID_INPUT
