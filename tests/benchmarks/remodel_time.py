"""Where the time of a re-model goes: python -m tests.benchmarks.remodel_time RUN [--evaluate].

One line per search (what was tried, parameters, overlap, seconds), then one per stage. All searches are in
one process here; `cranktopo remodel` gives a second one a part of them.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

from cranktopo.design.writing import design_from_run
from cranktopo.engine.plan.simulated import strip_features
from cranktopo.runs.directories import open_run
from cranktopo.tasks.importing.imported_body import read_half_throw
from cranktopo.tasks.refit import fit, select
from cranktopo.tasks.refit.shape_error import shape_error
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.throw.manufacturing_limits import ManufacturingLimits


def timed(name: str, work: Callable[[], Any]) -> Any:
    """Result of a stage; prints its wall time."""
    began = time.perf_counter()
    result = work()
    print(f"{name:24} {time.perf_counter() - began:7.1f} s", flush=True)
    return result


@contextmanager
def searches_shown() -> Iterator[None]:
    """Context in which every search of the fit prints one line."""
    search = select.fit_from

    def shown(problem: Any, task: Any) -> Any:
        began = time.perf_counter()
        found = search(problem, task)
        overlap = float("nan") if found is None else 100 * found.overlap
        seconds = time.perf_counter() - began
        print(
            f"  {task.step:22} {len(task.guess):3d} parameters {overlap:6.2f} % {seconds:7.1f} s", flush=True
        )
        return found

    with patch.object(select, "fit_from", shown):
        yield


def main(run: Path, evaluated: bool) -> None:
    """Fit, compare and, if asked, evaluate the web of a run."""
    scene = design_from_run(open_run(str(run)))
    surface = read_half_throw(run / "web.stl", scene)
    with searches_shown():
        fitted = timed("fit", lambda: fit.fit_web(surface, scene, ManufacturingLimits()))
    sharp = strip_features(fitted.scene, "fillets")
    near = timed("shape error", lambda: shape_error(sharp, surface))
    print(f"overlap (IoU): web {100 * near.web_iou:.1f} %, half throw {100 * near.iou:.1f} %")
    if evaluated:
        for name, target in (("body", run / "web.stl"), ("fitted, no fillets", None), ("fitted", None)):
            what = Target(name, fitted.scene if name == "fitted" else sharp, target)
            timed(f"evaluation: {name}", lambda what=what: evaluate(what))


if __name__ == "__main__":
    main(Path(sys.argv[1]), "--evaluate" in sys.argv[2:])
