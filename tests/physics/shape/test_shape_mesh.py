"""Gradients of a parametric web on a moved mesh, against the moved faces, differences and new meshes."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from unittest.mock import patch

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import WebHistory, WebLoads, load_history
from cranktopo.engine.judged_histories import histories_of
from cranktopo.numerics.tetrahedra import solver
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble, centrifugal_force, swing_force
from cranktopo.numerics.tetrahedra.node_gradients import centrifugal_slopes, swing_slopes
from cranktopo.numerics.tetrahedra.stress import nodal_stress, outer_surface, surface_stress
from cranktopo.numerics.tetrahedra.stress_adjoint import stress_adjoint
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.throw_fatigue.fillets import fillet_nodes
from cranktopo.tasks.throw_fatigue.largest_stress import largest_of_field_MPa
from cranktopo.tasks.throw_fatigue.mesh_quality import Quality
from cranktopo.tasks.throw_fatigue.needs import load_kinds
from cranktopo.tasks.throw_fatigue.safety_field import safety_field
from cranktopo.tasks.throw_fatigue.stress_model import StressModel, images_of
from cranktopo.tasks.throw_fatigue.target_safety import least_field
from cranktopo.tasks.throw_fea.unit_fields import unit_fields
from cranktopo.tasks.web_shape.mesh_model import MeshModel, MeshResponses
from tests.physics.shape.shape_cases import (
    COARSE_FILLET,
    COARSE_MM,
    Array,
    die_web,
    drafted_web,
    full_web,
    milled_web,
    round_groove_web,
    round_side_web,
    rounded_web,
    solid_web,
)

WEBS = {
    "every-feature": full_web,
    "drafted-pockets": drafted_web,
    "drafted-bevels": die_web,
    "round-floors": milled_web,
    "round-groove": round_groove_web,
    "round-sides": round_side_web,
    "solid-journals": solid_web,
}
SLOW = ("drafted-pockets", "drafted-bevels", "round-floors", "round-groove", "round-sides", "solid-journals")
THIN = ("drafted-pockets", "round-floors", "round-sides")
"""With thin walls beside pockets: on coarse meshes these scatter more."""
ELASTIC = 2e5, 0.3
STRESSED = "fatigue_safety", "stress"


@pytest.fixture(scope="module", autouse=True)
def solved_directly() -> Iterator[None]:
    """Derivatives are those of exact solves, on meshes of every size.

    What iterations leave of the loads moves with the mesh as well: with a round groove, 13,425 unknowns, a
    safety is 1.2e-7 off, its slope by the depth of a bevel 5e-5, and what differences say of that slope
    1.1e-3. Solved directly, slope and differences agree to 1e-6.
    """
    with patch.object(solver, "DIRECT_LIMIT", 10**9):
        yield


@dataclass(frozen=True)
class Case:
    scene: Scene
    layout: Layout
    model: MeshModel
    values: Array
    found: MeshResponses
    fresh_mm: float = COARSE_MM


@pytest.fixture(
    scope="module",
    params=[pytest.param(name, marks=[pytest.mark.slow] if name in SLOW else []) for name in WEBS],
)
def case(request: pytest.FixtureRequest) -> Case:
    scene, layout, values = WEBS[request.param]()
    swings = ["natural_frequency >= 90 %"] if scene.engine and scene.engine.throws > 1 else []
    scene = with_goal(scene, minimise="mass", limits=(*swings, "stress <= 110 %"))
    model = MeshModel(scene, layout, values, COARSE_MM, COARSE_FILLET, STRESSED)
    size_mm = COARSE_MM / 2 if request.param in THIN else COARSE_MM
    return Case(scene, layout, model, values, model.responses(values), size_mm)


def directions(case: Case, count: int) -> Array:
    """Changes of all parameters at once, (count, parameters), mm or degrees."""
    return np.random.default_rng(7).standard_normal((count, len(case.values)))


def test_nodes_follow_the_faces_of_the_web_to_second_order(case: Case) -> None:
    """From where the first move puts them: edge nodes of straightened elements begin a little off a face."""
    moved, step = case.model.moved, 0.02
    mesh = moved.at(case.values + 1e-9)
    assert np.abs(mesh.points_mm - moved.mesh.points_mm).max() < 1e-3
    motion = moved.velocities(mesh, case.values)
    before = moved.distances_mm(mesh.points_mm, case.values).max()
    assert before < 1e-6
    for i, name in enumerate(case.layout.names):
        changed = case.values + step * np.eye(len(case.values))[i]
        off = moved.distances_mm(mesh.points_mm + step * motion[:, :, i], changed).max()
        unmoved = moved.distances_mm(mesh.points_mm, changed).max()
        assert off < 2 * before + step**2, name
        assert unmoved > 20 * off, name


def test_a_moved_mesh_lies_on_the_new_web_and_its_journals_stand_still(case: Case) -> None:
    moved = case.model.moved
    changed = case.values + 0.2 * directions(case, 1)[0]
    mesh = moved.at(changed)
    assert moved.distances_mm(mesh.points_mm, changed).max() < 1e-8
    assert 0.5 < moved.quality(mesh) < 1
    low, _ = case.model.scene.web_z_mm
    z = moved.mesh.points_mm[2]
    surface = np.hypot(moved.mesh.points_mm[0], moved.mesh.points_mm[1])
    rim = np.abs(surface - case.model.scene.throw.main_journal.radius_mm) < 1e-6
    still = rim & (z < low)
    assert still.any()
    assert np.array_equal(mesh.points_mm[:, still], moved.mesh.points_mm[:, still])


def test_gradients_are_those_of_the_moved_mesh(case: Case) -> None:
    step = 1e-3
    for direction in directions(case, 1):
        above, below = (case.model.responses(case.values + s * step * direction) for s in (1, -1))
        for name, value in case.found.values.items():
            measured = (above.values[name] - below.values[name]) / (2 * step)
            assert case.found.gradients[name] @ direction == pytest.approx(
                measured, rel=1e-4, abs=1e-8 * abs(value)
            )


def test_solves_that_iterate_tell_what_direct_ones_tell(case: Case) -> None:
    """As a search does with its meshes: far nearer than the 0.1 % by which these scatter."""
    with patch.object(solver, "DIRECT_LIMIT", 0):
        iterated = case.model.responses(case.values)
    assert iterated.values["fatigue_safety"] != case.found.values["fatigue_safety"]
    for name, value in case.found.values.items():
        assert iterated.values[name] == pytest.approx(value, rel=1e-6), name
        off = iterated.gradients[name] - case.found.gradients[name]
        assert np.linalg.norm(off) < 1e-4 * np.linalg.norm(case.found.gradients[name]), name


@pytest.mark.slow
def test_gradients_beside_round_corners_in_the_sides() -> None:
    scene, layout, values = rounded_web()
    model, step = MeshModel(scene, layout, values, COARSE_MM), 1e-3
    found, direction = model.responses(values), np.random.default_rng(7).standard_normal(len(values))
    above, below = (model.responses(values + s * step * direction) for s in (1, -1))
    for name, value in found.values.items():
        measured = (above.values[name] - below.values[name]) / (2 * step)
        assert found.gradients[name] @ direction == pytest.approx(
            measured, rel=1e-4, abs=1e-8 * abs(value)
        ), name


def test_safety_and_stress_are_those_of_the_assessment_on_the_same_mesh(case: Case) -> None:
    scene, mesh = case.model.scene, case.model.moved.mesh
    elastic = scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson
    model = assemble(mesh, *elastic)
    enabled, kinds = load_kinds(scene, "extremes")
    fields = unit_fields(model, scene, mesh.mirrored, kinds)
    found = nodal_stress(model, np.stack([f.displacement_mm for f in fields]), *elastic)
    planes = ((2, 0.0), (2, scene.pitch_mm / 2), (0, 0.0))
    surface = outer_surface(model, found.elements, planes)
    on = [fillet_nodes(scene, name, surface.points_mm) for name in ("journal", "pin")]
    stresses = surface_stress(model, surface, found)
    quality = Quality(1.0, 1.0, 1, 0.0, 0.0, 0.0, 0.0)
    images = images_of(fields, mirrored=True)
    assessed = safety_field(
        StressModel("", scene, 1.0, kinds, surface, stresses, images, on[0], on[1], quality),
        "lsa",
        load_history(scene, "extremes", enabled),
    )
    assert case.found.values["fatigue_safety"] == pytest.approx(assessed.critical.safety, rel=1e-9)
    assert case.found.values["stress"] == pytest.approx(largest_of_field_MPa(assessed), rel=1e-9)


@dataclass(frozen=True)
class CycleCase:
    """A throw with its tangential force: the quarter with three condensations, or the half with two."""

    model: MeshModel
    values: Array


@pytest.fixture(
    scope="module", params=["on", pytest.param("off", marks=pytest.mark.slow)], ids=["quarter", "half"]
)
def cycle(request: pytest.FixtureRequest) -> CycleCase:
    scene, layout, values = die_web()
    on = {"tangential": "on", "centrifugal": "on", "lateral_symmetry": request.param}
    scene = scene.model_copy(update={"effects": scene.effects.model_copy(update=on)})
    return CycleCase(MeshModel(scene, layout, values, COARSE_MM, COARSE_FILLET, STRESSED, "cycle"), values)


@pytest.mark.slow
def test_safety_and_stress_over_the_cycle_are_those_of_the_assessment(cycle: CycleCase) -> None:
    scene, mesh = cycle.model.scene, cycle.model.moved.mesh
    elastic = scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson
    model = assemble(mesh, *elastic)
    enabled, kinds = load_kinds(scene, "cycle")
    assert "tangential" in kinds
    fields = unit_fields(model, scene, mesh.mirrored, kinds)
    found = nodal_stress(model, np.stack([f.displacement_mm for f in fields]), *elastic)
    planes = [(2, 0.0), (2, scene.pitch_mm / 2)] + ([(0, 0.0)] if mesh.mirrored else [])
    surface = outer_surface(model, found.elements, tuple(planes))
    on = [fillet_nodes(scene, name, surface.points_mm) for name in ("journal", "pin")]
    throw = StressModel(
        "",
        scene,
        1.0,
        kinds,
        surface,
        surface_stress(model, surface, found),
        images_of(fields, mesh.mirrored),
        on[0],
        on[1],
        Quality(1.0, 1.0, 1, 0.0, 0.0, 0.0, 0.0),
    )
    parts = [safety_field(throw, "lsa", one) for one in histories_of(scene, "cycle", enabled)]
    by_model = cycle.model.responses(cycle.values).values
    assert by_model["fatigue_safety"] == pytest.approx(least_field(parts).critical.safety, rel=1e-9)
    assert by_model["stress"] == pytest.approx(max(map(largest_of_field_MPa, parts)), rel=1e-9)


@pytest.mark.slow
def test_the_gradients_over_the_cycle_are_what_differences_say(cycle: CycleCase) -> None:
    model, values, step = cycle.model, cycle.values, 1e-3
    direction = np.random.default_rng(7).standard_normal(len(values))
    found = model.responses(values, STRESSED).gradients
    above, below = (model.responses(values + s * step * direction, STRESSED).values for s in (1, -1))
    for name in STRESSED:
        measured = (above[name] - below[name]) / (2 * step)
        assert found[name] @ direction == pytest.approx(measured, rel=1e-4), name


def of_a_web(seed: int, force_N: float = 3e4) -> WebHistory:
    """Load states such as a web has in its shaft, with moments of its neighbours."""
    parts = np.random.default_rng(seed).uniform(-1, 1, (6, 24)) * force_N
    return WebHistory(
        radial_N=parts[0],
        tangential_N=parts[1] / 2,
        torque_Nm=0.02 * parts[2],
        angular_speed_rad_s=np.full(24, 220.0),
        labels=tuple(map(str, range(24))),
        moment_Nm=0.02 * parts[3],
        side_moment_Nm=0.01 * parts[4],
        swing_Nm=0.02 * parts[5],
    )


@pytest.mark.slow
@pytest.mark.parametrize("symmetry", ["on", "off"], ids=["quarter", "half"])
def test_the_safety_of_a_web_in_its_shaft_and_its_gradient(symmetry: str) -> None:
    """The worst of the webs that are to be equal, on the near half alone; slopes as differences say."""
    scene, layout, values = die_web()
    effects = scene.effects.model_copy(update={"lateral_symmetry": symmetry})
    scene = scene.model_copy(update={"effects": effects})
    wanted, worse = ("fatigue_safety",), of_a_web(3, 6e4)

    def model_of(*histories: WebHistory) -> MeshModel:
        return MeshModel(scene, layout, values, COARSE_MM, COARSE_FILLET, wanted, WebLoads(histories))

    both, worst = model_of(of_a_web(2), worse), model_of(worse)
    found = both.responses(values, wanted)
    assert found.values["fatigue_safety"] == pytest.approx(
        worst.responses(values, wanted).values["fatigue_safety"], rel=1e-9
    )
    direction, step = np.random.default_rng(7).standard_normal(len(values)), 1e-3
    above, below = (both.responses(values + s * step * direction, wanted).values for s in (1, -1))
    measured = (above["fatigue_safety"] - below["fatigue_safety"]) / (2 * step)
    assert found.gradients["fatigue_safety"] @ direction == pytest.approx(measured, rel=1e-4)


@pytest.mark.parametrize(
    ("load", "slopes_of"),
    [
        (
            lambda model: centrifugal_force(model, 1.0),
            lambda model, field: centrifugal_slopes(model, 1.0, field),
        ),
        (swing_force, swing_slopes),
    ],
    ids=["centrifugal", "swing"],
)
def test_loads_of_the_mass_change_with_the_nodes_as_differences_say(
    case: Case, load: Callable[[Elasticity], Array], slopes_of: Callable[[Elasticity, Array], Array]
) -> None:
    mesh, random = case.model.moved.mesh, np.random.default_rng(3)
    field = random.standard_normal(mesh.points_mm.size)
    step = 1e-5 * random.standard_normal(mesh.points_mm.shape)
    above, below = (
        load(assemble(replace(mesh, points_mm=mesh.points_mm + s * step), 1.0, 0.3)) @ field for s in (1, -1)
    )
    slopes = slopes_of(assemble(mesh, 1.0, 0.3), field)
    assert 2 * (slopes * step).sum() == pytest.approx(above - below, rel=1e-5)


def test_the_way_back_from_stresses_is_what_differences_say(case: Case) -> None:
    """All nodes move, those of the fillets too, as they do for no parameter of a web."""
    scene, mesh, random = case.model.scene, case.model.moved.mesh, np.random.default_rng(5)
    planes = ((2, 0.0), (2, scene.pitch_mm / 2), (0, 0.0))
    field = 1e-3 * random.standard_normal((1, mesh.points_mm.size))
    model = assemble(mesh, *ELASTIC)
    found = nodal_stress(model, field, *ELASTIC)
    surface = outer_surface(model, found.elements, planes)
    on = fillet_nodes(scene, "pin", surface.points_mm)[:, None]
    worth = on * random.standard_normal((2, 1, len(on), 6))
    forces, slopes = stress_adjoint(model, surface, found, field, (worth[0], worth[1]), ELASTIC)
    moved = 1e-4 * random.standard_normal(field.shape)
    shift = 1e-6 * random.standard_normal(mesh.points_mm.shape)
    for axis, position in planes:
        shift[axis, np.abs(mesh.points_mm[axis] - position) < 1e-6] = 0.0

    def result(moved: Array | float, shift: Array | float) -> float:
        body = assemble(replace(mesh, points_mm=mesh.points_mm + shift), *ELASTIC)
        stress = nodal_stress(body, field + moved, *ELASTIC)
        here = surface_stress(body, outer_surface(body, stress.elements, planes), stress)
        return float((worth[0] * here.stress_MPa).sum() + (worth[1] * here.depth_MPa_per_mm).sum())

    by_fields, by_nodes = result(moved, 0.0) - result(-moved, 0.0), result(0.0, shift) - result(0.0, -shift)
    assert 2 * (forces * moved).sum() == pytest.approx(by_fields, rel=1e-5)
    assert 2 * (slopes * shift).sum() == pytest.approx(by_nodes, rel=1e-4)


@pytest.mark.slow
def test_gradients_by_each_parameter_are_those_of_the_moved_mesh(case: Case) -> None:
    """Every parameter alone: `pytest -m slow tests/physics/shape/test_shape_mesh.py`."""
    step = 1e-3
    for i, name in enumerate(case.layout.names):
        change = step * np.eye(len(case.values))[i]
        above, below = (case.model.responses(case.values + s * change) for s in (1, -1))
        for quantity, value in case.found.values.items():
            measured = (above.values[quantity] - below.values[quantity]) / (2 * step)
            exact = pytest.approx(measured, rel=1e-3, abs=1e-7 * abs(value))
            assert case.found.gradients[quantity][i] == exact, f"{quantity} by {name}"


@pytest.mark.slow
def test_a_moved_mesh_tells_the_change_that_a_new_mesh_tells(case: Case) -> None:
    """Meshes graded for stiffness scatter by 0.1 % at this size; masses are exact on them."""
    change = 0.3 * directions(case, 1)[0]
    changed = case.values + change
    moved, fresh = (
        MeshModel(case.scene, case.layout, start, case.fresh_mm).responses(changed)
        for start in (case.values, changed)
    )
    for name in ("mass", "inertia", "unbalance"):
        assert moved.values[name] == pytest.approx(fresh.values[name], rel=1e-4), name
    for name in ("torsion", "bending"):
        assert moved.values[name] == pytest.approx(fresh.values[name], rel=3e-3), name


def test_a_move_that_folds_the_mesh_is_refused(case: Case) -> None:
    far = case.values.copy()
    far[case.layout.names.index("bevel-journal.y")] -= 40.0
    with pytest.raises(CranktopoError, match="folds"):
        case.model.moved.at(far)
