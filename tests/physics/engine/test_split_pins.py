"""Split pins of a V: firing, loads of both webs, balance; against sums over directions and published V6."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.assumed import LOADS, assumptions
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.balance.crank import drawn_crank_mass
from cranktopo.engine.balance.free_forces import (
    counterweights,
    free_forces,
    inner_moment,
    oscillating_force,
    rotating_force,
    turning_masses,
)
from cranktopo.engine.balance.throw import _half_product, splayed_mass, throw_balance
from cranktopo.engine.balance.whole_engine import main_bearings
from cranktopo.engine.continuous_beam import _pin_loads, span_bending
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.histories import load_history
from cranktopo.engine.vibration.torque_harmonics import curve_of, torque_harmonics
from cranktopo.tasks.balance.proposal import propose_counterweight
from tests.engine_arrangements import arranged

KINDS = frozenset({"bending", "torsion", "tangential"}) | INERTIA_EFFECTS
RADIUS, ROD, PITCH = 48.0, 166.0, 114.0


def vee(bank: float, splay: float, more: str = "rod_offset_mm = 20.0") -> Scene:
    text = f"layout = 'V'\nbank_angle_deg = {bank}\npin_splay_deg = {splay}\n{more}"
    return arranged(text, 6, (1, 4, 3, 6, 2, 5))


def twin(splay: float) -> Scene:
    text = "layout = 'V'\nbank_angle_deg = 80.0\nthrow_angles_deg = [0.0]\nrod_offset_mm = 22.0\n"
    return arranged(text + f"pin_splay_deg = {splay}", 2, (1, 2))


@pytest.mark.parametrize(("bank", "splay"), [(90.0, -30.0), (60.0, -60.0)])
def test_a_v6_fires_evenly(bank: float, splay: float) -> None:
    """Published splays of even V6: 30 deg with banks of 90 deg, 60 deg with 60 deg."""
    engine = vee(bank, splay).engine
    assert engine is not None
    assert np.diff(sorted(engine.firing_angles_deg)) == pytest.approx(120.0)
    assert engine.throw_angles_deg == pytest.approx((0.0, 240.0, 120.0))
    for cylinder, fire in enumerate(engine.firing_angles_deg, start=1):
        pin = engine.throw_angles_deg[(cylinder - 1) % 3] + (-splay / 2 if cylinder < 4 else splay / 2)
        axis = 0.0 if cylinder < 4 else bank
        at = fire + pin - axis - (-splay / 2)  # angles count from the pin of cylinder 1
        assert (at + 180) % 360 - 180 == pytest.approx(0, abs=1e-9)


@pytest.mark.parametrize(
    ("bank", "splay", "with_crank", "against"), [(90.0, -30.0, 15.0, 105.0), (60.0, -60.0, 30.0, 90.0)]
)
def test_published_balance_of_a_v6(bank: float, splay: float, with_crank: float, against: float) -> None:
    """No free force; a moment of order 1 that counterweights balance at 60 deg, and a shaft must at 90 deg.

    The two pistons of a throw give |1 + exp(i (b - 120 deg))| / 2 with the crank and
    |1 + exp(i (b + 120 deg))| / 2 against it, and three throws sqrt 3 times their distance.
    """
    masses = turning_masses(vee(bank, splay, "rod_offset_mm = 1e-9"))
    one = masses.piston_kg_mm * masses.w2 / 1000
    first = oscillating_force(masses, 1)
    assert first.force.largest == pytest.approx(0, abs=1e-9 * one)
    parts = abs(first.moment.forward), abs(first.moment.backward)
    arm = math.sqrt(3) * PITCH / 1000 * one
    expected = [arm * abs(math.cos(math.radians(angle))) for angle in (with_crank, against)]
    assert parts == pytest.approx(expected, abs=1e-9 * arm)
    assert oscillating_force(masses, 2).force.largest == pytest.approx(0, abs=1e-9 * one)


def test_against_the_inertia_of_all_masses() -> None:
    """Halves of the throws, rods and pistons in their own places, accelerated by Fourier series."""
    scene = vee(70.0, -25.0, "rod_offset_mm = 20.0\nthrow_angles_deg = [0, 250, 130]")
    engine, masses = scene.engine, turning_masses(scene)
    assert engine is not None
    turn = np.linspace(0, 2 * np.pi, 512, endpoint=False)
    orders = np.fft.fftfreq(512, 1 / 512)
    half_kg = throw_balance(scene).throw_unbalance_kg_mm / 2 / RADIUS
    half_z = half_place_mm(scene)
    throws, splay = np.radians([0, 250, 130]), math.radians(-25.0)
    first = math.radians(-35.0) + splay / 2
    force, moment = np.zeros(512, complex), np.zeros(512, complex)

    def add(kg: float, place: np.ndarray, z: float) -> None:
        nonlocal force, moment
        pull = kg * orders**2 * np.fft.fft(place) / 512 * masses.w2 / 1000
        force, moment = force + pull, moment + pull * z / 1000

    for k, angle in enumerate(throws):
        for side, bank in ((-1, -35.0), (1, 35.0)):
            axis, z = np.exp(1j * math.radians(bank)), (k - 1) * PITCH
            pin = RADIUS * np.exp(1j * (turn + first + angle + side * splay / 2))
            add(half_kg, pin, z + side * half_z)
            add(engine.rod_rotating_kg, pin, z + side * 10.0)
            seen = pin / axis
            piston = (seen.real + np.sqrt(ROD**2 - seen.imag**2)) * axis
            add(engine.reciprocating_kg, piston, z + side * 10.0)
    scale = masses.piston_kg_mm * masses.w2 / 1000
    for free in free_forces(masses):
        for vector, spectrum in ((free.force, force), (free.moment, moment)):
            assert abs(vector.forward - spectrum[free.order]) < 1e-9 * scale
            assert abs(vector.backward - spectrum[-free.order]) < 1e-9 * scale


def half_place_mm(scene: Scene) -> float:
    """Distance of what is unbalanced of a half throw from the middle of the pin."""
    return _half_product(scene).real / (throw_balance(scene).throw_unbalance_kg_mm / 2)


@pytest.mark.parametrize("splay", [-30.0, 40.0])
def test_each_web_carries_the_reaction_of_its_bearing(splay: float) -> None:
    """Bearings from directions and places of rods and halves in space; webs along their own half pins."""
    scene = twin(splay)
    cycle = analyse(scene).cycle
    assert cycle is not None
    loads = main_bearings(scene, turning_masses(scene)).load_N
    sizes = []
    for (_, forces), load in zip(cycle.pins, loads, strict=True):
        assert forces.main_journal_force_N == pytest.approx(np.abs(load), rel=1e-9)
        sizes.append(forces.web_force_N.max())
    assert sizes[0] != pytest.approx(sizes[1], rel=1e-3)


def test_the_shaft_as_a_beam_has_both_rods_in_their_directions() -> None:
    """Both forces on a pin, in the axes of its throw: those of both bearings, less what the throw pulls."""
    scene = twin(-30.0)
    masses, loads = turning_masses(scene), _pin_loads(scene)
    bearings = main_bearings(scene, masses)
    crank = np.exp(1j * np.radians(masses.layout.throw_deg[0] + bearings.angle_deg))
    along = (bearings.load_N.sum(axis=0) / crank)[:: bearings.angle_deg.size // loads.force_N.shape[1]]
    own = splayed_mass(scene).throw * masses.w2 / 1000
    assert loads.turning_N[0, 0] == pytest.approx(1j * own.real, rel=1e-12)
    outward_and_ahead = loads.force_N[0].imag + 1j * loads.force_N[0].real
    assert outward_and_ahead == pytest.approx(along - own, rel=1e-9, abs=1e-6)


def test_torque_along_the_shaft_by_orders() -> None:
    scene = vee(90.0, -30.0)
    cycle, harmonics = analyse(scene).cycle, torque_harmonics(scene)
    assert cycle is not None
    assert harmonics is not None
    found = cycle.torque.passed_on_Nm
    by_orders = np.cumsum(curve_of(harmonics.of_throws_Nm(2100.0).T, found.shape[1]), axis=0)
    assert found == pytest.approx(by_orders, abs=0.1)
    for index, (_, forces) in enumerate(cycle.pins):  # the torque of a throw is that of both its rods
        own = np.diff(np.vstack([np.zeros(found.shape[1]), found]), axis=0)[index // 2]
        assert forces.torque_Nm.mean() == pytest.approx(own.mean(), rel=1e-9)


def test_a_small_splay_is_nearly_none() -> None:
    """Loads, balance, bending of the shaft and load states go over into those of the straight pin."""
    tiny, straight = (twin(splay) for splay in (1e-6, 0.0))
    for of in (
        lambda scene: analyse(scene).cycle.pins[1][1].web_force_N,
        lambda scene: analyse(scene).cycle.pins[0][1].main_journal_force_N,
        lambda scene: load_history(scene, "cycle", KINDS).tangential_N,
        lambda scene: [w.unbalance_kg_mm for w in counterweights(turning_masses(scene))],
        lambda scene: inner_moment(turning_masses(scene)).moment_Nm,
        lambda scene: span_bending(scene).largest,
        lambda scene: drawn_crank_mass(scene).unbalance_kg_mm,
    ):
        assert of(tiny) == pytest.approx(of(straight), rel=1e-6, abs=1e-3)


def test_counterweights_of_a_splayed_throw_are_opposite_its_half_pins() -> None:
    """They leave nothing of what turns, neither force nor moment, and lie in their own half's plane."""
    masses = turning_masses(vee(90.0, -30.0))
    left = rotating_force(masses, counterweighted=True)
    scale = abs(masses.throw_kg_mm) * masses.w2 / 1000
    assert left.force.largest == pytest.approx(0, abs=1e-9 * scale)
    assert left.moment.largest == pytest.approx(0, abs=1e-9 * scale)
    first, second = counterweights(masses)[:2]
    assert (first.deg + second.deg) / 2 == pytest.approx(180.0, abs=1e-9)
    assert 0 < first.deg - 180.0 < 15.0  # between the middle of the throw and its own half pin


def test_without_offset_or_in_another_layout_it_is_refused() -> None:
    with pytest.raises(CranktopoError, match=r"rod_offset_mm = 0\.0: must be > 0 mm with split pins"):
        vee(90.0, -30.0, "rod_offset_mm = 0.0")
    with pytest.raises(CranktopoError, match=r"pin_splay_deg = 30\.0: only a V has split pins"):
        arranged("pin_splay_deg = 30.0")
    with pytest.raises(CranktopoError, match=r"pin_splay_deg = 91\.0: must be"):
        vee(90.0, 91.0)
    with pytest.raises(CranktopoError, match=r"pins? \(engine\.arrangement\.pin_splay_deg\)") as error:
        vee(90.0, -20.0)
    assert "cannot be even" in str(error.value)


def test_what_is_left_out_is_told_and_bodies_are_refused() -> None:
    scene = vee(90.0, -30.0)
    overlap = 2 * RADIUS * math.sin(math.radians(15.0))
    overlap = scene.throw.crankpin.outer_diameter_mm - overlap
    told = [str(one) for one in assumptions(scene, (LOADS,))]
    key = "engine.arrangement.pin_splay_deg"
    assert f"{key} = -30 (half pins overlap by {overlap:.4g} mm; a web between them is left out)" in told
    with pytest.raises(CranktopoError, match=r"pin_splay_deg = -30\.0: split pins are not modelled here"):
        mesh_throw(scene, 10.0)
    with pytest.raises(CranktopoError, match=r"--propose sizes .* of a throw with a straight pin"):
        propose_counterweight(scene, 50.0)
