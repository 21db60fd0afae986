"""Critical plane of W. N. Findley: the plane on which shear amplitude and normal stress together are worst.

Source: W. N. Findley, A theory for the effect of mean stress on fatigue of metals under combined torsion and
axial load or bending, J. Eng. Ind. 81 (1959), 301-306. On a plane with shear amplitude tau_a and largest
normal stress sigma_n of the cycle,

    tau_a + k sigma_n <= f.

Both constants follow from the strengths in fully reversed tension s and torsion t, whose worst planes are
known: f = t sqrt(1 + k^2) and 2 f = s (k + sqrt(1 + k^2)), so that k / sqrt(1 + k^2) = 2 t / s - 1.
"""

from __future__ import annotations

import math

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.numerics.enclosing_balls import enclosing_balls
from cranktopo.tasks.fatigue.lsa import FACTORS, NEEDS
from cranktopo.tasks.fatigue.plane_criterion import (
    HistoryBounds,
    PlaneCriterion,
    PlaneDiagram,
    Severity,
    check_scene,
    torsion_ratio,
)
from cranktopo.tasks.fatigue.planes import WorstPlane, on_planes, worst_planes


def normal_weight(torsion_over_tension: float) -> float:
    """Return k, the weight of the normal stress, from a ratio of strengths of 0.5 to below 1."""
    sine = 2 * torsion_over_tension - 1
    return sine / math.sqrt(1 - sine * sine)


def findley(history: Array, k: float) -> WorstPlane:
    """Return the worst plane of stress histories (n, states, 6); its value is tau_a + k sigma_n in MPa."""
    return worst_planes(history, lambda shear, normal: shear + k * normal)


def value_in_tension(k: float) -> float:
    """Return tau_a + k sigma_n on the worst plane in fully reversed tension of amplitude 1."""
    return (k + math.sqrt(1 + k * k)) / 2


def _severity(scene: Scene, history: Array) -> Severity:
    k = normal_weight(torsion_ratio(scene))
    found = findley(history, k)
    equivalent = np.maximum(found.value, 0.0) / value_in_tension(k)
    share = np.clip(found.shear_MPa / np.maximum(found.value, 1e-12), 0.0, 1.0)
    named = dict(zip(("normal_x", "normal_y", "normal_z"), found.normal.T, strict=True))
    stresses = {"tau_a_MPa": found.shear_MPa, "sigma_n_MPa": found.normal_MPa}
    return Severity(equivalent, share, {"k": np.full_like(share, k), **stresses, **named})


def _at_most_MPa(scene: Scene, bounds: HistoryBounds) -> Array:
    k = normal_weight(torsion_ratio(scene))
    return np.maximum(bounds.shear_MPa + k * bounds.normal_MPa, 0.0) / value_in_tension(k)


def _diagram(scene: Scene, history: Array, strength_MPa: float) -> PlaneDiagram:
    k = normal_weight(torsion_ratio(scene))
    normal, shear = on_planes(history[None], findley(history[None], k).normal)
    centre, _ = enclosing_balls(shear[0])
    path = np.linalg.norm(shear[0, 0] - centre[0], axis=1)
    limit = strength_MPa * value_in_tension(k)
    return PlaneDiagram("normal stress on the critical plane", normal[0, 0], path, k, limit)


FINDLEY = PlaneCriterion(
    "findley",
    NEEDS,
    _severity,
    _at_most_MPa,
    _diagram,
    "normal stress",
    takes=FACTORS,
    check=check_scene,
    title="Findley's criterion",
    includes="strength as lsa, mean stress normal to the critical plane; names no least safety",
)
