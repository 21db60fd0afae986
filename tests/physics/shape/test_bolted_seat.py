"""No search cuts the seat of a bolted counterweight or the threads of its bolts."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.base.arrays import Array
from cranktopo.bodies.seat import cut_seat_text, seat_cuts
from cranktopo.bodies.solid.files import kernel_surface_of
from cranktopo.design.bolt_holes import bolt_holes
from cranktopo.design.goal.limit import Goal, Limit
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import double_precision
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.tasks.refit.family import Layout, exact_web_of
from cranktopo.tasks.refit.fit import fit_problem, scene_with_web, usual_limits
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.refit.read_web import WebRead
from cranktopo.tasks.refit.search import Fit, minimise_misfit
from cranktopo.tasks.web_shape.optimum import ShapeSettings
from cranktopo.tasks.web_shape.rules import Rules, rules_at
from cranktopo.tasks.web_shape.stage import optimise_shape
from cranktopo.tasks.web_shape.start import scene_start
from cranktopo.throw.fitted_pocket import FittedCylinder
from tests.unit.bodies.test_bolt_holes import PAIR
from tests.unit.bodies.test_seat import WEIGHT, with_weight

DEEP = PAIR | {"engagement_mm": 12.0}
"""A seat of 12 mm below an outline of 30 mm about the crank axis: what lies beyond 18 mm stays."""
THIN = {key: value for key, value in DEEP.items() if key != "places_mm"} | {"engagement_mm": 6.0}
"""One of 6 mm, its bolts not placed: what lies beyond 24 mm stays."""
POCKET = FittedCylinder("journal")
SEAT = "the cylinder pocket of the journal face does not cut the seat of the bolted counterweight"
THREADS = "the cylinder pocket of the journal face does not cut the threads of the counterweight's bolts"
NONE = (np.zeros(0),) * 3


@pytest.fixture(scope="module")
def scene() -> Scene:
    return with_weight(WEIGHT, bolted_joint=[DEEP])


def pocketed(
    scene: Scene, y: float, diameter: float, depth: float, kind: FittedCylinder = POCKET
) -> tuple[Layout, Array]:
    """The scene's own web as one of the family, with a pocket in its middle."""
    start = scene_start(scene, usual_limits(scene))
    layout = Layout(start.layout.stations, (kind,))
    named = {"y": y, "diameter": diameter, "depth": depth}
    own = [named[name] for name in kind.names]
    return layout, np.concatenate([start.values, own])


def rules(scene: Scene, layout: Layout, values: Array) -> Rules:
    return rules_at(scene, ParametricWeb(layout, scene, usual_limits(scene), NONE), values)


def excess(found: Rules, name: str) -> float:
    return float(found.excess[found.names.index(name)])


@pytest.mark.parametrize(("y", "diameter"), [(-14.0, 4.0), (-14.0, 9.0), (-20.0, 5.0), (-9.0, 21.0)])
def test_a_pocket_breaks_the_rule_by_how_deep_it_cuts_the_seat(
    scene: Scene, y: float, diameter: float
) -> None:
    """Polar oracle: on the line away from the crankpin the seat begins 18 mm from the crank axis."""
    found = rules(scene, *pocketed(scene, y, diameter, 6.0))
    inside = min(-y, 30.0) + diameter / 2 - 18.0
    deepest = inside if -y < 18.0 else diameter / 2  # from a point on its axis
    assert excess(found, SEAT) == pytest.approx(deepest, abs=0.3)
    assert (SEAT in found.violated) == (inside > 0)


def test_a_pocket_breaks_the_rule_of_threads_by_its_distance(scene: Scene) -> None:
    """A pocket from the journal face in the plane x = 0: both threads are 12 mm aside, 3 mm in radius."""
    found = rules(scene, *pocketed(scene, -20.0, 10.0, 15.0))
    assert excess(found, THREADS) == pytest.approx(5.0 - (12.0 - 3.0), abs=0.05)
    assert THREADS not in found.violated
    found = rules(scene, *pocketed(scene, -20.0, 20.0, 15.0))
    assert excess(found, THREADS) == pytest.approx(10.0 - (12.0 - 3.0), abs=0.05)
    assert THREADS in found.violated


def test_gradients_of_the_rules_are_those_of_differences(scene: Scene) -> None:
    layout, values = pocketed(scene, -13.0, 7.0, 6.0)
    found = rules(scene, layout, values)
    place = found.names.index(SEAT)
    for k in (0, 2, *range(layout.stations, len(values))):
        step = 1e-4 * np.eye(len(values))[k]
        above, below = (rules(scene, layout, values + s * step).excess[place] for s in (1, -1))
        assert found.gradients[place, k] == pytest.approx((above - below) / 2e-4, rel=1e-3, abs=1e-4), k


def test_heads_and_floors_of_bolts_keep_to_the_outline_that_moves(scene: Scene) -> None:
    """A web 8 mm shorter below lifts heads by as much, and threads into the bore."""
    start = scene_start(scene, usual_limits(scene))
    names = {
        "heads of the counterweight's bolts lie below its rim": 1.0,
        "the bore of the main journal does not cut the threads of the counterweight's bolts": None,
    }
    own = rules(scene, start.layout, start.values)
    for name in names:
        assert name not in own.violated
    bolt = bolt_holes(scene)[1]
    out = bolt.head_radius_mm + 0.1 + bolt.x_mm
    rim = math.sqrt(62.0**2 - out**2)
    name = "heads of the counterweight's bolts lie below its rim"
    assert excess(own, name) == pytest.approx(0.02 - rim - bolt.head_end_mm, abs=0.05)
    shorter = start.values + 8.0 * (np.arange(start.values.size) == 0)
    moved = rules(scene, start.layout, shorter)
    assert (
        "the bore of the main journal does not cut the threads of the counterweight's bolts" in moved.violated
    )


def test_one_piece_or_none_has_no_such_rule() -> None:
    for weight in (None, {**WEIGHT, "density_kg_m3": None}):
        bare = with_weight(weight)
        names = rules(bare, *pocketed(bare, -20.0, 6.0, 6.0)).names
        assert not [name for name in names if "bolt" in name]


def web_with_pocket() -> Scene:
    """A pocket from the crankpin's face through which the seat would be lost."""
    data: dict[str, Any] = with_weight(WEIGHT, bolted_joint=[THIN]).model_dump(mode="json", exclude_none=True)
    pocket = {"shape": "cylinder", "face": "pin", "x_mm": 0.0, "y_mm": -26.0}
    data["web"]["pocket"] = [pocket | {"diameter_mm": 5.0, "depth_mm": 8.0}]
    return scene_from_dict(data, "pocketed")


def test_a_design_s_own_pocket_in_the_seat_is_told(scene: Scene) -> None:
    assert seat_cuts(scene) == ()
    assert cut_seat_text(scene) == ""
    assert "web.pocket[0] cut the seat of web.counterweight" in cut_seat_text(web_with_pocket())


@pytest.mark.slow
def test_a_re_model_leaves_the_seat_though_the_body_has_a_hole_there() -> None:
    """The fit begins with the body's own pocket in the seat, and ends clear of it."""
    body = solid_of(kernel_surface_of(web_with_pocket(), "half"), "body")
    free = with_weight(WEIGHT, bolted_joint=[THIN])
    layout, values = pocketed(free, -26.0, 5.0, 8.0, FittedCylinder("pin"))
    problem = fit_problem(body, free, replace(usual_limits(free), min_wall_mm=1.0), 2.0)
    kept, error = minimise_misfit(Fit(problem, layout), values, (2.0, 1.0))
    assert np.isfinite(error)
    fitted = scene_with_web(free, exact_web_of(layout, kept, free))
    assert seat_cuts(fitted) == ()
    assert lost_of_seat_mm3(fitted) < 0.5
    assert lost_of_seat_mm3(web_with_pocket()) == pytest.approx(math.pi * 2.5**2 * 8.0, rel=0.1)


def lost_of_seat_mm3(scene: Scene) -> float:
    """What the kernel's web lacks below 24 mm from the crank axis, beside its outline."""
    bare = scene.model_copy(update={"web": scene.web.model_copy(update={"pocket": (), "bevel": ()})})
    web, whole = (solid_of(kernel_surface_of(one, "web"), "web") for one in (scene, bare))
    (start, end), reach = scene.web_z_mm, 80.0
    inner = Manifold.cylinder(end - start, 24.0, 24.0, 512).translate((0.0, 0.0, start))
    below = Manifold.cube((2 * reach, reach, end - start)).translate((-reach, -reach, start))
    return float(((whole - web) ^ (below - inner)).volume())


@pytest.mark.slow
def test_shape_never_cuts_the_seat() -> None:
    """The lightest web that is stiff enough, from one whose pocket would grow into the seat."""
    room = {"shape": "box", "half_width_mm": 64.0, "y_min_mm": -66.0, "y_max_mm": 80.0}
    scene = with_weight({**WEIGHT, "density_kg_m3": 7850.0}, bolted_joint=[THIN], envelope=room)
    layout, values = pocketed(scene, -20.8, 6.0, 6.0, FittedCylinder("pin"))
    limits = replace(usual_limits(scene), min_wall_mm=1.0)
    settings = ShapeSettings(6.0, 12.0, 2, 12.0, limits, features=False)
    goal = Goal("minimise", "mass", (Limit("torsion", ">=", 90.0, percent=True),))
    with double_precision():
        found = optimise_shape(scene, goal, settings, None, WebRead(layout, values))
    shaped = found.result.web.scene
    assert shaped.web.pocket
    assert seat_cuts(shaped) == ()
    assert found.result.web.values["mass"] < 0.97 * found.original.values["mass"]
    (pocket,) = shaped.web.pocket
    assert pocket.diameter_mm / 2 - pocket.y_mm < 24.0
