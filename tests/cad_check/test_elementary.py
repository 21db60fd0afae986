"""Elementary surfaces recognised by samples of their closed forms; what is nearly one is none."""

from __future__ import annotations

import numpy as np
import pytest

from tests.cad_check.elementary import Array, elementary, torus_of

RING, TUBE, SLOPE = 7.0, 2.0, 0.3
U, V = (grid.ravel() for grid in np.meshgrid(np.linspace(0.1, 1.2, 7), np.linspace(0.2, 1.4, 7)))
OUT = np.stack([np.cos(U), np.sin(U), np.zeros_like(U)], axis=1)
UP = np.array([0.0, 0.0, 1.0])
TURN = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
NONE = np.zeros_like(U)
Samples = tuple[Array, Array, Array]


def placed(points: Array, normals: Array, first: Array, second: Array) -> Samples:
    """Somewhere in space; curvatures count toward the normal."""
    return points @ TURN.T + 5.0, normals @ TURN.T, np.stack([first, second], axis=1)


def tube(ring: Array | float) -> Samples:
    """Part of a torus, whose ring's radius may vary along it, which leaves the normals as they were."""
    way = np.cos(V)[:, None] * OUT + np.sin(V)[:, None] * UP
    middle = np.asarray(ring).reshape(-1, 1) * OUT
    across = np.cos(V) / (RING + TUBE * np.cos(V))
    return placed(middle + TUBE * way, way, NONE - 1 / TUBE, -across)


def cone(squeezed: float = 1.0) -> Samples:
    """With V the height below its apex; or squeezed across."""
    points = np.array([1.0, squeezed, 1.0]) * ((SLOPE * V)[:, None] * OUT - V[:, None] * UP)
    normals = (OUT * [1.0, 1 / squeezed, 1.0]) + SLOPE * UP
    normals /= np.linalg.norm(normals, axis=1)[:, None]
    return placed(points, normals, NONE, -1 / (SLOPE * V * np.hypot(1, SLOPE)))


def cylinder(squeezed: float = 1.0) -> Samples:
    """Round or elliptical."""
    normals = OUT * [1.0, 1 / squeezed, 1.0]
    size = np.linalg.norm(normals, axis=1)
    points = TUBE * OUT * [1.0, squeezed, 1.0] + V[:, None] * UP
    return placed(points, normals / size[:, None], NONE, -1 / (TUBE * squeezed**2 * size**3))


def sphere() -> Samples:
    way = np.cos(V)[:, None] * OUT + np.sin(V)[:, None] * UP
    return placed(TUBE * way, way, NONE - 1 / TUBE, NONE - 1 / TUBE)


def plane() -> Samples:
    return placed(np.stack([U, V, NONE], axis=1), np.tile(UP, (len(U), 1)), NONE, NONE)


@pytest.mark.parametrize(
    ("samples", "name"),
    [
        (plane(), "Plane"),
        (cylinder(), "Cylinder"),
        (cylinder(1.01), ""),
        (cone(), "Cone"),
        (cone(1.01), ""),
        (sphere(), "Sphere"),
        (tube(RING), "Torus"),
        (tube(RING * (1 + 0.02 * U**2)), ""),
    ],
)
def test_recognised(samples: Samples, name: str) -> None:
    assert elementary(*samples, same=1e-6) == name


def test_a_torus_by_its_radii_and_axis() -> None:
    found = torus_of(*tube(RING))
    assert (found.ring_mm, found.tube_mm) == pytest.approx((RING, TUBE), rel=1e-9)
    assert abs(float(found.axis @ TURN @ UP)) == pytest.approx(1.0, abs=1e-12)
