"""Probability of failure of a point whose strength, load and fillet radius scatter.

All three are lognormal. The given load and radius are means; the mean strength is that at a survival factor
of one. Stress at a fillet rises as its radius falls, by the exponent that the polynomials of IACS UR M53 have
in bending, and its gradient is inverse to the radius.
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.reliability import first_order
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.throw_fatigue.m53 import RADIUS_EXPONENT
from cranktopo.tasks.throw_fatigue.result import PointScatter
from cranktopo.tasks.throw_fatigue.stress_model import StressModel

METHOD = "lsa"
"""The method whose strength has a survival factor; the others' strengths are at a fixed probability."""
SafetyAt = Callable[[Scene, LocalStress], float]
"""Safety of one point of a scene."""


def counts_scatter(scene: Scene, method: str) -> bool:
    """Tell whether the scene has a scatter and the method knows the mean strength that it is about."""
    return scene.fatigue.scatter is not None and method == METHOD


def point_scatter(model: StressModel, node: int, local: LocalStress, safety_at: SafetyAt) -> PointScatter:
    """Return the probability of failure of a surface node.

    Args:
        local: stress of that node, arrays of length one.
        safety_at: its safety, by scene and stress.
    """
    scatter, scene = model.scene.fatigue.scatter, model.scene
    assert scatter is not None
    radius_mm, exponent = _fillet(model, node)
    radius_share = scatter.fillet_radius_mm / radius_mm if radius_mm else 0.0
    variations = np.array([scatter.strength_percent / 100, scatter.load_percent / 100, radius_share])

    def margin(normal: Array) -> float:
        strength, load, radius = lognormal(normal, variations)
        factor = load * radius**-exponent
        there = LocalStress(
            local.amplitude_MPa * factor, local.mean_MPa * factor, local.gradient_per_mm / radius
        )
        return math.log(safety_at(with_survival(scene, strength), there))

    found = first_order(margin, len(variations))
    return PointScatter(
        failure_probability=found.failure_probability,
        reliability_index=found.index,
        shares=dict(zip(("strength", "load", "fillet_radius"), map(float, found.shares), strict=True)),
    )


def lognormal(normal: Array, variations: Array) -> Array:
    """Return lognormal variables of mean one by standard normal ones and coefficients of variation, (n,)."""
    spread = np.log1p(variations**2)
    return np.asarray(np.exp(np.sqrt(spread) * normal - spread / 2))


def with_survival(scene: Scene, factor: float) -> Scene:
    """Return the scene whose strength is so many times the mean strength."""
    fatigue = scene.fatigue.model_copy(update={"survival_factor": factor})
    return scene.model_copy(update={"fatigue": fatigue})


def _fillet(model: StressModel, node: int) -> tuple[float, float]:
    """Return radius and exponent of the fillet that a node lies on, zeros off the fillets."""
    near, far = halves(model.scene)
    half = far if model.whole and model.on_second[node] else near
    if model.on_pin[node]:
        return half.throw.crankpin.fillet_mm, RADIUS_EXPONENT["pin"]
    if model.on_journal[node]:
        return half.throw.main_journal.fillet_mm, RADIUS_EXPONENT["journal"]
    return 0.0, 0.0
