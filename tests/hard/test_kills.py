"""Work killed at any moment, from the first millisecond on: it resumes to the same bytes, or starts clean.

The kills come at random moments of the whole work, by SIGKILL, SIGTERM and SIGINT in turn; half of those of
`optimise` in its first tenth. All of them: `python -m pytest tests/hard/test_kills.py -m slow -n 0`.
"""

from __future__ import annotations

import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from datetime import UTC, datetime
from pathlib import Path

import pytest

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
OPTIMISE = ["optimise", "--resolution-mm", "4.5", "--max-iterations", "6"]
LOOP = ["iterate", "--steps", "2", "--resolution-mm", "4.5", "--element-size-mm", "12", "--process", "free"]
COMMAND = [sys.executable, "-c", "from cranktopo.app.launch import main; main()"]
DONE, STOPPED = 0, 5
ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}


def start(*arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*COMMAND, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT
    )


def finish(*arguments: str, code: int = DONE) -> float:
    """Run a command to its end; returns the seconds that it took."""
    began = time.perf_counter()
    process = start(*arguments)
    _, stderr = process.communicate(timeout=1200)
    assert process.returncode == code, stderr
    return time.perf_counter() - began


def kill(number: int, moment: float, *arguments: str) -> str:
    """Kill a command after so many seconds, by one of the signals in turn; returns what it said."""
    process = start(*arguments)
    time.sleep(moment)
    process.send_signal(SIGNALS[number % 3])
    stdout, stderr = process.communicate(timeout=600)
    said = f"{moment:.3f} s, exit code {process.returncode}: {stdout}{stderr}"
    assert "Traceback" not in stderr, said
    return said


def status_of(run: Path, number: int, said: str, before: str) -> str:
    """Status of a run after a kill, or "nothing" where it left nothing.

    SIGKILL leaves "running" behind; what is killed while it is loaded leaves the status before.
    """
    if not (run / "manifest.json").is_file():
        assert not run.exists() or not any(run.iterdir()), f"{said}: a folder that is no run"
        return "nothing"
    status = json.loads((run / "manifest.json").read_text())["status"]
    told = SIGNALS[number % 3] != signal.SIGKILL and before != "running"
    assert status != "running" or not told, f"{said}: left at running"
    return status


def begin(out: Path) -> list[str]:
    return [*OPTIMISE, "--out", str(out)]


def resume(out: Path) -> list[str]:
    return ["optimise", "--resume", str(out)]


@pytest.fixture(scope="module")
def optimised(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, float]:
    """A run that nobody killed, and the seconds that it took with its programs stored."""
    folder = tmp_path_factory.mktemp("optimised")
    for name in ("first", "second"):
        seconds = finish(*begin(folder / name), code=STOPPED)
    assert (folder / "first" / "web.stl").read_bytes() == (folder / "second" / "web.stl").read_bytes()
    return folder / "second", seconds


@pytest.mark.slow
@pytest.mark.parametrize("chain", range(10))
def test_runs_killed_again_and_again(chain: int, optimised: tuple[Path, float], tmp_path: Path) -> None:
    """Ten kills, each of what the one before left: a run that resumes, or nothing. All runs end in the same
    bytes.
    """
    run, seconds = optimised
    out, found = tmp_path / "run-0", "nothing"
    draw = random.Random(chain)
    for number in range(10 * chain, 10 * chain + 10):
        moment = seconds * (draw.uniform(0.0, 0.1) if number % 2 else draw.random())
        said = kill(number, moment, *(begin(out) if found == "nothing" else resume(out)))
        found = status_of(out, number, said, found)
        if found == "done":
            assert (out / "web.stl").read_bytes() == (run / "web.stl").read_bytes(), said
            out, found = tmp_path / f"run-{number}", "nothing"
    finish(*(begin(out) if found == "nothing" else resume(out)), code=STOPPED)
    assert (out / "web.stl").read_bytes() == (run / "web.stl").read_bytes()


@pytest.mark.slow
def test_a_killed_remodel_leaves_nothing_and_starts_clean(
    optimised: tuple[Path, float], tmp_path: Path
) -> None:
    """Nine kills, then one that ends: the same bytes as that of a copy of the run that nobody killed."""
    run, whole = (shutil.copytree(optimised[0], tmp_path / name) for name in ("run", "whole"))
    seconds = finish("remodel", str(whole), "--no-evaluation")
    draw = random.Random(1)
    for number in range(9):
        said = kill(number, seconds * draw.random(), "remodel", str(run), "--no-evaluation")
        if (run / "remodel").exists():  # it was faster
            assert (run / "remodel" / "remodel.json").is_file(), said
            shutil.rmtree(run / "remodel")
    finish("remodel", str(run), "--no-evaluation")
    named = {"remodel.json", "report.html"}  # they hold the name of the run, and the seconds
    files = {path.name for path in (whole / "remodel").iterdir()} - named
    assert len(files) == 5
    for name in files:
        assert (run / "remodel" / name).read_bytes() == (whole / "remodel" / name).read_bytes(), name


def solids(loop: Path) -> dict[str, bytes]:
    """STL and STEP files of a loop, each STEP file without its date: that of the loop or of its last step."""
    found = {}
    for path in loop.rglob("*.st[el]*"):
        own = loop / "shape" if path.parent.name == "shape" else loop
        date = datetime.fromisoformat(json.loads((own / "manifest.json").read_text())["started"])
        written, content = date.astimezone(UTC).isoformat().encode(), path.read_bytes()
        assert path.suffix != ".step" or written in content, path
        found[str(path.relative_to(loop))] = content.replace(written, b"date")
    return found


@pytest.mark.slow
def test_a_loop_killed_again_and_again_ends_as_in_one_go(tmp_path: Path) -> None:
    seconds = finish(*LOOP, "--out", str(tmp_path / "whole"))
    out, found = tmp_path / "loop", "nothing"
    again = ["iterate", "--resume", str(out)]
    draw = random.Random(2)
    for number in range(9):
        moment = seconds * draw.uniform(0.0, 0.4)
        said = kill(number, moment, *([*LOOP, "--out", str(out)] if found == "nothing" else again))
        found = status_of(out, number, said, found)
        if found == "done":
            break
    if found != "done":
        finish(*again)
    assert number > 2, "some of the kills came before the end"
    assert not list(out.rglob(".*.tmp*")), "what the kills left unfinished is gone"
    assert len(solids(out)) > 8
    assert solids(out) == solids(tmp_path / "whole")
