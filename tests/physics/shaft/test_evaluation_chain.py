"""Throws chained into a shaft, against a frame of beams assembled in one piece, and the Mikron's shaft."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.loading import load_scene
from cranktopo.numerics.tetrahedra.rigid_motions import RZ
from cranktopo.tasks.shaft.assembly import Bearings, shaft_matrix, shaft_stiffness, throw_blocks, throw_matrix
from cranktopo.tasks.shaft.stage import evaluate_shaft
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import Target
from tests.physics.fea.evaluation_cases import elastic, mikron_with

Array = NDArray[np.float64]
CRANK_MM = [(0, 0, 0), (0, 0, 20), (6, 48, 22), (6, 48, 60), (0, 0, 62), (0, 0, 80)]
"""Axis of a crank throw; the pin sits 6 mm beside the throw plane so that nothing decouples."""
YOUNGS, SHEAR, AREA, INERTIA = 210e3, 80e3, 1300.0, 150e3
SPRING_N_PER_MM = 3e5


def beam(start: Array, end: Array) -> Array:
    """Euler-Bernoulli beam of round section between two points in space, (12, 12)."""
    length = float(np.linalg.norm(end - start))
    axial, twist = YOUNGS * AREA / length, SHEAR * 2 * INERTIA / length
    a, b, c = (f * YOUNGS * INERTIA / length**p for f, p in ((12, 3), (6, 2), (4, 1)))
    local = np.zeros((12, 12))
    for i, k in ((0, axial), (3, twist)):
        local[np.ix_([i, i + 6], [i, i + 6])] += k * np.array([[1, -1], [-1, 1]])
    for (u, r), sign in (((1, 5), 1.0), ((2, 4), -1.0)):
        s = sign * b
        local[np.ix_([u, r, u + 6, r + 6], [u, r, u + 6, r + 6])] += np.array(
            [[a, s, -a, s], [s, c, -s, c / 2], [-a, -s, a, -s], [s, c / 2, -s, c]]
        )
    x = (end - start) / length
    y = np.cross([0.3, 0.9, 0.2], x)
    y /= np.linalg.norm(y)
    turn = np.kron(np.eye(4), np.stack([x, y, np.cross(x, y)]))
    return np.asarray(turn.T @ local @ turn)


def frame(points: Array, kept: list[int]) -> Array:
    """Beams along a polygon, condensed to the motions of some of its points."""
    total = np.zeros((6 * len(points),) * 2)
    for i, (start, end) in enumerate(pairwise(points)):
        total[6 * i : 6 * i + 12, 6 * i : 6 * i + 12] += beam(start, end)
    index = [6 * p + m for p in kept for m in range(6)]
    rest = np.setdiff1d(np.arange(len(total)), index)
    inner = np.linalg.solve(total[np.ix_(rest, rest)], total[np.ix_(rest, index)])
    return np.asarray(total[np.ix_(index, index)] - total[np.ix_(index, rest)] @ inner)


def polygon(angles_deg: tuple[float, ...]) -> tuple[Array, list[int]]:
    """Points of a whole shaft in global axes, and which of them are its main sections."""
    points: list[Array] = [np.zeros(3)]
    for index, angle in enumerate(np.radians(angles_deg)):
        c, s = math.cos(angle), math.sin(angle)
        turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
        points += [turn @ np.array(p) + [0, 0, 80.0 * index] for p in CRANK_MM[1:]]
    return np.array(points), list(range(0, len(points), len(CRANK_MM) - 1))


def twisted(stiffness: Array, bearings: Bearings) -> Array:
    """Turns of the sections under a unit torque, one rigid motion held at a time, by plain elimination."""
    count = len(stiffness) // 6
    loaded = stiffness.copy()
    radial = [6 * s + m for s in range(count) for m in (0, 1)]
    held = {2, RZ}
    if bearings == "spring":
        loaded[radial, radial] += SPRING_N_PER_MM
    elif bearings == "rigid":
        held |= set(radial)
    else:
        held |= {0, 1, 3, 4}
    kept = [i for i in range(len(stiffness)) if i not in held]
    turn, torque = np.zeros(len(stiffness)), np.zeros(len(stiffness))
    torque[-6 + RZ] = 1.0
    turn[kept] = np.linalg.solve(loaded[np.ix_(kept, kept)], torque[kept])
    return turn[RZ::6]


@pytest.mark.parametrize("bearings", ["free", "rigid", "spring"])
@pytest.mark.parametrize("angles_deg", [(0.0,), (0.0, 180.0, 180.0, 0.0), (0.0, 120.0, 250.0)])
def test_chain_of_beam_cranks(angles_deg: tuple[float, ...], bearings: Bearings) -> None:
    """Throws turned and chained by their end matrices, against the same polygon in global axes at once."""
    throw = frame(np.array(CRANK_MM, dtype=float), [0, len(CRANK_MM) - 1])
    whole = frame(*polygon(angles_deg))
    chain = shaft_matrix(throw, angles_deg)
    assert np.abs(chain - whole).max() < 1e-8 * np.abs(whole).max()
    found = shaft_stiffness(chain, bearings, SPRING_N_PER_MM)
    steps = np.diff(twisted(whole, bearings))
    assert found.throws_Nm_per_rad == pytest.approx(1 / steps / 1000, rel=1e-5)
    assert found.end_to_end_Nm_per_rad == pytest.approx(1 / steps.sum() / 1000, rel=1e-5)


@pytest.mark.slow
def test_mikron_shaft_on_rigid_bearings() -> None:
    """Four sharp throws 0-180-180-0: 152.5 kN m/rad a throw, between 138.2 free and 187.3 held."""
    scene = mikron_with(fillet_mm=0.0)
    mesh = mesh_throw(scene, 6.3).mesh
    throw = throw_matrix(throw_blocks(elastic(mesh, scene), scene, mesh.mirrored))
    alone = shaft_stiffness(shaft_matrix(throw, (0.0,)), "free")
    assert alone.end_to_end_Nm_per_rad == pytest.approx(138.2e3, rel=5e-3)
    shaft = shaft_stiffness(shaft_matrix(throw, (0.0, 180.0, 180.0, 0.0)), "rigid")
    print(shaft)
    assert 4 * shaft.end_to_end_Nm_per_rad == pytest.approx(152.5e3, rel=5e-3)


def test_a_shaft_of_one_throw_has_the_bound_of_the_throw() -> None:
    """With free bearings both are the same problem; the shaft adds energies, the throw shares of its own."""
    target = Target("piston", load_scene("opposed-piston"))
    shaft = evaluate_shaft(target, "free", 24.0)
    throw = evaluate(target, 24.0).fine
    assert shaft.stiffness.end_to_end_Nm_per_rad == pytest.approx(throw.torsion["free"], rel=1e-5)
    assert shaft.error_percent == pytest.approx(throw.torsion_error_percent["free"], rel=0.05)
