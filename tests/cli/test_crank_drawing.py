"""Workshop drawing of the whole crank: what it says, its scale, nothing over anything, DXF for CAD."""

from __future__ import annotations

import sys
from datetime import datetime
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from manifold3d import Manifold
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.patches import ArrowStyle

from cranktopo.app.main import main
from cranktopo.base.units import MM_PER_INCH
from cranktopo.bodies.crank_ends import ends_volume_mm3
from cranktopo.bodies.volume import throw_volume_mm3
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.strength import treatment_notes
from cranktopo.engine.balance.crank import crank_mass
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.crank_drawing.balancing import balancing_notes
from cranktopo.tasks.crank_drawing.crank_shape import CrankShape, PlacedThrow, crank_shape
from cranktopo.tasks.crank_drawing.crank_views import _chain, _pins, draw_star
from cranktopo.tasks.crank_drawing.layout import SHEETS_MM, SheetLayout
from cranktopo.tasks.crank_drawing.sheet import _places, crank_figure
from cranktopo.tasks.drawing.views import Sheet, lengthwise_section
from cranktopo.throw.counterweight.table import Counterweight

JOURNAL = {"outer_diameter_mm": 40.0, "length_mm": 30.0, "fillet_mm": 2.0}
DAY = datetime(2026, 1, 2)


def small(**tables: Any) -> Scene:
    """A throw that is quickly meshed, with a pocket off both axes."""
    throw = {"radius_mm": 40.0, "main_journal": {**JOURNAL, "outer_diameter_mm": 44.0}, "crankpin": JOURNAL}
    pocket = {"shape": "box", "face": "pin", "x_mm": 14.0, "y_mm": 4.0, "size_x_mm": 8.0, "size_y_mm": 9.0}
    web = {
        "thickness_mm": 16.0,
        "outline": "obround",
        "width_mm": 60.0,
        "pocket": [{**pocket, "depth_mm": 3.0}],
    }
    return scene_from_dict(
        {"name": "small", "throw": throw, "web": web, "material": {"name": "42CrMo4"}, **tables}
    )


def drawn(scene: Scene) -> tuple[Figure, SheetLayout]:
    return crank_figure(scene, crank_shape(scene), DAY)


def words(figure: Figure) -> list[str]:
    return [text.get_text() for axes in figure.axes for text in axes.texts]


@pytest.fixture(scope="module")
def sheet() -> tuple[Figure, SheetLayout]:
    return drawn(
        small(
            drawing={"crankpin_fit": "k6", "hardness_HRC": 54.0, "number": "K-17", "notes": ["Crack test."]}
        )
    )


def test_it_says_what_the_shop_needs(sheet: tuple[Figure, SheetLayout]) -> None:
    found = "\n".join(words(sheet[0]))
    wanted = ("2× ⌀44 h6 (0/-0.016)", "1× ⌀40 k6 (+0.018/+0.002)", "54 HRC", "K-17", "Crack test.")
    for text in (*wanted, "42CrMo4", "G 16", "40 ±0.05", "2026-01-02", "↗", "∥", "R2\nRa 0.4", "WEB 1"):
        assert text in found, text


TREATED = {"surface_treatment_factor": 1.3, "surface_treatment_source": "rolled, by tests of the forge"}


@pytest.mark.parametrize(
    ("fatigue", "lines"),
    [
        (
            {"hardening": {"process": "nitrided", "case_depth_mm": 0.4, "surface_hardness_HV": 700.0}},
            ["Fillets of crankpins and main journals: nitrided, at least 0.4 mm deep and 700 HV."],
        ),
        (
            {
                "hardening": {
                    "process": "induction",
                    "case_depth_mm": 1.0,
                    "surface_hardness_HV": 600.0,
                    "fillets": "pin",
                }
            },
            ["Fillets of crankpins: induction-hardened, at least 1 mm deep and 600 HV."],
        ),
        (
            TREATED,
            ["Fillets of all journals: rolled, by tests of the forge; strength times 1.3."],
        ),
        ({}, []),
    ],
)
def test_the_treatment_that_the_safety_counts_is_asked_of_the_shop(
    fatigue: dict[str, Any], lines: list[str]
) -> None:
    """A crank made to a sheet without it had a safety of 1.27 where 1.62 was told."""
    scene = small(fatigue=fatigue, material={"name": "42CrMo4", "fkm_group": "Steel"})
    assert treatment_notes(scene) == lines


def test_the_treatment_is_on_the_sheet() -> None:
    scene = small(fatigue=TREATED, material={"name": "42CrMo4", "fkm_group": "Steel"})
    (line,) = treatment_notes(scene)
    assert line in " ".join(" ".join(words(drawn(scene)[0])).split())


@pytest.mark.parametrize(
    ("numbers", "alone", "words"),
    [
        ([1, 2, 3, 4, 5, 6], True, "all throws"),
        ([1], True, "throw 1"),
        ([2, 3], False, "throws 2, 3"),
        ([1, 3, 4, 5, 8], False, "throws 1, 3 to 5, 8"),
    ],
)
def test_webs_name_their_throws_in_few_words(numbers: list[int], alone: bool, words: str) -> None:
    """Six throws one by one ran into the title of the view beside."""
    assert _places(numbers, alone) == words


def test_a_pocket_is_dimensioned_from_both_axes(sheet: tuple[Figure, SheetLayout]) -> None:
    assert {"14.00", "4.00"} <= set(words(sheet[0]))


def test_views_have_their_scale(sheet: tuple[Figure, SheetLayout]) -> None:
    figure, found = sheet
    assert np.allclose(figure.get_size_inches() * MM_PER_INCH, SHEETS_MM[found.sheet])
    (axes,) = (axes for axes in figure.axes if axes.get_title(loc="left").startswith("Crank"))
    (x0, x1), box = axes.get_xlim(), axes.get_position()
    assert box.width * SHEETS_MM[found.sheet][0] == pytest.approx(found.scale * (x1 - x0))


def overlaps(figure: Figure) -> list[tuple[str, str]]:
    """Pairs of texts that lie over each other, and texts that leave the frame of the sheet."""
    canvas = FigureCanvasAgg(figure)
    renderer = canvas.get_renderer()
    texts = [t for axes in figure.axes for t in (*axes.texts, axes._left_title) if t.get_text().strip()]  # type: ignore[attr-defined]
    boxes = [text.get_window_extent(renderer) for text in texts]
    page, border = figure.bbox, 10.0 / MM_PER_INCH * figure.dpi
    out = [
        (text.get_text(), "leaves the sheet")
        for text, box in zip(texts, boxes, strict=True)
        if box.x0 < border or box.y0 < border or box.x1 > page.x1 - border or box.y1 > page.y1 - border
    ]
    shrunk = [box.expanded(0.9, 0.8) for box in boxes]
    return out + [
        (texts[i].get_text(), texts[j].get_text())
        for i in range(len(texts))
        for j in range(i)
        if shrunk[i].overlaps(shrunk[j])
    ]


def test_no_text_lies_over_another(sheet: tuple[Figure, SheetLayout]) -> None:
    assert not overlaps(sheet[0])


def test_numbers_and_arrows_of_short_parts_keep_apart() -> None:
    """A flange and two half journals at 1:20 on A2: their numbers lay over each other, and the arrowheads."""
    width, height = SHEETS_MM["A2"]
    mm, figure = 20.0, Figure(figsize=(width / MM_PER_INCH, height / MM_PER_INCH))
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0), xlim=(-1000.0, width * mm - 1000.0), ylim=(-4000.0, 4400.0))
    places = np.cumsum([0.0, 50.0, 70.0, 70.0, 125.0, 140.0, 125.0, 70.0, 10.0, 10.0, 10.0])
    _chain(axes, list(pairwise(places.tolist())), 0.0, -15.0 * mm, mm)
    assert len(words(figure)) == 2 * 10
    assert not overlaps(figure)
    for line in (text for text in axes.texts if hasattr(text, "measured")):
        short = abs(line.measured.end[0] - line.measured.start[0]) < 3.0 * mm
        headless = type(line.arrow_patch.get_arrowstyle()) is type(ArrowStyle("-"))
        assert headless or not short


def test_the_place_of_an_outlet_keeps_clear_of_the_radius_of_its_fillet() -> None:
    """At 1:2 the 7 mm off the middle lay under their own number, and that at the label of the fillet."""
    drilling = {
        "diameter_mm": 6.0,
        "from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": 7.0},
        "to": {"on": "crankpin", "angle_deg": 0.0, "place_mm": 0.0},
    }
    throw = small().throw.model_dump(mode="json", exclude_none=True, by_alias=True)
    cube = Manifold.cube((200.0, 200.0, 200.0), center=True)
    (_, room, _) = (one := Sheet(small(throw=throw | {"drilling": [drilling]}), cube)).rooms
    figure = Figure(figsize=[mm / MM_PER_INCH for mm in room.size_mm(0.5)])
    axes = figure.add_axes((0.0, 0.0, 1.0, 1.0))
    room.set_limits(axes, 0.5)
    lengthwise_section(axes, one, 0.5)
    assert not [pair for pair in overlaps(figure) if {"7", "R2"} & set(pair) and "leaves" not in pair[1]]
    renderer = FigureCanvasAgg(figure).get_renderer()
    (number,) = (text for text in axes.texts if text.get_text() == "7")
    (line,) = (text for text in axes.texts if hasattr(text, "measured") and text.measured.text == "7")
    box = number.get_window_extent(renderer)
    assert box.y1 < axes.transData.transform(line.xy)[1], "the number hides its line"


@pytest.mark.slow
@pytest.mark.parametrize(
    "design", ["mikron-iiic", "car-diesel", "industrial-gas", "opposed-piston-variant-2"]
)
def test_no_text_lies_over_another_in_designs(design: str) -> None:
    assert not overlaps(drawn(load_scene(design))[0])


def test_a_dxf_file_holds_true_millimetres_and_real_dimensions(
    sheet: tuple[Figure, SheetLayout], tmp_path: Path
) -> None:
    ezdxf = pytest.importorskip("ezdxf")
    from cranktopo.report.dxf import write_dxf

    scene, (figure, found) = small(), sheet
    write_dxf(figure, found.scale, tmp_path / "crank.dxf", DAY)
    document = ezdxf.readfile(tmp_path / "crank.dxf")
    assert not document.audit().errors
    dimensions = {entity.dxf.text: entity for entity in document.modelspace().query("DIMENSION")}
    assert dimensions[f"{scene.pitch_mm:g}"].get_measurement() == pytest.approx(scene.pitch_mm, abs=1e-6)
    assert dimensions["40 %%p0.05"].get_measurement() == pytest.approx(40.0, abs=1e-6)
    layers = {entity.dxf.layer for entity in document.modelspace()}
    assert {"EDGES", "HATCH", "CENTRE", "TEXT", "DIMENSIONS"} <= layers


def test_without_ezdxf_a_dxf_file_is_a_missing_tool(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "ezdxf", None)
    assert main(["drawing", "mikron-iiic", str(tmp_path / "crank.dxf")]) == 7
    assert "pip install 'cranktopo[dxf]'" in capsys.readouterr().err


@pytest.mark.slow
def test_it_replaces_a_file_by_force_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    path = tmp_path / "crank.svg"
    path.write_text("mine")
    assert main(["drawing", "mikron-iiic", str(path)]) == 2
    assert main(["drawing", "mikron-iiic", str(tmp_path / "crank.dwg")]) == 2
    monkeypatch.setattr("cranktopo.design.loading.load_scene", lambda *_, **__: small())
    assert main(["drawing", "small", str(path), "--force"]) == 0
    assert path.read_text(encoding="utf-8").startswith("<?xml")


def test_a_depth_of_hardening_needs_a_hardness() -> None:
    from cranktopo.base.errors import CranktopoError

    with pytest.raises(CranktopoError, match=r"drawing\.hardening_depth_mm = 2"):
        small(drawing={"hardening_depth_mm": 2.0})


def test_ends_and_own_throws_are_drawn() -> None:
    """The pieces of the whole crank hold its volume; its ends reach as far as their steps."""
    scene = load_scene("mikron-iiic-crank")
    shape = crank_shape(scene)
    volume = sum(piece.solid.volume() for piece in shape.pieces)
    expected = 4 * throw_volume_mm3(scene) + ends_volume_mm3(scene)
    assert volume == pytest.approx(expected, rel=5e-3)
    ends = [step.length_mm for end in scene.crank.end for step in end.step] if scene.crank else []
    start, stop = shape.z_mm
    whole = 4 * scene.pitch_mm + scene.throw.main_journal.length_mm + sum(ends)
    assert stop - start == pytest.approx(whole, rel=1e-6)
    first, last = shape.journals[0], shape.journals[-1]
    assert [b - a for a, b in (first.z_mm, last.z_mm)] == pytest.approx([40.0, 40.0])


@pytest.mark.slow
def test_flying_webs_are_drawn() -> None:
    """The pieces hold the crank's volume, and each flying web joins two pins without a journal in between."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    flying = [{"number": number, "length_mm": 0.0} for number in (1, 3)]
    scene = scene_from_dict({**data, "crank": {"bearings": [0, 2, 4], "main_journal": flying}}, "crank")
    shape, mass = crank_shape(scene), crank_mass(scene)
    assert mass is not None
    kg = sum(piece.solid.volume() for piece in shape.pieces) * scene.material.density_kg_m3 * 1e-9
    assert kg == pytest.approx(mass.mass_kg, rel=5e-3)
    start, stop = shape.z_mm
    assert stop - start == pytest.approx(
        4 * scene.pitch_mm - 2 * scene.throw.main_journal.length_mm, rel=1e-6
    )
    figure, _ = crank_figure(scene, shape, DAY)
    assert "3× ⌀42 h6" in "\n".join(words(figure))


def test_the_detail_of_a_fillet_names_its_recess() -> None:
    journal = {**JOURNAL, "recess_mm": 0.5}
    throw = {"radius_mm": 40.0, "main_journal": {**JOURNAL, "outer_diameter_mm": 44.0}, "crankpin": journal}
    found = words(drawn(small(throw=throw))[0])
    assert any("R2, recess 0.5\nRa 0.4" in text for text in found)
    assert any(text.startswith("R2\nRa 0.4") for text in found), "the main journal has none"


def test_a_crank_that_is_unbalanced_by_design_asks_for_bob_weights() -> None:
    """A single-cylinder crank with a counterweight: mass on the pin that brings the unbalance to nothing."""
    engine = {"bore_mm": 80.0, "rod_length_mm": 130.0, "speed_rpm": 3000.0, "cylinders": 1}
    heavy = small(engine=engine)
    (own, cannot) = balancing_notes(heavy, 3.0)
    unbalance = throw_balance(heavy).throw_unbalance_kg_mm
    assert own.startswith(f"Unbalance by design {float(f'{unbalance * 1000:.3g}'):g} g mm")
    assert cannot == "without counterweights it cannot be balanced to ISO 21940-11 G 16."
    narrow = Counterweight(outer_radius_mm=45.0, half_angle_deg=75.0)
    light = heavy.model_copy(update={"web": heavy.web.model_copy(update={"counterweight": narrow})})
    assert balancing_notes(light, 3.0)[1].startswith("without heavier counterweights it cannot be balanced")
    web = heavy.web.model_copy(
        update={"counterweight": Counterweight(outer_radius_mm=75.0, half_angle_deg=75.0)}
    )
    weighted = heavy.model_copy(update={"web": web})
    notes = balancing_notes(weighted, 4.0)
    bob = -throw_balance(weighted).throw_unbalance_kg_mm / 40.0
    assert bob > 0.05
    assert notes[1] == f"balanced with bob weights of {bob:.3f} kg on the crankpins"
    permitted = 1e6 * 16e-3 / (3000.0 * 2 * np.pi / 60) * 4.0
    assert f"at most {permitted:.3g} g mm" in notes[3]
    assert len(balancing_notes(load_scene("mikron-iiic"), 6.0)) == 2, "an in-line four is balanced as it is"


SPLIT = {
    "bore_mm": 80.0,
    "rod_length_mm": 140.0,
    "speed_rpm": 3000.0,
    "cylinders": 6,
    "firing_order": [1, 4, 3, 6, 2, 5],
    "arrangement": {
        "layout": "V",
        "bank_angle_deg": 90.0,
        "pin_splay_deg": -30.0,
        "rod_offset_mm": 15.0,
    },
    "masses": {"piston_group_kg": 0.4, "rod_reciprocating_kg": 0.15, "rod_rotating_kg": 0.35},
    "gas": {"peak_pressure_MPa": 5.0, "peak_angle_deg": 12.0, "compression_ratio": 9.0},
}
"""A V6 of 90 deg that fires evenly."""


def test_half_pins_meet_where_their_webs_say_and_the_star_names_them() -> None:
    """With a thicker second web the middle of the throw is not that of its pin."""
    scene = small(engine=SPLIT)
    thicker = scene.model_copy(update={"second_web": scene.web.model_copy(update={"thickness_mm": 20.0})})
    throws = tuple(PlacedThrow(thicker, angle, 0.0) for angle in (0.0, 240.0))
    (first, y), (second, other) = _pins(throws[0])
    assert [b - a for a, b in (first, second)] == [15.0, 15.0]
    assert y == other == pytest.approx(40.0 * np.cos(np.radians(15.0)))
    axes = Figure().add_subplot()
    draw_star(axes, CrankShape("c", throws, (), ()))
    found = {text.get_text() for text in axes.texts}
    assert {"1a\n15°", "1b\n345°", "2a\n255°", "2b\n225°"} <= found
    assert any("half pin 1a, radius 40 ±" in word for word in found)


@pytest.mark.slow
def test_split_pins_have_each_half_at_its_place() -> None:
    """Half pins 30 deg apart: each pin in its place, a star of six; no radius foreshortened."""
    scene = small(engine=SPLIT)
    shape = crank_shape(scene)
    whole = sum(piece.solid.volume() for piece in shape.pieces)
    assert whole == pytest.approx(3 * throw_volume_mm3(scene), rel=1e-3)
    turn, (first, *_) = np.radians(15.0), shape.pieces
    height = scene.web_z_mm[1] + 2.0
    for z, side in ((height, 1.0), (scene.pitch_mm - height, -1.0)):
        x0, y0, x1, y1 = first.solid.slice(z).bounds()
        middle = (x0 + x1) / 2, (y0 + y1) / 2
        assert middle == pytest.approx((side * 40.0 * np.sin(turn), 40.0 * np.cos(turn)), abs=0.05)
    found = words(drawn(scene)[0])
    assert any(word.startswith("6× ⌀40") for word in found)
    assert not any(word.startswith("40 ±") for word in found)
    assert any("lie 30° apart" in " ".join(word.split()) for word in found)
