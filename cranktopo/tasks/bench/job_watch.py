"""Jobs of a session while the bench is open: told as they go on, kept when they end, the proof begun."""

from __future__ import annotations

import asyncio
import subprocess
from collections.abc import Callable
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.tasks.bench.answers import Answers, Tell
from cranktopo.tasks.bench.jobs import BenchJob, Jobs, reap
from cranktopo.tasks.bench.project import Project
from cranktopo.tasks.bench.proof import Proof
from cranktopo.tasks.bench.results import job_numbers, job_table, job_words, variant_of


class JobWatch:
    """A look at the jobs of a session, again and again."""

    def __init__(self, tell_all: Tell, tell_state: Callable[[], None]) -> None:
        self.proof = Proof()
        self._tell_all, self._tell_state = tell_all, tell_state
        self._seen = ""

    async def look(self, project: Project, answers: Answers) -> None:
        """Tell pages how jobs go on, keep what finished ones found, start the proof where all is at rest."""
        reap()
        jobs = jobs_of(project)
        found = jobs.all()
        for job in found:
            if job.has_result and not job.known.variant:
                await self._keep_result(job, project, answers)
        if [job for job in found if self.proof.gave_up(job)]:
            self._tell_state()
        elif answers.at_rest(project.text) and self.proof.due(found, project.step.file):
            self.proof.begin(jobs, project)
            self._tell_state()
        states = job_states(project)
        if str(states) != self._seen:
            self._seen = str(states)
            self._tell_all({"type": "jobs", "jobs": states})

    async def _keep_result(self, job: BenchJob, project: Project, answers: Answers) -> None:
        """Keep what a finished job found: a variant, numbers, or both."""
        numbers, found = job_numbers(job), job_words(job)
        id_ = "-"
        try:
            text = await asyncio.to_thread(variant_of, job)
            if text is not None:
                exact = await answers.exact(project.data(text))
                gauges = {**answers.known(text), **exact, **numbers}
                name = f"{job.known.kind} {job.known.id}"
                outlines = await answers.outlines(project.data(text))
                id_ = project.keep(name, gauges, text, "; ".join(found[:1]), outlines).id
        except (CranktopoError, OSError, subprocess.SubprocessError) as error:
            found = [f"its result cannot be kept: {error}"]
        job.note_result(id_, found, numbers, job_table(job))
        self._tell_all({"type": "proof", "kind": job.known.kind})
        self._tell_state()


def jobs_of(project: Project) -> Jobs:
    """Return the jobs of a session."""
    return Jobs(project.place / "jobs")


def job_states(project: Project) -> list[dict[str, Any]]:
    """Return what pages show of the jobs of a session."""
    return [job.as_json(project.folder) for job in jobs_of(project).all()]
