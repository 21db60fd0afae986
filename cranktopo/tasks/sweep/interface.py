"""A sweep in one call, for Python."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from cranktopo.tasks.fea.evaluation import Info
from cranktopo.tasks.sweep.computed import Workplace
from cranktopo.tasks.sweep.job import PointFunction
from cranktopo.tasks.sweep.plan import sweep_plan
from cranktopo.tasks.sweep.run import resume_sweep, run_sweep
from cranktopo.tasks.sweep.variation import read_entry

if TYPE_CHECKING:
    import pandas


def sweep(
    design: str | Path | Sequence[str | Path] = "mikron-iiic",
    vary: Mapping[str, Any] | None = None,
    stage: str = "evaluate",
    sampling: str = "grid",
    samples: int | None = None,
    element_size_mm: float | None = None,
    accuracy_percent: float | None = None,
    refine: str = "all",
    budget_s: float | None = None,
    minimise: str | None = None,
    maximise: str | None = None,
    limits: Sequence[str] = (),
    workers: int | None = None,
    scheduler: str | None = None,
    out: str | Path | None = None,
    resume: str | Path | None = None,
    function: PointFunction | None = None,
    info: Info = lambda _: None,
) -> pandas.DataFrame:
    """Compute many variants of a design and return one row for each.

    In a script it stands below `if __name__ == "__main__":`, because worker processes import the script.

    Args:
        design: TOML path or name of a built-in design, or several; the first is the original.
        vary: values by key of the scene: a list, or text as behind `--vary KEY=`.
        stage: how far each point goes: evaluate, fatigue, optimise, remodel or shape.
        sampling: grid for all combinations, latin or sobol for so many `samples`.
        accuracy_percent: evaluations are refined until the bound of their error is no larger.
        refine: `front` computes all points coarse first, and those alone at full accuracy that may be on the
            front, within `budget_s` where it is given.
        minimise, maximise, limits: goal of optimisations; `torsion >= 90:130:5 %` varies its limit.
        workers: processes on this machine; by default as many as cores and memory allow.
        scheduler: address of a Dask scheduler to use instead.
        out: run directory; by default a new one under runs/.
        resume: run directory to continue; `design`, `vary` and the like are then read there.
        function: called with the `Scene` of every point in place of a stage; returns numbers by name.
        info: called with lines of progress.

    Returns:
        A frame, units in the column names; its `attrs` hold the run directory, the front and the picks.

    Raises:
        CranktopoError: bad input, a package missing, or interruption.
    """
    place = Workplace(workers, scheduler)
    if resume is not None:
        done = resume_sweep(str(resume), place, info, function)
    else:
        designs = [str(d) for d in ([design] if isinstance(design, str | Path) else design)]
        varied = [read_entry(key, entry) for key, entry in (vary or {}).items()]
        fineness, goal = (element_size_mm, accuracy_percent, refine, budget_s), (minimise, maximise, limits)
        plan = sweep_plan(designs, varied, sampling, samples, stage, *fineness, *goal)
        folder = None if out is None else Path(out)
        done = run_sweep(plan, place, folder, ("cranktopo.sweep",), info, function)
    frame = done.frame
    frame.attrs |= {"run": str(done.folder), "front": list(done.result.front), "picks": done.result.picks}
    return frame
