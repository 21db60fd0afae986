"""A sweep among the targets of a comparison: the webs that were picked out of it."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import builtin_designs
from cranktopo.runs.directories import RunStore, open_run, runs_named
from cranktopo.runs.kind import SWEEP, kind_of, read_result, resume_command, shown_results
from cranktopo.tasks.sweep.result import SweepResult


def with_picks(targets: Sequence[str]) -> list[str]:
    """Return the targets as the user types them, every sweep replaced by the webs of its picks, each once.

    Raises:
        CranktopoError: a sweep that is not finished, or has no webs to compare.
    """
    found: list[str] = []
    for text in targets:
        run = _sweep(text)
        found += [text] if run is None else _picked(run)
    return list(dict.fromkeys(found))


def _sweep(text: str) -> RunStore | None:
    path = Path(text)
    named = not path.exists() and text not in builtin_designs() and bool(runs_named(text))
    if not named and not (path / "manifest.json").is_file():
        return None
    run = open_run(text)
    return run if kind_of(run) == SWEEP else None


def _picked(run: RunStore) -> list[str]:
    data = read_result(run)
    if data is None:
        raise CranktopoError(
            f"run '{run.path}': is not finished.", hint=f"Continue it: {resume_command(run)}"
        )
    with shown_results(run):
        result = SweepResult.of_json(data, f"run '{run.path}'")
        points = {point.id: point for point in result.points}
        picked = [points[one] for one in result.picks.values()]
        found = [str(run.path / p.run / target) for p in picked if (target := p.number("target"))]
    if not found:
        raise CranktopoError(
            f"run '{run.path}': its points have no webs to compare.",
            hint="Sweep with a stage in place of a function; see its table for what failed.",
        )
    return found
