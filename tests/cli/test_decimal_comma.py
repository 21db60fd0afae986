"""Numbers with a decimal comma, in options and in a design: refused with the number to write."""

from __future__ import annotations

from pathlib import Path

import pytest

from cranktopo.app.main import main


@pytest.mark.parametrize(
    ("arguments", "meant"),
    [
        (["optimise", "mikron-iiic", "--volume-fraction", "0,3"], "0.3"),
        (["evaluate", "mikron-iiic", "--accuracy", "0,5%"], "0.5"),
        (["evaluate", "mikron-iiic", "--budget", "1,5min"], "1.5"),
        (["loads", "mikron-iiic", "--speed", "1000,5"], "1000.5"),
        (["sweep", "mikron-iiic", "--vary", "web.width_mm=48,5:50,5:3", "--out", "kept"], "48.5"),
    ],
    ids=["number", "percent", "time", "speeds", "range"],
)
def test_option(
    arguments: list[str],
    meant: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    assert main(arguments) in (2, 3)
    out, err = capsys.readouterr()
    assert out == ""
    assert f"A decimal comma: write {meant}." in err
    assert len(err.strip().splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("line", ["radius_mm = 48,5", "radius_mm = 48,5 # half the stroke"])
def test_design(line: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.toml"
    path.write_text(f'name = "mine"\n[throw]\n{line}\n', encoding="utf-8")
    assert main(["plan", str(path)]) == 3
    assert "a decimal comma: write 48.5: 'radius_mm = 48,5" in capsys.readouterr().err
