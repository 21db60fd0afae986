"""A shaft whose disks vibrate: journals carry the torque of the disks, the mass of throws takes the rest."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from cranktopo.base.units import NMM_PER_NM
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.forces import ShaftTorque
from cranktopo.engine.histories import LoadHistory, throw_histories
from cranktopo.engine.vibration.shaft_chain import moving_inertia_kg_mm2
from cranktopo.engine.vibration.vibrating_shaft import vibrating_torque
from cranktopo.numerics.tetrahedra.elasticity import swing_force
from cranktopo.numerics.tetrahedra.rigid_motions import RZ, UX
from cranktopo.tasks.shaft.cycle import CycleForces, ShaftCycle, cycle_forces, shaft_cycle, throw_states
from cranktopo.tasks.shaft.loaded_throw import LoadedThrow, ThrowBody, loaded_throw, throw_body
from cranktopo.tasks.shaft.web_loads import web_histories
from cranktopo.tasks.shaft.web_sections import web_sections
from cranktopo.tasks.throw_fatigue.safety_field import field_of_states, safety_field
from cranktopo.tasks.throw_fatigue.shaft_stress import solve_shaft_stress
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.unit_fields import FieldKind
from tests.fast_twin import fast_twin
from tests.physics.engine.test_judged_torque import VIBRATING

EVERY = VIBRATING | {"bending", "torsion", "tangential", "centrifugal"}


@pytest.fixture(scope="module")
def scene() -> Scene:
    return fast_twin()


@pytest.fixture(scope="module")
def body(scene: Scene) -> ThrowBody:
    return throw_body(mesh_throw(scene, 12.0), scene)


@pytest.fixture(scope="module")
def throw(body: ThrowBody, scene: Scene) -> LoadedThrow:
    return loaded_throw(body.blocks, scene)


@pytest.fixture(scope="module")
def forces(scene: Scene) -> CycleForces:
    return cycle_forces(scene, VIBRATING)


@pytest.fixture(scope="module")
def cycle(throw: LoadedThrow, scene: Scene, forces: CycleForces) -> ShaftCycle:
    angles = scene.shaft_angles_deg
    return shaft_cycle([throw] * len(angles), angles, forces, None)


def of_disks(scene: Scene, forces: CycleForces) -> ShaftTorque:
    """Torques of the disks at the angles of the forces, (throws, states)."""
    found, cycle_deg = vibrating_torque(scene, VIBRATING), scene.engine.cycle_deg  # type: ignore[union-attr]

    def at(curves: np.ndarray) -> np.ndarray:
        return np.array([np.interp(forces.angle_deg, found.angle_deg, c, period=cycle_deg) for c in curves])

    assert found.ahead_Nm is not None
    return ShaftTorque(forces.angle_deg, at(found.passed_on_Nm), at(found.ahead_Nm))


def test_every_throw_is_in_equilibrium(
    scene: Scene, throw: LoadedThrow, forces: CycleForces, cycle: ShaftCycle
) -> None:
    """What comes from ahead, from the pin and from the inertia of the disk is what goes on behind."""
    assert forces.swing is not None
    disks = of_disks(scene, forces)
    assert disks.ahead_Nm is not None
    arm = throw.loads["tangential"][[RZ, 6 + RZ]].sum()  # where the mesh has the middle of the pin
    pin = -arm * (forces.tangential_N + forces.swing.pin_N) / NMM_PER_NM
    turned = -cycle.throw_N[:, [RZ, 6 + RZ]] / NMM_PER_NM  # in the sense of rotation
    size = np.abs(turned).max()
    left = turned.sum(axis=1) + pin + forces.swing.throw_Nm
    assert np.abs(left).max() < 1e-9 * size
    radius_m = scene.throw.radius_mm / 1000
    inertia = forces.swing.throw_Nm + forces.swing.pin_N * radius_m
    own = forces.tangential_N * radius_m
    assert np.abs(disks.passed_on_Nm - disks.ahead_Nm - own - inertia).max() < 1e-9 * size
    moving, own_inertia = moving_inertia_kg_mm2(scene), throw_balance(scene).inertia_kg_mm2
    rods = forces.swing.pin_N * radius_m / inertia
    assert rods == pytest.approx(moving / (moving + own_inertia), rel=1e-9)


def test_both_journals_carry_the_torque_of_the_disks(
    scene: Scene, forces: CycleForces, cycle: ShaftCycle
) -> None:
    """Not that of the pin: what the mass takes up lies between, and the middle of a web has half of it."""
    disks = of_disks(scene, forces)
    assert disks.ahead_Nm is not None
    sections = web_sections(cycle, [scene] * len(disks.passed_on_Nm), forces.swing)
    both = np.stack([disks.ahead_Nm, disks.passed_on_Nm], axis=1)
    assert np.abs(sections.journal_torque_Nm) == pytest.approx(np.abs(both), abs=3e-3 * np.abs(both).max())
    journal, web = np.ptp(sections.journal_torque_Nm, axis=2), np.ptp(sections.torque_Nm, axis=2)
    assert np.abs(journal - web).max() > 0.4 * web.max(), "much of it at this speed"
    assert forces.swing is not None
    step = np.abs(sections.torque_Nm - sections.journal_torque_Nm)
    assert step == pytest.approx(np.abs(forces.swing.throw_Nm)[:, None].repeat(2, 1) / 4, abs=1e-9)


def test_a_throw_alone_has_at_its_ends_the_torque_of_the_disks(scene: Scene, forces: CycleForces) -> None:
    disks = of_disks(scene, forces)
    assert disks.ahead_Nm is not None
    webs = throw_histories(scene, EVERY)  # of the only throw: the rods are nearer to one of its webs each
    pin_N = np.mean([one.tangential_N for one in webs], axis=0)
    for one in webs:
        assert one.swing_Nm is not None
        half = (pin_N * scene.throw.radius_mm / NMM_PER_NM + one.swing_Nm) / 2
        for end, expected in (
            (one.torque_Nm - half, disks.ahead_Nm),
            (one.torque_Nm + half, disks.passed_on_Nm),
        ):
            assert np.ptp(end) == pytest.approx(np.ptp(expected), rel=2e-3)
    still = throw_histories(scene, EVERY - {"torsional_vibration"})
    assert all(one.swing_Nm is None for one in still)


def test_webs_of_a_swinging_shaft_have_their_section_beside_them(
    throw: LoadedThrow, scene: Scene, forces: CycleForces, cycle: ShaftCycle
) -> None:
    """A throw alone with these loads has on its near section the torque of the shaft's."""
    throws = [scene] * len(cycle.throw_N)
    webs = web_histories([throw] * len(throws), throws, forces, cycle)
    for number, web in enumerate(webs):
        end = cycle.throw_N[number // 2, 6 * (number % 2) + RZ] / NMM_PER_NM
        own = web.tangential_N * scene.throw.radius_mm / NMM_PER_NM + web.own_swing_Nm
        assert own / 2 - web.torque_Nm == pytest.approx(end, abs=1e-9 * np.abs(end).max())


def test_the_mass_pushes_by_its_distance_from_the_axis(
    body: ThrowBody, throw: LoadedThrow, scene: Scene
) -> None:
    """Against inertia and unbalance of the body: torque 1 N mm, and the force of its centre of mass."""
    force, nodes = swing_force(body.model).reshape(-1, 3).T, body.model.nodes_mm
    assert nodes[0] @ force[1] - nodes[1] @ force[0] == pytest.approx(-1.0, rel=1e-12)
    assert throw.loads["swing"][[RZ, 6 + RZ]].sum() == pytest.approx(-1.0, rel=1e-9)
    balance = throw_balance(scene)
    across = throw.loads["swing"][[UX, 6 + UX]].sum()
    expected = balance.throw_unbalance_kg_mm / balance.inertia_kg_mm2
    assert across == pytest.approx(expected, rel=0.03)


@pytest.mark.slow
def test_one_swinging_throw_between_two_bearings_is_the_throw_alone(
    scene: Scene, forces: CycleForces
) -> None:
    """Two ways to the same stress; with the torque of the pin at both journals it would be another one."""
    stress = solve_shaft_stress(Target("twin", scene), 2.0)
    throw = loaded_throw(stress.body.blocks, scene)
    none = np.zeros_like(forces.radial_N)
    middle = replace(forces, radial_aside_N_mm=none, tangential_aside_N_mm=none)
    cycle = shaft_cycle([throw], (0.0,), middle, None, rigid_at=(0, 1))  # as the sections of a throw alone
    states = throw_states([throw], (0.0,), middle, cycle)
    labels = tuple(f"{angle:g}" for angle in forces.angle_deg)
    found = field_of_states(stress.model, "lsa", stress.loads(states[0]), labels)
    swing = forces.swing
    assert swing is not None
    arm_mm = -float(throw.loads["tangential"][[RZ, 6 + RZ]].sum())
    across, mass = forces.tangential_N[0] + swing.pin_N[0], swing.throw_Nm[0]
    own = arm_mm * across / NMM_PER_NM + mass
    speed = np.full(len(labels), forces.angular_speed_rad_s)
    history = LoadHistory(forces.radial_N[0], across, swing.ahead_Nm + own / 2, speed, labels, swing_Nm=mass)
    kinds: tuple[FieldKind, ...] = ("bending", "tangential", "swing", "torsion", "centrifugal")
    model = solve_stresses(Target("twin", scene), kinds, 2.0)
    alone = safety_field(model, "lsa", history)
    assert found.fillet_safety == pytest.approx(alone.fillet_safety, rel=1e-5)
    at_pin = safety_field(model, "lsa", replace(history, swing_Nm=None))
    assert abs(at_pin.fillet_safety["journal"] / alone.fillet_safety["journal"] - 1) > 0.005
