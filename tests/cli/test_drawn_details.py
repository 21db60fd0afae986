"""Details of fillets: drawn where the fillet is, and marked by letters that lie over nothing."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest
from manifold3d import Manifold
from matplotlib.figure import Figure

from cranktopo.base.units import MM_PER_INCH
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_drawing.detail import details, mark_detail
from cranktopo.tasks.drawing.views import Sheet, lengthwise_section
from tests.cli.test_crank_drawing import overlaps, small


def _places_mm(name: str) -> list[float]:
    sheet: Any = SimpleNamespace(scene=load_scene(name))
    return [detail.at_mm[1] for detail in details(sheet, "KL")]


def test_a_detail_is_toward_the_other_axis_unless_a_bore_opens_the_fillet_there() -> None:
    whole, opened = load_scene("opposed-piston").throw, load_scene("opposed-piston-variant-1").throw
    pin = whole.radius_mm - whole.crankpin.radius_mm
    assert _places_mm("opposed-piston") == [whole.main_journal.radius_mm, pin]
    assert _places_mm("opposed-piston-variant-1")[0] == -opened.main_journal.radius_mm


def half_throw(scene: Scene) -> Manifold:
    """Web and journals without fillets and drillings."""
    throw, (start, stop), end = scene.throw, scene.web_z_mm, scene.pitch_mm / 2
    main = Manifold.cylinder(start, throw.main_journal.radius_mm)
    pin = Manifold.cylinder(end - stop, throw.crankpin.radius_mm).translate((0.0, throw.radius_mm, stop))
    return main + pin + Manifold.cube((60.0, 130.0, stop - start)).translate((-30.0, -40.0, start))


@pytest.mark.parametrize("place_mm", [7.0, None])
@pytest.mark.parametrize("scale", [1.0, 0.5, 0.2])
def test_letters_keep_clear_of_radii_and_their_leaders(scale: float, place_mm: float | None) -> None:
    """The outlet of a drilling put the radius of a fillet where its detail is marked, its leader under K."""
    throw = small().throw.model_dump(mode="json", exclude_none=True, by_alias=True)
    drilling = {
        "diameter_mm": 6.0,
        "from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": place_mm},
        "to": {"on": "crankpin", "angle_deg": 0.0, "place_mm": place_mm},
    }
    scene = small(throw=throw | {"drilling": [drilling] * (place_mm is not None)})
    room = (sheet := Sheet(scene, half_throw(scene))).rooms[1]
    figure = Figure(figsize=[mm / MM_PER_INCH for mm in room.size_mm(scale)])
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    room.set_limits(axes, scale)
    lengthwise_section(axes, sheet, scale)
    for detail in details(sheet, "KL"):
        mark_detail(axes, detail, scale)
    letters = {text.get_text() for text in axes.texts} & {"K", "L"}
    assert letters == {"K", "L"}
    assert not [pair for pair in overlaps(figure) if letters & set(pair) and "leaves" not in pair[1]]
