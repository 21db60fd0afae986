"""W and radial engines: three and more rods on a pin, against sums over their directions and closed forms."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import CranktopoError
from cranktopo.design.assumed import LOADS, assumptions
from cranktopo.design.loading import designs_folder, parse_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.balance.free_forces import ORDERS, free_forces, oscillating_force, turning_masses
from cranktopo.engine.balance.whole_engine import main_bearings
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.histories import load_history
from cranktopo.engine.states import load_cases
from cranktopo.engine.vibration.shaft_chain import varying_inertia_percent
from cranktopo.engine.vibration.torque_harmonics import curve_of, torque_harmonics
from cranktopo.tasks.film.stage import loaded_big_end
from cranktopo.tasks.loads.stage import loads_at_speeds
from cranktopo.tasks.loads.text import loads_text
from tests.engine_arrangements import MIKRON, arranged

KINDS = frozenset({"bending", "torsion", "tangential"}) | INERTIA_EFFECTS
RADIUS, ROD = 48.0, 166.0
LION = "layout = 'W'\nbank_angles_deg = [0.0, 60.0, 120.0]\n"
LION_ORDER = (1, 5, 9, 3, 7, 11, 4, 8, 12, 2, 6, 10)
W12 = arranged(LION + "rod_offset_mm = 9.0", 12, LION_ORDER)
UNEVEN_W6 = arranged(
    "layout = 'W'\nbank_angles_deg = [0, 50, 115]\nthrow_angles_deg = [0.0, 170.0]\nrod_offset_mm = 7.0",
    6,
    (1, 5, 2, 3, 4, 6),
)
DOUBLE_ORDER = (1, 10, 5, 14, 9, 4, 13, 8, 3, 12, 7, 2, 11, 6)
DOUBLE_ROW = arranged("layout = 'radial'\nthrow_angles_deg = [0.0, 180.0]", 14, DOUBLE_ORDER)


def radial(cylinders: int, more: str = "") -> Scene:
    """One row: four-stroke every other cylinder fires, two-stroke one after the other."""
    if cylinders % 2:
        order = (*range(1, cylinders + 1, 2), *range(2, cylinders + 1, 2))
        return arranged(f"layout = 'radial'\n{more}", cylinders, order)
    return arranged(f"layout = 'radial'\n{more}", cylinders, tuple(range(1, cylinders + 1)), 2)


def moving_masses(scene: Scene) -> list[tuple[float, Complex, float]]:
    """Mass, place across the shaft over a turn, and place along it of every piston and throw."""
    masses, engine = turning_masses(scene), scene.engine
    assert engine is not None
    arrangement = engine.arranged
    turn = np.linspace(0, 2 * np.pi, 512, endpoint=False)
    banks = np.radians(arrangement.bank_angles_deg)
    throws = np.radians(engine.throw_angles_deg)
    found = []

    def axis(cylinder: int) -> float:
        if len(banks):
            return float(banks[(cylinder - 1) // len(throws)] - banks[-1] / 2)
        return 2 * np.pi * (cylinder - 1) / engine.cylinders

    first = engine.order[0]
    crank = turn + axis(first) - throws[(first - 1) % len(throws)]
    for k, angle in enumerate(throws):
        z = (k - (len(throws) - 1) / 2) * scene.pitch_mm
        found.append((abs(masses.throw_kg_mm) / RADIUS, RADIUS * np.exp(1j * (crank + angle)), z))
        for rod, cylinder in enumerate(range(k + 1, engine.cylinders + 1, len(throws))):
            pin = RADIUS * np.exp(1j * (crank + angle - axis(cylinder)))
            piston = (pin.real + np.sqrt(ROD**2 - pin.imag**2)) * np.exp(1j * axis(cylinder))
            aside = (arrangement.rod_offset_mm or 0.0) * (rod - (len(banks) - 1) / 2)
            found.append((masses.piston_kg_mm / RADIUS, piston, z + aside))
    return found


@pytest.mark.parametrize(
    "scene",
    [radial(3), radial(5), radial(4), W12, UNEVEN_W6, DOUBLE_ROW],
    ids=["radial 3", "radial 5", "two-stroke radial 4", "W12", "uneven W6", "double row"],
)
def test_against_the_inertia_of_all_masses(scene: Scene) -> None:
    """Accelerations of the places by Fourier series; both turning parts of every order, force and moment."""
    masses = turning_masses(scene)
    orders = np.fft.fftfreq(512, 1 / 512)
    force, moment = np.zeros(512, complex), np.zeros(512, complex)
    for kg, place, z in moving_masses(scene):
        pull = kg * orders**2 * np.fft.fft(place) / 512 * masses.w2 / 1000
        force, moment = force + pull, moment + pull * z / 1000
    scale = masses.piston_kg_mm * masses.w2 / 1000
    for free in free_forces(masses):
        for vector, spectrum in ((free.force, force), (free.moment, moment)):
            assert abs(vector.forward - spectrum[free.order]) < 1e-10 * scale
            assert abs(vector.backward - spectrum[-free.order]) < 1e-10 * scale


@pytest.mark.parametrize("cylinders", [3, 4, 5, 7, 9])
def test_free_forces_of_a_radial_engine(cylinders: int) -> None:
    """Order 1: half of all oscillating masses at the crankpin; order n: where n + 1 or n - 1 is a multiple.

    The sum of exp(i (1 -+ n) b) over even directions b is their number there and 0 else.
    """
    masses = turning_masses(radial(cylinders))
    for order, c in zip(ORDERS, masses.harmonics, strict=True):
        one = masses.piston_kg_mm * masses.w2 / 1000 * abs(c)
        force = oscillating_force(masses, order).force
        for part, off in ((force.forward, order - 1), (force.backward, order + 1)):
            assert abs(part) == pytest.approx(cylinders / 2 * one * (off % cylinders == 0), abs=1e-9 * one)
    half = turning_masses(radial(cylinders, "balanced_oscillating_share = 0.5"))
    assert free_forces(half, counterweighted=True)[0].force.largest == 0


def test_free_forces_of_a_broad_arrow() -> None:
    """Banks at -60, 0 and 60 deg on one pin: order 1 is 3/2 with the crank and 1/2 against it.

    The sum of exp(2 i b) over the banks is 1 + 2 cos 120 deg = 0, that of exp(-i b) = 2, of exp(3 i b) = -1.
    """
    scene = arranged("layout = 'W'\nbank_angles_deg = [0, 60, 120]\nthrow_angles_deg = [0]", 3, (1, 2, 3))
    masses = turning_masses(scene)
    one = masses.piston_kg_mm * masses.w2 / 1000
    first, second = (oscillating_force(masses, order).force for order in (1, 2))
    assert (abs(first.forward), abs(first.backward)) == pytest.approx((1.5 * one, 0.0), abs=1e-9 * one)
    c2 = one * abs(masses.harmonics[1])
    assert (abs(second.forward), abs(second.backward)) == pytest.approx((c2, c2 / 2), rel=1e-12)


@pytest.mark.parametrize("scene", [W12, UNEVEN_W6, radial(5), DOUBLE_ROW], ids=["W12", "W6", "5", "14"])
def test_each_web_carries_the_reaction_of_its_bearing(scene: Scene) -> None:
    """The throw as a beam on two bearings, from directions and places of the rods in space."""
    engine = scene.engine
    assert engine is not None
    cycle = analyse(scene).cycle
    assert cycle is not None
    loads = main_bearings(scene, turning_masses(scene)).load_N
    by_throw = [[f for rods, f in cycle.pins if rods.throw == k] for k in (0, engine.throws - 1)]
    for bearing, forces in ((loads[0], by_throw[0][0]), (loads[-1], by_throw[1][-1])):
        size = np.abs(bearing).max()  # the outer bearings carry the outer web of one throw alone
        assert forces.main_journal_force_N.max() == pytest.approx(size, rel=1e-9)


def test_three_rods_that_move_together_are_three_times_one() -> None:
    """Banks almost in one plane; the places on the pin cancel in the sum of both webs."""
    together = arranged(
        "layout = 'W'\nbank_angles_deg = [0, 1e-9, 2e-9]\nthrow_angles_deg = [0]\nrod_offset_mm = 8.0",
        3,
        (1, 2, 3),
        2,
    )
    both, single = analyse(together).cycle, analyse(arranged("", 1, (1,), 2)).cycle
    assert both is not None
    assert single is not None
    for _, forces in both.pins:
        for name in ("radial_force_N", "tangential_force_N", "web_force_N", "torque_Nm"):
            assert getattr(forces, name) == pytest.approx(
                3 * getattr(single.forces, name), rel=1e-8, abs=1e-5
            )


@pytest.mark.parametrize("scene", [W12, DOUBLE_ROW], ids=["W12", "double row"])
def test_torque_along_the_shaft_by_orders(scene: Scene) -> None:
    """Sum of Fourier orders with the phases of the cylinders."""
    cycle, harmonics = analyse(scene).cycle, torque_harmonics(scene)
    assert cycle is not None
    assert harmonics is not None
    torque = cycle.torque
    by_orders = np.cumsum(curve_of(harmonics.of_throws_Nm(2100.0).T, len(torque.angle_deg)), axis=0)
    assert torque.passed_on_Nm == pytest.approx(by_orders, abs=0.2)
    assert torque.engine_Nm.mean() > 100


def test_firing_is_even_and_in_the_order_of_the_dead_centres() -> None:
    """Every cylinder is at its top dead centre when it fires: axis and crank are in one direction."""
    for scene in (W12, radial(9), DOUBLE_ROW):
        engine = scene.engine
        assert engine is not None
        fires = sorted(engine.firing_angles_deg)
        assert np.diff(fires) == pytest.approx(720 / engine.cylinders)
        for cylinder, fire in enumerate(engine.firing_angles_deg, start=1):
            crank = fire + engine.throw_angles_deg[(cylinder - 1) % engine.throws]
            assert (crank - engine.axis_deg(cylinder) + 180) % 360 - 180 == pytest.approx(0, abs=1e-6)


def test_pistons_of_a_radial_engine_have_one_inertia_at_every_angle() -> None:
    """The sum of the squares of the velocities of evenly spaced pistons varies by high orders alone."""
    assert varying_inertia_percent(radial(9), 1.0) < 1e-3
    assert varying_inertia_percent(radial(3), 1.0) > 1


def test_a_master_rod_bears_what_the_main_bearings_and_the_throw_leave() -> None:
    """Its bearing carries all rods: the sum of both main bearings less the pull of the throw itself."""
    table = '\n[bearings]\nclearance_mm = 0.05\noil = "ISO VG 46"\n'
    text = MIKRON.replace("cylinders = 4", "cylinders = 5").replace("[1, 3, 4, 2]", "[1, 3, 5, 2, 4]")
    scene = parse_scene(
        text.replace("[engine.masses]", "[engine.arrangement]\nlayout = 'radial'\n[engine.masses]") + table
    )
    assert scene.engine is not None
    assert (scene.has_master_rod, scene.big_ends) == (True, 1)
    masses = turning_masses(scene)
    main = main_bearings(scene, masses)
    crank = np.exp(1j * np.radians(main.angle_deg))
    own = (complex(masses.throw_kg_mm) - 5 * masses.rod_kg_mm) * masses.w2 / 1000 * crank
    loaded = loaded_big_end(scene)
    assert loaded.number == 1
    on_pin = (main.load_N.sum(axis=0) - own)[:: len(own) // len(loaded.load_N)]
    assert -loaded.load_N == pytest.approx(on_pin, rel=1e-9, abs=1e-6)
    assert loaded.bearing.width_mm > 1.9 * loaded_big_end(two_rods(table)).bearing.width_mm


def two_rods(table: str) -> Scene:
    text = MIKRON.replace("cylinders = 4", "cylinders = 2").replace("[1, 3, 4, 2]", "[1, 2]")
    vee = "[engine.arrangement]\nlayout = 'V'\nbank_angle_deg = 90\nthrow_angles_deg = [0]\n[engine.masses]"
    return parse_scene(text.replace("[engine.masses]", vee) + table)


def articulated(cylinders: int, ratio: float, knuckle: float) -> tuple[Array, list[Complex]]:
    """Crank angles, and Fourier coefficients of the piston's places; the first has the master rod."""
    angle = np.linspace(0, 2 * np.pi, 3600, endpoint=False)
    pin, lean = np.exp(1j * angle), -np.arcsin(np.sin(angle) / ratio)
    found = []
    for number in range(cylinders):
        axis, master = 2 * np.pi * number / cylinders, number == 0
        eye = pin + (0.0 if master else knuckle) * np.exp(1j * (lean + axis))
        eye *= np.exp(-1j * axis)
        length = ratio - (0.0 if master else knuckle)
        found.append(eye.real + np.sqrt(length**2 - eye.imag**2))
    return angle, found


@pytest.mark.parametrize("cylinders", [3, 5, 7, 9])
def test_what_centred_rods_leave_out(cylinders: int) -> None:
    """Link pins one throw radius off the pin, master rod of four radii: the figures of `loads.md`."""
    angle, places = articulated(cylinders, 4.0, 1.0)
    strokes = [np.ptp(place) / 2 for place in places]
    axes = np.degrees(2 * np.pi * np.arange(cylinders) / cylinders)
    late = [
        (np.degrees(angle[place.argmax()]) - at + 180) % 360 - 180
        for place, at in zip(places, axes, strict=True)
    ]
    assert 1.003 < max(strokes) < 1.007
    assert 3.3 < np.abs(late).max() < 4.6

    def turning(order: int, backward: bool) -> float:
        each = [2 * np.mean(place * np.exp(-1j * order * angle)) * order**2 for place in places]
        spins = np.exp(1j * np.radians(axes))
        return abs(sum((np.conj(x) if backward else x) * s for x, s in zip(each, spins, strict=True))) / 2

    assert turning(1, False) == pytest.approx(cylinders / 2, rel=1e-4)  # as with centred rods
    assert turning(2, False) == pytest.approx(0.0874 * cylinders, rel=2e-3)  # centred rods have none


def test_a_master_rod_is_told_and_its_strength_refused() -> None:
    told = [one for one in assumptions(radial(5), (LOADS,)) if one.key == "engine.arrangement.layout"]
    assert [str(one) for one in told] == [
        "engine.arrangement.layout = radial (all rods of a pin are centred on it, none is articulated)"
    ]
    assert not [one for one in assumptions(W12, (LOADS,)) if one.key == "engine.arrangement.layout"]


def test_load_cases_have_all_rods() -> None:
    """A radial five: the largest pull without gas is closed: 5/2 m_osc with the crank and all that turns."""
    scene = radial(5)
    engine = scene.engine
    assert engine is not None
    fast = scene.model_copy(
        update={
            "engine": engine.model_copy(
                update={
                    "overspeed_rpm": 9000.0,
                    "gas": None,
                    "max_gas_force_N": 1e3,
                    "max_torque_Nm": 100.0,
                    "rod_length_mm": 1e4,
                }
            )
        }
    )
    pull = -next(one for one in load_cases(fast, KINDS) if one.kind == "bending").radial_N
    closed = (2.5 * engine.reciprocating_kg + 5 * engine.rod_rotating_kg) * 0.048 * (9000 * math.pi / 30) ** 2
    assert pull == pytest.approx(closed, rel=5e-3)
    assert "all pistons and rods" in load_cases(fast, KINDS)[0].source


REFUSED = [
    (LION, {"cylinders": 10}, r"engine\.firing_order.*must name each"),
    (LION, {"cylinders": 10, "order": tuple(range(1, 11))}, r"cylinders = 10: must be a multiple of 3"),
    ("layout = 'W'\nbank_angles_deg = [0, 60]", {}, r"bank_angles_deg = \[0\.0, 60\.0\]: .*three or more"),
    ("layout = 'W'\nbank_angles_deg = [0, 70, 60]", {}, r"bank_angles_deg = .*must begin with 0 and rise"),
    (LION + "bank_angle_deg = 60.0", {}, r"bank_angle_deg = 60\.0: a W has three or more banks"),
    ("bank_angles_deg = [0, 60, 120]", {}, r"bank_angles_deg = .*belongs to layout = 'W'"),
    (LION + "rod_offset_mm = 18.0", {"cylinders": 12, "order": LION_ORDER}, r"rod_offset_mm = 18\.0: .*18"),
    ("layout = 'radial'\nbank_angle_deg = 60.0", {}, r"bank_angle_deg = 60\.0: .*evenly spaced"),
    ("layout = 'radial'\nrod_offset_mm = 5.0", {}, r"rod_offset_mm = 5\.0: only a V or a W"),
    ("layout = 'radial'\nthrow_angles_deg = [0, 120, 240]", {}, r"cylinders = 4: must be a multiple of 3"),
    ("layout = 'radial'\nthrow_angles_deg = [0, 90, 180, 270]", {}, r"leaves one cylinder a row"),
    ("layout = 'radial'", {}, r"firing_order.*cannot be even"),
]  # fmt: skip


@pytest.mark.parametrize(("arrangement", "engine", "message"), REFUSED)
def test_refused(arrangement: str, engine: dict[str, Any], message: str) -> None:
    with pytest.raises(CranktopoError, match=message):
        arranged(arrangement, **engine)


def test_a_rod_is_refused_where_a_master_rod_carries_others() -> None:
    text = (designs_folder() / "mikron-iiic-rod.toml").read_text(encoding="utf-8")
    text = re.sub(r"(?m)^cylinders = 4", "cylinders = 3", text).replace("[1, 3, 4, 2]", "[1, 3, 2]")
    with pytest.raises(CranktopoError, match=r"\[rod\]: is given, but a master rod"):
        parse_scene(text + "\n[engine.arrangement]\nlayout = 'radial'\n")


@pytest.mark.parametrize("scene", [W12, DOUBLE_ROW], ids=["W12", "double row"])
def test_every_web_has_the_cycle_of_all_its_rods(scene: Scene) -> None:
    """What fatigue judges: each web of a W, or throw of a radial, through all angles of its own cycle."""
    history, cycle = load_history(scene, "cycle", KINDS), analyse(scene).cycle
    assert cycle is not None
    assert len(history.labels) == 720 * len(cycle.pins)
    for index, (rods, forces) in enumerate(cycle.pins):
        own = slice(720 * index, 720 * (index + 1))
        assert history.labels[own.start].startswith(rods.name)
        assert history.radial_N[own] == pytest.approx(forces.web_force_N[::4], rel=1e-9)
        assert history.tangential_N[own] == pytest.approx(forces.tangential_force_N[::4], rel=1e-9)


def test_words_of_many_rods() -> None:
    told = " ".join(loads_text(loads_at_speeds(radial(9))[0]).split())
    assert "9 rods on each pin: the torque is that of all; radial" in told
    assert "all on the web that carries most" in told
