"""Marks of workshop drawings can be read: labels apart, numbers off short lines, no strokes of nothing."""

from __future__ import annotations

from itertools import combinations
from typing import Any, Literal

import pytest
from manifold3d import CrossSection, Manifold
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.drawing.raw_sheet import raw_pages
from cranktopo.tasks.drawing.sheet import drawing_figures
from cranktopo.tasks.drawing.views import Sheet, front_view
from cranktopo.throw.bevel import EndBevel
from cranktopo.throw.counterweight.table import Counterweight
from cranktopo.throw.profile import ProfileWeb
from cranktopo.throw.raw_part.table import Forging
from tests.drawn_texts import leaders, near_leaders


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


@pytest.mark.parametrize(
    "low_mm", [-35.0, -37.83, -42.0, *(pytest.param(low, marks=pytest.mark.slow) for low in (-38.6, -40.0))]
)
def test_leaders_of_the_front_view_are_apart(low_mm: float) -> None:
    """That of a station ran to the corner of the counterweight, from where that of its angle began."""
    web = ProfileWeb(
        outline="profile",
        thickness_mm=26.0,
        stations_mm=(-45.18, low_mm, -17.73, 9.73, 37.19, 57.29, 64.65),
        half_widths_mm=(0.0, 29.53, 36.6, 41.72, 34.65, 19.63, 0.0),
        counterweight=Counterweight(outer_radius_mm=74.0, half_angle_deg=58.55),
    )
    figure, _ = drawn(load_scene("mikron-iiic-plain").model_copy(update={"web": web}))
    named = [text for text, _ in leaders(figure.axes[0])]
    assert len(named) == 9
    assert {"2 × 58.55°", f"2:  y {low_mm:.2f}, x 29.53"} <= set(named)
    assert not near_leaders(figure)


@pytest.mark.parametrize(("half", "way"), [("first", 1), ("second", -1)])
def test_points_and_features_on_one_side_have_one_sign(
    scene: Scene, half: Literal["first", "second"], way: int
) -> None:
    """Of the second web x runs to the left: its pocket had -30.91 there, its outline x +35.20."""
    pocket = {"shape": "side", "y_mm": 17.0, "length_mm": 20.0, "height_mm": 8.0, "depth_mm": 6.0}
    web = ProfileWeb.model_validate({**scene.web.model_dump(exclude_none=True), "pocket": [pocket]})
    sheet = Sheet(scene.model_copy(update={"web": web}), Manifold.cube(), half=half, placed=True)
    axes = Figure().subplots()
    front_view(axes, sheet, 1.0)
    ((x, _),) = sheet.places
    texts = [text.get_text() for text in axes.texts]
    assert f"{way * x:.2f}" in texts
    stations = [text.split(", x ")[1] for text in texts if ", x " in text]
    half_widths = [f"{way * wide:.2f}" if wide else "0.00" for wide in web.half_widths_mm]
    assert sorted(stations) == sorted(half_widths)
    marks = {text.get_text(): text.get_position()[0] for text in axes.texts if text.get_text() in ("x", "y")}
    assert (marks["x"] - marks["y"]) * way > 0


@pytest.mark.parametrize("name", ["mikron-iiic", "industrial-gas", "opposed-piston-variant-2"])
def test_no_text_of_a_sheet_lies_over_another(name: str) -> None:
    """The depth of a bevel lay over the thickness of the web."""
    figure, renderer = drawn(load_scene(name))
    texts = [text for axes in figure.axes for text in axes.texts if text.get_text().strip()]
    boxes = [text.get_window_extent(renderer).expanded(0.95, 0.8) for text in texts]
    found = combinations(zip(texts, boxes, strict=True), 2)
    assert not [(a.get_text(), b.get_text()) for (a, one), (b, other) in found if one.overlaps(other)]


@pytest.fixture(scope="module")
def slit() -> Manifold:
    """A raw half with a slit through it as narrow as rounding leaves one, seen in a forging."""
    edge = CrossSection([[(-70.0, -30.0), (-50.0, -76.0), (50.0, -76.0), (70.0, -30.0), (0.0, 64.0)]])
    gap = CrossSection([[(5.43, -1.9764), (8.4763, -3.0851), (8.4766, -3.0852)]])
    return (edge - gap).extrude(30.0)


def raw_front(scene: Scene, raw: Manifold, monkeypatch: pytest.MonkeyPatch) -> Any:
    """The axes of the raw part's front view."""
    forging = Forging(allowance_mm=2.0, draft_deg=5.0, flash_mm=2.0)
    module = "cranktopo.tasks.drawing.raw_sheet"
    for name, value in {
        "surface_of": None,
        "solid_of": None,
        "cut_in_halves": [raw],
        "raw_mass_kg": 1.0,
    }.items():
        monkeypatch.setattr(f"{module}.{name}", lambda *_, value=value, **__: value)
    forged = scene.model_copy(update={"forging": forging})
    (page,) = raw_pages(forged, [Sheet(forged, Manifold.cube())])
    axes = Figure().add_axes((0.0, 0.0, 1.0, 1.0))
    page.views[0](axes, 0.5)
    return axes


def test_a_slit_of_rounding_is_no_stroke(
    scene: Scene, slit: Manifold, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Flanks of a raw counterweight that meet left a row of thick strokes, on one side of the web."""
    assert len(slit.project().to_polygons()) == 2
    outline = raw_front(scene, slit, monkeypatch).patches[0].get_path()
    assert len(outline.to_polygons()) == 1


def test_the_number_of_a_short_dimension_leaves_its_line(scene: Scene) -> None:
    """The box around the depth of a bevel covered line and arrows of its dimension."""
    bevel = EndBevel(face="journal", y_mm=48.2, depth_mm=16.79, crown_mm=1.66, draft_deg=5.0)
    web = scene.web.model_copy(update={"bevel": (bevel,)})
    figure, renderer = drawn(scene.model_copy(update={"web": web}))
    axes = figure.axes[1]
    (number,) = (text for text in axes.texts if text.get_text() == "16.79")
    (line,) = (
        text for text in axes.texts if getattr(text, "measured", None) and text.measured.text == "16.79"
    )
    ends = axes.transData.transform([line.xy, line.xyann])
    box = number.get_window_extent(renderer)
    assert box.y0 > ends[:, 1].max()
    assert box.x0 < ends[:, 0].mean() < box.x1


def test_extension_lines_begin_at_the_corners_that_they_measure(
    scene: Scene, slit: Manifold, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Those of a raw width began half-way up the web; of two corners of a lower edge the left one counts."""
    axes = raw_front(scene, slit, monkeypatch)
    found = [text.measured for text in axes.texts if hasattr(text, "measured")]
    ends = [(one.start, one.end) for one in found]
    assert ends == [((-70.0, -30.0), (70.0, -30.0)), ((-50.0, -76.0), (0.0, 64.0))]
