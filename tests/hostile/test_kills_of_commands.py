"""Every command killed at random moments, from its first millisecond on: the same command works afterwards.

SIGKILL, SIGTERM and SIGINT in turn; a command that does not end is told with what its threads were at.
`python -m tests.hostile.test_kills_of_commands KILLS` prints the counts by exit code; 200 take an hour.
"""

from __future__ import annotations

import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path

import pytest

from tests.hostile.watched import ENVIRONMENT, PROGRAM

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)

DESIGN, SMALL = "mikron-iiic-plain", ["--element-size-mm", "12"]
RUN = ["optimise", DESIGN, "--resolution-mm", "4.5", "--max-iterations", "2"]
GOAL = ["--maximise", "torsion", "--limit", "bending none", "--resolution-mm", "4.5"]
OUT = "out"
"""Folder of a command that begins a run; what is left in it decides whether it is resumed."""
COMMANDS: dict[str, list[str]] = {
    "plan": ["plan", DESIGN],
    "loads": ["loads", DESIGN, "--csv", "loads.csv", "--plot", "loads.pdf"],
    "balance": ["balance", DESIGN],
    "designs": ["designs", "copy", DESIGN, "copy.toml", "--force"],
    "export": ["export", DESIGN, "half.step", "--part", "half", "--force"],
    "drawing": ["export", DESIGN, "sheet.pdf", "--force"],
    "evaluate": ["evaluate", DESIGN, *SMALL],
    "evaluate a body": ["evaluate", "body.step", "--design", DESIGN, *SMALL],
    "compare": ["compare", DESIGN, "--baseline", DESIGN, *SMALL],
    "shaft": ["shaft", DESIGN, *SMALL],
    "vibration": ["vibration", DESIGN, *SMALL],
    "modes": ["modes", DESIGN, *SMALL],
    "fatigue": ["fatigue", DESIGN, "--fillet-fraction", "0.5"],
    "bound": ["bound", DESIGN, *GOAL],
    "report": ["report", "run"],
    "extract": ["extract", "run", "--out", "extracted.stl", "--force"],
    "film": ["film", "car-diesel"],
    "rod": ["rod", "mikron-iiic-rod"],
    "bolts": ["bolts", "mikron-iiic-rod-h"],
    "balancer": ["balancer", "balancer-shaft"],
    "crank drawing": ["drawing", "mikron-iiic-crank", "crank.pdf", "--force"],
    "import": ["import", "throw.step", "--out", "imported"],
    "remodel": ["remodel", "run", "--no-evaluation", "--out", "remodelled"],
    "runs": ["runs", "list", "--root", "."],
    "doctor": ["doctor"],
    "completion": ["completion", "bash"],
    "optimise": [*RUN, "--out", OUT],
    "iterate": ["iterate", DESIGN, "--steps", "1", "--resolution-mm", "4.5", *SMALL, "--out", OUT],
    "shape": ["shape", DESIGN, "--minimise", "mass", "--limit", "torsion >= 95 %", "--out", OUT],
    "each web": ["shape", "mikron-iiic", "--each-web", "--minimise", "mass", "--out", OUT],
    "accuracy": ["accuracy", DESIGN, "--budget", "20s", "--out", "studied"],
    "bench": ["bench", DESIGN, "--no-browser"],
    "sweep": ["sweep", DESIGN, "--vary", "web.width_mm=50,52", *SMALL, "--workers", "1", "--out", OUT],
}
NEW = ("remodelled", "imported")
"""Folders that a command makes at its end, and never over another."""
LONG = {"iterate": 60.0, "shape": 60.0, "each web": 60.0, "bench": 15.0}
"""Commands that are killed in their first part alone, s; a bench serves until it is asked to end."""
KILLS = 200
WAIT_S = 15.0
"""A command that is asked to end may save for so long."""
_ENDED = {0, 5, 6, 130}
"""Exit codes of a command that was done before, or that a signal asked to end."""


def start(*arguments: str, cwd: Path) -> subprocess.Popen[str]:
    pipe = subprocess.PIPE
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
    return subprocess.Popen(
        [*PROGRAM, *arguments], stdout=pipe, stderr=pipe, text=True, env=ENVIRONMENT, cwd=cwd
    )


def prepared(folder: Path) -> None:
    """A run and bodies that other commands take."""
    bodies = (("body.step", "half"), ("throw.step", "throw"))
    exports = (["export", DESIGN, file, "--part", part] for file, part in bodies)
    for line in ([*RUN, "--out", "run"], *exports):
        process = start(*line, cwd=folder)
        _, stderr = process.communicate(timeout=600)
        assert process.returncode in (0, 5), stderr


def line_of(name: str, folder: Path) -> list[str]:
    """The command line: that which resumes, where a run is left."""
    words = COMMANDS[name]
    if OUT in words and (folder / OUT / "manifest.json").is_file():
        return [words[0], "--resume", OUT]
    return words


def killed(name: str, moment: float, number: signal.Signals, folder: Path) -> tuple[int, list[str]]:
    """Exit code of a command after a kill, and what is wrong."""
    process = start(*line_of(name, folder), cwd=folder)
    time.sleep(moment)
    process.send_signal(number)
    faults = []
    try:
        _, stderr = process.communicate(timeout=WAIT_S)
    except subprocess.TimeoutExpired:
        process.send_signal(signal.SIGABRT)  # faulthandler tells what every thread is at
        _, stderr = process.communicate(timeout=60)
        faults.append(f"does not end in {WAIT_S:.0f} s")
    for path in NEW:  # where it was faster
        shutil.rmtree(folder / path, ignore_errors=True)
    code = process.returncode
    faults += [f"Traceback: {stderr[-3000:]}"] if "Traceback" in stderr else []
    loading = code == -number and not stderr.strip()  # before the program is loaded, nothing is to be saved
    if code not in _ENDED and not loading and number != signal.SIGKILL:
        faults.append(f"exit code {code}: {stderr[-3000:]}")
    return code, [f"{name}, {number.name} after {moment:.2f} s: {fault}" for fault in faults]


def works(name: str, folder: Path) -> list[str]:
    """What is wrong with the command after all its kills."""
    if name in LONG:  # it goes on, and ends when it is asked to
        code, faults = killed(name, 60, signal.SIGTERM, folder)
        return [*faults, *([] if code in (0, 130) else [f"{name} afterwards: exit code {code}"])]
    process = start(*line_of(name, folder), cwd=folder)
    _, stderr = process.communicate(timeout=1800)
    faults = [] if process.returncode in (0, 5, 6) else [f"exit code {process.returncode}: {stderr[-300:]}"]
    left = [str(path) for path in folder.rglob(".*.tmp*") if OUT in path.parts]
    return [f"{name} afterwards: {fault}" for fault in [*faults, *(f"leaves {one}" for one in left)]]


def campaign(names: list[str], kills: int, folder: Path) -> tuple[list[str], Counter[int]]:
    """Faults, and number of kills by exit code."""
    prepared(folder)
    draw, faults, codes = random.Random(3), list[str](), Counter[int]()
    for name in names:
        began = time.monotonic()
        if name not in LONG:
            faults += works(name, folder)
        seconds = LONG.get(name, time.monotonic() - began)
        for path in (OUT, *NEW):
            shutil.rmtree(folder / path, ignore_errors=True)
        for number in range(kills // len(names) + 1):
            code, found = killed(name, draw.uniform(0, seconds), SIGNALS[number % 3], folder)
            codes[code] += 1
            faults += found
        faults += works(name, folder)
        if (folder / OUT).exists():
            (folder / OUT).rename(folder / f"{name}-done")
        print(name, dict(codes), faults, flush=True)
    return faults, codes


@pytest.mark.slow
def test_two_hundred_kills(tmp_path: Path) -> None:
    faults, codes = campaign(list(COMMANDS), KILLS, tmp_path)
    assert not faults, "\n".join(faults)
    assert codes.total() >= KILLS


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as where:
        told, by_code = campaign(sys.argv[2:] or list(COMMANDS), int(sys.argv[1]), Path(where))
    print("\n".join(told))
    print(f"{by_code.total()} kills, {len(told)} faults; by exit code: {dict(sorted(by_code.items()))}")
