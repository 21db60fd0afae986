"""Stiffness of a web on coarse cells, for a drag: brought to the settled value by whoever shows it."""

from __future__ import annotations

from typing import Any

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.cells.fractions import QUICK
from cranktopo.design.halves import difference, usual_scale
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.states import main_load_cases
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density.model import build_model
from cranktopo.tasks.density.responses import quantities_of
from cranktopo.tasks.web_shape.web_model import solved_design

_CELL_MM = 4.0
_TOLERANCE = 1e-4
SHOWN = ("torsion", "bending", "torsion_per_mass", "bending_per_mass")


def coarse_stiffness(data: dict[str, Any]) -> dict[str, float]:
    """Return both stiffnesses, N m/rad and N/mm, alone and per mass, on cells of 4 mm for usual journals.

    Nothing where the halves of the throw differ: the cells hold one half.
    """
    scene = scene_from_dict(data, "design", whole=True)
    return {} if difference(scene) else _on_cells(scene)


def _on_cells(scene: Scene) -> dict[str, float]:
    with double_precision():
        domain = build_domain(scene, _CELL_MM / usual_scale(scene), "web", tolerance=QUICK)
        model = build_model(scene, domain, main_load_cases(scene, plan(scene).enabled))
        known = quantities_of(scene, model)
        solved = solved_design(model, domain.passive_fraction, domain.passive_fraction, _TOLERANCE)
        return {name: float(known[name].value(solved)) for name in SHOWN}
