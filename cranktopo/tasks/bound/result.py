"""What `bound --json` prints: the goal, the bound beside the original, and what it is about."""

from __future__ import annotations

from typing import Any

from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.tasks.bound.lower_bound import Bound, BoundModel
from cranktopo.tasks.density.assessment import model_error_percent
from cranktopo.tasks.density.manufacturing import is_manufactured

SCHEMA_VERSION = 1


def bound_json(model: BoundModel, bound: Bound) -> dict[str, Any]:
    """The entry of one bound."""
    goal, grid = bound.wanted.goal, model.domain.grid
    return {
        "schema_version": SCHEMA_VERSION,
        "design": model.scene.name,
        "goal": {
            **goal.as_json(),
            "dropped": [{"limit": str(limit), "reason": why} for limit, why in bound.wanted.dropped],
        },
        "bound": {
            "quantity": goal.quantity,
            "value": bound.value,
            "unit": QUANTITIES[goal.quantity].unit,
            "percent_of_original": bound.percent,
            "possible": bound.value is not None,
        },
        "variable_stiffness": {
            "value": bound.reached,
            "percent_of_original": 100 * bound.reached / bound.original,
            "steps": bound.steps,
        },
        "original": dict(model.original.quantities),
        "original_outside_envelope_percent": 100 * model.outside,
        "weights": {
            ceiling.told.quantity: price
            for ceiling, price in zip(bound.wanted.ceilings, bound.prices, strict=True)
        },
        "process": model.scene.optimise.process if is_manufactured(model.scene) else "free",
        "die": model.webs.die is not None,
        "cells": list(grid.cells),
        "design_cells": int((model.webs.design > 0).sum()),
        "resolution_mm": model.scene.optimise.resolution_mm,
        "model_error_percent": model_error_percent(model.scene, grid.largest_edge_mm),
        "seconds": bound.seconds,
    }
