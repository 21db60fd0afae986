"""No text of a sheet lies over another, over an edge of the body, on a line, or beyond the frame."""

from __future__ import annotations

from datetime import datetime
from typing import Any

import pytest
from matplotlib.figure import Figure

from cranktopo.design.loading import builtin_designs, load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.crank_drawing.crank_shape import crank_shape
from cranktopo.tasks.crank_drawing.sheet import crank_figure
from cranktopo.tasks.drawing.sheet import drawing_figures, throw_sheets
from tests.drawn_texts import beyond_frame, near_leaders, over_each_other, over_edges, over_lines
from tests.physics.throw.test_crossing_drillings import drilled_twin

WEIGHT: dict[str, Any] = {"outer_radius_mm": 85.0, "half_angle_deg": 60.0}
SIX = {"cylinders": 6, "firing_order": [1, 5, 3, 6, 2, 4]}


def weighted(engine: dict[str, Any], **weight: Any) -> Scene:
    """The twin's crank with counterweights and the throws of another engine."""
    data = drilled_twin(3.0, 1.0, "first").model_dump(mode="json", exclude_none=True, by_alias=True)
    data["web"]["counterweight"] = WEIGHT | weight
    if "density_kg_m3" in weight:
        data["throw"].pop("drilling")
    data["engine"] |= engine
    return scene_from_dict(data, "weighted", whole=True)


def cases() -> dict[str, Scene]:
    return {
        "twin with ends": drilled_twin(3.0, 1.0),
        "six with counterweights": weighted(SIX),
        "bolted counterweights": weighted({}, density_kg_m3=17000.0),
    }


def sheets(scene: Scene) -> list[Figure]:
    """A3 of the throw, and the sheet of the crank."""
    throws = drawing_figures(throw_sheets(scene), throw_balance(scene))
    return [*throws, crank_figure(scene, crank_shape(scene), datetime(2026, 1, 2))[0]]


def check(figure: Figure) -> None:
    for misplaced in (over_each_other, over_edges, over_lines, beyond_frame, near_leaders):
        assert not misplaced(figure), misplaced.__name__


@pytest.mark.slow
@pytest.mark.parametrize("name", cases())
def test_sheets_of_made_up_cranks(name: str) -> None:
    for figure in sheets(cases()[name]):
        check(figure)


def drawable() -> list[str]:
    """Built-in designs of a crank; others are of a rod or a balancer shaft alone."""
    return [name for name in builtin_designs() if name not in ("balancer-shaft",)]


@pytest.mark.slow
@pytest.mark.parametrize("name", drawable())
def test_sheets_of_built_in_designs(name: str) -> None:
    for figure in sheets(load_scene(name)):
        check(figure)
