"""The spline outline: against SciPy's spline, against a circle, and its refusals."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from cranktopo.base.errors import CranktopoError
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.throw.profile import ProfileWeb, flank_half_width_mm, flank_through, largest_half_width_mm

STATIONS = [-26.0, -20.0, -3.0, 24.0, 52.0, 69.0, 75.0]
HALF_WIDTHS = [0.0, 21.0, 33.0, 38.0, 31.0, 18.0, 0.0]


def web(stations: list[float], half_widths: list[float]) -> ProfileWeb:
    return ProfileWeb(
        thickness_mm=19.0,
        outline="profile",
        stations_mm=tuple(stations),
        half_widths_mm=tuple(half_widths),
    )


@pytest.mark.parametrize("round_ends", [True, False])
def test_flank_is_the_cubic_spline_over_chord_length(round_ends: bool) -> None:
    half = np.array(HALF_WIDTHS) + (0.0 if round_ends else 6.0)
    points = np.column_stack([half, STATIONS])
    chord = np.concatenate([[0], np.cumsum(np.linalg.norm(np.diff(points, axis=0), axis=1))])
    x = CubicSpline(chord, half, bc_type="natural")
    y = CubicSpline(chord, STATIONS, bc_type="clamped" if round_ends else "natural")
    flank = web(STATIONS, list(half)).flank
    u = np.linspace(0, 1, 23)
    for piece, points in enumerate(flank.at(u)):
        at = chord[piece] + u * (chord[piece + 1] - chord[piece])
        assert points[:, 0] == pytest.approx(x(at), abs=1e-10)
        assert points[:, 1] == pytest.approx(y(at), abs=1e-10)


def test_curvature_is_continuous_at_every_station() -> None:
    bend = web(STATIONS, HALF_WIDTHS).flank.curvature_per_mm(np.array([0.0, 1.0]))
    assert bend[1:, 0] == pytest.approx(bend[:-1, 1], rel=1e-9)


def test_round_ends_make_a_circle_a_circle() -> None:
    """Eleven points of a circle about y = 24: radius to 2e-4 everywhere, curvature to 1 %."""
    angle = np.linspace(-np.pi / 2, np.pi / 2, 11)
    flank = flank_through(40 * np.cos(angle), 24 + 40 * np.sin(angle), (True, True))
    points = flank.at(np.linspace(0, 1, 50)).reshape(-1, 2)
    assert np.hypot(points[:, 0], points[:, 1] - 24) == pytest.approx(40.0, rel=2e-4)
    assert flank.curvature_per_mm(np.linspace(0, 1, 50)) == pytest.approx(1 / 40, rel=1e-2)


def test_half_width_inverts_the_curve() -> None:
    flank = web(STATIONS, HALF_WIDTHS).flank
    points = flank.at(np.linspace(0.01, 0.99, 40)).reshape(-1, 2)
    assert flank_half_width_mm(flank, points[:, 1]) == pytest.approx(points[:, 0], abs=1e-9)
    assert flank_half_width_mm(flank, np.array([-26.1, 75.1])) == pytest.approx([0.0, 0.0])
    dense = flank_half_width_mm(flank, np.linspace(-26, 75, 20001))
    assert largest_half_width_mm(flank) == pytest.approx(dense.max(), abs=1e-6)
    assert largest_half_width_mm(flank) > max(HALF_WIDTHS)


def test_a_curve_that_folds_back_is_refused(mikron: Scene) -> None:
    half = [0.0, 34.0, 8.0, 38.0, 31.0, 18.0, 0.0]
    stations = [-26.0, -25.5, -3.0, 24.0, 52.0, 69.0, 75.0]
    table = {"thickness_mm": 19.0, "outline": "profile", "stations_mm": stations, "half_widths_mm": half}
    with pytest.raises(CranktopoError, match=r"folds back between the stations at -26 and -25\.5 mm"):
        scene_with_web(mikron, table)
