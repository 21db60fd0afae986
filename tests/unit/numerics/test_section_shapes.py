"""Deformations of a round section: how many, orthogonal to its rigid motions, and alike from every side."""

from __future__ import annotations

import math

import numpy as np
import pytest

from cranktopo.numerics.section_shapes import SectionShapes

RADIUS_MM, BORE_MM = 21.0, 12.0


def grid(count: int = 400) -> tuple[np.ndarray, np.ndarray]:
    """Points spread evenly over the section."""
    radius = np.sqrt(np.linspace(BORE_MM**2, RADIUS_MM**2, count))
    angle = 2 * math.pi * np.arange(count) / count
    x, y = np.outer(radius, np.cos(angle)), np.outer(radius, np.sin(angle))
    return x.ravel(), y.ravel()


@pytest.mark.parametrize(("degree", "count"), [(0, 0), (1, 3), (2, 12), (3, 24)])
def test_polynomials_less_rigid_motions(degree: int, count: int) -> None:
    """Three components of (d + 1)(d + 2) / 2 monomials, six of them rigid."""
    shapes = SectionShapes(RADIUS_MM, BORE_MM, degree)
    assert shapes.count == count
    even, odd = shapes.having("even"), shapes.having("odd")
    assert sorted([*even, *odd]) == sorted(shapes.having("none")) == list(range(count))


def test_they_do_no_work_with_forces_of_a_rigid_section() -> None:
    x, y = grid()
    moved = SectionShapes(RADIUS_MM, BORE_MM, 3).at(x, y)
    rigid = [moved[0], moved[1], moved[2], y[:, None] * moved[2], x[:, None] * moved[2]]
    rigid.append(x[:, None] * moved[1] - y[:, None] * moved[0])
    size = np.abs(moved).max()
    for part in rigid:
        assert np.abs(part.mean(axis=0)).max() < 5e-3 * size * max(1.0, np.abs(part).max() / size)


@pytest.mark.parametrize("angle_deg", [180.0, 120.0, -37.0])
def test_a_turned_section_has_the_same_deformations(angle_deg: float) -> None:
    shapes, angle = SectionShapes(RADIUS_MM, BORE_MM, 3), math.radians(angle_deg)
    turned = shapes.turned(angle)
    amplitudes = np.random.default_rng(3).standard_normal(shapes.count)
    x, y = grid(30)
    c, s = math.cos(angle), math.sin(angle)
    own = shapes.at(c * x + s * y, c * y - s * x) @ amplitudes
    expected = np.stack([c * own[0] - s * own[1], s * own[0] + c * own[1], own[2]])
    assert shapes.at(x, y) @ turned @ amplitudes == pytest.approx(expected, abs=1e-8 * np.abs(own).max())
    assert turned @ shapes.turned(-angle) == pytest.approx(np.eye(shapes.count), abs=1e-9)


def test_shapes_move_across_or_along() -> None:
    shapes = SectionShapes(RADIUS_MM, BORE_MM, 2)
    moved = shapes.at(*grid(20))
    assert np.abs(moved[2][:, ~shapes.axial]).max() == 0.0
    assert np.abs(moved[:2][:, :, shapes.axial]).max() == 0.0
    assert shapes.axial.sum() == 3
