"""Bodies that are no crank, given to `import`: one line and exit code 3, nothing written, no long wait."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

from cranktopo.app.main import main
from tests.hostile.bodies import COUNT, hostile_body

LIMIT_S = 30.0
QUICK = (1, 6)
"""Inside out, a connecting rod."""


def processor_s() -> float:
    """Return the processor time of this process and of its children: bodies are read in one."""
    return sum(os.times()[:4])


def fault_of(seed: int, folder: Path, capsys: pytest.CaptureFixture[str]) -> str:
    """Tell what went wrong with the body of a seed; empty where it is refused as it should be."""
    place = folder / str(seed)
    place.mkdir()
    body = hostile_body(seed, place)
    capsys.readouterr()
    began = processor_s()
    code = main(["import", str(body), "--out", str(place / "out"), "--quiet"])
    took = processor_s() - began
    out, err = capsys.readouterr()
    lines = [line for line in err.splitlines() if line.strip()]
    errors = [line for line in lines if line.startswith("error")]
    faults = [
        *([f"exit code {code}"] if code != 3 else []),
        *(["a traceback"] if "Traceback" in err else []),
        *([f"{len(errors)} errors"] if len(errors) != 1 else []),
        *(["a folder is left"] if (place / "out").exists() else []),
        *([f"{took:.0f} s"] if took > LIMIT_S else []),
    ]
    return f"seed {seed} ({body.name}): {', '.join(faults)}: {err[:300]}{out[:200]}" if faults else ""


def test_bodies_that_are_no_crank(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    faults = [fault for seed in QUICK if (fault := fault_of(seed, tmp_path, capsys))]
    assert not faults, "\n".join(faults)


@pytest.mark.slow
def test_two_hundred_bodies(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    faults = [fault for seed in range(COUNT) if (fault := fault_of(seed, tmp_path, capsys))]
    assert not faults, "\n".join(faults)
