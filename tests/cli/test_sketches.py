"""Sketches of the keys of a throw: every dimension has its name on one, in the template and on the page."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.design.reference import SKETCHES, scene_reference, template
from cranktopo.tasks.drawing.sketch import PARTS

KEPT = Path(__file__).resolve().parents[2] / "docs" / "pages" / "images" / "sketches"
TABLES = {
    **{table: {part} for table, part in SKETCHES.items()},
    "throw.main_journal": {"throw"},
    "throw.crankpin": {"throw"},
    "throw.drilling.from": {"drilling"},
    "throw.drilling.to": {"drilling"},
}
TOLERANCES = {"run_out_mm"}
"""What stands on the drawing and is no size of the body."""
ELSEWHERE = {"second_main_journal_length_mm", "second_crankpin_length_mm", "thickness_mm"}
"""A sketch shows half a throw; the thickness of the web is on that of the throw."""


def dimensions(part: str) -> set[str]:
    """Keys of lengths and angles that the tables of a sketch have."""
    return {
        key.name
        for table in scene_reference()
        if part in TABLES.get(table.path, ())
        for key in table.keys
        if key.unit in ("mm", "deg")
    } - (TOLERANCES | ELSEWHERE if part in ("throw", "web") else TOLERANCES)


@pytest.mark.parametrize(
    "part", ["web", *(pytest.param(p, marks=pytest.mark.slow) for p in PARTS if p != "web")]
)
def test_the_sketch_names_every_dimension(part: str, tmp_path: Path) -> None:
    """What is kept for the page is what the command draws."""
    path = tmp_path / f"{part}.svg"
    assert main(["designs", "sketch", part, str(path)]) == 0
    text = path.read_text(encoding="utf-8")
    words = set(re.findall(r"\w+", " ".join(re.findall(r"<text[^>]*>([^<]*)<", text))))
    assert dimensions(part) - words == set()
    kept = (KEPT / path.name).read_text(encoding="utf-8")
    assert re.findall(r"<text[^>]*>([^<]*)<", kept) == re.findall(r"<text[^>]*>([^<]*)<", text)


@pytest.mark.parametrize("part", PARTS)
def test_kept_sketches_name_every_dimension(part: str) -> None:
    """After `cranktopo designs sketch PART docs/pages/images/sketches/PART.svg --force`."""
    text = (KEPT / f"{part}.svg").read_text(encoding="utf-8")
    words = set(re.findall(r"\w+", " ".join(re.findall(r"<text[^>]*>([^<]*)<", text))))
    assert dimensions(part) - words == set()


def test_the_web_is_as_thick_as_on_the_sketch_of_the_throw() -> None:
    assert ">web.thickness_mm<" in (KEPT / "throw.svg").read_text(encoding="utf-8")


def test_every_part_is_named_in_the_template() -> None:
    named = set(re.findall(r"# Sketch: cranktopo designs sketch (\w+) ", template("mine")))
    assert named == set(PARTS) == set(SKETCHES.values())


def test_a_sketch_replaces_a_file_only_by_force(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "web.svg"
    path.write_text("mine", encoding="utf-8")
    assert main(["designs", "sketch", "web", str(path)]) == 2
    assert path.read_text(encoding="utf-8") == "mine"
    assert main(["designs", "sketch", "web", str(path), "--force"]) == 0
    assert "<svg" in path.read_text(encoding="utf-8")
