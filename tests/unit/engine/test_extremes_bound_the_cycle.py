"""The joined extremes hold every state of the cycle between them, whatever outweighs what."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from cranktopo.design.loading import scene_from_dict
from cranktopo.engine.analysis import analyse, at_speed
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.histories import load_history
from tests.hostile.featured_engines import featured_engine
from tests.random_engines import random_engine

ENABLED = INERTIA_EFFECTS | {"bending", "torsion"}
FACTORS = (0.5, 1.0, 2.0, 3.0)


@pytest.mark.parametrize("engine", [random_engine, featured_engine], ids=["in line", "V among them"])
def test_no_state_of_the_cycle_lies_outside(engine: Callable[[int], dict[str, Any]]) -> None:
    """At half to three times the speed: from gas that outweighs inertia to inertia that outweighs gas.

    A twin at 11 500 rpm, whose smallest force is the larger one, was judged by a range of nothing.
    """
    reversed_engines = 0
    for seed in range(8):
        data = engine(seed)
        data.pop("second_web", None)
        scene = scene_from_dict(data)
        for factor in FACTORS:
            fast = at_speed(scene, factor * scene.engine.speed_rpm)
            joined, cycle = (load_history(fast, kind, ENABLED) for kind in ("extremes", "cycle"))
            for name in ("radial_N", "torque_Nm"):
                bound, all_states = getattr(joined, name), getattr(cycle, name)
                slack = 1e-9 * np.abs(all_states).max()
                assert bound.min() <= all_states.min() + slack, (seed, factor, name)
                assert bound.max() >= all_states.max() - slack, (seed, factor, name)
            high, low = analyse(fast, ENABLED).cycle.extreme("web_force_N")
            reversed_engines += abs(low.value) > abs(high.value)
            assert np.ptp(joined.radial_N) == pytest.approx(high.value - low.value)
    assert reversed_engines > 5, "the case that was wrong is among them"
