"""Mesoscopic criterion of K. Dang Van: shear of the grains after shakedown, and hydrostatic stress.

Source: K. Dang Van, B. Griveau, O. Message, On a new multiaxial fatigue limit criterion, in: Biaxial and
multiaxial fatigue, EGF 3, 1989, 479-496. The grains settle in a state of residual stress: the centre of the
smallest hypersphere around the deviators of the cycle. With the largest shear stress tau of what is left (by
Tresca, on whichever plane) and the hydrostatic stress sigma_h at the same time,

    max over the cycle of tau + a sigma_h <= b,

and from the strengths in fully reversed tension s and torsion t: b = t, a = 3 (t / s - 1/2).
"""

from __future__ import annotations

import math

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.numerics.enclosing_balls import enclosing_balls
from cranktopo.numerics.tetrahedra.stress import principal_stresses
from cranktopo.tasks.fatigue.lsa import FACTORS, NEEDS
from cranktopo.tasks.fatigue.plane_criterion import (
    HistoryBounds,
    PlaneCriterion,
    PlaneDiagram,
    Severity,
    check_scene,
    torsion_ratio,
)

_VALUES = 2**21
_DEVIATORS = np.zeros((5, 6))
_DEVIATORS[0, :2] = np.array([1, -1]) / math.sqrt(2)
_DEVIATORS[1, :3] = np.array([-1, -1, 2]) / math.sqrt(6)
_DEVIATORS[2:, 3:] = math.sqrt(2) * np.eye(3)
"""Coordinates of a deviator whose length is that of the tensor."""
_TENSORS = np.concatenate([_DEVIATORS[:, :3], _DEVIATORS[:, 3:] / 2], axis=1)
"""The deviators of these coordinates."""


def hydrostatic_weight(torsion_over_tension: float) -> float:
    """Return a, the weight of the hydrostatic stress."""
    return 3 * (torsion_over_tension - 0.5)


def mesoscopic(history: Array) -> tuple[Array, Array]:
    """Return the shear stress of grains that have settled, and the hydrostatic stress, (n, states) each.

    Args:
        history: stress in each state, shape (n, states, 6).
    """
    step = max(_VALUES // (16 * history.shape[1]), 1)
    parts = [_shear(history[at : at + step]) for at in range(0, len(history), step)]
    return np.concatenate(parts), history[..., :3].mean(axis=-1)


def _shear(history: Array) -> Array:
    centre, _ = enclosing_balls(history @ _DEVIATORS.T)
    principal = principal_stresses(history - (centre @ _TENSORS)[:, None])
    return np.asarray(principal[..., 0] - principal[..., 2]) / 2


def _severity(scene: Scene, history: Array) -> Severity:
    ratio = torsion_ratio(scene)
    a = hydrostatic_weight(ratio)
    shear, hydrostatic = mesoscopic(history)
    value = shear + a * hydrostatic
    worst = value.argmax(axis=1)[:, None]
    most, tau, mean = (np.take_along_axis(v, worst, axis=1)[:, 0] for v in (value, shear, hydrostatic))
    share = np.clip(tau / np.maximum(most, 1e-12), 0.0, 1.0)
    factors = {"a": np.full_like(share, a), "tau_MPa": tau, "sigma_h_MPa": mean}
    return Severity(np.maximum(most, 0.0) / ratio, share, factors)


def _at_most_MPa(scene: Scene, bounds: HistoryBounds) -> Array:
    ratio = torsion_ratio(scene)
    most = bounds.shear_MPa + hydrostatic_weight(ratio) * bounds.hydrostatic_MPa
    return np.maximum(most, 0.0) / ratio


def _diagram(scene: Scene, history: Array, strength_MPa: float) -> PlaneDiagram:
    ratio = torsion_ratio(scene)
    (shear,), (hydrostatic,) = mesoscopic(history[None])
    a = hydrostatic_weight(ratio)
    return PlaneDiagram("hydrostatic stress", hydrostatic, shear, a, strength_MPa * ratio)


DANG_VAN = PlaneCriterion(
    "dang_van",
    NEEDS,
    _severity,
    _at_most_MPa,
    _diagram,
    "hydrostatic stress",
    takes=FACTORS,
    check=check_scene,
    title="Dang Van's criterion",
    includes="strength as lsa, mean stress by the hydrostatic stress; names no least safety",
)
