"""One point as a job: computed once, kept as one small file, whoever asks for it and however often."""

from __future__ import annotations

import errno
import tempfile
import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Any

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import UnwritableError, read_json, unwritable, write_json
from cranktopo.base.notes import note
from cranktopo.base.seals import seal_of
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.runs.destination import locked
from cranktopo.tasks.sweep.points import SweepPoint
from cranktopo.tasks.sweep.result import DONE, FAILED, IMPOSSIBLE, PointResult
from cranktopo.tasks.sweep.stages import run_stage

POINTS, RESULT = "points", "point.json"
PointFunction = Callable[[Scene], Mapping[str, Any]]
_SEAL = "result_sha256"
"""Key of the hash over all else in the file of a point."""
_WAIT_S = 1.0
_TRY_AGAIN = (ExitCode.MISSING_TOOL, ExitCode.INTERRUPTED)
_NO_WEB = (ExitCode.INVALID_INPUT, ExitCode.CRITERION_NOT_MET, ExitCode.NOT_CONVERGED)
_FULL = (errno.ENOSPC, errno.EDQUOT)


@dataclass(frozen=True)
class Job:
    """A point with all that a worker needs: absolute directory of the sweep, function in place of a stage."""

    point: SweepPoint
    root: str
    function: PointFunction | None = None

    @property
    def folder(self) -> Path:
        """Directory of the point."""
        return Path(self.root) / POINTS / self.point.id


def kept_result(job: Job) -> PointResult | None:
    """Return what a finished point told; None where it is still to be computed, or was damaged."""
    file, fault = job.folder / RESULT, ""
    if not file.is_file():
        return None
    try:
        told = read_json(file)
        sealed = told.pop(_SEAL, None) == seal_of(told, RESULT)
        kept = PointResult.of_json(told, f"'{file}'")
        if sealed and (kept.id, kept.sha256) == (job.point.id, job.point.sha256):
            return kept
        fault = f"'{file}': {'is of another point' if sealed else 'was changed'}."
    except CranktopoError as error:
        fault = error.message
    note(f"{fault} It is computed again.")
    return None


def keep_result(job: Job, result: PointResult) -> None:
    """Keep a result that was computed where the directory of the sweep cannot be seen."""
    if kept_result(job) is None:
        _make(job.folder)
        _write(job.folder, result)


def do_job(job: Job) -> PointResult:
    """Return the result of a point, computed now unless it is kept already.

    A worker that does not see the directory of the sweep computes in a folder of its own; whoever asked
    keeps the result.

    Raises:
        CranktopoError: an output cannot be written, a tool is missing.
    """
    if not (Path(job.root) / "manifest.json").is_file():
        with tempfile.TemporaryDirectory(prefix="cranktopo-point-") as folder:
            return _computed(job, Path(folder))
    try:
        _make(job.folder)
        with _alone(job.folder):
            kept = kept_result(job)
            if kept is None:
                kept = _computed(job, job.folder)
                _write(job.folder, kept)
            return kept
    except OSError as error:
        if error.errno in _FULL:
            raise unwritable(job.folder, error) from None
        raise


def point_result(job: Job, status: str, reason: str = "", **numbers: Any) -> PointResult:
    """Return how a point ended; of the numbers that its stage told one may be another status or reason."""
    point = job.point
    known = {name: getattr(point, name) for name in ("id", "stage", "design", "varied", "sha256")}
    run = "" if point.reason else f"{POINTS}/{point.id}"
    run_columns = {"run": run, "status": status, "reason": reason, "version": metadata.version("cranktopo")}
    return PointResult(**{**known, **run_columns, **numbers})


def _write(folder: Path, result: PointResult) -> None:
    told = result.as_json()
    write_json(folder / RESULT, {**told, _SEAL: seal_of(told, RESULT)})


def _computed(job: Job, folder: Path) -> PointResult:
    began, point = time.perf_counter(), job.point
    try:
        scene = scene_from_dict(dict(point.tables), point.design, whole=True)
        # a name of its own in tables and run directories
        scene = scene.model_copy(update={"name": f"{scene.name}-{point.id}"})
        if job.function is not None:
            found = {str(name): value for name, value in job.function(scene).items()}
        else:
            found = run_stage(point.stage, scene, folder, point.fineness)
    except UnwritableError:
        raise
    except CranktopoError as error:
        if error.code in _TRY_AGAIN:
            raise
        return point_result(job, IMPOSSIBLE if error.code in _NO_WEB else FAILED, str(error))
    return point_result(job, DONE, **{**found, "seconds": time.perf_counter() - began})


def _make(folder: Path) -> None:
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise unwritable(folder, error) from None


@contextmanager
def _alone(folder: Path) -> Iterator[None]:
    """Hold a point; where another worker holds it, as one that was thought dead, wait for its result."""
    with ExitStack() as stack:
        while True:
            try:
                stack.enter_context(locked(folder))
                break
            except UnwritableError:
                raise
            except CranktopoError:
                time.sleep(_WAIT_S)
        yield
