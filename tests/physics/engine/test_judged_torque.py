"""Torque that strength is judged by: both ends of every throw, each extreme at its own worst speed.

The oracle is a chain of disks written out by hand: its stiffness matrix in complex numbers, driven by the
harmonics of the slider crank's own torque, at every speed of a fine scan.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.gas import pressure_curve
from cranktopo.engine.histories import HistoryKind, load_history, tangential_range_N, torque_amplitude_Nm
from cranktopo.engine.states import extreme_states
from cranktopo.engine.vibration.vibrating_shaft import VibratingShaft
from tests.fast_twin import FLYWHEEL_KG_M2, LOSS, PULLEY_KG_M2, PULLEY_NM, THROW_NM, fast_twin

VIBRATING = INERTIA_EFFECTS | {"bending", "torsion", "torsional_vibration"}


@dataclass(frozen=True)
class Scan:
    """Ends of the torque ahead of and behind the throw over the cycle, N m, shape (speeds, 2)."""

    high: Array
    low: Array


def by_hand(scene: Scene) -> Scan:
    """Three disks, or two without a pulley: pulley, throw with its pistons and rods, flywheel."""
    r, rod, area = 0.03375, 0.124, math.pi * 0.1**2 / 4
    curve = pressure_curve(scene)
    assert curve is not None
    angle, pressure = np.radians(curve.angle_deg), curve.pressure_MPa * 1e6
    gas = (pressure - 101325.0) * area
    lam = r / rod
    sin, cos = np.sin(angle), np.cos(angle)
    lean = np.sqrt(1 - (lam * sin) ** 2)
    acceleration = r * (cos + lam * (cos**2 - sin**2) / lean + lam**3 * (sin * cos) ** 2 / lean**3)
    lever = r * sin * (1 + lam * cos / lean)
    later = round(450 / 720 * len(angle))
    throw = throw_balance(scene).inertia_kg_mm2 * 1e-6 + 2 * (0.3 + 0.53 / 2) * r**2
    half = 2 * THROW_NM * (1 + 1j * LOSS)
    springs = [half]
    disks = [throw, FLYWHEEL_KG_M2]
    if scene.shaft is not None and scene.shaft.pulley is not None:
        springs.insert(0, 1 / (1 / half + 1 / (PULLEY_NM * (1 + 1j * LOSS))))
        disks.insert(0, PULLEY_KG_M2)
    count, driven = len(disks), len(disks) - 2
    stiffness = np.zeros((count, count), dtype=complex)
    for i, k in enumerate(springs):
        stiffness[i : i + 2, i : i + 2] += k * np.array([[1, -1], [-1, 1]])
    orders = np.arange(1, 121) / 2
    high, low = [], []
    for rpm in (
        *np.arange(4000.0, 12001.0, 250.0),
        *np.arange(5700.0, 5900.0, 10.0),
        *np.arange(11450.0, 11700.0, 10.0),
    ):
        w = rpm * math.pi / 30
        one = (gas - 0.53 * acceleration * w**2) * lever
        torque = one + np.roll(one, later)
        part = 2 * np.fft.rfft(torque)[1:121] / len(torque)
        dynamic = stiffness - (orders * w)[:, None, None] ** 2 * np.diag(disks)
        load = np.zeros((120, count, 1), dtype=complex)
        load[:, driven, 0] = part
        twist = np.linalg.solve(dynamic, load)[..., 0]
        relative = np.pad((twist[:, :-1] - twist[:, 1:]) * springs, ((1, 0), (0, 0)))
        swings = np.fft.irfft(relative, 1440, axis=0).T * 720
        ahead = swings[0] if driven else np.zeros(1440)
        behind = swings[-1] + torque.mean()
        high.append([ahead.max(), behind.max()])
        low.append([ahead.min(), behind.min()])
    return Scan(np.array(high), np.array(low))


@pytest.mark.parametrize("pulley", [True, False], ids=["pulley", "free end"])
def test_each_extreme_is_the_worst_over_all_sections_and_speeds(pulley: bool) -> None:
    """With the pulley the largest torque is behind the throw, the smallest ahead of it, at another speed.

    The speed was that of the largest swing, which is ahead of the throw, and only the torque behind it was
    read there: +217 to +108 N m of -261 to +311.
    """
    scene = fast_twin(pulley=pulley)
    scan = by_hand(scene)
    states = {state.name: state.case for state in extreme_states(scene, VIBRATING)}
    assert states["max_torque"].torque_Nm == pytest.approx(scan.high.max(), rel=0.01)
    assert states["min_torque"].torque_Nm == pytest.approx(scan.low.min(), rel=0.01)
    assert "smallest torque ahead of throw 1 of the vibrating shaft" in states["min_torque"].source
    assert "largest torque behind throw 1 of the vibrating shaft" in states["max_torque"].source
    amplitude = (scan.high - scan.low).max() / 2
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
