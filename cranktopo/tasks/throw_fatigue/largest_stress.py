"""Largest von Mises stress of a throw over its load states, where its safety is judged; needs no strength."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.engine.histories import HistoryKind
from cranktopo.engine.judged_histories import histories_of
from cranktopo.tasks.fatigue.criterion import larger_end_MPa
from cranktopo.tasks.fatigue.superposition import signed_von_mises_ranges
from cranktopo.tasks.throw_fatigue.needs import load_kinds
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField, unit_loads
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fea.targets import Target


def largest_stress_MPa(
    target: Target, kind: HistoryKind = "extremes", fillet_fraction: float = RULE_FRACTION
) -> float:
    """Return the largest stress over the load states of a throw that stands alone.

    Raises:
        CranktopoError: missing loads, sharp fillets, or a failed solve.
    """
    enabled, kinds = load_kinds(target.scene, kind)
    histories = [unit_loads(one, kinds) for one in histories_of(target.scene, kind, enabled)]
    model = solve_stresses(target, kinds, fillet_fraction)
    ranges = (
        one.local
        for loads in histories
        for one in signed_von_mises_ranges(model.stress, [loads * image.signs for image in model.images])
    )
    return max(_largest(local.amplitude_MPa, local.mean_MPa, model.judged) for local in ranges)


def largest_of_field_MPa(field: FatigueField) -> float:
    """Return the same of a throw whose fatigue was judged, over the load states of that."""
    return _largest(field.amplitude_MPa, field.mean_MPa, field.model.judged)


def _largest(amplitude_MPa: Array, mean_MPa: Array, judged: NDArray[np.bool_]) -> float:
    """Return the largest of judged nodes (..., n)."""
    return float(larger_end_MPa(amplitude_MPa, mean_MPa)[..., judged].max())
