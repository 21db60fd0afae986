"""Jobs of a bench killed at random moments, alone or with all that they started: what is left goes on.

A job is stopped as the page stops it, ended by SIGTERM, or killed with its shell as where power fails.
It must never be left as running; continued, or begun anew, it ends in the bytes and numbers of one that
nobody killed. `python -m tests.hostile.test_kills_of_jobs KILLS [KIND...]` prints the counts by state.
"""

from __future__ import annotations

import os
import random
import signal
import sys
import tempfile
import time
from collections import Counter
from pathlib import Path
from typing import Any

import psutil
import pytest

from cranktopo.design.loading import design_text
from cranktopo.tasks.bench.jobs import BenchJob, Jobs, reap
from cranktopo.tasks.bench.results import job_numbers
from tests.hostile.test_kills_of_commands import DESIGN, WAIT_S

OPTIONS: dict[str, dict[str, Any]] = {
    "optimise": {"resolution-mm": "4.5", "max-iterations": "4", "volume-fraction": "0.3"},
    "sweep": {"vary": "web.width_mm=50,52", "workers": "1"},
    "evaluate": {},
}
"""Kinds of jobs with their options; the first two are continued."""
HOW = ("stopped", "SIGTERM", "killed")
KILLS = 18
LONGEST_S = 900.0


def ended(job: BenchJob, seconds: float = LONGEST_S) -> bool:
    """Wait for the end of a job's process."""
    end = time.monotonic() + seconds
    while job.alive and time.monotonic() < end:
        time.sleep(0.02)
        reap()
    return not job.alive


def kill(job: BenchJob, how: str) -> None:
    """End a job: as the page does, by a signal to its command, or with all its processes at once."""
    if how == "stopped":
        job.stop()
    elif how == "SIGTERM" and job.alive:
        for child in psutil.Process(job.known.pid).children():
            child.send_signal(signal.SIGTERM)
    elif job.alive:
        os.killpg(job.known.pid, signal.SIGKILL)


def begun(jobs: Jobs, left: BenchJob | None, kind: str) -> BenchJob:
    """A job that goes on from what a killed one left, or a new one."""
    if left is not None and left.resumable:
        return jobs.resume(left.known.id)
    return jobs.start(kind, design_text(DESIGN), OPTIONS[kind])


def result(job: BenchJob) -> dict[str, Any]:
    """What a finished job leaves that does not depend on the time it took."""
    surface, table = job.out / "web.stl", job.out / "sweep.json"
    content = surface.read_bytes() if surface.is_file() else b""
    points = len(table.read_text().split('"status": "done"')) if table.is_file() else 0
    return {**job_numbers(job), "surface": content, "points": points}


def chain(kind: str, kills: int, folder: Path, draw: random.Random) -> tuple[list[str], Counter[str]]:
    """Faults and number of kills by the state that they left, each kill of what the one before left."""
    jobs, faults, states = Jobs(folder), list[str](), Counter[str]()
    began = time.monotonic()
    whole = begun(jobs, None, kind)
    assert ended(whole)
    assert whole.state == "done", whole.stdout()
    seconds, left = time.monotonic() - began, None
    for number in range(kills):
        job, how, moment = begun(jobs, left, kind), HOW[number % 3], draw.uniform(0, seconds)
        time.sleep(moment)
        kill(job, how)
        what = f"{kind}, {how} after {moment:.2f} s"
        if not ended(job, WAIT_S):
            faults.append(f"{what}: does not end in {WAIT_S:.0f} s")
            kill(job, "killed")
        left = jobs.job(job.known.id)  # as a bench that is opened again reads it
        states[f"{kind} {left.state}"] += 1
        notes = (left.place / "notes.txt").read_text(errors="replace") if left.code is not None else ""
        faults += [f"{what}: left as running"] if left.state == "running" else []
        faults += [f"{what}: {notes[-2000:]}"] if "Traceback" in notes else []
        if left.state == "done":
            faults += [] if result(left) == result(whole) else [f"{what}: another result"]
            left = None
    last = begun(jobs, left, kind)
    assert ended(last)
    last = jobs.job(last.known.id)
    if last.state != "done":
        faults.append(f"{kind} afterwards: {last.state}: {last.as_json()['notes']}")
    elif result(last) != result(whole):
        faults.append(f"{kind} afterwards: another result than that of a job that nobody killed")
    return faults, states


def campaign(kinds: list[str], kills: int, folder: Path) -> tuple[list[str], Counter[str]]:
    """Faults and number of kills by kind and state."""
    draw, faults, states = random.Random(3), list[str](), Counter[str]()
    for kind in kinds:
        found, counts = chain(kind, -(-kills // len(kinds)), folder / kind, draw)
        faults, states = faults + found, states + counts
        print(kind, dict(states), faults, flush=True)
    return faults, states


@pytest.mark.slow
def test_kills_of_jobs(tmp_path: Path) -> None:
    faults, states = campaign(list(OPTIONS), KILLS, tmp_path)
    assert not faults, "\n".join(faults)
    assert states.total() >= KILLS


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as where:
        told, by_state = campaign(sys.argv[2:] or list(OPTIONS), int(sys.argv[1]), Path(where))
    print("\n".join(told))
    print(f"{by_state.total()} kills, {len(told)} faults; by state: {dict(sorted(by_state.items()))}")
