"""The bound of a design: what no web of its envelope can beat."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from cranktopo.bodies.cells.domain import laterally_symmetric
from cranktopo.bodies.cells.resolution import available_memory_MiB, check_resolution
from cranktopo.design.assumed import ENVELOPE, GOAL, SUPPORTS, THROW, assumed_json, assumed_text, assumptions
from cranktopo.design.goal.wanted import needed
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.bound.lower_bound import bound_model, densities_on_cells, prove
from cranktopo.tasks.bound.result import bound_json

Info = Callable[[str], None]
_CASES = 2
_FINE = 8
"""Cells through the web from which on densities of cells twice as large are the start."""
_TABLES = (THROW, SUPPORTS, ENVELOPE, GOAL)


def bound_of(
    scene: Scene,
    resolution_mm: float | None = None,
    info: Info = lambda _: None,
    detail: Info = lambda _: None,
) -> dict[str, Any]:
    """What no web of a scene's envelope can beat, for its goal and limits.

    Args:
        resolution_mm: largest cell edge; the scene's own by default.
        info, detail: called with lines of progress.

    Returns:
        The object that `bound --json` prints.

    Raises:
        CranktopoError: no goal, one about which nothing can be proven, no envelope, or a failed solve.
    """
    goal = needed(scene, "bound", "torsion")
    assumed = assumptions(scene, _TABLES)
    info(assumed_text(assumed))
    cell_mm = resolution_mm or scene.optimise.resolution_mm
    check_resolution(scene, cell_mm, laterally_symmetric(scene, "envelope"), _CASES, available_memory_MiB())
    with double_precision():
        model = bound_model(scene, cell_mm, goal)
        start = None
        if cell_mm <= scene.web.thickness_mm / _FINE:
            coarse = bound_model(scene, 2 * cell_mm, goal)
            start = densities_on_cells(coarse, prove(coarse, goal).density, model)
        nx, ny, nz = model.domain.grid.cells
        info(f"{scene.name}: {nx} x {ny} x {nz} cells, {int((model.webs.design > 0).sum())} to fill")
        return {**bound_json(model, prove(model, goal, detail, start)), "assumed": assumed_json(assumed)}
