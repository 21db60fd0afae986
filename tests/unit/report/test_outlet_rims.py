"""Rims of rounded outlets in the drawing of the whole crank."""

from __future__ import annotations

import numpy as np
import pytest
from matplotlib.figure import Figure

from cranktopo.base.arrays import Array
from cranktopo.design.arrangement import Arrangement
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of
from cranktopo.numerics.surfaces.visible_edges import visible_edges
from cranktopo.tasks.crank_drawing.crank_shape import CrankShape, PlacedThrow
from cranktopo.tasks.crank_drawing.crank_views import draw_star
from cranktopo.tasks.crank_drawing.outlet_lines import outlet_rims, outside_of
from tests.physics.fea.test_two_webs import scene_with

ACROSS = {
    "diameter_mm": 5.0,
    "outlet_radius_mm": 1.0,
    "web": "first",
    "from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": 8.0},
    "to": {"on": "crankpin", "angle_deg": 0.0, "place_mm": 0.0},
}


def drilled(angle_deg: float) -> PlacedThrow:
    return PlacedThrow(scene_with({"drilling": [ACROSS]}), angle_deg, 100.0)


@pytest.mark.parametrize("angle_deg", [0.0, 120.0, 240.0])
def test_every_rim_is_closed_and_lies_on_its_journal(angle_deg: float) -> None:
    """By the distance from the axis of the main journal and of the pin, which the crank turns."""
    throw = drilled(angle_deg)
    main, pin = outlet_rims([throw], (0.0, 1000.0))
    turn, radius = np.radians(angle_deg), throw.scene.throw.radius_mm
    axis = radius * np.array([np.sin(turn), np.cos(turn)])
    journals = throw.scene.throw.main_journal, throw.scene.throw.crankpin
    for rim, centre, journal in zip((main, pin), (np.zeros(2), axis), journals, strict=True):
        away = np.linalg.norm(rim[:, :2] - centre, axis=1)
        assert away == pytest.approx(journal.radius_mm, abs=1e-9)
        assert rim[0] == pytest.approx(rim[-1], abs=1e-9)
    assert pin[:, 2].mean() == pytest.approx(100.0 + throw.scene.pitch_mm / 2, abs=1.0)


def test_rims_of_a_split_pin_turn_with_their_half() -> None:
    """Halves drilled alike: those of the first are 15 deg behind the throw, of the second as much ahead."""
    throw = PlacedThrow(scene_with({"drilling": [{**ACROSS, "web": "both"}]}), 0.0, 0.0)
    assert throw.scene.engine is not None
    arranged = Arrangement.model_validate({"layout": "V", "pin_splay_deg": 30.0})
    engine = throw.scene.engine.model_copy(update={"arrangement": arranged})
    split = PlacedThrow(throw.scene.model_copy(update={"engine": engine}), 0.0, 0.0)
    assert split.half_angles_deg == (-15.0, 15.0)
    straight = outlet_rims([throw], (0.0, 1000.0))
    for degrees, now, then in zip(
        (-15.0, -15.0, 15.0, 15.0), outlet_rims([split], (0.0, 1000.0)), straight, strict=True
    ):
        turn = np.radians(degrees)
        x, y, z = then.T
        placed = np.column_stack(
            [np.cos(turn) * x + np.sin(turn) * y, -np.sin(turn) * x + np.cos(turn) * y, z]
        )
        assert now == pytest.approx(placed, abs=1e-9)


def test_a_line_on_the_near_side_is_drawn_whole_and_one_behind_is_not() -> None:
    from manifold3d import Manifold

    cylinder = mesh_of(Manifold.cylinder(40.0, 20.0, 20.0, 180))
    turn = np.linspace(0, 2 * np.pi, 73)
    x, z = 4 * np.cos(turn), 20 + 4 * np.sin(turn)
    near = np.column_stack([x, np.sqrt(20.0**2 - x**2), z])
    view = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, 1.0], [0.0, 1.0, 0.0]])  # from +y

    def lengths(rim: Array) -> float:
        chains = visible_edges(
            SurfaceMesh(cylinder.vertices_mm @ view.T, cylinder.faces[:, ::-1]), 0.1, [rim @ view.T]
        )
        inside = [c for c in chains if np.linalg.norm(c - [0.0, 20.0], axis=1).max() < 5.0]
        return float(sum(np.linalg.norm(np.diff(c, axis=0), axis=1).sum() for c in inside))

    assert lengths(near) == pytest.approx(2 * np.pi * 4, rel=0.01)
    assert lengths(near * (1.0, -1.0, 1.0)) == 0.0


def test_a_rim_ends_where_the_crank_ends() -> None:
    """A throw at the free end, its outlet across the middle of the outer journal, stuck out."""
    throw = drilled(0.0)
    whole = outlet_rims([throw], (0.0, 1000.0))
    cut = outlet_rims([throw], (float(whole[0][:, 2].mean()), 1000.0))
    assert min(rim[:, 2].min() for rim in cut) >= whole[0][:, 2].mean() - 1e-6
    assert sum(map(len, cut)) < sum(map(len, whole))


def test_what_lies_in_the_quarter_that_is_cut_away_is_left_out() -> None:
    line = np.column_stack([np.linspace(-2, 2, 9), np.ones(9), np.zeros(9)])
    (kept,) = outside_of([line], np.array([-9.0, 0.0, -9.0]), np.array([0.0, 9.0, 9.0]))
    assert kept[:, 0].tolist() == [0.0, 0.5, 1.0, 1.5, 2.0]


@pytest.mark.parametrize(
    ("rotation", "told"),
    [
        (None, "arrow: sense of rotation, assumed"),
        ("clockwise", "arrow: sense of rotation"),
        ("counter-clockwise", "its crank is the mirror image"),
    ],
)
def test_the_arrow_of_the_star_says_what_is_known_of_the_rotation(rotation: str | None, told: str) -> None:
    """Not one thing on the drawing and another in the dossier."""
    throw = drilled(0.0)
    assert throw.scene.engine is not None
    engine = throw.scene.engine.model_copy(update={"rotation": rotation})
    turned = PlacedThrow(throw.scene.model_copy(update={"engine": engine}), 0.0, 0.0)
    axes = Figure().add_subplot()
    draw_star(axes, CrankShape("c", (turned,), (), ()))
    assert any(text.get_text().endswith(told) for text in axes.texts)
