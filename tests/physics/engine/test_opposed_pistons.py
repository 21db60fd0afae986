"""Opposed pistons: one crank of two, with the gas between both pistons; direct formulas and limits."""

from __future__ import annotations

import math
import re
import tomllib
from pathlib import Path

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.design.assumed import LOADS, assumptions
from cranktopo.design.idle_keys import idle_keys
from cranktopo.design.loading import parse_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.chamber import Piston, chamber, chamber_of
from cranktopo.engine.gas import pressure_curve
from cranktopo.engine.motored import motored_curve
from cranktopo.engine.performance import pressure_warnings
from cranktopo.tasks.throw_fatigue.dossier_sections import engine_section
from tests.engine_arrangements import MIKRON, arranged

R, L = 48.0, 166.0
AREA = math.pi / 4 * 95.0**2


def opposed(lead: float, more: str = "", strokes: int = 2) -> Scene:
    text = MIKRON.replace("strokes = 4", f"strokes = {strokes}").replace("cylinders = 4", "cylinders = 1")
    text = text.replace("[1, 3, 4, 2]", "[1]")
    for key in ("exhaust_pressure_MPa",) if strokes == 2 else ():
        text = "\n".join(line for line in text.splitlines() if not line.startswith(key))
    return parse_scene(f"{text}\n[engine.opposed]\nlead_deg = {lead}\n{more}")


def way(angle_deg: Array, radius: float = R, rod: float = L) -> Array:
    """Path of a piston from its inner dead centre, from the triangle of throw and rod."""
    a = np.radians(angle_deg)
    return radius + rod - radius * np.cos(a) - np.sqrt(rod**2 - (radius * np.sin(a)) ** 2)


def test_volume_between_two_pistons_that_differ() -> None:
    """Both paths added, least and largest volume found on a fine grid."""
    room = chamber(Piston(R, L), Piston(40.0, 150.0, -14.0))
    fine = np.arange(0.0, 360.0, 0.001)
    both = way(fine) + way(fine - 14.0, 40.0, 150.0)
    least = fine[both.argmin()]
    assert room.dead_centre_deg == pytest.approx(least, abs=1e-3)
    assert 0 < least < 14.0
    assert room.stroke_mm == pytest.approx(np.ptp(both), rel=1e-9)
    after = np.array([-120.0, -30.0, 0.0, 15.0, 90.0, 200.0])
    volume, rate = room.volume(after, 16.0), room.volume_rate(after, 16.0)
    at = after + room.dead_centre_deg
    there = way(at) + way(at - 14.0, 40.0, 150.0)
    assert volume == pytest.approx(1 + 15.0 * (there - both.min()) / np.ptp(both), rel=1e-9)
    step = 1e-5
    ends = [room.volume(after + sign * math.degrees(step), 16.0) for sign in (-1, 1)]
    assert rate == pytest.approx((ends[1] - ends[0]) / (2 * step), abs=1e-6)


def test_a_second_piston_that_stands_still_leaves_a_single_one() -> None:
    still, single = chamber(Piston(R, L), Piston(1e-9, L, 20.0)), chamber(Piston(R, L))
    assert (single.dead_centre_deg, single.least_mm, single.stroke_mm) == (0.0, 0.0, 2 * R)
    angle = np.linspace(-180.0, 180.0, 91)
    assert still.volume(angle, 12.0) == pytest.approx(single.volume(angle, 12.0), abs=1e-8)
    assert still.volume_rate(angle, 12.0) == pytest.approx(single.volume_rate(angle, 12.0), abs=1e-8)


def test_cranks_in_step_have_the_pressure_of_a_single_piston() -> None:
    """Both pistons do the same, so the volume over the least one is that of one of them under a head."""
    both, one = opposed(0.0, strokes=4), arranged("", 1, (1,))
    for curve in (pressure_curve, motored_curve):
        found, alone = curve(both), curve(one)
        assert found is not None
        assert alone is not None
        assert found.pressure_MPa == pytest.approx(alone.pressure_MPa, rel=1e-9)
    cycles = [analyse(scene).cycle for scene in (both, one)]
    assert cycles[0] is not None
    assert cycles[1] is not None
    assert cycles[0].forces.web_force_N == pytest.approx(cycles[1].forces.web_force_N, rel=1e-9, abs=1e-3)


@pytest.mark.parametrize("strokes", [2, 4])
def test_both_cranks_share_the_work_of_the_gas(strokes: int) -> None:
    """Each design is one of them: same gas, angles apart by the lead; their works are that of the volume.

    The crank that leads, that of the exhaust in a two-stroke engine, has more of it.
    """
    leads, trails = opposed(-12.0, strokes=strokes), opposed(12.0, strokes=strokes)
    first, second = (analyse(scene).cycle for scene in (leads, trails))
    assert first is not None
    assert second is not None
    cycle = first.pressure.cycle_deg
    assert first.room.dead_centre_deg - second.room.dead_centre_deg == pytest.approx(12.0, abs=1e-6)
    fine = np.arange(0.0, cycle, 0.05)
    one, other = (
        np.interp(fine + c.room.dead_centre_deg, c.pressure.angle_deg, c.pressure.pressure_MPa, period=cycle)
        for c in (first, second)
    )
    assert one == pytest.approx(other, rel=2e-3)
    at = fine + first.room.dead_centre_deg
    volume = AREA * (way(at) + way(at - 12.0))
    mean = (one + np.roll(one, -1)) / 2
    work = float((mean * (np.roll(volume, -1) - volume)).sum()) / 1000
    assert first.indicated_work_J + second.indicated_work_J == pytest.approx(work, rel=1e-4)
    assert first.indicated_work_J > 1.1 * second.indicated_work_J


def test_torque_does_the_work_on_its_own_piston() -> None:
    cycle = analyse(opposed(-12.0)).cycle
    assert cycle is not None
    mean = float(cycle.forces.torque_Nm.mean())
    assert mean * 2 * math.pi == pytest.approx(cycle.indicated_work_J, rel=1e-4)
    assert not pressure_warnings(opposed(-12.0))


def test_the_peak_counts_from_the_least_volume() -> None:
    scene = opposed(-12.0)
    curve = pressure_curve(scene)
    assert curve is not None
    least = chamber_of(scene).dead_centre_deg
    peak = curve.angle_deg[curve.pressure_MPa.argmax()]
    assert peak == pytest.approx(11.0 + least, abs=0.25)
    assert least == pytest.approx(6.0, abs=1e-6)  # equal cranks: half the lead


def test_motored_pressures_are_alike_on_both_sides_of_the_least_volume() -> None:
    curve = motored_curve(opposed(-20.0, strokes=4))
    assert curve is not None
    angle = np.arange(1.0, 100.0)
    before, after = (
        np.interp(curve.least_volume_deg + sign * angle, curve.angle_deg, curve.pressure_MPa, period=720.0)
        for sign in (-1, 1)
    )
    assert after == pytest.approx(before, rel=1e-3)
    fired = pressure_curve(opposed(-20.0, strokes=4))
    assert fired is not None
    assert fired.pressure_MPa.max() > 2 * curve.pressure_MPa.max()


def test_a_measured_trace_counts_from_the_least_volume(tmp_path: Path) -> None:
    angle = np.arange(0.0, 720.0)
    values = 0.1 + 5.0 * np.exp(-((((angle + 360.0) % 720.0 - 360.0 - 10.0) / 25.0) ** 2))
    rows = "\n".join(f"{a:g},{p:.6f}" for a, p in zip(angle, values, strict=True))
    trace = tmp_path / "trace.csv"
    trace.write_text(f"crank_angle_deg,pressure_MPa\n{rows}\n")
    scene = opposed(-16.0, strokes=4)
    assert scene.engine is not None
    assert scene.engine.gas is not None
    update = {"indicator_csv": str(trace), "peak_pressure_MPa": None, "peak_angle_deg": None}
    gas = scene.engine.gas.model_copy(update=update)
    measured = scene.model_copy(update={"engine": scene.engine.model_copy(update={"gas": gas})})
    curve, unfired = pressure_curve(measured), motored_curve(measured)
    assert curve is not None
    assert unfired is not None
    assert curve.angle_deg[curve.pressure_MPa.argmax()] == pytest.approx(18.0, abs=0.25)
    sides = [np.interp(8.0 + a, unfired.angle_deg, unfired.pressure_MPa, period=720.0) for a in (-30.0, 30.0)]
    assert sides[0] == pytest.approx(sides[1], rel=1e-6)


def test_what_is_of_one_crank_is_told_and_what_cannot_be_is_refused() -> None:
    told = [str(one) for one in assumptions(opposed(-12.0), (LOADS,))]
    assert any("free forces are those of one crank of the two" in one for one in told)
    assert "the other crank is -12 deg ahead; loads and power" in str(engine_section(opposed(-12.0), None))
    with pytest.raises(CranktopoError, match=r"lead_deg = 61\.0: must be"):
        opposed(61.0)
    with pytest.raises(CranktopoError, match=r"opposed\.radius_mm = 170\.0: gives the other crank no rod"):
        opposed(0.0, "radius_mm = 170.0")
    with pytest.raises(CranktopoError, match=r"opposed\.rod_length_mm = 40\.0: gives the other crank no rod"):
        opposed(0.0, "rod_length_mm = 40.0")
    text = re.sub(r"(?s)\[engine\.gas\].*?(?=\n\[)", "[engine.opposed]\nlead_deg = 5.0\n", MIKRON)
    idle = idle_keys(parse_scene(text), tomllib.loads(text))
    assert idle == ("engine.opposed.lead_deg: it changes the pressure, which needs [engine.gas]",)
    with pytest.raises(CranktopoError, match=r"layout = 'boxer': must be 'in-line' with \[engine\.opposed\]"):
        arranged("layout = 'boxer'\n[engine.opposed]\nlead_deg = 5.0", 4, (1, 3, 2, 4))
