"""Which command made a run directory, and so what it holds and what can read or continue it."""

from __future__ import annotations

import shlex
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any, Literal

from cranktopo.base.errors import CranktopoError, quoted
from cranktopo.base.files import read_json
from cranktopo.runs.directories import RunStore

RunKind = Literal["optimise", "iterate", "shape", "sweep"]
"""The command that made a run: a density optimisation, the loop over many, a shape optimisation, a sweep."""
LOOP: RunKind = "iterate"
SHAPE: RunKind = "shape"
SWEEP: RunKind = "sweep"
"""Kinds of runs, and the keys of their settings among the manifest's options."""
RESULT_FILES: dict[RunKind, str] = {
    "optimise": "metrics.json",
    "iterate": "iterate.json",
    "shape": "shape.json",
    "sweep": "sweep.json",
}
"""Name of the file that a run of each kind writes last."""


def kind_of(run: RunStore) -> RunKind:
    """Return the command that made a run; raises CranktopoError when its manifest cannot be used."""
    options = run.manifest()["options"]
    return next((kind for kind in (LOOP, SHAPE, SWEEP) if kind in options), "optimise")


def read_result(run: RunStore) -> dict[str, Any] | None:
    """Return what a run reached, None before its end; raises CranktopoError when a file cannot be used."""
    path = run.path / RESULT_FILES[kind_of(run)]
    return read_json(path) if path.is_file() else None


@contextmanager
def shown_results(run: RunStore) -> Iterator[None]:
    """Show stored results in the block: what they lack is damage, a CranktopoError, and no defect here."""
    try:
        yield
    except (KeyError, TypeError, IndexError, AttributeError, ValueError) as error:
        raise CranktopoError(
            f"run '{run.path}': its results are damaged ({type(error).__name__}: {quoted(str(error))}).",
            hint="Start a new run.",
        ) from error


def resume_command(run: RunStore) -> str:
    """Return the command line that continues a run; raises CranktopoError for an unusable manifest."""
    return shlex.join(["cranktopo", kind_of(run), "--resume", str(run.path)])


def require_kind(run: RunStore, wanted: RunKind) -> None:
    """Check that the `wanted` command made a run; raises CranktopoError."""
    found = kind_of(run)
    if found != wanted:
        show = shlex.join(["cranktopo", "runs", "show", str(run.path)])
        raise CranktopoError(
            f"run '{run.path}': was made by `cranktopo {found}`; this needs one of `cranktopo {wanted}`.",
            hint=f"See what it holds: {show}; or continue it: {resume_command(run)}",
        )
