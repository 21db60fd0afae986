"""The proof that starts by itself: at rest, behind all else, gone when the design moves on."""

from __future__ import annotations

import asyncio
import json
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any
from unittest.mock import MagicMock

import psutil
import pytest

pytest.importorskip("tornado")
from cranktopo.design.loading import design_text
from cranktopo.tasks.bench import jobs as jobs_module
from cranktopo.tasks.bench import proof as proof_module
from cranktopo.tasks.bench.answers import Answers
from cranktopo.tasks.bench.job_watch import JobWatch, jobs_of
from cranktopo.tasks.bench.jobs import BenchJob
from cranktopo.tasks.bench.project import Project

BOUND = {
    "schema_version": 1, "design": "mine", "original": {}, "weights": {}, "process": "free", "die": False,
    "goal": {"minimise": "mass", "limits": [], "dropped": []},
    "bound": {"quantity": "mass", "value": 1.2, "unit": "kg", "percent_of_original": 81.0, "possible": True},
    "variable_stiffness": {"value": 1.1, "percent_of_original": 75.0, "steps": 3}, "cells": [1, 1, 1],
    "original_outside_envelope_percent": 0.0, "original_outside_envelope_mm3": 0.0, "design_cells": 1,
    "resolution_mm": 4.0, "model_error_percent": {}, "seconds": 1.0, "assumed": [],
}  # fmt: skip


class Session:
    """A project whose jobs are watched; what it does in place of the program is a line of Python."""

    def __init__(self, folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        text = design_text("mikron-iiic-plain")
        self.project = Project.opened(folder, text, "mine.toml", "opened", "cranktopo bench mine")
        self.answers, self.told = MagicMock(), list[dict[str, Any]]()
        self.answers.at_rest.return_value = True
        self.states = 0
        self.watch = JobWatch(self.told.append, self._told_state)
        self._patch = monkeypatch
        monkeypatch.setattr(proof_module, "_REST_S", -1.0)

    def does(self, line: str) -> None:
        """Have jobs run a line of Python in place of the program."""
        self._patch.setattr(jobs_module, "own_command", lambda *words: [sys.executable, "-c", line, *words])

    def look(self) -> list[BenchJob]:
        """Look once; return the jobs after it."""
        with ThreadPoolExecutor(1) as pool:  # the thread of a browser's tests has a loop that runs
            pool.submit(asyncio.run, self.watch.look(self.project, self.answers)).result()
        return jobs_of(self.project).all()

    def until(self, holds: Callable[[list[BenchJob]], bool]) -> list[BenchJob]:
        """Look until something holds of the jobs."""
        for _ in range(600):
            if holds(found := self.look()):
                return found
            time.sleep(0.05)
        raise AssertionError([job.as_json() for job in found])

    def _told_state(self) -> None:
        self.states += 1


@pytest.fixture
def session(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Session]:
    found = Session(tmp_path, monkeypatch)
    found.does("import time; time.sleep(60)")
    yield found
    found.watch.proof.forget()
    found.project.close()


def test_it_starts_at_rest_once_and_with_the_least_priority(session: Session) -> None:
    session.answers.at_rest.return_value = False
    assert session.look() == []
    session.answers.at_rest.return_value = True
    (job,) = session.look()
    assert job.known.automatic
    assert job.known.words == ("bound", "design.toml", "--resolution-mm=4.0", "--json")
    for _ in range(100):  # until `nice` has set it
        if (nice := psutil.Process(job.known.pid).nice()) == 19:
            break
        time.sleep(0.05)
    assert nice == 19
    assert len(session.look()) == 1, "one is enough"


def test_it_waits_for_the_jobs_that_somebody_asked_for(session: Session) -> None:
    job = jobs_of(session.project).start("evaluate", session.project.text, {}, session.project.step.file)
    assert len(session.look()) == 1
    job.discard()
    assert [job.known.kind for job in session.until(lambda jobs: bool(jobs))] == ["bound"]


def test_it_ends_when_the_design_moves_on_and_leaves_nothing(session: Session) -> None:
    (job,) = session.look()
    session.watch.proof.leave(session.project.step.file)
    assert len(jobs_of(session.project).all()) == 1, "the same step is proven still"
    processes = psutil.Process(job.known.pid).children(recursive=True)
    session.watch.proof.leave()
    assert jobs_of(session.project).all() == []
    assert not psutil.wait_procs(processes, timeout=20)[1], "none of its processes goes on"
    session.project.change({"web.thickness_mm": 20.0}, "thicker")
    (other,) = session.look()
    assert (other.known.step, job.known.step) == ("0001.toml", "0000.toml")


def test_what_it_finds_is_kept_with_its_step(session: Session) -> None:
    session.does(f"import sys; print({json.dumps(BOUND)!r}); sys.exit(0)")
    (job,) = session.until(lambda jobs: bool(jobs) and bool(jobs[0].known.variant))
    assert job.known.gauges == {"bound_mass": 1.2, "bound_percent_mass": 81.0}
    assert len(session.look()) == 1, "it is not proven again"


def test_a_refusal_is_told_once_and_is_no_job(session: Session) -> None:
    session.does('import sys; print(\'{"error": {"message": "no envelope."}}\'); sys.exit(2)')
    step = session.project.step.file
    session.until(lambda jobs: not jobs and bool(session.watch.proof.missing(step)))
    assert session.watch.proof.missing(step) == "no envelope."
    told = session.states
    assert session.look() == []
    assert session.states == told
    session.watch.proof.forget()
    assert session.watch.proof.missing(step) == ""


def test_all_has_settled_before_a_design_is_at_rest() -> None:
    answers = Answers(lambda message: None)
    answers._now = "text"
    assert not answers.at_rest("text")
    for part in ("stiffness", "film", "shaft", "vibration", "safety", "colours"):
        assert not answers.at_rest("text")
        answers._keep("text", part, {"gauges": {}})
    assert answers.at_rest("text")
    assert not answers.at_rest("another")
    answers._live = MagicMock(busy=True)
    assert not answers.at_rest("text"), "a drag is answered"
    answers.close()
