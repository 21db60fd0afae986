"""`shape --each-web` killed at random moments over its whole course, its long stages replaced by short waits.

All else is its own: runs, kept parts, hashes, files. Every run goes on to the designs and figures of one that
nobody killed. `python -m tests.hostile.test_kills_of_each_web KILLS` prints the counts by exit code.
"""

from __future__ import annotations

import json
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

import pytest

from tests.hostile.watched import ENVIRONMENT

SIGNALS = (signal.SIGKILL, signal.SIGTERM, signal.SIGINT)
PROGRAM = [sys.executable, "-c", "from tests.hostile.test_kills_of_each_web import main; main()"]
BEGIN, RESUME = ["shape", "mikron-iiic", "--each-web", "--out"], ["shape", "--resume"]
STAGE_S = 0.3
KILLS = 21
_ENDED = {0, 6, 130}


def main() -> None:
    """The command line, each shaft and each search of which takes a moment."""
    for number in SIGNALS[1:]:  # as the program itself while it loads
        signal.signal(number, signal.SIG_DFL)
    from cranktopo.app.process import run_to_its_end
    from cranktopo.tasks.web_shape import evaluated_web
    from cranktopo.tasks.web_shape import run as shape_run
    from cranktopo.tasks.web_shape.each_web import rounds, run
    from tests.shaft_stand_in import told_shaft
    from tests.shape_stand_in import ShapeStandIn

    def waited(call: Any) -> Any:
        def slow(*arguments: Any, **named: Any) -> Any:
            time.sleep(STAGE_S)
            return call(*arguments, **named)

        return slow

    search, own = ShapeStandIn({"mass": 90.0}), (1.2, 1.3, 1.6, 1.5, 1.5, 1.6, 1.3, 1.2)

    def after(design: str, _: float) -> Any:
        return told_shaft((1.2,) * 8, 5.6 if "one-web" in design else 5.32)

    patched = pytest.MonkeyPatch()
    patched.setattr(run, "loaded_shaft", waited(lambda *_: told_shaft(own, 6.0)))
    patched.setattr(rounds, "loaded_shaft", waited(after))
    patched.setattr(evaluated_web, "web_safety", waited(lambda *_: 2.0))
    patched.setattr(shape_run, "shape_design", waited(search.design))
    patched.setattr(shape_run, "resume_shape", waited(search.resume))
    run_to_its_end(list(SIGNALS[1:]))


def start(words: list[str], folder: Path) -> subprocess.Popen[str]:
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background job ignores it
    pipe = subprocess.PIPE
    return subprocess.Popen(
        [*PROGRAM, *words], stdout=pipe, stderr=pipe, text=True, env=ENVIRONMENT, cwd=folder
    )


def words_of(out: Path) -> list[str]:
    return [*(RESUME if (out / "manifest.json").is_file() else BEGIN), str(out)]


def result(out: Path) -> dict[str, Any]:
    """The result without its seconds, and the designs of all webs and cranks."""
    found = json.loads((out / "each-web.json").read_text())
    found.pop("seconds")
    designs = [file for file in out.rglob("*.toml") if file.name != "design.toml"]
    return {**found, **{str(file.relative_to(out)): _dimensions(file) for file in designs}}


def _dimensions(file: Path) -> dict[str, Any]:
    """A design as it is read: one that goes on has the defaults written out, too."""
    from cranktopo.design.loading import load_scene

    return load_scene(file, whole=True).model_dump()


def campaign(kills: int, folder: Path) -> tuple[list[str], Counter[int]]:
    """Faults, and number of kills by exit code; each kill is of what the one before left."""
    faults, codes, draw = list[str](), Counter[int](), random.Random(5)
    began = time.monotonic()
    process = start(words_of(folder / "whole"), folder)
    _, stderr = process.communicate(timeout=600)
    assert process.returncode == 0, stderr
    seconds, whole, out = time.monotonic() - began, result(folder / "whole"), folder / "out"
    for number in range(kills):
        moment, sent = draw.uniform(0, seconds), SIGNALS[number % 3]
        process = start(words_of(out), folder)
        time.sleep(moment)
        process.send_signal(sent)
        _, stderr = process.communicate(timeout=600)
        codes[process.returncode] += 1
        what = f"{sent.name} after {moment:.2f} s"
        faults += [f"{what}: {stderr[-3000:]}"] if "Traceback" in stderr else []
        loading = process.returncode == -sent and not stderr.strip()
        if process.returncode not in _ENDED and not loading and sent != signal.SIGKILL:
            faults.append(f"{what}: exit code {process.returncode}: {stderr[-3000:]}")
        if process.returncode == 0:
            faults += [] if result(out) == whole else [f"{what}: another result"]
            shutil.rmtree(out)
    process = start(words_of(out), folder)
    _, stderr = process.communicate(timeout=600)
    if process.returncode != 0:
        faults.append(f"afterwards: exit code {process.returncode}: {stderr[-3000:]}")
    elif result(out) != whole:
        faults.append("afterwards: another result than that of a run that nobody killed")
    return faults, codes


@pytest.mark.slow
def test_kills_of_each_web(tmp_path: Path) -> None:
    faults, codes = campaign(KILLS, tmp_path)
    assert not faults, "\n".join(faults)
    assert codes.total() == KILLS


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as where:
        told, by_code = campaign(int(sys.argv[1]), Path(where))
    print("\n".join(told))
    print(f"{by_code.total()} kills, {len(told)} faults; by exit code: {dict(sorted(by_code.items()))}")
