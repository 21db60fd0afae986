"""The shaft with its mass: without mass, integrated in time, beside disks, from elsewhere, its energy."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.base.frames import about_z_deg
from cranktopo.design.misfire import with_misfire
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.vibration.shaft_chain import ShaftChain, shaft_chain
from cranktopo.numerics.section_shapes import WARPS
from cranktopo.numerics.tetrahedra.rigid_motions import RZ, UZ
from cranktopo.numerics.turning_body import TurningBody
from cranktopo.tasks.dynamics.moving_shaft import MovingCycle, MovingShaft, moving_cycle
from cranktopo.tasks.dynamics.resonance import crossings_of
from cranktopo.tasks.modes.reduced_throw import reduced_throw, section_shapes
from cranktopo.tasks.modes.shaft_model import shaft_model
from cranktopo.tasks.modes.stage import STEPS, moving_kg
from cranktopo.tasks.shaft.assembly import SECTIONS, Bearings, shaft_matrix, shaft_stiffness, turned
from cranktopo.tasks.shaft.cycle import CycleForces, load_shares, shaft_cycle
from cranktopo.tasks.shaft.web_sections import web_sections
from tests.physics.dynamics.shafts import body, forces_at, mikron, of_orders, shaft_of, without_mass

Array = NDArray[np.float64]
SPRING = 4e5
STATES = 36
"""Angles of a cycle: harmonics up to 18 are solved, and the forces of a single order need no other."""
PROPELLER = {"inertia_kg_m2": 0.6, "mass_kg": 6.0, "diametral_inertia_kg_m2": 0.31, "overhang_mm": 60.0}


def still(shaft: MovingShaft, forces: CycleForces) -> Array:
    """Forces on both sections of every throw of the shaft without mass."""
    throws = [one.still for one in shaft.throws]
    borne = shaft.borne_by
    tilt = shaft.tilt_Nmm_per_rad
    return shaft_cycle(
        throws, shaft.angles_deg, forces, shaft.spring_N_per_mm, borne, tilt_Nmm_per_rad=tilt
    ).throw_N


def apart(one: Array, other: Array) -> float:
    """Largest difference of forces, then of moments, over the largest of each."""
    one, other = (values.reshape(*values.shape[:-2], -1, 6, values.shape[-1]) for values in (one, other))
    found = [
        np.abs(one[..., kind, :] - other[..., kind, :]).max() / np.abs(other[..., kind, :]).max()
        for kind in (slice(0, 3), slice(3, 6))
    ]
    return float(max(found))


@pytest.mark.parametrize("spring", [None, SPRING])
def test_without_mass_it_is_the_shaft_on_its_bearings(spring: float | None) -> None:
    """Motions, bearing forces and section forces over the whole cycle, whatever the speed."""
    scene = mikron()
    shaft, forces = shaft_of(scene, spring, 0.0), forces_at(scene, 2100.0)
    found = moving_cycle(without_mass(shaft), forces)
    throws = [one.still for one in shaft.throws]
    expected = shaft_cycle(throws, shaft.angles_deg, forces, spring)
    for name in ("motion", "bearing_N", "throw_N"):
        one, other = getattr(found.shaft, name), getattr(expected, name)
        if name == "motion":  # a shaft without mass, free along its axis, is anywhere
            one[UZ::6] -= one[-6 + UZ]
        assert np.abs(one - other).max() < 1e-8 * np.abs(other).max(), name
    assert abs(found.damping_work_J) < 1e-9
    for index, within in enumerate(found.within):
        shares = load_shares(throws[index], forces, index)
        assert np.abs(within[:5] - shares).max() < 1e-8 * np.abs(shares).max()
        moved = within[5:] * np.sqrt(np.diag(shaft.throws[index].damped.body.stiffness))[SECTIONS + 5 :, None]
        assert np.abs(moved).max() < 1e-6 * np.abs(shares[:2]).max()


def test_at_a_low_speed_inertia_does_nothing() -> None:
    """The forces of the engine's own speed, gone through slowly: the difference falls with its square."""
    scene = mikron()
    shaft, forces = shaft_of(scene, None, 0.0), forces_at(scene, 2100.0)
    expected = still(shaft, replace(forces, angular_speed_rad_s=0.0))
    errors = []
    for speed in (2e-2, 2e-3):
        found = moving_cycle(shaft, replace(forces, angular_speed_rad_s=speed)).shaft.throw_N
        errors.append(apart(found, expected))
    assert errors[1] < 1e-8
    assert errors[1] < 0.03 * errors[0]


def in_one_piece(scene: Scene, shaft: MovingShaft) -> tuple[TurningBody, Array, list[Array]]:
    """Matrices of all unknowns, of `modes`; loads (unknowns, throws, loads); motions of the sections."""
    held: Bearings = "rigid" if shaft.spring_N_per_mm is None else "spring"
    model = shaft_model([one.reduced for one in shaft.throws], scene, held, shaft.spring_N_per_mm or 0.0)
    last = np.flatnonzero(model.sections[-1].motion[RZ])
    model = model.held(last.tolist())
    own = len(shaft.throws[0].reduced.step_of)
    sections = len(shaft.throws) + 1
    loads = np.zeros((len(model.step_of), len(shaft.throws), 5))
    body = shaft.throws[0].reduced.body
    columns: dict[str, int] = {}
    for one in shaft.throws[0].reduced.held:
        columns |= dict(zip(one.loads, one.unknowns[len(one.unknowns) - len(one.loads) :], strict=True))
    names = ("radial", "tangential", "radial aside", "tangential aside", "centrifugal")
    inner = own - SECTIONS
    start = len(model.step_of) - inner * len(shaft.throws)
    for throw, angle in enumerate(shaft.angles_deg):
        both = np.vstack([model.sections[throw].motion, model.sections[throw + 1].motion])
        turn = turned(about_z_deg(angle), SECTIONS)
        warps = start + WARPS * (throw - sections) + np.arange(2 * WARPS)
        for place, name in enumerate(names):
            on_sections = turn @ shaft.throws[throw].still.loads[name]
            loads[:, throw, place] += both.T @ on_sections[:12]
            loads[warps, throw, place] += on_sections[12:]
            rows = start + throw * inner + np.arange(inner)
            loads[rows, throw, place] += body.stiffness[SECTIONS:, columns[name]]
    assert sections == len(model.sections)
    return model.body, loads, [one.motion for one in model.sections]


@pytest.mark.parametrize("spring", [None, SPRING])
def test_it_moves_as_when_it_is_integrated_in_time(spring: float | None) -> None:
    """The equations of motion step by step over a cycle that ends as it begins, forces straight in a step.

    Of the whole shaft by the matrices of `modes`; damped by its cylinders alone, as loss has no time.
    """
    scene = mikron(cylinder_damping_Nms_per_rad=2.0, throw_damping_Nms_per_rad=5.0, throw_loss_factor=0.0)
    shaft, states, speed = shaft_of(scene, spring, 0.0), 720, 2500 * np.pi / 30
    forces = of_orders(4, (0, 1, 2, 5, 8, 13), states, speed)
    found = moving_cycle(shaft, forces)
    body, loads, sections = in_one_piece(scene, shaft)
    shares = np.stack([load_shares(one.still, forces, index) for index, one in enumerate(shaft.throws)])
    pushed = np.einsum("ntl,tls->ns", loads, shares)
    every = np.vstack(sections)
    viscous = every.T @ shaft.viscous[: len(every), : len(every)] @ every
    along = loads[:, :, 1]  # of the tangential forces, against which the pistons rub
    viscous += 2.0 * 1000 / scene.throw.radius_mm**2 * along @ along.T
    moved = periodic(body, viscous, pushed, about_z_deg(1.0) * speed, 4 * np.pi / speed / states)
    whole = np.vstack(sections) @ moved
    axial = np.arange(len(whole)) % 6 == UZ
    whole[axial] -= whole[axial][-1:] - found.shaft.motion[axial][-1:]  # nothing holds it along its axis
    assert apart(whole, found.shaft.motion) < 2e-3
    assert found.work_in_J == pytest.approx(found.damping_work_J, rel=1e-6)


def periodic(body: TurningBody, viscous: Array, force: Array, speed: float, step: float) -> Array:
    """Motion that repeats under a force that repeats, by the exact step of forces straight in it."""
    from scipy.linalg import expm

    count = len(body.mass)
    scale = 1 / np.sqrt(np.diag(body.mass))
    body, force = body.over(np.diag(scale)), scale[:, None] * force
    viscous = viscous * np.outer(scale, scale)
    inverse = np.linalg.inv(body.mass)
    held = body.stiffness - speed**2 * (body.lateral - body.stiffening)
    length = step
    state = np.zeros((2 * count, 2 * count))  # displacement and velocity times a time
    state[:count, count:] = np.eye(count) / length
    state[count:, :count] = -length * inverse @ held
    state[count:, count:] = -inverse @ (2 * speed * body.coriolis + viscous)
    enters = np.vstack([np.zeros((count, count)), length * inverse]) @ force
    states = force.shape[1]
    grown = np.zeros((3 * 2 * count,) * 2)
    grown[: 2 * count, : 2 * count] = state * step
    grown[: 2 * count, 2 * count : 4 * count] = np.eye(2 * count) * step
    grown[2 * count : 4 * count, 4 * count :] = np.eye(2 * count)
    through = expm(grown)[: 2 * count]
    free, constant, rising = (through[:, 2 * count * i : 2 * count * (i + 1)] for i in range(3))
    driven = constant @ enters + rising @ (np.roll(enters, -1, axis=1) - enters)

    def over_cycle(at: Array) -> Array:
        found = [at]
        for index in range(states):
            found.append(free @ found[-1] + driven[:, index])
        return np.array(found)

    ends = over_cycle(np.zeros(2 * count))[-1]
    once = np.linalg.matrix_power(free, states)
    begin = np.linalg.lstsq(np.eye(2 * count) - once, ends, rcond=1e-9)[0]
    return scale[:, None] * over_cycle(begin)[:-1, :count].T


def test_what_the_forces_do_is_what_damping_takes() -> None:
    """Force times velocity of each pin over the cycle, a propeller in the air, every kind of damping."""
    damper = {
        "kind": "rubber",
        "ring_inertia_kg_m2": 0.01,
        "hub_inertia_kg_m2": 0.004,
        "stiffness_Nm_per_rad": 2e5,
        "loss_factor": 0.2,
    }
    scene = mikron(
        cylinder_damping_Nms_per_rad=0.5,
        throw_damping_Nms_per_rad=1.0,
        propeller={**PROPELLER, "damping_Nms_per_rad": 20.0, "stiffness_Nm_per_rad": 1e5, "loss_factor": 0.1},
        damper=damper,
    )
    for spring, rpm in ((None, 2800.0), (SPRING, 1000.0)):
        shaft, forces = shaft_of(scene, spring), forces_at(scene, rpm)
        found = moving_cycle(shaft, forces)
        work = worked(shaft, forces, found)
        assert found.work_in_J > 0
        assert work == pytest.approx(found.work_in_J, rel=1e-6)
        assert found.damping_work_J == pytest.approx(found.work_in_J, rel=1e-6)


def worked(shaft: MovingShaft, forces: CycleForces, found: MovingCycle) -> float:
    """Force times velocity of every unit load, summed over the angles of the cycle, J."""
    states, total = forces.angle_deg.size, 0.0
    for index, (one, angle, within) in enumerate(
        zip(shaft.throws, shaft.angles_deg, found.within, strict=True)
    ):
        own = found.shaft.of_throw(index, angle)
        moved = one.loads.T @ np.vstack([own, within])
        shares = load_shares(one.still, forces, index)
        number = np.arange(states // 2 + 1)
        slope = np.fft.irfft(1j * number * np.fft.rfft(moved), n=states)
        total += float((shares * slope).sum() * 2 * np.pi / states) / 1000
    return total


@pytest.mark.parametrize("spring", [None, SPRING])
def test_it_does_not_matter_where_the_cycle_begins(spring: float | None) -> None:
    """Angles counted from elsewhere: the states in another order, all throws turned by the same angle."""
    scene = mikron(flywheel={"inertia_kg_m2": 0.05, "mass_kg": 8.0})
    shaft, forces = shaft_of(scene, spring), forces_at(scene, 2500.0)
    later = {
        name: np.roll(getattr(forces, name), -136, axis=1)
        for name in ("radial_N", "tangential_N", "radial_aside_N_mm", "tangential_aside_N_mm")
    }
    turned_by = replace(shaft, angles_deg=tuple(angle - 137.3 for angle in shaft.angles_deg))
    one = moving_cycle(shaft, forces).shaft.throw_N
    other = moving_cycle(turned_by, replace(forces, **later)).shaft.throw_N
    assert apart(np.roll(one, -136, axis=-1), other) < 1e-9


@pytest.mark.parametrize("spring", [None, SPRING])
def test_a_shaft_seen_from_its_other_end_vibrates_alike(spring: float | None) -> None:
    """Throws numbered from the other end, mirrored; nothing holds either end, torques add up to nothing.

    The mean holds the last section in rotation: the pin of a mesh is not quite round, so that turning with
    the shaft strains it by 1e-4.
    """
    scene = mikron()
    angles = (0.0, 90.0, 250.0, 10.0)
    shaft = replace(shaft_of(scene, spring), angles_deg=angles, turns_freely=True)
    forces = of_orders(4, (0, 1, 3, 8, 21), 720, 250.0)
    across = forces.tangential_N - forces.tangential_N.mean(axis=(0, 1))
    forces = replace(forces, tangential_N=across)
    mirrored = replace(
        forces,
        radial_N=forces.radial_N[::-1],
        tangential_N=forces.tangential_N[::-1],
        radial_aside_N_mm=-forces.radial_aside_N_mm[::-1],
        tangential_aside_N_mm=-forces.tangential_aside_N_mm[::-1],
    )
    one, other = (
        moving_cycle(replace(shaft, angles_deg=order), load).shaft.throw_N
        for order, load in ((angles, forces), (angles[::-1], mirrored))
    )
    image = np.array([1.0, 1.0, -1.0, -1.0, -1.0, 1.0])
    back = (other.reshape(4, 2, 6, -1)[::-1, ::-1] * image[:, None]).reshape(one.shape)
    assert apart(one, back) < 1e-3
    swinging, swung = (curves - curves.mean(axis=-1, keepdims=True) for curves in (one, back))
    assert apart(swinging, swung) < 1e-9


def test_torsion_of_a_shaft_that_does_not_bend_is_that_of_disks() -> None:
    """Journals that cannot tilt, a propeller: torque of each order behind the throws, and at resonance.

    Disks have no inertia between them, and all of it in the planes of the pins.
    """
    scene = mikron(propeller={"inertia_kg_m2": 0.6})
    shaft = replace(shaft_of(scene), tilt_Nmm_per_rad=1e12)
    chain = disks(scene, shaft)
    first = float(chain.chain.natural_frequencies_Hz()[0])
    for order, share, within in ((2, 0.3, 0.01), (5, 0.7, 0.02), (3, 0.9, 0.05)):
        ours, expected = torque_amplitudes(scene, shaft, chain, order, share * first)
        assert np.abs(ours / expected - 1).max() < within, (order, ours, expected)


DAMPED: dict[str, dict[str, Any]] = {
    "friction of cylinders": {"cylinder_damping_Nms_per_rad": 1.0, "propeller": {"inertia_kg_m2": 0.6}},
    "between throws": {"throw_damping_Nms_per_rad": 12.0, "propeller": {"inertia_kg_m2": 0.6}},
    "propeller on a lossy shaft": {
        "propeller": {
            "inertia_kg_m2": 0.05,
            "damping_Nms_per_rad": 10.0,
            "stiffness_Nm_per_rad": 5e4,
            "loss_factor": 0.1,
        }
    },
    "viscous damper": {
        "damper": {
            "kind": "viscous",
            "ring_inertia_kg_m2": 0.02,
            "hub_inertia_kg_m2": 0.004,
            "damping_Nms_per_rad": 5.0,
        },
        "propeller": {"inertia_kg_m2": 0.6},
    },
    "pulley on a lossy shaft": {
        "pulley": {"inertia_kg_m2": 0.01, "stiffness_Nm_per_rad": 3e4, "loss_factor": 0.15},
        "propeller": {"inertia_kg_m2": 0.6},
    },
}


@pytest.mark.parametrize(
    "kind",
    [
        pytest.param(kind, marks=[pytest.mark.slow] * (kind == "pulley on a lossy shaft"))  # as the propeller
        for kind in DAMPED
    ],
)
def test_every_kind_of_damping_is_that_of_disks(kind: str) -> None:
    """The largest torque around the first resonance, where damping alone decides.

    Between throws it is of the mean rotation of both sections, and that of disks of the pins.
    """
    scene = mikron(throw_loss_factor=0.0, **DAMPED[kind])
    shaft = replace(shaft_of(scene, loss_factor=0.0), tilt_Nmm_per_rad=1e12)
    chain = disks(scene, shaft)
    first = chain.chain.damped_modes()[0].frequency_Hz
    found = [torque_amplitudes(scene, shaft, chain, 4, first * at) for at in np.linspace(0.96, 1.04, 33)]
    ours, expected = (np.max(curves, axis=0) for curves in zip(*found, strict=True))
    assert ours == pytest.approx(expected, rel=0.05 if kind == "between throws" else 0.02)
    aside, _ = torque_amplitudes(scene, shaft, chain, 4, 0.5 * first)
    assert ours.max() > 2 * aside.max()


def torque_amplitudes(
    scene: Scene, shaft: MovingShaft, chain: ShaftChain, order: int, frequency_Hz: float
) -> tuple[Array, Array]:
    """Amplitudes of the torque behind the throws by a harmonic of the pin forces, and those of disks."""
    speed = 4 * np.pi * frequency_Hz / order  # a cycle is two turns
    forces = of_orders(4, (order,), STATES, speed)
    found = moving_cycle(shaft, forces).shaft.throw_N[:, 6 + RZ]
    torque = 2 * np.fft.fft(forces.tangential_N)[:, order] / STATES * scene.throw.radius_mm / 1000
    loads = np.zeros((1, len(chain.names)), dtype=complex)
    loads[0, chain.driven] = torque
    frequency = np.array([frequency_Hz * 2 * np.pi])
    twist = chain.chain.response_rad(frequency, loads)
    expected = np.abs(chain.chain.section_torque_Nm(frequency, twist)[0])[chain.behind]
    return 2 * np.abs(np.fft.fft(found)[:, order]) / STATES / 1000, expected


def disks(scene: Scene, shaft: MovingShaft) -> ShaftChain:
    """The chain of the same throws, as stiff as they are in such bearings."""
    whole = shaft_matrix(shaft.throws[0].still.stiffness, [about_z_deg(one) for one in shaft.angles_deg])
    motions = slice(6 * len(shaft.throws) + 6)
    warps = slice(motions.stop, None)
    led = np.linalg.solve(whole[warps, warps], whole[warps, motions])
    matrix = whole[motions, motions] - whole[motions, warps] @ led
    stiffness = shaft_stiffness(matrix, "rigid", tilt_Nmm_per_rad=shaft.tilt_Nmm_per_rad)
    return shaft_chain(scene, throw_balance(scene).inertia_kg_mm2, stiffness.throws_Nm_per_rad)


def bending_ranges(scene: Scene, shaft: MovingShaft, rpm: float) -> Array:
    """Range of the bending moment in every web with mass over that without it."""
    forces = forces_at(scene, rpm)
    throws = [one.still for one in shaft.throws]
    both = moving_cycle(shaft, forces).shaft, shaft_cycle(throws, shaft.angles_deg, forces, None)
    moved, still = (web_sections(cycle, [scene] * 4).range_of("bending_Nm") for cycle in both)
    return np.asarray(moved / still)


def test_motion_along_the_axis_decides_where_the_shaft_bends_most() -> None:
    """Order 6 meets the first mode in the plane, of a flywheel of 20 kg, if the shaft moves along its axis.

    Held along its axis at every main journal it has no such mode there. `modes`, whose sections deform in
    more ways, has it at the same speed.
    """
    scene = mikron(flywheel={"inertia_kg_m2": 0.2, "mass_kg": 20.0})
    free = shaft_of(scene)
    number = np.arange(len(free.viscous))
    along = (number % 6 == UZ) & (number < 6 * len(free.throws) + 6)
    held = replace(free, viscous=free.viscous + 1e9 * np.diag(along.astype(float)))
    of_modes = reduced_throw(body(), scene, section_shapes(scene), STEPS, moving_kg(scene))
    crossing, same = (
        next(one for one in crossings_of(throws, scene, "rigid", 0.0, (2200.0, 2400.0)) if one.order == 6.0)
        for throws in ([one.reduced for one in free.throws], [of_modes] * len(free.throws))
    )
    assert crossing.kind.startswith("bending")
    assert crossing.speed_rpm == pytest.approx(same.speed_rpm, rel=2e-3)
    speeds = crossing.speed_rpm * np.linspace(0.99, 1.01, 9)
    one, other = (
        np.array([bending_ranges(scene, shaft, rpm).max() for rpm in speeds]) for shaft in (free, held)
    )
    assert speeds[int(one.argmax())] == pytest.approx(crossing.speed_rpm, rel=3e-3)
    assert one.max() > 4.0
    assert other.max() < 1.9


def test_a_misfire_meets_a_mode_that_all_cylinders_pass_by() -> None:
    """Torques of order 1 cancel while all four fire; one that does not leaves it, at the mode of a coupling.

    Without mass the shaft feels nothing of it: all cylinders still push as much.
    """
    scene = mikron(
        coupling={"inertia_kg_m2": 0.005, "stiffness_Nm_per_rad": 1500.0, "loss_factor": 0.1},
        driven={"inertia_kg_m2": 0.3},
    )
    shaft = shaft_of(scene)
    met = crossings_of([one.reduced for one in shaft.throws], scene, "rigid", 0.0, (2900.0, 3200.0))
    (crossing,) = (one for one in met if one.order == 1.0)
    assert crossing.kind == "torsion"
    healthy, dead = (torques(one, shaft, crossing.speed_rpm) for one in (scene, with_misfire(scene, (2,))))
    assert healthy[0] < healthy[1]
    assert dead[0] > 2.5 * dead[1]
    assert dead[1] == pytest.approx(healthy[1], rel=0.02)


def torques(scene: Scene, shaft: MovingShaft, rpm: float) -> tuple[float, float]:
    """Largest range of the torque in a web with mass and without it."""
    forces = forces_at(scene, rpm)
    throws = [one.still for one in shaft.throws]
    both = moving_cycle(shaft, forces).shaft, shaft_cycle(throws, shaft.angles_deg, forces, None)
    moved, still = (float(web_sections(cycle, [scene] * 4).range_of("torque_Nm").max()) for cycle in both)
    return moved, still
