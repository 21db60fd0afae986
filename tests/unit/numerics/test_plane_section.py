"""Sections of bodies with a face in the cutting plane: what is cut on both sides of it, and nothing else."""

from __future__ import annotations

from math import asin, cos, pi, radians, sin, sqrt

import numpy as np
import pytest
from manifold3d import CrossSection, Manifold

from cranktopo.numerics.surfaces.plane_section import section_x, section_y
from cranktopo.tasks.crank_drawing.crank_shape import CrankShape, Piece
from cranktopo.tasks.crank_drawing.crank_views import Lengthwise, lengthwise

LOW, HIGH, THICK, AWAY = 30.0, 70.0, 11.0, 25.0
"""Top of a web at x = 0, corner of its counterweight, thickness, distance of two webs."""
TURNS_DEG = [
    pytest.param(turn, marks=[pytest.mark.slow] * (number % 2))
    for number, turn in enumerate(np.random.default_rng(7).uniform(0.0, 360.0, 12))
]


def web(from_deg: float, to_deg: float, turn_deg: float) -> Manifold:
    """A round web with a triangle about the axis, its flanks at two angles to +y, made turned back."""
    corners = [
        (-HIGH * sin(radians(one - turn_deg)), HIGH * cos(radians(one - turn_deg)))
        for one in (from_deg, to_deg)
    ]
    outline = CrossSection([[(0.0, 0.0), *corners]]) + CrossSection.circle(LOW, 360)
    return Manifold.extrude(outline, THICK).rotate((0.0, 0.0, turn_deg))


def upper(section: CrossSection) -> float:
    """Area of a section above the axis, mm2."""
    return float((section ^ CrossSection.square((1e3, 1e3)).translate((-500.0, 0.0))).area())


@pytest.mark.parametrize("turn_deg", TURNS_DEG)
def test_a_flank_in_the_plane_is_not_cut(turn_deg: float) -> None:
    """A counterweight on one side of the plane leaves the web's section; one across it its chord."""
    for span in ((0.0, 60.0), (-60.0, 0.0)):
        body = web(*span, turn_deg)
        assert upper(section_x(body)) == pytest.approx(THICK * LOW, rel=1e-4)
        turned = body.rotate((0.0, 0.0, 90.0))  # the flank in y = 0, to -x
        assert section_y(turned, 0.0).area() == pytest.approx(2 * THICK * LOW, rel=1e-4)
    across = web(-20.0, 60.0, turn_deg)
    chord = HIGH * cos(radians(40.0)) / cos(radians(20.0))
    assert upper(section_x(across)) == pytest.approx(THICK * chord, rel=1e-4)


@pytest.mark.parametrize("span", [(0.0, 60.0), (-60.0, 0.0), (-20.0, 60.0), (30.0, 75.0)])
def test_it_is_the_lesser_of_both_limits(span: tuple[float, float]) -> None:
    """Limits from both sides, of slices ever nearer to the plane, against the section."""
    body = web(*span, 0.0)
    turned = body.rotate((0.0, -90.0, 0.0))
    sides = [[turned.slice(way * off).area() for off in (0.4, 0.2)] for way in (-1.0, 1.0)]
    limits = [2 * near - far for far, near in sides]  # a flank is straight
    assert section_x(body).area() == pytest.approx(min(limits), rel=1e-3)
    apart = abs(limits[0] - limits[1]) > 0.1 * min(limits)
    assert apart == (0.0 in span), "a face in the plane alone makes them differ"


def test_a_bored_ball_off_the_plane() -> None:
    """Area and place of a section without a face in its plane: a circle less the strip of a bore along it."""
    ball = Manifold.sphere(20.0, 720).translate((5.0, 3.0, -8.0))
    bore = Manifold.cylinder(80.0, 4.0, circular_segments=720, center=True).translate((0.0, 3.0, -8.0))
    section, square = section_x(ball - bore), 20.0**2 - 5.0**2
    strip = 2 * (4.0 * sqrt(square - 4.0**2) + square * asin(4.0 / sqrt(square)))
    assert section.area() == pytest.approx(pi * square - strip, rel=1e-3)
    left, low, right, high = section.bounds()
    assert ((left + right) / 2, (low + high) / 2) == pytest.approx((-8.0, 3.0), abs=0.01)


def drawn(*bodies: Manifold) -> Lengthwise:
    """Lines of a crank of webs, one behind the other."""
    pieces = tuple(Piece(one.translate((0.0, 0.0, AWAY * k))) for k, one in enumerate(bodies))
    return lengthwise(CrankShape("webs", (), (), pieces))


@pytest.mark.parametrize("turn_deg", TURNS_DEG)
def test_no_skin_of_a_part_that_is_cut_away_is_drawn(turn_deg: float) -> None:
    """On the viewer's side the counterweight is gone; behind the plane its flank is seen, and is not hatched.

    Blocks without hatching stood over webs whose counterweights end in the plane of the section.
    """
    near, far, through = (web(*span, turn_deg) for span in ((0.0, 60.0), (-60.0, 0.0), (-20.0, 60.0)))
    view = drawn(through, far, near)
    chord = HIGH * cos(radians(40.0)) / cos(radians(20.0))
    cut = sum(CrossSection([one]).area() for one in view.cut)
    assert cut == pytest.approx(THICK * (2 * LOW + chord), rel=1e-3)
    tops = [
        max(
            chain[:, 1].max()
            for chain in view.chains
            if abs(chain[:, 0].mean() - AWAY * k - THICK / 2) < THICK
        )
        for k in range(3)
    ]
    behind = max(chord, HIGH * cos(radians(20.0)))
    assert tops == pytest.approx([behind, HIGH, LOW], abs=0.2)
