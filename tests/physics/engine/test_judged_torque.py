"""Torque that strength is judged by: both ends of every throw, each extreme at its own worst speed.

The oracle is a chain of disks written out by hand, at every speed of a fine scan.
"""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.histories import HistoryKind, load_history, tangential_range_N, torque_amplitude_Nm
from cranktopo.engine.states import extreme_states
from cranktopo.engine.vibration.vibrating_shaft import VibratingShaft, vibrating_torque
from tests.fast_twin import fast_twin
from tests.physics.engine.twin_by_hand import TwinByHand

VIBRATING = INERTIA_EFFECTS | {"bending", "torsion", "torsional_vibration"}


def scanned(scene: Scene) -> Array:
    """Torque ahead of and behind the throw at every half degree and at many speeds, (speeds, 2, 1440)."""
    chain = TwinByHand.of(scene)
    near_critical = *np.arange(5700.0, 5900.0, 10.0), *np.arange(11450.0, 11700.0, 10.0)
    return np.stack([chain.torques_Nm(rpm) for rpm in (*np.arange(4000.0, 12001.0, 250.0), *near_critical)])


@pytest.mark.parametrize("pulley", [True, False], ids=["pulley", "free end"])
def test_both_torques_are_those_of_the_chain_at_every_angle(pulley: bool) -> None:
    """Extremes say nothing of the phase, in which they meet the forces on the pin."""
    scene = fast_twin(pulley=pulley)
    found, by_hand = vibrating_torque(scene, VIBRATING), TwinByHand.of(scene).torques_Nm(11500.0)
    assert found.ahead_Nm is not None
    for torque, expected in zip((found.ahead_Nm[0], found.passed_on_Nm[0]), by_hand, strict=True):
        own = np.interp(np.arange(1440) / 2, found.angle_deg, torque, period=720.0)
        assert own == pytest.approx(expected, abs=1e-4 * np.ptp(by_hand))


@pytest.mark.parametrize("pulley", [True, False], ids=["pulley", "free end"])
def test_each_extreme_is_the_worst_over_all_sections_and_speeds(pulley: bool) -> None:
    """With the pulley the largest torque is behind the throw, the smallest ahead of it, at another speed.

    The speed was that of the largest swing, which is ahead of the throw, and only the torque behind it was
    read there: +217 to +108 N m of -261 to +311.
    """
    scene = fast_twin(pulley=pulley)
    torque = scanned(scene)
    states = {state.name: state.case for state in extreme_states(scene, VIBRATING)}
    assert states["max_torque"].torque_Nm == pytest.approx(torque.max(), rel=0.01)
    assert states["min_torque"].torque_Nm == pytest.approx(torque.min(), rel=0.01)
    assert "smallest torque ahead of throw 1 of the vibrating shaft" in states["min_torque"].source
    assert "largest torque behind throw 1 of the vibrating shaft" in states["max_torque"].source
    amplitude = np.ptp(torque, axis=2).max() / 2
    for kind in ("extremes", "cycle"):
        found = torque_amplitude_Nm(scene, kind, VIBRATING)
        assert found >= 0.99 * amplitude
    assert found == pytest.approx(amplitude, rel=0.01), "of a cycle it is that of the worst section itself"


def test_the_rule_takes_all_the_torque_behind_a_throw_whose_free_end_is_bare() -> None:
    """Ahead of throw 1 there is none: the mean of both ends is half of what its second web carries."""
    scene = fast_twin()
    plain = VIBRATING - {"torsional_vibration"}
    history = load_history(scene, "cycle", plain)
    found = torque_amplitude_Nm(scene, "cycle", plain)
    assert found == pytest.approx((999.15 + 376.50) / 2, rel=1e-4)  # engine torque by hand, N m
    assert found == pytest.approx(np.ptp(history.torque_Nm), rel=1e-3)


def test_the_range_is_solved_once_for_all_histories(monkeypatch: pytest.MonkeyPatch) -> None:
    """Extremes, cycle and the force at outlets ask for its worst and extreme speeds, one after another."""
    scene, solved = fast_twin(name="solved-once"), []
    solve = VibratingShaft.over_the_range
    monkeypatch.setattr(VibratingShaft, "over_the_range", lambda own: solved.append(1) or solve(own))
    kinds: tuple[HistoryKind, ...] = ("extremes", "cycle")
    for kind in kinds:
        torque_amplitude_Nm(scene, kind, VIBRATING)
    tangential_range_N(scene, VIBRATING)
    assert len(solved) == 1
