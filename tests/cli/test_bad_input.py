"""Every user's mistake: one clear line, the documented exit code, nothing written."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import designs_folder

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")


@pytest.fixture(autouse=True)
def _in_empty_folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def fails(capsys: pytest.CaptureFixture[str], code: int, *arguments: str) -> str:
    before = sorted(Path().rglob("*"))
    assert main(["optimise", *arguments]) == code
    captured = capsys.readouterr()
    assert sorted(Path().rglob("*")) == before, "something was written"
    assert captured.out == ""
    lines = captured.err.strip().splitlines()
    assert len(lines) == 1, lines
    assert lines[0].startswith("error: ")
    assert "Traceback" not in captured.err
    return lines[0]


@pytest.mark.parametrize("value", ["0", "1", "1.5", "-0.1", "nan", "inf", "a third"])
def test_volume_fraction(capsys: pytest.CaptureFixture[str], value: str) -> None:
    line = fails(capsys, 2, "--volume-fraction", value)
    assert "--volume-fraction" in line
    assert value in line
    assert "must be a number >= 0.01 and <= 0.99" in line


@pytest.mark.parametrize("value", ["0", "-1", "nan", "fine"])
def test_resolution(capsys: pytest.CaptureFixture[str], value: str) -> None:
    assert "must be a number >= 0.001" in fails(capsys, 2, "--resolution-mm", value)


def test_resolution_too_coarse_names_the_wall(capsys: pytest.CaptureFixture[str]) -> None:
    line = fails(capsys, 3, "--resolution-mm", "6")
    assert "optimise.resolution_mm = 6.0" in line
    assert "wall is 9 mm" in line
    assert "at most 4.5 mm" in line


@pytest.mark.parametrize("value", ["0.05", "0.001"])
def test_resolution_too_fine_says_what_fits(capsys: pytest.CaptureFixture[str], value: str) -> None:
    line = fails(capsys, 3, "--resolution-mm", value)
    assert "GiB needed" in line
    finest = float(line.split("about ")[-1].split(" mm")[0])
    assert 0.05 < finest < 1.5


@pytest.mark.parametrize(
    ("old", "new", "expected"),
    [
        ("width_mm = 50.0", "witdh_mm = 50.0", ["unknown key web.witdh_mm", "'width_mm'"]),
        ("[engine.gas]", "[engine.gass]", ["unknown key engine.gass", "'gas'"]),
        ("radius_mm = 48.0", "radius_mm = -48.0", ["throw.radius_mm = -48.0", ">= 0.05 and <= 20000"]),
        ("length_mm = 40.0", "length_mm = 0.0", ["throw.main_journal.length_mm = 0.0", ">= 0.05"]),
        ("radius_mm = 48.0", "radius_mm = nan", ["throw.radius_mm = nan", "finite"]),
        ("radius_mm = 48.0", 'radius_mm = "wide"', ["throw.radius_mm = 'wide'", "number"]),
        ("bore_diameter_mm = 24.0", "bore_diameter_mm = 42.0", ["bore_diameter_mm = 42.0", "smaller than"]),
        ('"obround"', '"obrund"', ["web.outline = 'obrund'", "'obround'"]),
        ('"31CrMoV9"', '"31CrMoV8"', ["material.name = '31CrMoV8'", "'31CrMoV9'"]),
        ("y_min_mm = -34.0", "y_min_mm = 30.0", ["envelope", "end face of throw.main_journal"]),
        ("y_max_mm = 82.0", "y_max_mm = 20.0", ["envelope", "end face of throw.crankpin"]),
        ("rod_length_mm = 166.0", "rod_length_mm = 40.0", ["engine.rod_length_mm = 40.0", "longer than"]),
        ("volume_fraction = 0.3", "volume_fraction = 1.5", ["optimise.volume_fraction = 1.5", "<= 0.99"]),
        ("schema_version = 1", "schema_version = 7", ["schema_version = 7"]),
        ("[throw]", "[throw", ["not valid TOML", "line"]),
    ],
)
def test_design(
    capsys: pytest.CaptureFixture[str], tmp_path: Path, old: str, new: str, expected: list[str]
) -> None:
    assert old in MIKRON
    (tmp_path / "mine.toml").write_text(MIKRON.replace(old, new, 1), encoding="utf-8")
    line = fails(capsys, 3, "mine.toml")
    for words in expected:
        assert words in line


@pytest.mark.parametrize(
    "command", ["loads", "plan", "optimise", "evaluate", "fatigue", "shaft", "accuracy", "iterate"]
)
def test_a_web_that_cannot_exist(capsys: pytest.CaptureFixture[str], tmp_path: Path, command: str) -> None:
    (tmp_path / "mine.toml").write_text(
        MIKRON.replace("width_mm = 50.0", "width_mm = 20.0"), encoding="utf-8"
    )
    assert main([command, "mine.toml"]) == 3
    captured = capsys.readouterr()
    assert captured.out == ""
    assert captured.err == (
        "error: throw.main_journal.bore_diameter_mm = 24.0: breaks through the web's rim; "
        "must be smaller than 19.8 mm. Reduce the bore or widen the web.\n"
    )


def test_missing_design_suggests_the_nearest(capsys: pytest.CaptureFixture[str]) -> None:
    line = fails(capsys, 3, "mikron")
    assert "no such file or built-in design" in line
    assert "'mikron-iiic'" in line


def test_no_envelope(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    text = MIKRON[: MIKRON.index("[envelope]")]
    (tmp_path / "mine.toml").write_text(text, encoding="utf-8")
    assert "Add an [envelope] table" in fails(capsys, 3, "mine.toml")


def test_output_that_exists_is_never_overwritten(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "taken").mkdir()
    (tmp_path / "taken" / "file").write_text("mine")
    assert "not empty" in fails(capsys, 3, "--out", "taken")


def test_unwritable_output(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    assert "is a file" in fails(capsys, 3, "--out", "file/run")


def test_misspelt_command_option_and_run(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["optimize"]) == 2
    assert "'optimise'" in capsys.readouterr().err
    assert "--volume-fraction" in fails(capsys, 2, "--volume-fracton", "0.3")
    assert "no such run" in fails(capsys, 3, "--resume", "yesterday")
    assert "--max-iterations" in fails(capsys, 2, "mikron-iiic-plain", "--resume", "yesterday")


def test_error_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["optimise", "--json", "--resolution-mm", "6"]) == 3
    captured = capsys.readouterr()
    error = json.loads(captured.out)["error"]
    assert error["code"] == 3
    assert "resolution_mm" in error["message"]
    assert "4.5 mm" in error["hint"]


@pytest.mark.parametrize(
    ("typed", "message"),
    [
        ("forgd", "'forgd' is none of free, forged, cast, milled. Did you mean 'forged'?"),
        ("xyz", "'xyz' is none of free, forged, cast, milled. See"),
    ],
)
def test_misspelt_word_of_an_option(typed: str, message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["optimise", "--process", typed]) == 2
    assert message in capsys.readouterr().err


@pytest.mark.parametrize("command", ["evaluate", "shaft"])
def test_elements_too_fine_say_what_fits(
    command: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cranktopo.bodies.memory.available_memory_MiB", lambda: 8 * 1024.0)
    assert main([command, "mikron-iiic-plain", "--element-size-mm", "0.3", "--quiet"]) == 3
    captured = capsys.readouterr()
    assert captured.out == ""
    (line,) = captured.err.splitlines()
    assert "element size = 0.3: too fine: at least 2" in line
    finest = float(line.split("about ")[-1].split(" mm")[0])
    assert 0.6 < finest < 1.5


def test_a_bad_date_of_writing_is_one_line(
    capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Every command ended in exit 1, by a library that reads the same variable."""
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "x")
    assert main(["loads"]) == 3
    assert capsys.readouterr().err.startswith("error: SOURCE_DATE_EPOCH = 'x': must be seconds since 1970")
