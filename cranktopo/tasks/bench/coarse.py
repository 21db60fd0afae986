"""Stiffness of a web on coarse cells, for a drag: brought to the settled value by whoever shows it."""

from __future__ import annotations

import json
from functools import lru_cache
from typing import Any

from cranktopo.bodies.cells.domain import build_domain, laterally_symmetric, throw_reach
from cranktopo.bodies.cells.fractions import QUICK
from cranktopo.bodies.cells.grid import Extent, follow_grid, plan_grid
from cranktopo.design.halves import difference, usual_scale
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.states import main_load_cases
from cranktopo.engine.throw_compliance import throw_compliance
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density.model import build_model
from cranktopo.tasks.density.responses import quantities_of
from cranktopo.tasks.web_shape.web_model import solved_design

_CELL_MM = 4.0
_TOLERANCE = 1e-4
_FILLETS = {"torsion": 1.85, "bending": 1.1}
"""Effect of fillets on the logarithm of a stiffness, over that by the closed form: from 15 moves of a fillet
(`tests.studies.live_ring`, 10000 to 10067)."""
_OF_FILLET = ("fillet_mm", "fillet_axial_mm")


def coarse_stiffness(data: dict[str, Any], settled: dict[str, Any]) -> dict[str, float]:
    """Return both stiffnesses, N m/rad and N/mm, alone and per mass, on cells of 4 mm for usual journals.

    Nothing where the halves of the throw differ: the cells hold one half.

    Args:
        settled: design that this one is compared with, whose cells it has: with others both would differ by
            a percent for this alone.
    """
    scene, first = scene_from_dict(data, "design", whole=True), _read(json.dumps(settled))
    return {} if difference(scene) or difference(first) else _on_cells(scene, first)


@lru_cache(maxsize=1)
def _read(settled: str) -> Scene:
    """Return the design as JSON that a drag begins at, the same for all its moves."""
    return scene_from_dict(json.loads(settled), "design", whole=True)


def _on_cells(scene: Scene, first: Scene) -> dict[str, float]:
    with double_precision():
        size = _CELL_MM / usual_scale(first)
        extent: Extent = "quarter" if laterally_symmetric(scene, "web") else "half"
        reach = throw_reach(first, "web")
        grid = follow_grid(plan_grid(*reach, size, extent), reach, throw_reach(scene, "web"))
        domain = build_domain(scene, size, "web", extent, grid, QUICK)
        model = build_model(scene, domain, main_load_cases(scene, plan(scene).enabled))
        known = quantities_of(scene, model)
        solved = solved_design(model, domain.passive_fraction, domain.passive_fraction, _TOLERANCE)
        fillets = _by_fillets(scene, first)
        return {name: factor * float(known[name].value(solved)) for name, factor in fillets.items()}


def _by_fillets(scene: Scene, first: Scene) -> dict[str, float]:
    """Return what the first throw gains by the fillets of a scene, which cells do not have, by quantity."""
    first = first.with_drillings(())  # no matter here, and slow to weigh
    moved = _with_fillets(first, scene)
    before, after = throw_compliance(first), throw_compliance(moved)
    found = {
        "torsion": (before.torsion_rad_per_Nmm / after.torsion_rad_per_Nmm) ** _FILLETS["torsion"],
        "bending": (before.bending_mm_per_N / after.bending_mm_per_N) ** _FILLETS["bending"],
    }
    heavier = throw_balance(moved).mass_kg / throw_balance(first).mass_kg
    return found | {f"{name}_per_mass": stiffer / heavier for name, stiffer in found.items()}


def _with_fillets(first: Scene, scene: Scene) -> Scene:
    """Return the first scene with the fillets of another."""
    journals = {
        name: getattr(first.throw, name).model_copy(
            update={key: getattr(getattr(scene.throw, name), key) for key in _OF_FILLET}
        )
        for name in ("main_journal", "crankpin")
    }
    return first.model_copy(update={"throw": first.throw.model_copy(update=journals)})
