"""Runs killed at any moment, from the first millisecond on: they resume to the same bytes, or start clean.

The kills come at random moments of the whole run, half of them in its first tenth, by SIGKILL, SIGTERM and
SIGINT in turn.
"""

from __future__ import annotations

import json
import os
import random
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
OPTIONS = ["optimise", "--resolution-mm", "4.5", "--max-iterations", "6"]
COMMAND = [sys.executable, "-c", "from cranktopo.cli.launch import main; main()"]
STOPPED = 5
ENVIRONMENT = {**os.environ, "PYTHONPATH": os.pathsep.join(sys.path)}


def start(*arguments: str) -> subprocess.Popen[str]:
    return subprocess.Popen(
        [*COMMAND, *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=ENVIRONMENT
    )


def finish(*arguments: str) -> None:
    process = start(*arguments)
    _, stderr = process.communicate(timeout=300)
    assert process.returncode == STOPPED, stderr


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> tuple[bytes, float]:
    """Surface of the run that nobody killed, and the seconds that it took with its programs stored."""
    folder = tmp_path_factory.mktemp("whole")
    for name in ("first", "second"):
        began = time.perf_counter()
        finish(*OPTIONS, "--out", str(folder / name))
        seconds = time.perf_counter() - began
    assert (folder / "first" / "web.stl").read_bytes() == (folder / "second" / "web.stl").read_bytes()
    return (folder / "second" / "web.stl").read_bytes(), seconds


def kill(number: int, seconds: float, out: Path) -> str:
    """Kill one run; returns what was found afterwards."""
    draw = random.Random(number)
    moment = seconds * (draw.uniform(0.0, 0.1) if number % 2 else draw.random())
    process = start(*OPTIONS, "--out", str(out))
    time.sleep(moment)
    process.send_signal(SIGNALS[number % 3])
    stdout, stderr = process.communicate(timeout=60)
    assert "Traceback" not in stderr, f"{moment:.3f} s: {stderr}"
    if not (out / "manifest.json").is_file():
        assert not out.exists() or not any(out.iterdir()), f"{moment:.3f} s: a folder that is no run"
        return "nothing"
    status = json.loads((out / "manifest.json").read_text())["status"]
    if SIGNALS[number % 3] == signal.SIGKILL:
        return status
    assert status != "running", f"{moment:.3f} s: status left at running ({stdout} {stderr})"
    return status


@pytest.mark.slow
@pytest.mark.parametrize("number", range(100))
def test_a_killed_run_resumes_or_starts_clean(
    number: int, whole: tuple[bytes, float], tmp_path: Path
) -> None:
    surface, seconds = whole
    out = tmp_path / f"run-{number}"
    found = kill(number, seconds, out)
    if found == "nothing":
        finish(*OPTIONS, "--out", str(out))
    elif found != "done":
        finish("optimise", "--resume", str(out))
    assert (out / "web.stl").read_bytes() == surface
