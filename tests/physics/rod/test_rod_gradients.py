"""Exact slopes of what elements find of a rod, against differences of the moved mesh and its own faces."""

from dataclasses import dataclass

import numpy as np
import pytest

from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.mesh.rod_mesh import default_rod_element_mm, mesh_rod
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.engine.rod_forces import rod_motions
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.tasks.fatigue.criteria import criterion
from cranktopo.tasks.fatigue.smooth_extremes import JudgedSurface, least_safety
from cranktopo.tasks.fatigue.superposition import SIGNED, TENSOR
from cranktopo.tasks.rod.element_gradients import MARGIN, RodGradients
from cranktopo.tasks.rod.element_stress import (
    PLACES,
    cycle_states,
    element_stress,
    image_cycles,
    place_of,
    unit_stress,
)
from cranktopo.tasks.rod.elements import eye_shapes
from cranktopo.tasks.rod.faces import moved_rod
from cranktopo.tasks.rod.lighter import resized, rod_search
from cranktopo.tasks.rod.unit_fields import rod_model, solve_rod
from tests.random_rods import random_rod_engine

LIMITS = {"rod.small_end_ovalisation_um": 20.0, "rod.big_end_ovalisation_um": 50.0}
OIL = {"rod.oil_hole_mm": 1.5, "rod.bush_interference_um": 30.0}
RODS = {
    "I": lambda: load_scene("mikron-iiic-rod-i"),
    "H": lambda: with_values(load_scene("mikron-iiic-rod-h"), OIL),
    "oblique": lambda: with_values(load_scene("mikron-iiic-rod"), {"rod.split_angle_deg": 45.0}),
}
SIZE_MM, EDGE_MM, STEPS_MM = 7.0, 4.0, (2e-3, 1e-3)


@dataclass(frozen=True)
class Case:
    scene: Scene
    names: tuple[str, ...]
    motions: tuple
    found: RodGradients
    nodes: dict
    slopes: dict


def of_rod(scene: Scene) -> Scene:
    return scene.model_copy(update={"material": scene.rod.material or scene.material})


def case_of(name: str, size_mm: float = SIZE_MM, edge_mm: float = EDGE_MM) -> Case:
    scene = of_rod(with_values(RODS[name](), LIMITS))
    names, motions = rod_search(scene, "lsa", 3.0).names, rod_motions(scene)
    fields = solve_rod(scene, rod_model(scene, size_mm), {})
    stress = element_stress(fields, cycle_states(fields, motions), "lsa", edge_mm)
    found, place = RodGradients(stress, motions, "lsa", names), place_of(fields, stress.surface.points_mm)
    nodes = {name: np.flatnonzero(stress.judged & (place == k)) for k, name in enumerate(PLACES)}
    keys = [
        (name, kind) for name in PLACES for kind in ("yield_safety", "fatigue_safety") if len(nodes[name])
    ]
    keys += [(f"{eye} end", MARGIN) for eye in ("small", "big")]
    return Case(scene, names, motions, found, nodes, found.of(keys))


@pytest.fixture(scope="module")
def coarse() -> Case:
    """Slopes are those of the mesh, however coarse."""
    return case_of("I", 13.0, 8.0)


@pytest.fixture(scope="module", params=[pytest.param(name, marks=pytest.mark.slow) for name in RODS])
def case(request) -> Case:
    return case_of(request.param)


def logarithms(case: Case, values) -> dict:
    """Logarithms of all quantities on the moved mesh, from nothing: loads, masses and places of its own."""
    scene, mesh = resized(case.scene, case.names, values), case.found.moved.at(values)
    elastic = scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson
    fields = solve_rod(scene, assemble(mesh, *elastic), {})
    stress, loads = unit_stress(fields).stress, cycle_states(fields, case.motions)
    judges = {
        "yield_safety": lambda s: scene.material.yield_MPa / (s.amplitude_MPa + np.abs(s.mean_MPa)),
        "fatigue_safety": lambda s: criterion("lsa").point_safety(scene, s).safety,
    }
    found, shapes = {}, eye_shapes(fields, loads)
    for name, kind in case.slopes:
        if kind == MARGIN:
            worst = max(s.ovalisation_um for s in shapes if s.eye == name and s.permitted_um)
            found[name, kind] = -np.log(worst)
            continue
        measure = TENSOR if kind == "fatigue_safety" else SIGNED
        judged = JudgedSurface(stress, image_cycles(loads), case.nodes[name], (), measure)
        found[name, kind] = np.log(least_safety(judged, lambda _, kind=kind: judges[kind]).value)
    return found


def agrees(case: Case, direction, names: str) -> None:
    off = off_by(case, direction, STEPS_MM[0])
    if off:  # another state of the cycle takes over between the two sides, and the safety jumps by 2e-7
        off &= off_by(case, direction, STEPS_MM[1])
    assert not off, f"by {names}"


def off_by(case: Case, direction, step_mm: float) -> set[tuple[str, str]]:
    """Quantities whose slope is not that of a central difference."""
    own = case.found.moved.values
    above, below = (logarithms(case, own + sign * step_mm * direction) for sign in (1, -1))
    found = set()
    for key, slopes in case.slopes.items():
        measured = (above[key] - below[key]) / (2 * step_mm)
        # the next state of a cycle takes over as the highest: a corner of the largest stress
        within = 2e-4 if key[1] == "yield_safety" else 1e-4
        least = max(2e-6, within * np.abs(slopes).max())
        if slopes @ direction != pytest.approx(measured, rel=within, abs=least):
            found.add(key)
    return found


def free(case: Case) -> list[int]:
    """The height of the cap's bosses stays where bolts clamp it: their holes there stand still."""
    return [k for k, name in enumerate(case.names) if name != "boss_below_mm"]


def agrees_by_all(case: Case) -> None:
    direction = np.zeros(len(case.names))
    direction[free(case)] = np.random.default_rng(7).standard_normal(len(free(case)))
    agrees(case, direction, "all dimensions")


def test_slopes_are_those_of_the_moved_mesh(coarse: Case) -> None:
    agrees_by_all(coarse)


def test_slopes_of_every_rod_are_those_of_its_moved_mesh(case: Case) -> None:
    agrees_by_all(case)


@pytest.mark.slow
def test_slopes_by_each_dimension_are_those_of_the_moved_mesh(case: Case) -> None:
    for k in free(case):
        agrees(case, np.eye(len(case.names))[k], case.names[k])


def follow_to_second_order(case: Case) -> None:
    moved, step = case.found.moved, 0.02
    motion = moved.velocities(moved.mesh, moved.values)
    before = moved.distances_mm(moved.mesh.points_mm, moved.values).max()
    assert before < 1e-5
    for k in free(case):
        changed = moved.values + step * np.eye(len(case.names))[k]
        off = moved.distances_mm(moved.mesh.points_mm + step * motion[:, :, k], changed).max()
        assert off < 2 * before + step**2, case.names[k]
        assert moved.distances_mm(moved.mesh.points_mm, changed).max() > 10 * off, case.names[k]


def test_nodes_follow_the_faces_of_the_rod_to_second_order(coarse: Case) -> None:
    follow_to_second_order(coarse)


def test_nodes_of_every_rod_follow_its_faces_to_second_order(case: Case) -> None:
    follow_to_second_order(case)


@pytest.mark.parametrize("seed", [0, *(pytest.param(k, marks=pytest.mark.slow) for k in range(1, 60))])
def test_every_part_of_a_random_rod_belongs_to_a_face(seed: int) -> None:
    scene = of_rod(scene_from_dict(random_rod_engine(seed)))
    mesh = mesh_rod(scene, 4 * default_rod_element_mm(scene))
    moved = moved_rod(mesh, scene, rod_search(scene, "lsa", 0.5).names)
    assert np.isfinite(moved.velocities(moved.mesh, moved.values)).all()


@pytest.mark.parametrize("width_mm", [27.41, pytest.param(28.0, marks=pytest.mark.slow)])
def test_all_of_the_surface_has_a_face_where_shank_and_eye_are_of_one_width(width_mm: float) -> None:
    """In one plane a triangle may lie across the edge of the eye."""
    sizes = {"rod.shank_width_mm": width_mm, "rod.small_end_diameter_mm": 38.971, "rod.boss_above_mm": 14.0}
    scene = with_values(load_scene("mikron-iiic-rod"), sizes)
    moved = moved_rod(mesh_rod(scene, 4.0), scene, ("shank_width_mm", "small_end_diameter_mm"))
    assert moved.mesh.points_mm[2].max() == pytest.approx(15.0)
