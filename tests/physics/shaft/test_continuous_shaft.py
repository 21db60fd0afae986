"""The shaft on all its bearings: against frames of beams in one piece, and the three-moment equation."""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, mesh_throw
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.free_forces import turning_masses
from cranktopo.engine.balance.throw import product_of_inertia_kg_mm2, throw_balance
from cranktopo.engine.balance.whole_engine import engine_balance, main_bearings
from cranktopo.engine.continuous_beam import PinLoads, Spans, bend_spans, span_bending
from cranktopo.numerics.roller_laminae import RollerSet, reference_life_turns
from cranktopo.numerics.tetrahedra.elasticity import mean_displacement
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, RZ, UX, UY, UZ
from cranktopo.tasks.balance.result import balance_result
from cranktopo.tasks.film.stage import oil_films
from cranktopo.tasks.shaft.assembly import SECTIONS, Bearings, shaft_matrix, shaft_stiffness
from cranktopo.tasks.shaft.continuous import (
    _AtSpeed,
    _loaded_big_end,
    _of_throw,
    _with_films,
    continuous_shaft,
)
from cranktopo.tasks.shaft.cycle import (
    CycleForces,
    ShaftCycle,
    bent_into_bearings_N_per_mm,
    cycle_forces,
    loads_on_bearings_N,
    pin_tilts,
    shaft_cycle,
)
from cranktopo.tasks.shaft.loaded_throw import (
    ACTING,
    LoadedBlock,
    LoadedThrow,
    ThrowBody,
    loaded_throw,
    throw_body,
)
from cranktopo.tasks.shaft.on_film import carried_cycle
from cranktopo.tasks.shaft.result import ContinuousShaft, ShaftBearing, ShaftBigEnds
from cranktopo.tasks.shaft.web_sections import web_sections, write_web_sections
from cranktopo.tasks.throw_fea.condense import loaded_mm
from tests.engine_arrangements import VEE, arranged
from tests.physics.shaft.test_evaluation_chain import CRANK_MM, SPRING_N_PER_MM, beam, polygon

Array = NDArray[np.float64]
PIN_MM = (6.0, 48.0, 41.0)
"""Where the pin of the beam crank carries its load, beside the middle of the throw."""
WITH_PIN_MM = [*CRANK_MM[:3], PIN_MM, *CRANK_MM[3:]]
TILT_NMM_PER_RAD = 5e7
"""Of a bearing: as much as a span resists by itself."""
MOTIONS = {"radial": (UY, -1.0), "tangential": (UX, 1.0)}


def assembled(points: Array) -> Array:
    """Stiffness of beams along a polygon, none of them condensed."""
    total = np.zeros((6 * len(points),) * 2)
    for i, (start, end) in enumerate(pairwise(points)):
        total[6 * i : 6 * i + 12, 6 * i : 6 * i + 12] += beam(start, end)
    return total


def beam_throw(points_mm: list[tuple[float, float, float]], pin: int) -> LoadedThrow:
    """A throw of beams condensed to its ends, its pin force by plain elimination."""
    total = assembled(np.array(points_mm, dtype=float))
    ends = [*range(6), *range(len(total) - 6, len(total))]
    rest = np.setdiff1d(np.arange(len(total)), ends)
    inner = np.linalg.solve(total[np.ix_(rest, rest)], total[np.ix_(rest, ends)])
    loads, tilts = {}, np.searchsorted(rest, [6 * pin + RX, 6 * pin + RY])
    pin_tilt = np.hstack([-inner[tilts], np.zeros((2, len(ACTING)))])
    for column, (name, (motion, sign)) in enumerate(MOTIONS.items(), start=12):
        force = np.zeros(len(total))
        force[6 * pin + motion] = sign
        loads[name] = force[ends] - inner.T @ force[rest]
        pin_tilt[:, column] = np.linalg.solve(total[np.ix_(rest, rest)], force[rest])[tilts]
    for name in ("radial aside", "tangential aside", "centrifugal"):
        loads[name] = np.zeros(12)
    stiffness = total[np.ix_(ends, ends)] - total[np.ix_(ends, rest)] @ inner
    return LoadedThrow(stiffness, loads, 1.0, pin_tilt)


def random_forces(throws: int, states: int = 7) -> CycleForces:
    """Forces on the pins that nothing relates."""
    radial, tangential = np.random.default_rng(3).normal(0.0, 1e4, (2, throws, states))
    none = np.zeros((throws, states))
    return CycleForces(np.arange(states, dtype=float), radial, tangential, none, none, 0.0)


def in_one_piece(
    angles_deg: tuple[float, ...], forces: CycleForces, spring: float | None, tilt: float = 0.0
) -> tuple[Array, list[int], list[int]]:
    """Motions of all points of the shaft as one frame, and which of them are its sections and its pins."""
    points, _ = polygon(tuple(-a for a in angles_deg))
    corners = len(CRANK_MM) - 1
    along = [points[0]]
    pins, sections = [], [0]
    for index, angle in enumerate(np.radians([-a for a in angles_deg])):
        c, s = np.cos(angle), np.sin(angle)
        pin = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]]) @ PIN_MM + [0, 0, 80.0 * index]
        first = corners * index + 1
        pins.append(len(along) + 2)
        along += [points[first], points[first + 1], pin, *points[first + 2 : first + corners]]
        sections.append(len(along) - 1)
    total = assembled(np.array(along))
    load = np.zeros((len(total), forces.angle_deg.size))
    for index, (at, angle) in enumerate(zip(pins, np.radians([-a for a in angles_deg]), strict=True)):
        c, s = np.cos(angle), np.sin(angle)
        x, y = forces.tangential_N[index], -forces.radial_N[index]
        load[6 * at + UX], load[6 * at + UY] = c * x - s * y, s * x + c * y
    held = {6 * sections[-1] + RZ, 6 * sections[-1] + UZ}
    for at in sections:
        for motion in (RX, RY):
            total[6 * at + motion, 6 * at + motion] += tilt
        for motion in (UX, UY):
            if spring is None:
                held.add(6 * at + motion)
            else:
                total[6 * at + motion, 6 * at + motion] += spring
    free = [i for i in range(len(total)) if i not in held]
    motion = np.zeros_like(load)
    motion[free] = np.linalg.solve(total[np.ix_(free, free)], load[free])
    return motion, sections, pins


@pytest.mark.parametrize("tilt", [0.0, TILT_NMM_PER_RAD])
@pytest.mark.parametrize("spring", [None, SPRING_N_PER_MM])
@pytest.mark.parametrize("angles_deg", [(0.0,), (0.0, 180.0, 180.0, 0.0), (0.0, 120.0, 250.0)])
def test_condensed_throws_move_as_one_frame_of_beams(
    angles_deg: tuple[float, ...], spring: float | None, tilt: float
) -> None:
    """Lopsided cranks with forces beside the middle of their pins, every section, all six motions."""
    throw = beam_throw(WITH_PIN_MM, 3)
    forces = random_forces(len(angles_deg))
    found = shaft_cycle([throw] * len(angles_deg), angles_deg, forces, spring, tilt_Nmm_per_rad=tilt)
    motion, sections, pins = in_one_piece(angles_deg, forces, spring, tilt)
    whole = np.concatenate([motion[6 * at : 6 * at + 6] for at in sections])
    assert np.abs(found.motion - whole).max() < 1e-8 * np.abs(whole).max()
    turned = [motion[[6 * at + RX, 6 * at + RY]] for at in pins]
    leads = [1j * about_y - about_x for about_x, about_y in turned]  # of the places along z, y + i x
    turn = np.exp(-1j * np.radians(angles_deg))[:, None]  # into the axes of each throw
    tilts = pin_tilts([throw] * len(angles_deg), angles_deg, forces, found)
    assert np.abs(tilts - turn * leads).max() < 1e-8 * np.abs(leads).max()
    if spring is not None:
        springs = -spring * np.stack([motion[[6 * at + UX, 6 * at + UY]] for at in sections])
        assert np.abs(found.bearing_N - springs).max() < 1e-7 * np.abs(springs).max()


@pytest.mark.parametrize("spans", range(1, 7))
def test_straight_shaft_on_many_bearings_by_the_three_moment_equation(spans: int) -> None:
    """Two to seven equally distant bearings, a force in the middle of each span, no moment at the ends.

    M(i-1) + 4 M(i) + M(i+1) = -3/8 (P(i) + P(i+1)) L.
    """
    length = 80.0
    throw = beam_throw([(0.0, 0.0, 0.0), (0.0, 0.0, length / 2), (0.0, 0.0, length)], 1)
    forces = random_forces(spans)
    found = shaft_cycle([throw] * spans, (0.0,) * spans, forces, None)
    right = -3 / 8 * length * (forces.radial_N[:-1] + forces.radial_N[1:])
    inner = spans - 1
    matrix = 4 * np.eye(inner) + np.eye(inner, k=1) + np.eye(inner, k=-1)
    moments = np.pad(np.linalg.solve(matrix, right), ((1, 1), (0, 0)))
    scale = length * np.abs(forces.radial_N).max()
    near, far = found.throw_N[:, RX], found.throw_N[:, 6 + RX]
    assert np.abs(np.abs(near) - np.abs(moments[:-1])).max() < 1e-8 * scale
    assert np.abs(np.abs(far) - np.abs(moments[1:])).max() < 1e-8 * scale


def test_bearings_that_do_not_let_the_journal_tilt_are_built_in_ends() -> None:
    """Of a span with a force in its middle: P L / 8 at both ends, whatever its neighbours."""
    length = 80.0
    throw = beam_throw([(0.0, 0.0, 0.0), (0.0, 0.0, length / 2), (0.0, 0.0, length)], 1)
    forces = random_forces(3)
    found = shaft_cycle([throw] * 3, (0.0,) * 3, forces, None, tilt_Nmm_per_rad=1e15)
    built_in = np.abs(forces.radial_N) * length / 8
    for ends in (found.throw_N[:, RX], found.throw_N[:, 6 + RX]):
        assert np.abs(np.abs(ends) - built_in).max() < 1e-5 * built_in.max()
    loads = PinLoads(1j * forces.radial_N, *2 * (np.zeros_like(forces.radial_N, dtype=complex),))
    spans = Spans(4e10, length, [length / 4] * 2, 1e15)
    webs, _ = bend_spans(spans, loads, dict.fromkeys(range(4)))
    assert np.abs(webs).max() < 1e-5 * built_in.max(), "no moment a quarter of a span from a built-in end"


@pytest.mark.parametrize(("bearings", "differs"), [("free", False), ("rigid", True), ("spring", True)])
def test_torsion_of_a_shaft_feels_bearings_that_resist_tilt(bearings: Bearings, differs: bool) -> None:
    """A twisted crank tilts its journals; free bearings resist nothing."""
    shaft = shaft_matrix(beam_throw(WITH_PIN_MM, 3).stiffness, (0.0, 120.0, 250.0))
    plain, held = (
        shaft_stiffness(shaft, bearings, SPRING_N_PER_MM, tilt_Nmm_per_rad=tilt).end_to_end_Nm_per_rad
        for tilt in (0.0, TILT_NMM_PER_RAD)
    )
    assert (held > 1.001 * plain) == differs
    assert held == pytest.approx(plain, rel=1.0 if differs else 1e-12)


def meshed_body(scene: Scene, size_mm: float) -> ThrowBody:
    """A throw meshed and condensed with its loads, its fields kept."""
    return throw_body(mesh_throw(scene, size_mm), scene)


def meshed(scene: Scene, size_mm: float) -> tuple[MeshedThrow, LoadedThrow]:
    """A throw meshed and condensed with its loads."""
    body = meshed_body(scene, size_mm)
    return body.meshed, loaded_throw(body.blocks, scene)


def unlike_webs() -> Scene:
    scene = load_scene("mikron-iiic-plain")
    wider = scene.web.model_copy(update={"width_mm": scene.web.width_mm + 14})
    return scene.model_copy(update={"second_web": wider})


def pin_rotation(body: ThrowBody, scene: Scene, block: LoadedBlock, field: Array) -> Array:
    """Rotation of the pin about x and y by the places where a field leads both of its halves, (2,)."""
    if block.span == "symmetric":
        return np.zeros(2)
    low, high = loaded_mm(scene, whole=True)
    middle = (low + high) / 2
    near, far = (
        np.array([mean_displacement(body.model, axis, *half) @ field for axis in (UX, UY)])
        for half in ((low, middle), (middle, high) if block.span == "whole" else (low, middle))
    )
    apart_mm = 2 * loaded_throw(body.blocks, scene).aside_moment_mm
    x, y = (far - near if block.span == "whole" else -2 * near) / apart_mm
    held = {"even": [1, 0], "odd": [0, 1], "none": [1, 1]}[block.lateral]  # the half x >= 0 alone moves aside
    return np.array([-y, x]) * held


def about_near(scene: Scene, forces: Array) -> Array:
    """Resultant force and moment about the near section of forces on both, (6,)."""
    near, far = forces[:6], forces[6:12]
    arm = np.array([0.0, 0.0, scene.pitch_mm])
    return np.concatenate([near[:3] + far[:3], near[3:] + far[3:] + np.cross(arm, far[:3])])


def test_section_forces_have_the_resultants_of_the_loads() -> None:
    """Pin forces, their moments along the pin, and the centrifugal force of the unbalance."""
    scene = load_scene("car-diesel")
    mesh, throw = meshed(scene, 20.0)
    middle, radius = scene.pitch_mm / 2, scene.throw.radius_mm
    radial = about_near(scene, throw.loads["radial"])
    assert radial == pytest.approx([0, -1, 0, middle, 0, 0], abs=1e-5)
    tangential = about_near(scene, throw.loads["tangential"])
    assert tangential == pytest.approx([1, 0, 0, 0, middle, -radius], rel=1e-3, abs=1e-5)
    aside = about_near(scene, throw.loads["radial aside"])
    assert aside == pytest.approx([0, 0, 0, -throw.aside_moment_mm, 0, 0], abs=1e-8)
    assert throw.aside_moment_mm == pytest.approx(scene.throw.crankpin.length_mm / 4, rel=2e-2)
    spinning = about_near(scene, throw.loads["centrifugal"])
    unbalance_N = throw_balance(scene).throw_unbalance_kg_mm / 1000
    assert spinning[:2] == pytest.approx([0, unbalance_N], rel=2e-2, abs=1e-8)
    rigid = np.zeros(SECTIONS)
    rigid[[UY, 6 + UY]] = 1.0
    assert np.abs(throw.stiffness @ rigid).max() < 1e-6 * throw.stiffness.max()
    assert not mesh.whole


@pytest.mark.parametrize("design", ["car-diesel", "unlike webs"])
def test_the_pin_tilts_as_its_halves_lead_off(design: str) -> None:
    """With the sections tilted as a rigid body, and under each load with them held."""
    scene = unlike_webs() if design == "unlike webs" else load_scene(design)
    body = meshed_body(scene, 20.0)
    throw = loaded_throw(body.blocks, scene)
    for row, motion in enumerate((RX, RY)):
        far = {RX: (UY, -scene.pitch_mm), RY: (UX, scene.pitch_mm)}[motion]
        rigid = np.zeros(SECTIONS + len(ACTING))
        rigid[[motion, 6 + motion, 6 + far[0]]] = 1.0, 1.0, far[1]
        assert throw.pin_tilt @ rigid == pytest.approx(np.eye(2)[row], abs=1e-7)
    by_loads = np.zeros((2, len(ACTING)))
    for block in body.blocks:
        for column, name in enumerate(block.names):
            field = block.block.displacement[:, len(block.block.displacement.T) - len(block.names) + column]
            models = 1 if name == "centrifugal" else block.block.copies * block.block.parts
            by_loads[:, ACTING.index(name)] += pin_rotation(body, scene, block, field) / models
    assert throw.pin_tilt[:, SECTIONS:] == pytest.approx(by_loads, abs=1e-7 * np.abs(by_loads).max())


def test_unlike_webs_turn_with_the_couple_of_their_product_of_inertia() -> None:
    """About the middle of the throw; elements of 20 mm are within 2 % of the closed form, of 12 mm nearer."""
    scene = unlike_webs()
    spinning = about_near(scene, meshed(scene, 20.0)[1].loads["centrifugal"])
    couple = spinning[3:] - np.cross([0.0, 0.0, scene.pitch_mm / 2], spinning[:3])
    couple_Nmm_s2 = product_of_inertia_kg_mm2(scene).real / 1000
    assert couple_Nmm_s2 > 0.1
    assert couple[0] == pytest.approx(-couple_Nmm_s2, rel=2e-2)  # a force along y at z has the moment -z
    assert couple[1:] == pytest.approx([0.0, 0.0], abs=1e-2 * couple_Nmm_s2)


def test_a_single_throw_carries_half_of_its_pin_force() -> None:
    """Statically determinate: half the force times the arm in the web, whatever the stiffness."""
    scene = with_values(load_scene("car-diesel"), {"bearings.permitted_film_um": None})
    _, throw = meshed(scene, 20.0)
    forces = random_forces(1)
    found = web_sections(shaft_cycle([throw], (0.0,), forces, None), [scene])
    arm_m = sum(scene.web_z_mm) / 2000
    radial, across = forces.radial_N[0], forces.tangential_N[0]
    for web in (0, 1):
        assert np.abs(found.bending_Nm[0, web]) == pytest.approx(np.abs(radial / 2 * arm_m), rel=1e-4)
        assert np.abs(found.side_bending_Nm[0, web]) == pytest.approx(np.abs(across / 2 * arm_m), rel=1e-4)
        assert np.abs(found.shear_N[0, web]) == pytest.approx(np.abs(radial / 2), rel=1e-4)
        assert np.abs(found.side_shear_N[0, web]) == pytest.approx(np.abs(across / 2), rel=1e-4)
    assert np.abs(found.axial_N).max() < 1e-6 * np.abs(radial).max()


def test_rollers_live_under_the_forces_of_the_whole_shaft() -> None:
    """ISO 281 by hand; one throw has the life of `balance`, the second bearing of four a third of it."""
    one = with_values(load_scene("mikron-iiic-plain"), {"supports.roller_bearing": {"name": "HK6020"}})
    _, throw = meshed(one, 20.0)
    four = continuous_shaft([(throw, one)] * 4, one, None)
    cycle = carried_cycle([throw] * 4, one, cycle_forces(one), None)
    for number, bearing in enumerate(four.main_bearings):
        force_kN = np.hypot(*cycle.bearing_N[number, :2]) / 1000
        turns = 1e6 * 31.9 ** (10 / 3) / np.mean(force_kN ** (10 / 3))
        assert bearing.life_h == pytest.approx(turns / (60 * 2100.0), rel=1e-9)
    sizes = {"name": "HK6020", "roller_diameter_mm": 3.0, "pitch_diameter_mm": 63.0}
    sized = with_values(one, {"supports.roller_bearing": sizes})
    resisting = continuous_shaft([(throw, sized)] * 4, sized, None)
    told = resisting.main_bearings[1]
    cycle = carried_cycle([throw] * 4, sized, cycle_forces(sized), None)  # rollers resist the tilt
    motion = cycle.motion.reshape(5, 6, -1)[1]
    held = RollerSet(40, 3.0, 15.3, 63.0), 31900.0, -cycle.bearing_N[1].T
    turns = reference_life_turns(*held, np.stack([motion[RY], -motion[RX]], axis=1))
    assert told.reference_life_h == pytest.approx(1 / np.mean(1 / turns) / (60 * 2100.0), rel=1e-6)
    straight = reference_life_turns(*held, np.zeros((720, 2)))
    assert told.reference_life_h < 0.25 / np.mean(1 / straight) / (60 * 2100.0), "tilt up to 1.6 mrad"
    assert four.main_bearings[1].reference_life_h is None
    assert four.tilt_spring_Nm_per_rad is None
    assert resisting.tilt_spring_Nm_per_rad == pytest.approx(39135, rel=1e-3)
    for shaft, share, tilt_mrad in ((four, 0.79, 2.55), (resisting, 0.65, 2.1)):
        assert shaft.webs[0].share == pytest.approx(share, abs=0.01)
        assert shaft.main_bearings[0].tilt_mrad == pytest.approx(tilt_mrad, rel=0.03)
    alone = balance_result(engine_balance(one)).main_bearings[1]
    assert four.main_bearings[1].life_h == pytest.approx(0.355 * alone.life_h, rel=0.01)
    one = with_values(one, {"engine.cylinders": 1, "engine.firing_order": [1]})
    single = continuous_shaft([(throw, one)], one, None).main_bearings[0]
    assert single.life_h == pytest.approx(
        balance_result(engine_balance(one)).main_bearings[0].life_h, rel=0.02
    )


def test_the_force_on_a_drilled_pin_acts_on_its_axis() -> None:
    """Spread over material that a drilling lacks, it had a lever 0.3 % short, and the opposite sign."""
    scene = load_scene("industrial-gas")
    assert scene.throw.drilling
    _, throw = meshed(scene, 60.0)
    forces = random_forces(1)
    found = web_sections(shaft_cycle([throw], (0.0,), forces, None), [scene])
    ahead, behind = found.torque_Nm[0]
    assert np.abs(ahead).max() < 1e-6 * np.abs(behind).max()
    assert behind == pytest.approx(forces.tangential_N[0] * scene.throw.radius_mm / 1000, rel=1e-6)


def test_webs_carry_what_stands_ahead_of_them(tmp_path: Path) -> None:
    """In rigid bearings the torque is that of the pins ahead; forces change at pins and bearings.

    The file of the curves has all of it, one row an angle.
    """
    angles = (0.0, 90.0, 250.0)
    throw, forces = beam_throw(WITH_PIN_MM, 3), random_forces(3)
    cycle = shaft_cycle([throw] * 3, angles, forces, None)
    scene = load_scene("car-diesel")
    found = web_sections(cycle, [scene] * 3)
    x_mm, y_mm, _ = PIN_MM
    own = (forces.tangential_N * y_mm - x_mm * -forces.radial_N) / 1000
    behind = np.cumsum(own, axis=0)
    assert np.abs(found.torque_Nm[:, 1]) == pytest.approx(np.abs(behind), rel=1e-9)
    assert np.abs(found.torque_Nm[1:, 0]) == pytest.approx(np.abs(behind[:-1]), rel=1e-9)
    step = np.abs(found.shear_N[:, 1] - found.shear_N[:, 0])
    assert step == pytest.approx(np.abs(forces.radial_N), rel=1e-9)
    ahead = found.shear_N[0, 0] + 1j * found.side_shear_N[0, 0]
    assert np.abs(ahead) == pytest.approx(np.hypot(*cycle.bearing_N[0]), rel=1e-9)
    path = tmp_path / "webs.csv"
    write_web_sections([(900.0, found), (1800.0, found)], path)
    head, *rows = path.read_text(encoding="utf-8").splitlines()
    assert head.startswith("speed_rpm,web,throw,angle_deg,bending_Nm,side_bending_Nm,torque_Nm,shear_N")
    table = np.array([[float(cell) for cell in row.split(",")] for row in rows])
    assert len(table) == 2 * 6 * len(forces.angle_deg)
    last = table[(table[:, 0] == 1800.0) & (table[:, 1] == 6.0)]
    assert set(last[:, 2]) == {3.0}
    assert last[:, 6] == pytest.approx(found.torque_Nm[2, 1], rel=1e-7)


@pytest.mark.parametrize("offset_mm", [None, pytest.param(0.0, marks=pytest.mark.slow), 6.0])
def test_two_rods_on_a_pin_load_the_bearings_by_the_lever_rule(offset_mm: float | None) -> None:
    """Of a V with one throw, beside the balance: the two rods stand aside of the middle of the pin."""
    data = load_scene("car-diesel").model_dump(mode="json", by_alias=True, exclude_none=True)
    data["engine"] |= {"cylinders": 2, "firing_order": [1, 2]}
    data["engine"]["arrangement"] = {"layout": "V", "bank_angle_deg": 90.0, "throw_angles_deg": [0.0]}
    if offset_mm is not None:
        data["engine"]["arrangement"]["rod_offset_mm"] = offset_mm
    scene = scene_from_dict(data)
    _, throw = meshed(scene, 20.0)
    cycle = shaft_cycle([throw], (0.0,), _of_throw(cycle_forces(scene), 0), None)
    loads = main_bearings(scene, turning_masses(scene))
    stride = round(1.0 / float(loads.angle_deg[1] - loads.angle_deg[0]))
    for bearing, expected in zip(loads_on_bearings_N(cycle), np.abs(loads.load_N)[:, ::stride], strict=True):
        assert np.hypot(*bearing).max() == pytest.approx(expected.max(), rel=5e-3)


@pytest.mark.slow
def test_a_single_throw_has_the_bearing_forces_and_films_of_the_balance(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Direction and sense of rotation, too: the film follows the load as it turns."""
    monkeypatch.setattr("cranktopo.tasks.shaft.continuous.carried", lambda _: (0, 1))  # of the one throw
    scene = load_scene("car-diesel")
    _, throw = meshed(scene, 20.0)
    cycle = shaft_cycle([throw], (0.0,), _of_throw(cycle_forces(scene), 0), None)
    x, y = loads_on_bearings_N(cycle)[0]
    loads = main_bearings(scene, turning_masses(scene))
    stride = round(1.0 / float(loads.angle_deg[1] - loads.angle_deg[0]))
    first = loads.load_N[0][::stride]
    assert np.abs(y + 1j * x - first).max() < 5e-3 * np.abs(first).max()
    bearing = ShaftBearing(bearing=1, largest_N=0, at_deg=0, halves_N=0, tilt_mrad=0, offset_um=0)
    big_ends = ShaftBigEnds(tilt_mrad=(0.0,))
    shaft = ContinuousShaft(
        speed_rpm=1.0, spring_N_per_mm=None, webs=(), main_bearings=(bearing, bearing), big_ends=big_ends
    )
    straight = np.zeros((len(scene.shaft_angles_deg), cycle.angle_deg.size), complex)
    (filled,) = _with_films([_AtSpeed(scene, shaft, cycle, straight)])
    every = oil_films(scene).speeds[0].bearings
    first_and_big_end = filled.bearings[0], filled.bearings[-1]
    for film, alone in zip(first_and_big_end, (every[0], every[-1]), strict=True):
        assert film.film_um == pytest.approx(alone.film_um, rel=0.01)
        assert film.pressure_MPa == pytest.approx(alone.pressure_MPa, rel=0.01)


@pytest.mark.parametrize("scene", [arranged(""), arranged(VEE + "throw_angles_deg = [0.0]", 2, (1, 2))])
def test_each_big_end_leans_with_its_own_pin_at_its_own_time(scene: Scene) -> None:
    """A tilt along the throw, when its cylinder fires, leads the journal along that cylinder's axis."""
    scene = with_values(scene, {"bearings": {"clearance_mm": 0.05, "oil": "ISO VG 46"}})
    engine, angle = engine_of(scene), np.arange(0.0, engine_of(scene).cycle_deg)
    fires = engine.firing_angles_deg
    pulses = np.array([angle == fire % engine.cycle_deg for fire in fires], complex)
    pulses *= np.arange(1, len(fires) + 1)[:, None]
    tilts = np.array([pulses[throw :: engine.throws].sum(axis=0) for throw in range(engine.throws)])
    cycle = ShaftCycle(angle, np.zeros((0, 0)), np.zeros((0, 2, 0)), np.zeros((0, 12, 0)))
    found = _loaded_big_end(_AtSpeed(scene, ContinuousShaft.model_construct(), cycle, tilts))
    half = found.bearing.width_mm / 2 / found.bearing.clearance_mm
    assert found.tilts is not None
    assert found.tilts[:, 0] == pytest.approx(half * np.arange(1, len(fires) + 1))


@pytest.mark.slow
def test_shafts_of_the_built_in_engines() -> None:
    """Outer webs carry about four fifths, inner ones about half of what a throw alone does."""
    for name, spring, outer, inner in (
        ("mikron-iiic", 1.07e6, 0.81, 0.52),
        ("car-diesel", 1.5e6, 0.85, 0.54),
    ):
        scene = load_scene(name)
        _, throw = meshed(scene, 8.0)
        found = continuous_shaft([(throw, scene)] * 4, scene, spring)
        assert found.webs[0].share == pytest.approx(outer, abs=0.02)
        assert min(web.share for web in found.webs) == pytest.approx(inner, abs=0.02)


def test_the_scene_tells_what_resists_the_tilt_of_journals() -> None:
    """The cycle in rigid bearings, what films feel of the bent shaft, and the plan's beam take the key."""
    free = load_scene("car-diesel")
    stiff = with_values(free, {"supports.bearing_tilt_spring_Nm_per_rad": TILT_NMM_PER_RAD / 1000})
    throws, angles, forces = [beam_throw(WITH_PIN_MM, 3)] * 4, free.shaft_angles_deg, cycle_forces(free)
    found = carried_cycle(throws, stiff, forces, None)
    expected = shaft_cycle(throws, angles, forces, None, tilt_Nmm_per_rad=TILT_NMM_PER_RAD)
    assert np.array_equal(found.motion, expected.motion)
    tilted = [
        np.abs(one.motion.reshape(5, 6, -1)[:, [RX, RY]]).max()
        for one in (carried_cycle(throws, free, forces, None), found)
    ]
    assert tilted[1] < 0.95 * tilted[0]
    bent = [bent_into_bearings_N_per_mm(throws, angles, range(5), tilt) for tilt in (0.0, TILT_NMM_PER_RAD)]
    assert np.linalg.eigvalsh(bent[1] - bent[0]).min() > -1e-6 * np.abs(bent[0]).max()
    assert span_bending(stiff) != span_bending(free)
