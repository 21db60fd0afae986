"""Films of a design: bearings and oil of the scene, loads of the engine, what is told."""

from __future__ import annotations

import json
import math
import re
from pathlib import Path

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.design.bearing_room import big_end_room_mm
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import designs_folder, load_scene, parse_scene
from cranktopo.design.named import with_values
from cranktopo.design.plain_bearings import PlainBearings
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse, engine_of
from cranktopo.numerics.bearing_film.orbit import orbits
from cranktopo.tasks.film import stage
from cranktopo.tasks.film.conserving import _warn_of_thin, near_limit, oil_feed
from cranktopo.tasks.film.result import ConservingFilm, FilmResult
from cranktopo.tasks.film.stage import (
    _assumed,
    big_end,
    film_change,
    loaded_big_end,
    main_bearing,
    oil_films,
    plain_bearings,
)
from cranktopo.tasks.film.text import film_text

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
OIL = 'clearance_mm = 0.05\noil = "ISO VG 46"\n'


def scene(bearings: str = OIL, text: str = MIKRON) -> Scene:
    return parse_scene(f"{text}\n[bearings]\n{bearings}")


@pytest.fixture(scope="module")
def usual() -> FilmResult:
    """Films of the design at its speed."""
    return oil_films(scene(OIL + "permitted_film_um = 0.5"))


@pytest.fixture
def solved(usual: FilmResult, monkeypatch: pytest.MonkeyPatch) -> None:
    """Films that are not the subject are those of the design."""
    monkeypatch.setattr(stage, "orbits_of", lambda cases: [[None] * len(loaded) for _, loaded, _ in cases])
    monkeypatch.setattr(stage, "_films_along", lambda *_, **__: [usual.speeds[0].bearings])


def test_viscosity_of_a_grade() -> None:
    """ISO 3448 at 40 degC; Walther's equation is a straight line, so that 70 degC is between."""

    def kinematic(temperature_C: float) -> float:
        table = PlainBearings(clearance_mm=0.05, oil="ISO VG 46", temperature_C=temperature_C)
        density = 880.0 - 0.64 * (temperature_C - 15.0)
        return table.dynamic_viscosity_Pas / density * 1e6

    assert kinematic(40.0) == pytest.approx(46.0, rel=1e-12)
    assert kinematic(100.0) == pytest.approx(6.8, rel=1e-12)
    middle = kinematic(math.sqrt(313.15 * 373.15) - 273.15)  # middle of the logarithm of T

    def double(viscosity: float) -> float:
        return math.log10(math.log10(viscosity + 0.7))

    assert double(middle) == pytest.approx((double(46.0) + double(6.8)) / 2, rel=1e-12)
    assert PlainBearings(clearance_mm=0.05, viscosity_mPas=8.0).dynamic_viscosity_Pas == 0.008


def test_viscosity_of_a_curve() -> None:
    """Its points, between two of them a straight line by Walther; two points of a grade are that grade."""

    def of(points: tuple[tuple[float, float], ...], temperature_C: float) -> float:
        table = PlainBearings(clearance_mm=0.05, viscosity_curve_mPas=points, temperature_C=temperature_C)
        return 1e3 * table.dynamic_viscosity_Pas

    points = ((40.0, 90.0), (70.0, 27.0), (100.0, 11.0), (150.0, 4.0))
    for temperature_C, viscosity in points:
        assert of(points, temperature_C) == pytest.approx(viscosity, rel=1e-12)
    assert of(points, 85.0) == of(points[1:3], 85.0), "the two nearest decide"
    assert of(points, 20.0) == of(points[:2], 20.0) > 90.0
    assert of(points, 180.0) == of(points[2:], 180.0) < 4.0

    def of_grade(temperature_C: float) -> float:
        table = PlainBearings(clearance_mm=0.05, oil="ISO VG 100", temperature_C=temperature_C)
        return 1e3 * table.dynamic_viscosity_Pas

    two = tuple((at_C, of_grade(at_C)) for at_C in (50.0, 120.0))
    for temperature_C in (20.0, 90.0, 140.0):
        assert of(two, temperature_C) == pytest.approx(of_grade(temperature_C), rel=1e-12)


def test_a_curve_is_told_and_takes_the_place_of_the_grade(solved: None) -> None:
    found = oil_films(
        scene("clearance_mm = 0.05\ntemperature_C = 100\nviscosity_curve_mPas = [[40, 90.0], [100, 11.0]]")
    )
    assert (found.oil, found.temperature_C) == (None, 100.0)
    assert found.viscosity_mPas == pytest.approx(11.0, rel=1e-12)
    assert "oil of the given curve at 100 degC, 11.00 mPa s" in film_text(found)
    assert "bearings.oil" not in {one.key for one in found.assumed}


@pytest.mark.parametrize(
    ("bearings", "message"),
    [
        ('clearance_mm = 0.05\noil = "SAE 30"', "bearings.oil = 'SAE 30': must be 'ISO VG 22', "),
        (
            OIL + "width_mm = 45",
            "bearings.width_mm = 45.0: must be at most 35 mm, the journal between its fillets",
        ),
        (OIL + "big_end_width_mm = 37", "must be at most 31 mm, the journal between its fillets"),
        ('clearance_mm = 0.5\noil = "ISO VG 46"', "must be at most 0.42 mm, 1 % of the journal's diameter"),
        (OIL + "feed_hole_mm = 16", "must be at most 15.5 mm, half the width of the narrowest bearing"),
        (OIL + "supply_pressure_MPa = 0", "bearings.supply_pressure_MPa = 0"),
        (OIL + "width_mm = 20\ngroove_mm = 20", "Take at most 18.32 mm, 0 for none"),
        (
            OIL + "viscosity_curve_mPas = [[100, 11.0], [40, 90.0]]",
            "must have rising temperatures and falling",
        ),
        (OIL + "viscosity_curve_mPas = [[40, 9.0], [90, 9.0]]", "must have rising temperatures and falling"),
        (
            OIL + "viscosity_mPas = 8\nviscosity_curve_mPas = [[40, 90.0], [100, 11.0]]",
            "must not stand beside bearings.viscosity_mPas",
        ),
        ("", "bearings.clearance_mm is missing"),
    ],
)
def test_what_cannot_be_is_refused(bearings: str, message: str) -> None:
    with pytest.raises(CranktopoError) as refused:
        scene(bearings)
    assert message in str(refused.value)


def test_every_bearing_has_its_film(usual: FilmResult) -> None:
    (at,) = usual.speeds
    assert [one.bearing for one in at.bearings] == [*(f"main {n}" for n in range(1, 6)), "big end"]
    first, last = at.bearings[0], at.bearings[4]
    assert (first.film_um, first.pressure_MPa) == pytest.approx((last.film_um, last.pressure_MPa), rel=1e-3)
    assert all(0 < one.film_um < 25 and one.pressure_MPa > 5 for one in at.bearings)
    # The firing order is the same from either end, two bearings of its crank are the mirrored ones.
    assert at.bearings[1].film_um == pytest.approx(at.bearings[3].film_um, rel=1e-3)


def test_the_big_end_has_the_force_of_the_loads() -> None:
    base = scene()
    loaded, forces = loaded_big_end(base), analyse(base).cycle.forces
    step = len(forces.crankpin_force_N) // len(loaded.load_N)
    assert np.abs(loaded.load_N) == pytest.approx(forces.crankpin_force_N[::step], rel=1e-9)
    ratio = base.throw.radius_mm / engine_of(base).rod_length_mm
    turned = np.cumsum(loaded.sleeve) * np.radians(forces.angle_deg[step])
    assert np.ptp(turned) == pytest.approx(2 * math.asin(ratio), rel=1e-3)
    assert loaded.sleeve[0] == pytest.approx(-ratio)


def test_a_big_end_bearing_is_no_wider_than_its_rod() -> None:
    """The pin has 31 mm between its fillets, a rod of 30 was told with the film of 31."""
    rod = load_scene("mikron-iiic-rod")
    assert rod.rod is not None
    wide = rod.rod.big_end_width_mm
    own = with_values(rod, {"bearings": {"clearance_mm": 0.05, "oil": "ISO VG 46"}})
    assert big_end(own).width_mm == wide < big_end_room_mm(own)
    assumed = {one.key: one for one in _assumed(own, plain_bearings(own), frozenset())}
    assert assumed["bearings.big_end_width_mm"].value == pytest.approx(wide)
    assert "rod.big_end_width_mm" in str(assumed["bearings.big_end_width_mm"])
    with pytest.raises(CranktopoError, match=r"must be at most 30 mm, rod\.big_end_width_mm"):
        with_values(own, {"bearings.big_end_width_mm": wide + 1})


@pytest.mark.slow
def test_a_groove_takes_film() -> None:
    whole, parted = main_bearing(scene(), 1), main_bearing(scene(OIL + "groove_mm = 5"), 1)
    assert (whole.width_mm, whole.films) == (35.0, 1)
    assert (parted.width_mm, parted.films) == (15.0, 2)
    thinner = [oil_films(scene(OIL + f"groove_mm = {g}")).speeds[0].bearings[1].film_um for g in (0, 5)]
    assert thinner[1] < 0.8 * thinner[0]


@pytest.mark.slow
def test_a_film_near_the_permitted_one_keeps_its_oil() -> None:
    """Of those within 1.5 times, the big end alone; what is worse than permitted by it is said first."""
    result = oil_films(scene(OIL + "permitted_film_um = 1.7\npermitted_pressure_MPa = 95"))
    (at,) = result.speeds
    (one,) = at.conserving
    assert (one.bearing, result.near, result.holds) == ("big end", 1.5, False)
    own = one.conserving
    assert own is not None
    assert own.edge is None
    assert own.film_um == pytest.approx(one.film_um, rel=0.3)
    assert own.film_um != one.film_um
    assert own.pressure_MPa == pytest.approx(one.pressure_MPa, rel=0.3)
    assert 0.1 < own.least_filled < 0.9
    assert 0.01 < own.oil_cm3_per_s < 10
    assert own.oil_left_out < 1e-10
    row = next(line for line in film_text(result).splitlines() if line.startswith("big end "))
    assert f"{own.film_um:.2f}" in row.split(), "the table tells the film that is judged"
    lines = film_text(result).splitlines()
    assert lines[0] == f"below the permitted 1.7 um: big end {own.film_um:.2f} um at 2100 rpm"
    assert lines[1] == f"above the permitted 95 MPa: big end {own.pressure_MPa:.1f} MPa at 2100 rpm"
    assert "mass-conserving film of those within 1.5 times of what is permitted" in lines
    assert all(len(line) <= 80 for line in lines)
    told = {one.key for one in result.assumed}
    assert {"bearings.supply_pressure_MPa", "bearings.feed_hole_mm"} <= told
    assert "bearings.feed_hole_deg" not in told, "that is of main bearings"


def test_a_film_far_from_the_permitted_one_is_left_to_the_mobility_method(usual: FilmResult) -> None:
    assert usual.holds is True
    assert not usual.speeds[0].conserving
    assert "mass-conserving" not in film_text(usual)
    assert "near" not in usual.as_json()
    assert "bearings.supply_pressure_MPa" not in {one.key for one in usual.assumed}


def test_without_what_is_permitted_nothing_is_said_to_hold(solved: None) -> None:
    assert oil_films(scene()).holds is None


def test_a_limit_of_the_goal_counts_like_what_is_permitted(usual: FilmResult) -> None:
    """In um by itself; in percent of another web the least film and those within 1.5 times of it."""
    (at,) = usual.speeds
    told = ((3, 90), (2, 20), (4, 61), (6, 10), (2.9, 59), (9, 5))
    films = [
        one.model_copy(update={"film_um": film_um, "pressure_MPa": pressure_MPa})
        for one, (film_um, pressure_MPa) in zip(at.bearings, told, strict=True)
    ]

    def near(*limits: str) -> list[int]:
        limited = with_goal(scene(), minimise="mass", limits=limits)
        return [place for place, close in enumerate(near_limit(limited, films)) if close]

    assert near() == []
    assert near("oil_film >= 1.9 um") == [1]
    assert near("oil_film >= 1.95 um") == [1, 4]
    assert near("oil_film >= 95 %") == [1, 4]
    assert near("bearing_pressure <= 150 MPa") == []
    assert near("bearing_pressure <= 90.5 MPa") == [0, 2]
    assert near("bearing_pressure <= 105 %") == [0, 2]


def test_where_the_oil_comes_from() -> None:
    """A groove, a hole of the bearing at rest, a hole that turns with the pin, or the drilling of the pin."""
    angle = np.array([0.0, 90.0])
    base = scene(OIL + "supply_pressure_MPa = 0.4\nfeed_hole_mm = 5\nfeed_hole_deg = 30")
    still = oil_feed(base, "main 2", angle, 42.0)
    assert (still.pressure_MPa, still.groove_mm, still.hole_mm) == (0.4, 0.0, 5.0)
    assert np.degrees(still.hole_rad) == pytest.approx([30.0, 30.0])
    grooved = oil_feed(scene(OIL + "groove_mm = 5"), "main 2", angle, 42.0)
    assert (grooved.groove_mm, grooved.hole_rad) == (5.0, None)
    turning = oil_feed(scene(OIL + "groove_mm = 5"), "big end", angle, 42.0)
    assert turning.hole_mm == pytest.approx(4.2)
    assert np.degrees(turning.hole_rad) == pytest.approx([90.0, 180.0])
    drilling = (
        "[[throw.drilling]]\ndiameter_mm = 4.0\n[throw.drilling.to]\non = 'crankpin'\nangle_deg = -20.0\n"
    )
    drilling += "place_mm = 0.0\n"
    solid = re.sub(r"bore_diameter_mm = [0-9.]+", "bore_diameter_mm = 0.0", MIKRON)
    drilled = oil_feed(scene(OIL, solid + "\n" + drilling), "big end", angle, 42.0)
    assert drilled.hole_mm == 4.0
    assert np.degrees(drilled.hole_rad) == pytest.approx([-20.0, 70.0])


@pytest.mark.slow
def test_the_pressure_of_another_speed_is_told() -> None:
    result = oil_films(scene(OIL), [900.0])
    told = "The pressure is that of 2100 rpm at every speed: with less load it is lower;"
    assert told in film_text(result)
    assert "The pressure is that" not in film_text(oil_films(scene(OIL)))


def test_the_oil_is_assumed_where_none_is_given(solved: None) -> None:
    told = {one.key: one.value for one in oil_films(scene("clearance_mm = 0.05")).assumed}
    assert (told["bearings.oil"], told["bearings.temperature_C"]) == ("ISO VG 46", 100.0)
    given = oil_films(scene("clearance_mm = 0.05\nviscosity_mPas = 8"))
    assert (given.oil, given.viscosity_mPas) == (None, 8.0)
    assert not {"bearings.oil", "bearings.temperature_C"} & {one.key for one in given.assumed}


@pytest.mark.slow
def test_length_taken_from_a_bearing_has_its_price() -> None:
    """A thicker web at the same pitch leaves a shorter main bearing."""
    base = scene()
    assert film_change(parse_scene(MIKRON), parse_scene(MIKRON)) == ""
    thicker = with_values(base, {"web.thickness_mm": 23.0, "throw.main_journal.length_mm": 32.0})
    line = film_change(base, thicker)
    least, before = (
        float(number) for number in re.findall(r"main bearings (.*?) um .*?\((.*?) before", line)[0]
    )
    assert before == pytest.approx(
        min(one.film_um for one in oil_films(base).speeds[0].bearings[:-1]), abs=0.005
    )
    assert least < 0.9 * before


def test_a_main_journal_of_its_own_has_its_own_bearing() -> None:
    """And the half beyond the crankpin counts where it differs."""
    crank = "[[crank.main_journal]]\nnumber = 2\nouter_diameter_mm = 44.0\nlength_mm = 30.0\n"
    own = parse_scene(f"{MIKRON}\n{crank}\n[bearings]\n{OIL}")
    assert [(b.diameter_mm, b.width_mm) for b in (main_bearing(own, 1), main_bearing(own, 2))] == [
        (42.0, 35.0),
        (44.0, 25.0),
    ]
    at = "[throw.main_journal]"
    longer = MIKRON.replace(at, f"second_main_journal_length_mm = 30.0\n{at}", 1)
    other = parse_scene(f"{longer}\n[bearings]\n{OIL}", whole=True)
    assert main_bearing(other, 1).width_mm == 30.0


def test_command(tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch) -> None:
    file = tmp_path / "a.toml"
    file.write_text(f"{MIKRON}\n[bearings]\n{OIL}", encoding="utf-8")
    single, speeds = tmp_path / "single.toml", ["--speed", "1000:2000:1000"]
    one = MIKRON.replace("cylinders = 4", "cylinders = 1").replace("[1, 3, 4, 2]", "[1]")
    single.write_text(f"{one}\n[bearings]\n{OIL}", encoding="utf-8")
    assert main(["film", str(single), "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["viscosity_mPas"] == pytest.approx(5.61, abs=0.01)
    assert {one["key"] for one in found["assumed"]} >= {"bearings.width_mm", "bearings.temperature_C"}
    solved = []
    with monkeypatch.context() as patch:
        patch.setattr(stage, "orbits", lambda *of: solved.append(of) or orbits(*of))
        assert main(["film", str(single), *speeds, "--plot", str(tmp_path / "films.txt")]) == 2
        assert not solved, "a file that is no plot is refused before the work"
        assert main(["film", str(single), *speeds, "--plot", str(tmp_path / "films.png")]) == 0
        assert len(solved) == 1, "what is drawn is not solved again"
    told = capsys.readouterr().out
    assert "least film" in told
    assert re.findall(r"(?m)^ *(1000|2000|2100) ", told) == ["1000", "2000"], "not that of the engine, 2100"
    assert (tmp_path / "films.png").read_bytes().startswith(b"\x89PNG")
    assert main(["film", "mikron-iiic-plain"]) == 3
    assert "[bearings] is missing" in capsys.readouterr().err
    assert main(["film", str(file), "--speed", "0"]) == 3
    assert "only where the engine turns" in capsys.readouterr().err


def test_a_film_far_thinner_than_by_mobility_is_warned_of(
    usual: FilmResult, caplog: pytest.LogCaptureFixture
) -> None:
    """Such a film lacks oil: a starved one is told, one a little thinner is usual."""
    (at,) = usual.speeds
    own = {"film_deg": 470.0, "pressure_MPa": 150.0, "pressure_deg": 8.0, "least_filled": 0.5}
    for um, warned in ((5.3, False), (0.95, True)):
        film = ConservingFilm(film_um=um, **own, oil_cm3_per_s=1.0, oil_left_out=0.0)
        caplog.clear()
        _warn_of_thin(scene(), at.bearings[0].model_copy(update={"film_um": 5.5, "conserving": film}))
        assert ("83 % thinner than that of the mobility method, 5.50 um" in caplog.text) == warned
