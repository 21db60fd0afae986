"""Oil films as limits of a shape optimisation: values, slopes, what they need, who judges them."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.bearing_room import main_room_mm
from cranktopo.design.goal.limit import goal_text
from cranktopo.design.goal.scene_goal import check_goal, goal_of, with_goal
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.bound.webs import convex_problem
from cranktopo.tasks.film.stage import oil_films
from cranktopo.tasks.refit.family import scene_at
from cranktopo.tasks.web_shape.bearing_films import film_slopes, film_values
from tests.physics.shape.shape_cases import Array, free_throw

BEARINGS = {"clearance_mm": 0.05, "oil": "ISO VG 100", "groove_mm": 15.0}
"""So wide a groove that the main bearings decide, not the big ends."""


def limited(scene: Scene, *limits: str) -> Scene:
    data = scene.model_dump(mode="json", by_alias=True, exclude_none=True)
    found = scene_from_dict({**data, "bearings": BEARINGS})
    return with_goal(found, minimise="mass", maximise=None, limits=limits)


@pytest.mark.slow
def test_values_are_those_of_the_film_command() -> None:
    """Of the one main bearing near the limit the mass-conserving film: one web has one verdict."""
    scene = limited(load_scene("mikron-iiic"), "oil_film >= 0.7 um")
    (at,) = oil_films(scene).speeds
    told = film_values(scene)
    (near,) = at.conserving
    assert near.bearing == "main 3"
    assert near.conserving is not None
    assert near.conserving.film_um != pytest.approx(near.film_um, rel=1e-3)
    assert told["oil_film"] == pytest.approx(min(one.film_um for one in at.least_films), rel=1e-12)
    assert told["oil_film"] == pytest.approx(near.conserving.film_um, rel=1e-12)
    assert told["bearing_pressure"] == pytest.approx(
        max(one.pressure_MPa for one in at.least_films), rel=1e-12
    )
    assert film_values(limited(load_scene("mikron-iiic"), "torsion >= 90 %")) == {}


@pytest.mark.slow
def test_slopes_are_those_by_the_width_that_a_dimension_takes() -> None:
    """The slope by the thickness is that by the bearing's width, given, times what the thickness takes."""
    free, layout, values = free_throw()
    scene = limited(free, "oil_film >= 0.1 um")  # so far from it that the mobility method judges
    found, slopes = film_slopes(scene, layout, values)
    place = layout.names.index("web_thickness")

    def room(thicker: float) -> float:
        moved = values + thicker * np.eye(len(values))[place]
        return min(main_room_mm(scene_at(scene, layout, moved), n) for n in (0, 1))

    def at_width(width: float) -> Array:
        at = scene_at(scene, layout, values)
        assert at.bearings is not None
        given = at.bearings.model_copy(update={"width_mm": width})
        return np.array(list(film_values(at.model_copy(update={"bearings": given})).values()))

    own, taken = room(0.0), (room(0.5) - room(-0.5)) / 1.0
    assert taken == pytest.approx(-2.0)
    assert list(found.values()) == pytest.approx(list(at_width(own)), rel=1e-9)
    by_width = (at_width(own + 0.02) - at_width(own - 0.02)) / 0.04
    goal_of = taken * by_width
    assert [slope[place] for slope in slopes.values()] == pytest.approx(list(goal_of), rel=0.05), (
        "and a little of its mass"
    )
    assert slopes["oil_film"][place] < 0 < slopes["bearing_pressure"][place]
    others = [i for i, name in enumerate(layout.names) if name not in layout.dimensions]
    assert not slopes["oil_film"][others].any(), "the outline takes no room"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"bearings": None}, "needs [bearings]: clearance and oil make the film"),
        ({"engine": None}, "needs [engine.gas] and engine.speed_rpm"),
    ],
)
def test_a_limit_that_the_scene_cannot_tell_is_refused(change: dict[str, None], words: str) -> None:
    scene = limited(load_scene("mikron-iiic"), "oil_film >= 1 um", "fatigue_safety none")
    with pytest.raises(CranktopoError) as error:
        check_goal(scene.model_copy(update=change))
    assert words in str(error.value)


def test_a_film_is_no_goal_and_has_no_part_in_a_proof_or_on_cells() -> None:
    scene = limited(load_scene("mikron-iiic"), "oil_film >= 1 um", "bearing_pressure <= 90 %")
    with pytest.raises(CranktopoError, match="can be limited but is no goal"):
        with_goal(scene, minimise=None, maximise="oil_film", limits=())
    goal = goal_of(scene)
    assert goal is not None
    told = goal_text(goal, "density")
    assert "not judged, `cranktopo shape` changes what the bearings have: " in told
    assert "oil_film >= 1 um, bearing_pressure <= 90 %" in told
    original = {"mass": 1.5, "torsion": 1.4e5, "bending": 2.3e5, "inertia": 2000.0, "unbalance": 35.0}
    dropped = {limit.quantity: why for limit, why in convex_problem(goal, original).dropped}
    assert dropped["oil_film"] == dropped["bearing_pressure"] == "bearings are not part of the proof"
