"""Safety of every web of a shaft: against the throw alone, and what must not change it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import at_speed, at_worst_speed, engine_of
from cranktopo.engine.histories import LoadHistory, WebLoads
from cranktopo.engine.judged_speeds import speeds_of_range
from cranktopo.numerics.section_shapes import WARPS
from cranktopo.numerics.tetrahedra.rigid_motions import RZ
from cranktopo.tasks.shaft.assembly import SECTIONS, SPLITS, WARP_SPLITS
from cranktopo.tasks.shaft.cycle import CycleForces, cycle_forces, shaft_cycle, throw_states
from cranktopo.tasks.shaft.loaded_throw import ACTING, LOADS, loaded_throw
from cranktopo.tasks.shaft.stage import shaft_effects
from cranktopo.tasks.shaft.web_loads import web_histories
from cranktopo.tasks.shaft_safety.worst_stress import stress_over_cycle
from cranktopo.tasks.throw_fatigue import shaft_stress
from cranktopo.tasks.throw_fatigue.least import Part, least_safeties, web_parts
from cranktopo.tasks.throw_fatigue.needs import load_kinds
from cranktopo.tasks.throw_fatigue.safety_field import field_of_states, safety_field, unit_loads
from cranktopo.tasks.throw_fatigue.shaft_stress import ShaftStress, solve_shaft_stress, worst_throw
from cranktopo.tasks.throw_fatigue.stage import assess_by_methods
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fatigue.text import field_remarks
from cranktopo.tasks.throw_fea.targets import Target
from tests.physics.fea.evaluation_cases import mikron_with
from tests.physics.shaft.test_continuous_shaft import meshed_body

Array = NDArray[np.float64]
COARSE = 2.0
"""Elements of two fillet radii: what is compared is the same mesh."""
SPEEDS_RPM = (900.0, 1500.0, 2100.0)


def test_fields_of_a_throw_are_all_that_strains_it() -> None:
    """Any motion of the sections, any loads: six of twelve motions move the whole body, and are left out."""
    scene = load_scene("car-diesel")
    body = meshed_body(scene, 20.0)
    acting = np.random.default_rng(5).standard_normal(SECTIONS + len(ACTING))
    acting[[3, 4, 5, 9, 10, 11]] /= 50.0
    count = 0
    for part in body.blocks:
        fields, shares = part.straining_fields()
        count += fields.shape[1]
        block = part.block
        moved = block.displacement[:, : len(block.motions)] @ (
            SPLITS[part.span][list(block.motions)] @ acting[:12]
        )
        moved += part.warp_fields @ WARP_SPLITS[part.span][part.warps] @ acting[12:SECTIONS]
        models = block.copies * block.parts
        for column, name in enumerate(part.names, start=block.displacement.shape[1] - len(part.names)):
            number = acting[SECTIONS + ACTING.index(name)] / (1 if name == "centrifugal" else models)
            moved = moved + number * block.displacement[:, column]
        force = body.model.stiffness @ moved
        assert (
            np.abs(body.model.stiffness @ (fields @ (shares @ acting)) - force).max()
            < 1e-6 * np.abs(force).max()
        )
    assert count == 6 + 2 * WARPS + len(LOADS)


@pytest.fixture(scope="module")
def stress() -> ShaftStress:
    return solve_shaft_stress(Target("mikron", mikron_with()), COARSE)


def loads(
    stress: ShaftStress,
    angles: Sequence[float],
    forces: CycleForces,
    spring: float | None,
    rigid_at: Sequence[int] = (),
) -> Array:
    """Factors of the fields of every throw, (throws, states, fields)."""
    throws = [loaded_throw(stress.body.blocks, stress.model.scene)] * len(angles)
    cycle = shaft_cycle(throws, angles, forces, spring, rigid_at=rigid_at)
    states = throw_states(throws, angles, forces, cycle)
    return np.stack([stress.loads(own) for own in states])


def at_speeds(stress: ShaftStress, scene: Scene, spring: float | None = None) -> list[Array]:
    """Factors of the fields of each throw at all speeds, (speeds, states, fields)."""
    found = [
        loads(stress, scene.shaft_angles_deg, cycle_forces(at_speed(scene, rpm)), spring)
        for rpm in SPEEDS_RPM
    ]
    return list(np.stack(found, axis=1))


def by_web(stress: ShaftStress, of_throws: Sequence[Array], method: str = "lsa") -> Array:
    """Least safety of pin and journal fillet of every web at every speed, (webs, 2, speeds)."""
    least = least_safeties(stress.model, of_throws, method)
    parts: tuple[Part, ...] = ("pin_fillet", "journal_fillet")
    return np.array([[one[side, part] for part in parts] for one in least for side in (0, 1)])


@pytest.mark.slow
def test_one_throw_between_two_bearings_is_the_throw_alone(stress: ShaftStress) -> None:
    """The isolated model: equal forces at both sections, which stay plane, and a torque from the pin."""
    scene = stress.model.scene
    forces = cycle_forces(scene)
    alone = CycleForces(
        forces.angle_deg,
        *(getattr(forces, name)[:1] for name in ("radial_N", "tangential_N")),
        *(getattr(forces, name)[:1] for name in ("radial_aside_N_mm", "tangential_aside_N_mm")),
        forces.angular_speed_rad_s,
    )
    labels = tuple(f"{angle:g}" for angle in alone.angle_deg)
    (factors,) = loads(stress, (0.0,), alone, None, rigid_at=(0, 1))
    found = field_of_states(stress.model, "lsa", factors, labels)
    model = solve_stresses(
        Target("mikron", scene), ("bending", "tangential", "torsion", "centrifugal"), COARSE
    )
    across = loaded_throw(stress.body.blocks, scene).loads["tangential"]
    arm_mm = -float(across[RZ] + across[6 + RZ])  # where the mesh has the middle of the pin's material
    assert arm_mm == pytest.approx(scene.throw.radius_mm, rel=1e-3)
    history = LoadHistory(
        alone.radial_N[0],
        alone.tangential_N[0],
        alone.tangential_N[0] * arm_mm / 2000,
        np.full(len(labels), alone.angular_speed_rad_s),
        labels,
    )
    expected = safety_field(model, "lsa", history)
    assert found.critical.safety == pytest.approx(expected.critical.safety, rel=2e-6)
    assert found.critical.place == expected.critical.place
    assert found.critical.states == expected.critical.states
    weak = expected.safety < 5
    assert weak.sum() > 100
    both = found.safety[weak], expected.safety[weak]
    assert np.isclose(*both, rtol=1e-4).mean() > 0.999, "but where two states are worst within the residual"
    assert both[0] == pytest.approx(both[1], rel=1e-2)
    (parts,) = least_safeties(stress.model, [factors[None]], "lsa")
    assert min(float(safety[0]) for safety in parts.values()) == pytest.approx(
        expected.critical.safety, rel=2e-6
    )


@pytest.mark.slow
@pytest.mark.parametrize("method", ["lsa", "fkm"])
def test_only_nodes_that_cannot_be_the_worst_are_left_out(stress: ShaftStress, method: str) -> None:
    """Every part of every web at every speed: as with every node in every state."""
    of_throws = at_speeds(stress, stress.model.scene, 3e5)
    least = least_safeties(stress.model, of_throws, method)
    labels = tuple(map(str, range(of_throws[0].shape[1])))
    for found, own in zip(least, of_throws, strict=True):
        assert len(found) == len(web_parts(stress.model)) == 6
        for number, factors in enumerate(own):
            field = field_of_states(stress.model, method, factors, labels)
            for part in web_parts(stress.model):
                every = field.safety[list(part.images)][:, part.nodes]
                assert found[part.side, part.part][number] == pytest.approx(every.min(), rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("spring", [None, 3e5])
def test_safety_does_not_depend_on_where_the_cycle_begins(stress: ShaftStress, spring: float | None) -> None:
    """Angles counted from elsewhere: the states in another order, and all throws turned by the same angle."""
    scene = stress.model.scene
    forces, angles = cycle_forces(scene), scene.shaft_angles_deg
    later = {
        name: np.roll(getattr(forces, name), -136, axis=1)
        for name in ("radial_N", "tangential_N", "radial_aside_N_mm", "tangential_aside_N_mm")
    }
    one = by_web(stress, list(loads(stress, angles, forces, spring)[:, None]))
    turned = [angle - 137.3 for angle in angles]
    other = by_web(stress, list(loads(stress, turned, replace(forces, **later), spring)[:, None]))
    assert np.abs(one / other - 1).max() < 1e-9


@pytest.mark.slow
def test_a_shaft_seen_from_its_other_end_is_as_safe(stress: ShaftStress) -> None:
    """Throws in the opposite order, on springs; torques that add up to nothing, so that no end holds any."""
    angles = (0.0, 120.0, 250.0)
    rng = np.random.default_rng(2)
    radial, across = rng.normal(0.0, 1.5e4, (2, 3, 90))
    across -= across.mean(axis=0)
    none = np.zeros_like(radial)
    forces = CycleForces(np.arange(90.0), radial, across, 50 * radial, none, 200.0)
    mirrored = replace(
        forces,
        radial_N=radial[::-1],
        tangential_N=across[::-1],
        radial_aside_N_mm=-forces.radial_aside_N_mm[::-1],
    )
    one = by_web(stress, list(loads(stress, angles, forces, 4e5)[:, None]))
    other = by_web(stress, list(loads(stress, angles[::-1], mirrored, 4e5)[:, None]))
    assert np.abs(one / other[::-1] - 1).max() < 1e-9
    assert np.ptp(one[:, 0]) > 0.05 * one[:, 0].min()


@pytest.mark.slow
def test_safety_falls_as_all_forces_grow(stress: ShaftStress) -> None:
    """Linear: twice the forces, centrifugal ones too, half the safety; twice the modulus changes nothing."""
    scene = stress.model.scene
    of_throws = at_speeds(stress, scene)
    once, twice = (by_web(stress, [number * own for own in of_throws]) for number in (1.0, 2.0))
    assert np.abs(2 * twice / once - 1).max() < 1e-9
    material = scene.material.model_copy(update={"E_GPa": 2 * scene.material.E_GPa})
    stiff = solve_shaft_stress(Target("stiff", scene.model_copy(update={"material": material})), COARSE)
    assert np.abs(by_web(stiff, at_speeds(stiff, scene)) / once - 1).max() < 1e-9


@pytest.mark.slow
def test_the_worst_point_has_its_stress_over_the_cycle(stress: ShaftStress) -> None:
    """Extremes as judged; on a surface without traction two normal stresses and a shear make von Mises."""
    scene = stress.model.scene
    of_throws = loads(stress, scene.shaft_angles_deg, cycle_forces(scene), None)
    angle_deg = np.arange(float(len(of_throws[0])))
    labels = tuple(f"{angle:g}" for angle in angle_deg)
    for factors in of_throws:
        found = field_of_states(stress.model, "lsa", factors, labels)
        over = stress_over_cycle(found, factors, angle_deg)
        point, signed = found.critical, np.array(over.signed_von_mises_MPa)
        high, low = point.mean_MPa + point.amplitude_MPa, point.mean_MPa - point.amplitude_MPa
        assert [signed.max(), signed.min()] == pytest.approx([high, low], abs=1e-3)
        assert (labels[signed.argmax()], labels[signed.argmin()]) == point.states
        one, other, shear = map(np.array, (over.along_MPa, over.around_MPa, over.shear_MPa))
        plane = np.sqrt(one**2 + other**2 - one * other + 3 * shear**2)
        assert np.abs(plane - np.abs(signed)).max() < 0.1 * np.abs(signed).max(), "a mesh of two radii"
        assert np.ptp(one) > np.ptp(other), "bending opens and closes the arc of the fillet"


@pytest.mark.slow
def test_fatigue_takes_the_worst_throw_of_the_shaft(
    stress: ShaftStress, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The effect switched on: the least safety of all webs over the range of speeds up to the overspeed.

    At 6000 rpm the masses pull more than the gas pushes. Each speed is judged in every node.
    """
    scene = stress.model.scene
    effects = scene.effects.model_copy(update={"continuous_shaft": "on"})
    assert scene.engine is not None
    engine = scene.engine.model_copy(update={"overspeed_rpm": 6000.0})
    scene = scene.model_copy(update={"effects": effects, "engine": engine})
    told = replace(stress, model=replace(stress.model, scene=scene))
    monkeypatch.setattr(shaft_stress, "solve_shaft_stress", lambda *_: told)
    target = Target("mikron", scene)
    ((found,),) = (one.fields for one in assess_by_methods([target], ("lsa",), fillet_fraction=COARSE))
    least = {}
    for rpm in (2100.0, 6000.0):
        of_throws = loads(stress, scene.shaft_angles_deg, cycle_forces(at_speed(scene, rpm)), None)
        labels = tuple(map(str, range(len(of_throws[0]))))
        fields = [field_of_states(stress.model, "lsa", own, labels) for own in of_throws]
        least[rpm] = min(field.critical.safety for field in fields)
    assert min(least, key=lambda rpm: least[rpm]) == 6000.0
    assert found.critical.safety == pytest.approx(least[6000.0], rel=1e-9)
    assert found.critical.states[0].startswith("throw ")
    assert found.critical.states[0].endswith("deg, 6000 rpm")
    assert field_remarks([found])[-1] == "mikron: the least safety is that at the overspeed of 6000 rpm."
    assert len(found.labels) == 720
    assert found.on_bearings


@pytest.mark.slow
def test_a_throw_alone_with_the_loads_of_a_web_has_its_safety(stress: ShaftStress) -> None:
    """Two ways to the stress of each of eight webs: fields of the shaft, and unit loads of a throw alone.

    From the section beside it to the pin both have the same forces. On the pin itself they are spread
    differently, which its fillet feels a little. Sections of a throw alone stay plane: those of the shaft
    deform, so that its journal fillets have other safeties, and are held here first.
    """
    scene = stress.model.scene
    sections = range(5)
    throws, forces = [loaded_throw(stress.body.blocks, scene)] * 4, cycle_forces(scene)
    cycle = shaft_cycle(throws, scene.shaft_angles_deg, forces, None, rigid_at=sections)
    histories = web_histories(throws, [scene] * 4, forces, cycle)
    plane, deformed = (
        least_safeties(stress.model, [own[None] for own in of_throws], "lsa")
        for rigid_at in (sections, ())
        for of_throws in [loads(stress, scene.shaft_angles_deg, forces, None, rigid_at)]
    )
    alone = solve_stresses(Target("mikron", scene), load_kinds(scene, WebLoads(histories))[1], COARSE)
    within: dict[Part, float] = {"pin_fillet": 0.03, "journal_fillet": 5e-3, "elsewhere": 0.03}
    for number, history in enumerate(histories):
        found = least_safeties(alone, [unit_loads(history, alone.kinds)[None]], "lsa")[0]
        for part, error in within.items():
            own = float(found[0, part][0])
            held, free = (float(one[number // 2][number % 2, part][0]) for one in (plane, deformed))
            assert own == pytest.approx(held, rel=error), (number + 1, part)
            assert own == pytest.approx(free, rel=0.08), (number + 1, part)


@pytest.mark.slow
def test_each_speed_of_a_vibrating_shaft_is_judged_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    """The least safety of all speeds, as `shaft --method` has it; one range over both would be lower."""
    data = mikron_with().model_dump(mode="json", exclude_none=True)
    data["shaft"] = {
        "throw_stiffness_Nm_per_rad": 1.4e5,
        "speed_min_rpm": 2600.0,
        "speed_max_rpm": 2800.0,
        "cylinder_damping_Nms_per_rad": 0.5,
        "propeller": {"inertia_kg_m2": 0.6},
    }
    data["effects"]["torsional_vibration"] = "on"
    data["engine"]["speed_rpm"] = 600.0
    scene = scene_from_dict(data)
    effects = shaft_effects(scene)
    speeds = speeds_of_range(scene, effects)
    assert engine_of(at_worst_speed(scene, effects)).speed_rpm in [engine_of(at).speed_rpm for at in speeds]
    target = Target("mikron", scene)
    stress = solve_shaft_stress(target, COARSE)  # of this scene: a throw that may vibrate has a load more
    monkeypatch.setattr(shaft_stress, "solve_shaft_stress", lambda *_: stress)
    (found,) = worst_throw(target, ("lsa",), COARSE)
    by_speed = [loads(stress, scene.shaft_angles_deg, cycle_forces(at, effects), None) for at in speeds]
    each = list(np.stack(by_speed, axis=1))
    least = [safety.min() for one in least_safeties(stress.model, each, "lsa") for safety in one.values()]
    assert found.critical.safety == pytest.approx(min(least), rel=1e-9)
    joined = [own.reshape(1, -1, own.shape[-1]) for own in each]
    lower = [safety.min() for one in least_safeties(stress.model, joined, "lsa") for safety in one.values()]
    assert min(lower) < 0.97 * min(least)  # 1.164 and 1.207


FACTORS = {"_mm": 2.0, "_kg": 8.0, "_rpm": 0.5}
"""Of an engine twice as large, of the same metal and pressures: the same stress at half the speed."""


def twice_as_large(value: Any, factor: float = 1.0) -> Any:
    """A table with its lengths, masses and speeds in other units."""
    if isinstance(value, dict):
        ends = {key: next((FACTORS[end] for end in FACTORS if key.endswith(end)), factor) for key in value}
        return {key: twice_as_large(one, ends[key]) for key, one in value.items()}
    if isinstance(value, list):
        return [twice_as_large(one, factor) for one in value]
    is_number = isinstance(value, float | int) and not isinstance(value, bool)
    return value * factor if is_number and factor != 1.0 else value


@pytest.mark.slow
def test_scaled_units_give_the_same_stresses(stress: ShaftStress, monkeypatch: pytest.MonkeyPatch) -> None:
    """Every dimension twice as large, masses eight times, half the speed: the same mesh has the same stress.

    Criteria are not asked: the stress gradient of an engine twice as large is half, and its fillets weaker.
    """
    small = stress.model.scene
    data = small.model_dump(mode="json", exclude_none=True, exclude={"published", "fatigue", "drawing"})
    large = scene_from_dict(twice_as_large(data))
    meshed = stress.body.meshed
    off = meshed.mesh.off_surface_mm
    mesh = replace(
        meshed.mesh,
        points_mm=2.0 * meshed.mesh.points_mm,
        off_surface_mm=None if off is None else 2.0 * off,
    )
    monkeypatch.setattr(shaft_stress, "mesh_for_stress", lambda *_: (replace(meshed, mesh=mesh), large))
    scaled = solve_shaft_stress(Target("large", large), COARSE)
    found = []
    for one, scene in ((stress, small), (scaled, large)):
        of_throws = loads(one, scene.shaft_angles_deg, cycle_forces(scene), None)
        labels = tuple(map(str, range(len(of_throws[0]))))
        found.append([field_of_states(one.model, "lsa", own, labels) for own in of_throws])
    for before, after in zip(*found, strict=True):
        largest = before.amplitude_MPa.max()
        assert np.abs(after.amplitude_MPa - before.amplitude_MPa).max() < 1e-9 * largest
        assert np.abs(after.mean_MPa - before.mean_MPa).max() < 1e-9 * largest
