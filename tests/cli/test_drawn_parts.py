"""`cranktopo export FILE.pdf --part`: obeyed where the part has a sheet, else refused with what there is."""

from __future__ import annotations

from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import ExitCode
from cranktopo.design.loading import designs_folder

FORGING = "\n[forging]\nallowance_mm = 2.0\ndraft_deg = 5.0\nflash_mm = 2.0\n"


@pytest.fixture
def forged(tmp_path: Path) -> Path:
    design = tmp_path / "forged.toml"
    design.write_text((designs_folder() / "car-diesel.toml").read_text(encoding="utf-8") + FORGING)
    return design


@pytest.mark.slow
def test_the_raw_part_is_drawn_alone(
    forged: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    titles: list[str] = []
    monkeypatch.setattr(
        "cranktopo.tasks.drawing.raw_sheet.write_pages",
        lambda pages, name, paths: (titles.extend(page.title for page in pages), paths[0].touch()),
    )
    file = tmp_path / "raw.pdf"
    assert main(["export", str(forged), str(file), "--part", "raw"]) == ExitCode.DONE
    assert titles == ["car-diesel: raw part, half of it shown"]
    assert f"{file}: workshop drawing, raw part, A3" in capsys.readouterr().out
    assert file.exists()


def test_without_a_forging_there_is_no_raw_part(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "raw.svg"
    assert main(["export", "car-diesel", str(file), "--part", "raw"]) == ExitCode.INVALID_INPUT
    assert "forging" in capsys.readouterr().err
    assert not file.exists()


@pytest.mark.parametrize(
    ("part", "said"),
    [
        ("web", "it has no workshop drawing of its own, only .step and .stl"),
        ("half", "it has no workshop drawing of its own"),
        ("crankshaft", "cranktopo drawing DESIGN FILE draws the whole crank"),
        ("rod", "cranktopo rod DESIGN --drawing FILE draws it"),
        ("raw_crankshaft", "the raw one on page 2 of a PDF"),
    ],
)
def test_a_part_without_a_sheet_is_refused_with_what_there_is(
    part: str, said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = tmp_path / "part.pdf"
    assert main(["export", "mikron-iiic", str(file), "--part", part]) == ExitCode.USAGE
    told = " ".join(capsys.readouterr().err.split())
    assert f"--part {part}: " in told
    assert said in told
    assert "--part raw its raw part" in told
    assert not file.exists()
