"""By which shapes sections mainly deform: orthogonal to rigid motions, the same ones when turned."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.quadrature import gauss_legendre
from cranktopo.numerics.section_shapes import WARPS, WarpShapes

SHAPES = WarpShapes(21.0, 12.0)
ANGLE = np.linspace(0.0, 2 * np.pi, 24, endpoint=False)


def points() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Points of the section and their weights."""
    nodes, weights = gauss_legendre(6)
    radius = SHAPES.bore_mm + (SHAPES.radius_mm - SHAPES.bore_mm) * (nodes + 1) / 2
    x, y = np.outer(radius, np.cos(ANGLE)), np.outer(radius, np.sin(ANGLE))
    return x.ravel(), y.ravel(), np.repeat(weights * radius, ANGLE.size)


def test_they_do_no_work_under_forces_that_move_a_section_as_a_whole() -> None:
    """Bearings and neighbours push on the mean motion alone."""
    x, y, weight = points()
    moved, zero, one = SHAPES.at(x, y), np.zeros_like(x), np.ones_like(x)
    rigid = [(one, zero, zero), (zero, one, zero), (zero, zero, one)]
    rigid += [(zero, zero, y), (zero, zero, -x), (-y, x, zero)]
    for motion in rigid:
        work = np.einsum("ip,ips,p->s", np.array(motion), moved, weight)
        assert np.abs(work).max() < 1e-9 * SHAPES.radius_mm * weight.sum()


@pytest.mark.parametrize("turn", [0.3, np.pi, -2.0])
def test_a_turned_section_has_the_same_ones(turn: float) -> None:
    x, y, _ = points()
    c, s = np.cos(turn), np.sin(turn)
    own = SHAPES.at(c * x + s * y, c * y - s * x)
    turned = np.stack([c * own[0] - s * own[1], s * own[0] + c * own[1], own[2]])
    assert turned == pytest.approx(SHAPES.at(x, y) @ SHAPES.turned(turn), abs=1e-12)


def test_each_is_even_or_odd() -> None:
    x, y, _ = points()
    mirrored = SHAPES.at(-x, y) * np.array([-1.0, 1.0, 1.0])[:, None, None]
    even, odd = SHAPES.having("even"), SHAPES.having("odd")
    assert sorted([*even, *odd]) == list(range(WARPS))
    here = SHAPES.at(x, y)
    assert mirrored[:, :, even] == pytest.approx(here[:, :, even], abs=1e-12)
    assert mirrored[:, :, odd] == pytest.approx(-here[:, :, odd], abs=1e-12)
    assert (np.abs(here[2]).max(axis=0) > 0).tolist() == SHAPES.axial.tolist()
