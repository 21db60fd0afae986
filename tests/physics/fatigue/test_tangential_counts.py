"""The default load states tell no more than the whole cycle does, a tangential force included."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.design.named import with_values
from cranktopo.engine.histories import LoadHistory, rated_histories
from cranktopo.engine.judged_histories import histories_of
from cranktopo.tasks.throw_fatigue.needs import load_kinds
from cranktopo.tasks.throw_fatigue.safety_field import safety_field
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fatigue.target_safety import least_field
from cranktopo.tasks.throw_fatigue.verdicts import SAME
from cranktopo.tasks.throw_fea.targets import Target
from tests.physics.fatigue.test_least_safety import drilled


@pytest.mark.slow
def test_no_place_near_the_least_safety_is_told_safer_than_over_the_cycle() -> None:
    """A drilled V-twin with its outlet at the side of the pin; joined extremes alone told 20 % more."""
    scene = with_values(drilled(), {"throw.drilling[0].to.angle_deg": 56.0})
    enabled, kinds = load_kinds(scene, "extremes")
    model = solve_stresses(Target("twin", scene), kinds, 0.5)

    def safety(histories: list[LoadHistory]) -> np.ndarray:
        return least_field(safety_field(model, "lsa", one) for one in histories).safety[:, model.judged]

    cycle = safety([*histories_of(scene, "cycle", enabled)])
    near = cycle < 1.5 * cycle.min()
    joined = safety([*rated_histories(scene, "extremes", enabled)])
    assert (joined / cycle)[near].max() > 1.15
    assert (safety([*histories_of(scene, "extremes", enabled)]) / cycle)[near].max() < 1 + SAME
