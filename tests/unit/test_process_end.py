"""Processes end without a word about solids that something still holds."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
HOLDING = """
import threading
from manifold3d import Manifold

def hold(ready):
    solid = Manifold.cube((1, 1, 1))
    ready.set()
    threading.Event().wait()
    print(solid)

def begin():
    ready = threading.Event()
    threading.Thread(target=hold, args=(ready,), daemon=True).start()
    ready.wait()
"""
TEST = """
def test_it():
    begin()
    assert EXPECTED
"""
COMMAND = """
import sys
from cranktopo.cli.launch import main
begin()
sys.argv = ["cranktopo", "--version"]
main()
"""


def ended(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    others = {name: value for name, value in os.environ.items() if not name.startswith("PYTEST_")}
    path = os.pathsep.join([str(ROOT), os.environ.get("PYTHONPATH", "")])
    return subprocess.run(
        [sys.executable, *arguments],
        capture_output=True,
        text=True,
        check=False,
        cwd=folder,
        env={**others, "PYTHONPATH": path},
    )


@pytest.mark.parametrize(("expected", "code"), [(True, 0), (False, 1)])
def test_test_processes(expected: bool, code: int, tmp_path: Path) -> None:
    file = tmp_path / "test_it.py"
    file.write_text(HOLDING + TEST.replace("EXPECTED", str(expected)), encoding="utf-8")
    done = ended(
        tmp_path, "-m", "pytest", "-p", "tests.conftest", "-n", "1", "-q", "--basetemp=tmp", str(file)
    )
    assert done.returncode == code
    assert done.stderr == ""
    assert "nanobind" not in done.stdout


def test_the_command(tmp_path: Path) -> None:
    done = ended(tmp_path, "-c", HOLDING + COMMAND)
    assert done.returncode == 0
    assert done.stdout.startswith("cranktopo")
    assert done.stderr == ""
