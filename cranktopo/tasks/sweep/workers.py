"""How many workers a machine has room for: by its cores, and by the memory that a point takes."""

from __future__ import annotations

from cranktopo.base.machine import usable_cores
from cranktopo.bodies.memory import available_memory_MiB, evaluation_memory_MiB, optimiser_memory_MiB
from cranktopo.design.scale import default_element_size_mm
from cranktopo.design.schema import Scene
from cranktopo.tasks.sweep.plan import Stage

_PROGRAM_MIB = 500.0
"""Of a worker that has loaded everything and computes nothing."""
_REFINED = 2.0
"""An estimate leaves out what is refined at fillets."""


def point_memory_MiB(scene: Scene, stage: Stage, element_size_mm: float | None) -> float:
    """Estimated peak memory of a worker at a stage, MiB."""
    size = element_size_mm or default_element_size_mm(scene)
    evaluation = _PROGRAM_MIB + _REFINED * evaluation_memory_MiB(scene, size)
    if stage in ("evaluate", "fatigue") or scene.envelope is None:
        return evaluation
    cells = optimiser_memory_MiB(scene, scene.optimise.resolution_mm, quarter=False, cases=2)
    return max(evaluation, cells)


def workers_for(points: int, point_MiB: float, asked: int | None = None) -> int:
    """Workers for a number of points: as many as asked for, or as cores and memory allow."""
    if asked is not None:
        return max(1, min(asked, points))
    fitting = int(available_memory_MiB() / point_MiB)
    return max(1, min(usable_cores(), points, fitting))
