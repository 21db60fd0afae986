"""`compare --report`: the page of a comparison, without the finite elements."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cranktopo.cli.main import main
from cranktopo.evaluate.evaluation import Evaluation, Stiffness
from cranktopo.evaluate.targets import Target

NAMES = ["opposed-piston", "opposed-piston-casting"]


def judged(target: Target, *_: object) -> Evaluation:
    """An invented judgement: the casting is lighter and stiffer per mass."""
    light = target.name.endswith("casting")
    torsion, bending = (90e3, 50e3) if light else (100e3, 70e3)
    fine = Stiffness({"free": torsion}, {"pinned": bending}, 1234, 4.0, 1.0, 2.0)
    mass = 1.5 if light else 2.0
    return Evaluation(target.name, mass, mass / 3, 5000, 50, fine, "free", "pinned", 0.3, 0.4, 3.0 + light)


@pytest.fixture(autouse=True)
def _without_finite_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cranktopo.evaluate.evaluation.evaluate", judged)


def test_html(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "page.html"
    assert main(["compare", *NAMES, "--baseline", NAMES[0], "--report", str(path), "--quiet"]) == 0
    assert capsys.readouterr().err == ""
    text = path.read_text(encoding="utf-8")
    assert path.stat().st_size < 8_000_000
    assert "opposed-piston-casting is the stiffest in torsion per kilogram: +20.0 % against" in text
    assert re.findall(r'data-value="([^"]*)"', text)[:3] == ["2.0", "100.0", "70.0"]
    assert text.count("<option") == 2
    assert "SHA-256 of the scene" in text


def test_markdown(tmp_path: Path) -> None:
    path = tmp_path / "page.md"
    assert main(["compare", NAMES[1], "--baseline", NAMES[0], "--report", str(path)]) == 0
    text = path.read_text(encoding="utf-8")
    names = re.findall(r"!\[.*?\]\((.*?)\)", text)
    assert len(names) >= 3
    assert all((tmp_path / name).is_file() for name in names)
    assert "| opposed-piston-casting | 1.500* | 90.00 |" in text


@pytest.mark.parametrize("name", ["page.pdf", "page", "absent/page.html"])
def test_bad_name_is_refused_before_the_work(
    name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", *NAMES, "--baseline", NAMES[0], "--report", str(tmp_path / name)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.strip().splitlines()) == 1
    assert list(tmp_path.iterdir()) == []
