"""Pressures over speed: between two of them they are interpolated, in every stage that asks at a speed."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import designs_folder, load_scene, parse_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse, at_speed
from cranktopo.engine.gas import higher_elsewhere, pressure_curve
from cranktopo.engine.performance import pressure_words
from cranktopo.engine.vibration.shaft_chain import estimated_chain
from cranktopo.engine.vibration.steady import vibration
from cranktopo.engine.vibration.torque_harmonics import torque_harmonics
from cranktopo.tasks.loads.stage import loads_at_speeds
from cranktopo.tasks.loads.text import loads_text, sweep_text
from cranktopo.tasks.throw_fatigue.dossier_sections import engine_section

TEXT = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
PEAK = "peak_pressure_MPa = 5.16\npeak_angle_deg = 11.0\n"
PEAKS = {1000.0: 4.0, 2000.0: 6.0, 2500.0: 5.0}


def entry(rpm: float, peak_MPa: float) -> str:
    return f"[[engine.gas.map]]\nrpm = {rpm}\npeak_pressure_MPa = {peak_MPa}\npeak_angle_deg = 11.0\n"


def mapped(entries: str = "".join(entry(*pair) for pair in PEAKS.items())) -> Scene:
    head, tail = TEXT.split("[engine.masses]")
    assert PEAK in head
    return parse_scene(f"{head.replace(PEAK, '')}\n{entries}\n[engine.masses]{tail}")


def single(peak_MPa: float) -> Scene:
    return parse_scene(TEXT.replace("peak_pressure_MPa = 5.16", f"peak_pressure_MPa = {peak_MPa}"))


def pressure(scene: Scene, rpm: float) -> np.ndarray:
    curve = pressure_curve(at_speed(scene, rpm))
    assert curve is not None
    return curve.pressure_MPa


@pytest.mark.parametrize(("rpm", "peak_MPa"), PEAKS.items())
def test_at_the_speed_of_an_entry_it_is_that_curve(rpm: float, peak_MPa: float) -> None:
    assert pressure(mapped(), rpm) == pytest.approx(pressure(single(peak_MPa), rpm), rel=1e-12)


def test_a_peak_that_cannot_be_is_that_of_its_entry() -> None:
    """The error named engine.gas.peak_pressure_MPa, which no design with a map has."""
    scene = mapped(entry(1000.0, 1.2) + entry(2000.0, 6.0))
    with pytest.raises(
        CranktopoError, match=r"engine\.gas\.map\[0\]\.peak_pressure_MPa = 1\.2: .* 1000 rpm"
    ) as told:
        pressure_curve(scene)
    assert "its own trace by `file`" in told.value.hint


def test_between_two_speeds_and_beyond_the_last() -> None:
    low, high = (pressure(single(PEAKS[rpm]), rpm) for rpm in (1000.0, 2000.0))
    assert pressure(mapped(), 1250.0) == pytest.approx(0.75 * low + 0.25 * high, rel=1e-12)
    assert pressure(mapped(), 700.0) == pytest.approx(low, rel=1e-12)
    assert pressure(mapped(), 2800.0) == pytest.approx(pressure(single(5.0), 2500.0), rel=1e-12)
    assert analyse(at_speed(mapped(), 2000.0)).cycle is not None


def test_the_vibrating_shaft_has_the_pressures_of_each_speed() -> None:
    scene, speeds = mapped(), np.array([1000.0, 1500.0, 2000.0])
    together = vibration(estimated_chain(scene), _harmonics(scene), speeds)
    for index, rpm in enumerate(speeds):
        at = at_speed(scene, float(rpm))
        alone = parse_at(at, float(rpm))
        assert together.torque_Nm[index] == pytest.approx(alone, rel=1e-9, abs=1e-9)
    mean = analyse(at_speed(scene, 2000.0)).cycle
    assert mean is not None
    assert together.mean_torque_Nm[-1] <= mean.torque.engine_Nm.mean() * (1 + 1e-9)


def _harmonics(scene: Scene):  # type: ignore[no-untyped-def]
    found = torque_harmonics(scene)
    assert found is not None
    return found


def parse_at(scene: Scene, rpm: float) -> np.ndarray:
    """Torque of the sections with the one curve of that speed, which the harmonics take at the scene's."""
    harmonics = _harmonics(scene)
    plain = type(harmonics)(
        harmonics.orders, harmonics.gas_Nm, harmonics.inertia_Nm_s2, harmonics.firing_deg, harmonics.throw_of
    )
    return vibration(estimated_chain(scene), plain, np.array([rpm])).torque_Nm[0]


def test_files_are_found_beside_the_design(tmp_path: Path) -> None:
    angle = np.arange(0.0, 720.0, 2.0)
    for rpm, peak in ((1000, 40.0), (2000, 60.0)):
        bars = 1.0 + (peak - 1.0) * np.exp(-(((angle + 350) % 720 - 360) ** 2) / 800)
        rows = "\n".join(f"{a},{p}" for a, p in zip(angle, bars, strict=True))
        (tmp_path / f"{rpm}.csv").write_text(f"crank_angle_deg,pressure_bar\n{rows}\n")
    entries = "".join(f'[[engine.gas.map]]\nrpm = {rpm}\nfile = "{rpm}.csv"\n' for rpm in (1000, 2000))
    head, tail = TEXT.split("[engine.masses]")
    text = f"{head.replace(PEAK, '')}\n{entries}\n[engine.masses]{tail}"
    (tmp_path / "a.toml").write_text(text, encoding="utf-8")
    scene = load_scene(str(tmp_path / "a.toml"))
    assert pressure(scene, 1500.0).max() == pytest.approx(5.0, rel=1e-3)


@pytest.mark.parametrize(
    ("entries", "message"),
    [
        (PEAK + entry(1000, 4), "a map over speed and a single curve are both given"),
        (entry(1000, 4) + entry(1000, 5), "map[1].rpm = 1000.0: must be above the 1000 rpm before it"),
        ("[[engine.gas.map]]\nrpm = 1000\n", "give either file, or peak_pressure_MPa and peak_angle_deg"),
        (entry(1000, 4) + 'file = "a.csv"\n', "give either file, or peak_pressure_MPa and peak_angle_deg"),
        (entry(1000, 4).replace("11.0", "75.0"), "map[0].peak_angle_deg = 75.0: must be > 0 and < 60 deg"),
        (entry(1000, 4).replace("rpm =", "rmp ="), "unknown key engine.gas.map[0].rmp"),
    ],
)
def test_what_cannot_be_is_refused(entries: str, message: str) -> None:
    with pytest.raises(CranktopoError) as refused:
        mapped(entries)
    assert message in str(refused.value)


def test_a_higher_peak_at_another_speed_is_told() -> None:
    assert higher_elsewhere(at_speed(mapped(), 2000.0)) == ""
    told = higher_elsewhere(at_speed(mapped(), 2500.0))
    assert told == "pressure at 2500 rpm: peak 5 MPa; the map over speed has 6 MPa at 2000 rpm"
    assert loads_at_speeds(mapped(), [2500.0])[0].warnings[-1] == told


WIEBE = "Wiebe combustion model fitted to {} MPa at 11 deg"


def source(rpm: float) -> str:
    curve = pressure_curve(at_speed(mapped(), rpm))
    assert curve is not None
    return curve.source


def test_the_source_names_the_entries_of_the_map_that_act() -> None:
    """One at an entry and beyond the ends, two between: "between 2500 and 2500 rpm" is none of them."""
    assert source(2500.0).startswith(f"map over speed, entry of 2500 rpm: {WIEBE.format(5)}")
    beyond = "map over speed at {} rpm, beyond its ends: that of the nearest entry of {} rpm: "
    assert source(700.0).startswith(beyond.format(700, 1000) + WIEBE.format(4))
    assert source(2800.0).startswith(beyond.format(2800, 2500) + WIEBE.format(5))
    between = source(1250.0)
    assert between.startswith(
        f"map over speed at 1250 rpm, in proportion between 1000 rpm ({WIEBE.format(4)}"
    )
    assert f"and 2000 rpm ({WIEBE.format(6)}" in between
    (at,) = loads_at_speeds(mapped(), [2500.0])
    assert at.pressure_source == source(2500.0)


def test_every_entry_of_a_map_is_told() -> None:
    scene = mapped()
    words = pressure_words(scene, (1000.0, 1800.0))
    assert words.startswith("The pressure is that of the map over speed, in proportion between its entries: ")
    for rpm, peak in PEAKS.items():
        assert f"{rpm:g} rpm: {WIEBE.format(f'{peak:g}')}" in words
    assert "beyond its ends that of the nearest entry" not in words
    assert "beyond its ends that of the nearest entry" in pressure_words(scene, (700.0, 1800.0))
    data = engine_section(scene, analyse(scene).cycle).tables[0][1]
    rows = {str(row["what"]): str(row["value"]) for row in data.rows}
    for rpm, peak in PEAKS.items():
        told = rows[f"cylinder pressure at {rpm:g} rpm"]
        assert told.startswith(WIEBE.format(f"{peak:g}"))
        assert told.endswith(f"; largest {peak:g} MPa")


def test_one_pressure_at_other_speeds_is_told() -> None:
    scene = single(5.16)
    line = "The pressure is that of 2100 rpm at every speed: with less load it is lower; "
    assert pressure_words(scene, [2100.0]) == pressure_words(scene, []) == ""
    assert pressure_words(scene, [900.0]).startswith(line)
    assert line.strip() in " ".join(loads_text(loads_at_speeds(scene, [900.0])[0]).split())
    assert line.strip() in " ".join(sweep_text(loads_at_speeds(scene, [900.0, 2100.0])).split())
    assert line.strip() not in " ".join(loads_text(loads_at_speeds(scene)[0]).split())


def test_nothing_changes_without_a_map() -> None:
    scene = single(5.16)
    harmonics = _harmonics(scene)
    assert harmonics.gas_at_Nm(777.0) == pytest.approx(harmonics.gas_Nm)
    assert math.isclose(pressure(scene, 700.0).max(), pressure(scene, 2800.0).max())
