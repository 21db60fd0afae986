"""A part that is neither web nor rod takes the same path: a strip with a hole, pulled along.

Its stress against R. C. J. Howland (1930), the slope of its safety by the diameter and by the width against
differences and against closed forms.
"""

from dataclasses import dataclass

import numpy as np
import pytest

from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.numerics.tetrahedra.cad_mesh import generate
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.numerics.tetrahedra.moved_mesh import MovedMesh
from cranktopo.numerics.tetrahedra.moving_faces import STEP, MovingFace, contact_of
from cranktopo.numerics.tetrahedra.node_gradients import sums_of_work_slopes
from cranktopo.numerics.tetrahedra.surface_loads import faces_where, pressure_force
from cranktopo.numerics.tetrahedra.unit_stress import UnitStress
from cranktopo.tasks.fatigue.smooth_extremes import JudgedSurface, least_safety

ELASTIC = 210e3, 0.3
LENGTH_MM, THICK_MM, PULL_N, LIMIT_MPA = 60.0, 2.0, 1000.0, 500.0
VALUES = np.array([5.0, 20.0])
"""Radius of the hole and half the width of the strip, mm."""
PLANES = ((0, 0.0), (1, 0.0), (2, 0.0), (1, LENGTH_MM))


@dataclass(frozen=True)
class Face(MovingFace):
    """Of the strip along y, its hole along z."""

    distance: object

    def contact(self, points_mm, values):
        return contact_of(lambda at: self.distance(values, at), points_mm)

    def gradients(self, points_mm, values):
        return central_difference(lambda moved: self.distance(moved, points_mm), values, STEP)


FACES = [Face(lambda _, at, axis=axis, place=place: at[axis] - place) for axis, place in PLANES]
FACES += [
    Face(lambda _, at: at[2] - THICK_MM),
    Face(lambda values, at: at[0] - values[1]),
    Face(lambda values, at: np.hypot(at[0], at[1]) - values[0]),
]


@pytest.fixture(scope="module")
def moved() -> MovedMesh:
    radius, half = VALUES
    with cad_session("strip") as gmsh:
        occ = gmsh.model.occ
        strip = occ.addBox(0, 0, 0, half, LENGTH_MM, THICK_MM)
        hole = occ.addCylinder(0, 0, 0, 0, 0, THICK_MM, radius)
        occ.cut([(3, strip)], [(3, hole)])
        occ.synchronize()
        for option, value in (("MeshSizeMax", 3.0), ("MeshSizeFromCurvature", 48)):
            gmsh.option.setNumber(f"Mesh.{option}", value)
        mesh = generate(gmsh, True, stresses=True, regular=False)
    return MovedMesh(mesh, FACES, VALUES, lambda points: np.zeros(points.shape[2], dtype=bool), "strip")


def held(model: Elasticity) -> np.ndarray:
    return np.concatenate(
        [3 * np.flatnonzero(np.abs(model.nodes_mm[axis]) < 1e-6) + axis for axis in (0, 1, 2)]
    )


def pull(model: Elasticity) -> np.ndarray:
    """Evenly over the end of a quarter of the strip, half its thickness."""
    end = faces_where(model, lambda p: np.abs(p[1] - LENGTH_MM) < 1e-9)
    force = pressure_force(model, end, -np.ones(end.dx.shape))
    return PULL_N / 4 * force / force[1::3].sum()


def judged(unit: UnitStress) -> JudgedSurface:
    """Full load and none."""
    at_hole = np.hypot(*unit.surface.points_mm[:2]) < VALUES[0] + 1.0
    return JudgedSurface(unit.stress, (np.array([[0.0], [1.0]]),), np.flatnonzero(at_hole))


def solved(model: Elasticity) -> UnitStress:
    return UnitStress(model, model.equations.solver(held(model))(pull(model)[:, None]).T, ELASTIC, PLANES)


def safety(local):
    """Half of the range is amplitude and mean: their sum is the largest stress."""
    return LIMIT_MPA / (local.amplitude_MPa + np.abs(local.mean_MPa))


def least(unit: UnitStress):
    return least_safety(judged(unit), lambda _: safety)


def log_slopes(moved: MovedMesh) -> np.ndarray:
    """Of the smooth safety by radius and half width: the pull stays as evenly spread, by its own slope."""
    model = assemble(moved.mesh, *ELASTIC)
    unit = solved(model)
    found = least(unit)
    by_fields, by_nodes = unit.adjoint(found.adjoint)
    adjoint = model.equations.solver(held(model))(by_fields.T).T
    by_nodes = by_nodes - sums_of_work_slopes(model, *ELASTIC, unit.displacement_mm, adjoint[None])[0]
    motion = moved.velocities(moved.mesh, moved.values)
    step = 1e-4
    loads = [
        pull(assemble(moved.at(VALUES + sign * step * unit_vector), *ELASTIC)) @ adjoint[0]
        for unit_vector in np.eye(2)
        for sign in (1, -1)
    ]
    by_loads = np.array([loads[0] - loads[1], loads[2] - loads[3]]) / (2 * step)
    return (np.einsum("in,inp->p", by_nodes, motion) + by_loads) / found.value


def test_the_stress_at_the_hole_is_that_of_howland(moved: MovedMesh) -> None:
    """By the mean stress in the narrowest section; in the middle of the thickness it is a little larger."""
    share = VALUES[0] / VALUES[1]
    factor = 3.0 - 3.14 * share + 3.667 * share**2 - 1.527 * share**3
    mean = PULL_N / (2 * THICK_MM * 2 * (VALUES[1] - VALUES[0]))
    found = least(solved(assemble(moved.mesh, *ELASTIC))).extreme
    assert LIMIT_MPA / found == pytest.approx(factor * mean, rel=0.04)


def test_its_slopes_are_those_of_the_moved_mesh(moved: MovedMesh) -> None:
    slopes, step = log_slopes(moved), 1e-3
    for column, unit_vector in enumerate(np.eye(2)):
        above, below = (
            np.log(least(solved(assemble(moved.at(VALUES + sign * step * unit_vector), *ELASTIC))).value)
            for sign in (1, -1)
        )
        assert slopes[column] == pytest.approx((above - below) / (2 * step), rel=1e-4)
