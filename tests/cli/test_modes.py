"""`cranktopo modes`: what it prints and writes, what it warns of, what it refuses."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import designs_folder
from cranktopo.tasks.modes.result import ShaftModes
from cranktopo.tasks.modes.text import modes_text

pytestmark = pytest.mark.usefixtures("throws_made_once")

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
COARSE = ["--element-size-mm", "24", "--quiet"]
FLYWHEEL = "[shaft.flywheel]\ninertia_kg_m2 = 0.6\nmass_kg = 25.0\noverhang_mm = 80.0\n"
PULLEY = "[shaft.pulley]\ninertia_kg_m2 = 0.01\n"


def design(folder: Path, table: str) -> str:
    path = folder / "mine.toml"
    path.write_text(MIKRON.replace("[engine]\n", f"{table}\n[engine]\n", 1), encoding="utf-8")
    return str(path)


def printed(arguments: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    assert main(["modes", *arguments, *COARSE]) == 0
    return capsys.readouterr().out


@pytest.fixture(scope="module")
def found(tmp_path_factory: pytest.TempPathFactory) -> tuple[ShaftModes, str]:
    """Modes of an engine with a flywheel beyond its bearings, and their page."""
    folder = tmp_path_factory.mktemp("modes")
    page = folder / "modes.html"
    with pytest.MonkeyPatch.context() as patched:
        text: list[str] = []
        patched.setattr("click.echo", lambda message="", **_: text.append(str(message)))
        words = [design(folder, PULLEY + FLYWHEEL), "--speeds", "1000:6000:6", "--report", str(page)]
        assert main(["modes", *words, "--json", *COARSE]) == 0
    return ShaftModes.of_json(json.loads(text[-1]), "modes --json"), page.read_text(encoding="utf-8")


def test_the_json_is_that_of_the_model(found: tuple[ShaftModes, str]) -> None:
    modes = found[0]
    assert modes.speeds_rpm == pytest.approx([1000.0 + 1000.0 * i for i in range(6)])
    assert all(len(mode.frequencies_Hz) == len(mode.whirl) == 6 for mode in modes.modes)
    places = [station.z_mm for station in modes.modes[0].shape]
    assert places == sorted(places)
    assert len(places) == 5 + 8 + 2


def test_the_text_tells_what_counts(found: tuple[ShaftModes, str]) -> None:
    text = modes_text(found[0])
    assert "bending" in text
    assert "torsion" in text
    assert "forward" in text
    assert "backward" in text
    assert "shaft.pulley.mass_kg is not given" in text
    assert "The lowest order that meets a mode from 1,000 to 6,000 rpm is" in text
    tables = [line for line in text.splitlines() if line[:1].isdigit() and "  " in line]
    assert max(map(len, tables)) <= 80


def test_damping_that_modes_leave_out_is_not_assumed(found: tuple[ShaftModes, str]) -> None:
    keys = {one.key for one in found[0].assumed}
    assert "shaft.pulley.overhang_mm" in keys
    assert not [key for key in keys if "damping" in key or "loss" in key]


def test_orders_meet_modes_where_they_say(found: tuple[ShaftModes, str]) -> None:
    speeds = found[0].speeds_rpm
    for mode in found[0].modes:
        for at in mode.critical_speeds:
            assert speeds[0] <= at.speed_rpm <= speeds[-1]
            below = max(i for i, speed in enumerate(speeds[:-1]) if speed <= at.speed_rpm)
            low, high = sorted(mode.frequencies_Hz[below : below + 2])
            assert low - 1e-6 <= at.order * at.speed_rpm / 60 <= high + 1e-6


def test_the_page_has_diagrams_and_shapes(found: tuple[ShaftModes, str]) -> None:
    page = found[1]
    for word in ("Frequencies at rest", "Over speed", "Shapes", "First torsion", "First bending"):
        assert word in page
    assert page.count("<svg") == 2 + 6


def test_bearings_without_a_spring_are_refused(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["modes", "mikron-iiic-plain", "--bearings", "spring", *COARSE]) == 3
    assert "supports.bearing_spring_N_per_mm" in capsys.readouterr().err


def test_a_page_is_checked_before_anything_is_solved(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["modes", "--report", "modes.txt"]) != 0
    assert ".html" in capsys.readouterr().err


def test_the_speeds_are_those_of_the_design(capsys: pytest.CaptureFixture[str]) -> None:
    text = printed(["mikron-iiic-plain"], capsys)
    assert "At 2,800 rpm" in text


def test_a_mode_of_disks_that_bending_shares_is_told(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """A V-twin with a flywheel: none of its modes is the one of its disks, least of all the stiff ones."""
    text = (Path(__file__).parents[1] / "data/v-twin.toml").read_text(encoding="utf-8")
    path = tmp_path / "twin.toml"
    path.write_text(f"{text}mass_kg = 2.5\noverhang_mm = 40.0\n", encoding="utf-8")
    found = ShaftModes.of_json(json.loads(printed([str(path), "--json"], capsys)), "modes --json")
    assert not [mode for mode in found.modes if mode.disks_Hz is not None]
    (shared,) = found.disks_shared
    assert set(shared.modes[:2]) == {2, 3}
    assert sum(shared.shares_percent[:2]) > 60.0
    assert f"Disks swing at {shared.disks_Hz:.1f} Hz; no mode of the body is that alone" in modes_text(found)
