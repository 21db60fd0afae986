"""Marks of workshop drawings can be read: labels apart, numbers off short lines, no strokes of nothing."""

from __future__ import annotations

from itertools import combinations
from typing import Any

import pytest
from manifold3d import Manifold
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.drawing.sheet import drawing_figures
from cranktopo.tasks.drawing.views import Sheet
from cranktopo.throw.counterweight.table import Counterweight
from cranktopo.throw.profile import ProfileWeb


@pytest.fixture(scope="module")
def scene() -> Scene:
    """A web with a profile outline whose lowest stations are as high as the corners of its counterweight."""
    web = ProfileWeb(
        outline="profile",
        thickness_mm=20.0,
        stations_mm=(-31.65, -25.23, -7.68, 16.29, 40.26, 57.81, 64.23),
        half_widths_mm=(0.0, 14.59, 29.57, 36.5, 32.64, 17.97, 0.0),
        counterweight=Counterweight(outer_radius_mm=76.65, half_angle_deg=70.0),
    )
    return load_scene("mikron-iiic-plain").model_copy(update={"web": web})


def drawn(scene: Scene) -> tuple[Figure, Any]:
    """The sheet of a scene, and what measures its texts."""
    (figure,) = drawing_figures([Sheet(scene, Manifold.cube())], throw_balance(scene))
    return figure, FigureCanvasAgg(figure).get_renderer()


def test_labels_of_the_front_view_are_apart(scene: Scene) -> None:
    """The angle of the counterweight stood over the label of a station."""
    figure, renderer = drawn(scene)
    labels = [text for text in figure.axes[0].texts if text.get_text()]
    assert {"2 × 70°", "R76.65", "1:  y -31.65, x 0.00"} <= {text.get_text() for text in labels}
    for one, other in combinations(labels, 2):
        a, b = (text.get_window_extent(renderer) for text in (one, other))
        assert not a.overlaps(b), (one.get_text(), other.get_text())
