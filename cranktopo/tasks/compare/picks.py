"""Targets of a comparison that stand for the picks of a sweep."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import builtin_designs
from cranktopo.runs.directories import RunStore, open_run, runs_named
from cranktopo.runs.kind import SWEEP, kind_of, read_result, reading_results, resume_command
from cranktopo.runs.stored import unchanged
from cranktopo.tasks.sweep.result import SweepResult
from cranktopo.tasks.sweep.text import condition_words
from cranktopo.tasks.throw_fea.targets import TargetLike


def with_picks(targets: Sequence[TargetLike]) -> list[TargetLike]:
    """Return the targets, every sweep replaced by the webs of its picks, each once.

    Raises:
        CranktopoError: a sweep that is not finished, or has no webs to compare.
    """
    found: list[TargetLike] = []
    for target in targets:
        run = _sweep(str(target)) if isinstance(target, str | Path) else None
        for one in _picked(run) if run else [target]:
            found += [] if one in found else [one]
    return found


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
    with reading_results(run):
        result = SweepResult.of_json(data, f"run '{run.path}'")
        points = {point.id: point for point in result.points}
        picked = [points[one] for one in result.picks.values()]
        names = [f"{p.run}/{target}" for p in picked if (target := p.number("target"))]
        found = [str(unchanged(run.path / name)) for name in names]
    if not found and result.operating_conditions:
        raise CranktopoError(f"run '{run.path}': picks nothing.", hint=f"{condition_words(result)}.")
    if not found:
        raise CranktopoError(
            f"run '{run.path}': its points have no webs to compare.",
            hint="Sweep with a stage in place of a function; see its table for what failed.",
        )
    return found
