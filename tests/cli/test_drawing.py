"""Workshop drawings: fields of the title block, every dimension, true scale, nothing over the body."""

from __future__ import annotations

import re
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest
from manifold3d import CrossSection, FillRule, Manifold
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure

from cranktopo.app.main import main
from cranktopo.bodies.prisms import web_region
from cranktopo.bodies.solid.files import surface_of
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of
from cranktopo.numerics.surfaces.plane_section import section_x
from cranktopo.tasks.drawing.sheet import drawing_figures, throw_sheets, write_drawing
from cranktopo.tasks.drawing.views import Sheet, front_view
from cranktopo.throw.counterweight.table import Counterweight
from cranktopo.throw.profile import ProfileWeb
from tests.physics.fea.test_two_webs import POCKET, lopsided
from tests.unit.refit.remodel_cases import WHOLE, known_scene

A3_MM = (420.0, 297.0)


@pytest.fixture(scope="module", params=["mikron-iiic-plain", "known"])
def drawn(request: pytest.FixtureRequest) -> tuple[Scene, SurfaceMesh]:
    scene = load_scene("mikron-iiic-plain")
    scene = scene if request.param == "mikron-iiic-plain" else known_scene(scene, WHOLE)
    return scene, surface_of(scene, "half", 2.0)


def texts(figure: Figure) -> list[str]:
    return [text.get_text() for axes in figure.axes for text in axes.texts]


def test_title_block_and_dimensions(drawn: tuple[Scene, SurfaceMesh]) -> None:
    scene, half = drawn
    (figure,) = drawing_figures([Sheet(scene, solid_of(half))], throw_balance(scene))
    found = "\n".join(texts(figure))
    throw = scene.throw
    for wanted in (scene.name, scene.material.name, "1:1", "first-angle", "ISO 2768", "Ra"):
        assert wanted in found
    web_kg = web_region(solid_of(half), scene).volume() * scene.material.density_kg_m3 * 1e-9
    (shown,) = re.findall(r"one web (\S+) kg", found)
    assert float(shown) == pytest.approx(web_kg, rel=5e-3)
    for journal in (throw.main_journal, throw.crankpin):
        assert f"⌀{journal.outer_diameter_mm:g}" in found
        assert f"length {journal.length_mm:g}" in found
        assert f"R{journal.fillet_mm:g}" in found
    if scene.web.outline == "profile":
        assert "cubic spline (degree 3, C2)" in found
        assert all(
            f"{y:9.3f}     {h:9.3f}" in found
            for y, h in zip(scene.web.stations_mm, scene.web.half_widths_mm, strict=True)
        )
        numbers = [number for bevel in scene.web.bevel for number in (bevel.y_mm, bevel.depth_mm)]
        for pocket in scene.web.pocket:
            numbers += [value for value in pocket.model_dump().values() if isinstance(value, float)]
        assert all(f" {number:.2f}" in found for number in numbers)
        assert "draft 12.00°" in found


def test_views_have_the_scale_of_the_title_block(drawn: tuple[Scene, SurfaceMesh]) -> None:
    scene, half = drawn
    (figure,) = drawing_figures([Sheet(scene, solid_of(half))], throw_balance(scene))
    scale = float(next(re.sub(":1", "", t) for t in texts(figure) if re.fullmatch(r"\d+:1", t)))
    assert np.allclose(figure.get_size_inches() * 25.4, A3_MM)
    for axes in figure.axes[:3]:
        (x0, x1), (y0, y1) = axes.get_xlim(), axes.get_ylim()
        box = axes.get_position()
        assert box.width * A3_MM[0] == pytest.approx(scale * (x1 - x0))
        assert box.height * A3_MM[1] == pytest.approx(scale * abs(y1 - y0))


def test_no_dimension_lies_over_the_body(drawn: tuple[Scene, SurfaceMesh]) -> None:
    """Middles of all dimension lines, against the cut or outlined area of their view."""
    scene, half = drawn
    (figure,) = drawing_figures([Sheet(scene, solid_of(half))], throw_balance(scene))
    for axes in figure.axes[:3]:
        path = axes.patches[0].get_path()
        body = CrossSection([p[:-1] for p in path.to_polygons()], FillRule.EvenOdd)
        arrows = [text for text in axes.texts if getattr(text, "arrow_patch", None) and not text.get_text()]
        assert arrows
        for arrow in arrows:
            middle = (np.array(arrow.xy) + np.array(arrow.xyann)) / 2
            spot = CrossSection.circle(0.05, 8).translate(tuple(middle))
            assert (spot ^ body).area() == 0.0, (axes.get_title(loc="left"), middle)


def test_each_sheet_is_a_page_of_the_pdf(tmp_path: Path) -> None:
    """Two A3 in one page of 420 x 594 mm cannot be printed; a picture has them one above the other."""
    scene = load_scene("mikron-iiic-plain")
    sheets = [Sheet(scene, Manifold.cube((200.0, 200.0, 200.0), center=True), half="first")] * 2
    files = [tmp_path / name for name in ("drawing.pdf", "drawing.svg")]
    write_drawing(sheets, throw_balance(scene), files)
    boxes = re.findall(rb"/MediaBox \[ 0 0 ([\d.]+) ([\d.]+) \]", files[0].read_bytes())
    sizes = [[float(side) / 72 * 25.4 for side in box] for box in boxes]
    assert np.allclose(sizes, [A3_MM, A3_MM], atol=0.01)
    assert f'height="{2 * 297 / 25.4 * 72:.3f}'[:14] in files[1].read_text(encoding="utf-8")


def largest_sagitta_mm(sheet: Sheet) -> float:
    """Farthest that a chord of the section x = 0 runs from the arc of the main journal's fillet."""
    journal, face = sheet.scene.throw.main_journal, sheet.scene.web_z_mm[0]
    radius = journal.fillet_mm
    centre, found = np.array([face - radius, journal.radius_mm + radius]), list[float]()
    for points in section_x(sheet.solid).to_polygons():
        away = np.hypot(*(points - centre).T)
        middle = np.hypot(*((points + np.roll(points, -1, axis=0)) / 2 - centre).T)
        on = (np.abs(away - radius) < 0.02) & (np.abs(np.roll(away, -1) - radius) < 0.02)
        found += list(radius - middle[on])
    assert len(found) > 4
    return max(found)


def test_fillets_are_round_in_sections() -> None:
    """Facets of 1 mm made four chords of a quarter circle of 3 mm, which details show at 5:1."""
    (sheet,) = throw_sheets(load_scene("mikron-iiic-plain"))
    assert largest_sagitta_mm(sheet) < 0.02


def test_the_notes_of_a_second_sheet_stand_above_the_title() -> None:
    scene = load_scene("mikron-iiic-plain")
    sheet = Sheet(scene, Manifold.cube((200.0, 200.0, 200.0), center=True), half="second")
    (figure,) = drawing_figures([sheet], throw_balance(scene))
    renderer = FigureCanvasAgg(figure).get_renderer()
    boxes = {text.get_text(): text.get_window_extent(renderer) for text in figure.axes[3].texts}
    (notes,) = (text for text in boxes if "Half a turn" in text)
    assert notes.count("\n") >= 6
    assert boxes[notes].y0 > boxes["Title"].y1


def test_stations_are_numbered_beside_a_counterweight_and_apart() -> None:
    """At 1:5 the stations of the ends are nearer to each other than lines of text."""
    plain = load_scene("mikron-iiic-plain")
    added = Counterweight(outer_radius_mm=80.0, half_angle_deg=60.0)
    web = ProfileWeb(
        outline="profile",
        thickness_mm=19.0,
        stations_mm=(-30.0, -22.0, 24.0, 64.0, 78.0),
        half_widths_mm=(0.0, 20.0, 30.0, 20.0, 0.0),
        counterweight=added,
    )
    sheet = Sheet(plain.model_copy(update={"web": web}), Manifold.cube())
    axes = Figure().add_axes((0.0, 0.0, 1.0, 1.0))
    front_view(axes, sheet, 0.2)
    labels = [text for text in axes.texts if ":  y " in text.get_text()]
    assert len(labels) == len(web.stations_mm)
    assert all(text.get_position()[0] > sheet.half_width_mm > 60.0 for text in labels)
    assert np.diff([text.get_position()[1] for text in labels]).min() > 15.0


def test_a_drawing_on_a_page_of_a_report_says_that_it_is_reduced() -> None:
    scene = load_scene("mikron-iiic-plain")
    sheet = Sheet(scene, Manifold.cube())
    balance = throw_balance(scene)
    ((plain,), (reduced,)) = (drawing_figures([sheet], balance, reduced=small) for small in (False, True))
    assert "1:1" in texts(plain)
    (line,) = (text for text in texts(reduced) if text.startswith("1:1"))
    assert line == "1:1 on A3; reduced on this page, not to scale"


def test_heights_end_where_the_counterweight_has_its_edge() -> None:
    """The round lower end of the outline lies inside the counterweight, where nobody can measure to it."""
    plain = load_scene("mikron-iiic-plain")
    added = Counterweight(outer_radius_mm=60.0, half_angle_deg=60.0)
    low, high = plain.web.y_range_mm(plain.throw.radius_mm)
    scene = plain.model_copy(update={"web": plain.web.model_copy(update={"counterweight": added})})
    axes = Figure().add_axes((0.0, 0.0, 1.0, 1.0))
    front_view(axes, Sheet(scene, Manifold.cube()), 1.0)
    found = {text.get_text() for text in axes.texts}
    assert {"60.00", f"{high + 60.0:.2f}"} <= found
    assert not {f"{-low:.2f}", f"{high - low:.2f}"} & found


@pytest.mark.parametrize("ending", [pytest.param(".svg", marks=pytest.mark.slow), ".pdf", ".png"])
def test_export_writes_it(ending: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / f"drawing{ending}"
    assert main(["export", "mikron-iiic-plain", str(path)]) == 0
    assert "workshop drawing" in capsys.readouterr().out
    assert path.stat().st_size > 10_000
    assert main(["export", "mikron-iiic-plain", str(path)]) == 2
    assert main(["export", "mikron-iiic-plain", str(tmp_path / "drawing.dwg")]) == 2


@pytest.mark.slow
def test_halves_that_differ_have_a_sheet_each() -> None:
    """The second pocket, at x = +9 of the throw, is at x = -9 of its sheet, in the solid and as a stroke."""
    scene = lopsided()
    sheets, balance = throw_sheets(scene), throw_balance(scene)
    assert max(map(largest_sagitta_mm, sheets)) < 0.02
    second = sheets[1]
    floor = second.solid.translate((0.0, 0.0, 1.0 - second.scene.web_z_mm[1])).slice(0.0)
    spot = CrossSection.circle(1.0, 8)
    empty, full = ((spot.translate((x, POCKET["y_mm"])) ^ floor).area() for x in (-9.0, 9.0))
    assert empty == 0.0
    assert full == pytest.approx(spot.area())
    figures = drawing_figures(sheets, balance)
    assert all(np.allclose(figure.get_size_inches() * 25.4, A3_MM) for figure in figures)
    lines = [line.get_xydata() for line in figures[1].axes[0].lines]
    assert any(np.allclose(line.mean(axis=0), (-9.0, POCKET["y_mm"]), atol=2.0) for line in lines)
    found = "\n".join(text for figure in figures for text in texts(figure))
    kg = f"first web {balance.web_kg:.3f} kg", f"second web {balance.second_web_kg:.3f} kg"
    for wanted in ("sheet 1 of 2", "sheet 2 of 2", "this half 57 long", "this half 70 long", *kg):
        assert wanted in found


def test_numbers_of_places_stand_clear_of_an_angle() -> None:
    """The foot of a drilling lies at the height of the corner of a counterweight."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data.pop("envelope")
    data["web"]["counterweight"] = {"outer_radius_mm": 75.0, "half_angle_deg": 75.0}
    data["throw"]["drilling"] = [
        {
            "diameter_mm": 5.0,
            "from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": 2.0},
            "to": {"on": "crankpin", "angle_deg": 0.0, "place_mm": 8.0},
        }
    ]
    sheet = Sheet(scene_from_dict(data), Manifold.cube((1.0, 1.0, 1.0)), placed=True)
    scale, room = 0.5, sheet.rooms[0]
    width, height = (size / 25.4 for size in room.size_mm(scale))
    figure = Figure(figsize=(width, height))
    FigureCanvasAgg(figure)
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    front_view(axes, sheet, scale)
    room.set_limits(axes, scale)
    figure.canvas.draw()
    assert {"2 × 75°", "-21.00"} <= set(texts(figure))
    boxes = [(text.get_text(), text.get_window_extent().padded(-1)) for text in axes.texts if text.get_text()]
    assert not [(a, b) for (a, one), (b, other) in combinations(boxes, 2) if one.overlaps(other)]
