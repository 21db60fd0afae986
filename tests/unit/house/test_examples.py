"""Every script of examples/ runs and writes its picture; the gallery shows all of them."""

from __future__ import annotations

import ast
import runpy
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

ROOT = Path(__file__).resolve().parents[3]
GALLERY = ROOT / "docs" / "pages" / "images" / "examples"
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))
LARGEST_PICTURE_BYTES = 60_000
SLOW = (
    "05_own_response",
    "06_own_fatigue",
    "07_sweep",
    "08_finished_run",
    "10_sensitivities",
    "11_goal_and_limits",
    "12_export",
)


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """One folder for all, so that the run that several read is made once."""
    return tmp_path_factory.mktemp("examples")


@pytest.mark.parametrize(
    "script",
    [
        pytest.param(script, id=script.stem, marks=[pytest.mark.slow] if script.stem in SLOW else [])
        for script in SCRIPTS
    ],
)
def test_an_example_writes_its_picture(script: Path, out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sys, "argv", [str(script), str(out)])
    runpy.run_path(str(script), run_name="__main__")
    plt.close("all")
    (shown,) = GALLERY.glob(f"{script.stem}.*")
    assert (out / shown.name).stat().st_size > 4000


def test_the_gallery_has_a_small_picture_of_every_example_and_no_other() -> None:
    pictures = sorted(GALLERY.iterdir())
    assert [picture.stem for picture in pictures] == [script.stem for script in SCRIPTS]
    assert all(picture.stat().st_size < LARGEST_PICTURE_BYTES for picture in pictures)
    assert len(SCRIPTS) >= 10


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_an_example_is_short_and_begins_with_its_topic_and_its_idea(script: Path) -> None:
    text = script.read_text(encoding="utf-8")
    topic, _, idea = (ast.get_docstring(ast.parse(text)) or "").partition(": ")
    assert 0 < len(topic) < 60
    assert idea.endswith(".")
    assert len(text.splitlines()) <= 45
