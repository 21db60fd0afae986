"""The proof that starts by itself: the bound of the design in hand, behind all other work.

It is a job as any other, with the least priority. It ends when the design moves on.
"""

from __future__ import annotations

import time
from collections.abc import Sequence

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene
from cranktopo.engine.plan.cost import bound_cell_mm
from cranktopo.tasks.bench.jobs import BenchJob, Jobs
from cranktopo.tasks.bench.project import Project
from cranktopo.tasks.bench.session_files import portable

_KIND = "bound"
_REST_S = 3.0
"""After a drag: a pause in it starts nothing."""
_STOPPED = "it was stopped"


class Proof:
    """The automatic bound of a session, and why steps of it have none."""

    def __init__(self) -> None:
        self._job: BenchJob | None = None
        self._left_at = -_REST_S
        self._missing: dict[str, str] = {}

    def missing(self, step: str) -> str:
        """Return why a step has no bound; empty where it has one, or may get one."""
        return self._missing.get(step, "")

    def forget(self) -> None:
        """End the proof that runs, and forget why others have none: another session begins."""
        self.leave()
        self._missing = {}

    def leave(self, step: str = "") -> None:
        """End the proof that runs, unless it is that of a step."""
        self._left_at = time.monotonic()
        if self._job is not None and self._job.known.step != step:
            if self._job.state == "running":
                self._job.discard()
            self._job = None

    def due(self, jobs: Sequence[BenchJob], step: str) -> bool:
        """Tell whether a step has no bound yet and may have one, and no job is at work."""
        busy = any(job.state == "running" for job in jobs)
        known = any(job.known.kind == _KIND and job.known.step == step for job in jobs)
        rested = time.monotonic() - self._left_at > _REST_S
        return rested and not busy and not known and not self.missing(step)

    def begin(self, jobs: Jobs, project: Project) -> None:
        """Start that of the step in hand, by its goal or for the least mass, on cells as beside a result."""
        step = project.step.file
        try:
            file = portable(project, project.text, "proof")
            cell_mm = bound_cell_mm(load_scene(file, whole=True))
            design, options = file.read_text(encoding="utf-8"), {"resolution-mm": round(cell_mm, 3)}
            self._job = jobs.start(_KIND, design, options, step, automatic=True)
        except CranktopoError as error:
            self._missing[step] = error.message

    def gave_up(self, job: BenchJob) -> bool:
        """Take away an automatic job that ended without a result, and note why; false for any other."""
        if not job.known.automatic or job.state not in ("failed", "stopped"):
            return False
        if job.code is not None:  # a killed one may be tried again
            self._missing[job.known.step] = _STOPPED if job.state == "stopped" else _reason(job)
        job.discard()
        return True


def _reason(job: BenchJob) -> str:
    """Return the message of the error that a job printed."""
    try:
        return str(job.printed()["error"]["message"])
    except (ValueError, KeyError, TypeError):
        return f"exit code {job.code}"
