"""Every script of examples/ runs and writes its picture; the gallery shows all of them."""

from __future__ import annotations

import ast
import runpy
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import matplotlib.pyplot as plt
import pytest

from cranktopo.design.schema import Scene
from cranktopo.tasks.evaluate.sensitivities import Sensitivities, evaluate_sensitivities
from cranktopo.tasks.sweep.job import Job, do_job
from cranktopo.tasks.throw_fea.evaluation import Evaluation, evaluate
from cranktopo.tasks.throw_fea.targets import Target

ROOT = Path(__file__).resolve().parents[3]
GALLERY = ROOT / "docs" / "pages" / "images" / "examples"
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))
LARGEST_PICTURE_BYTES = 60_000
OWN_WORK = (
    "04_two_webs",
    "07_sweep",
    "08_finished_run",
    "10_sensitivities",
    "11_goal_and_limits",
    "12_export",
)
"""Scripts that start processes or a run or solve much, for which the quick tests have something cheaper."""


def in_this_process(jobs: Sequence[Job], engine: object, done: Callable[..., None], enough: object) -> None:
    """Compute the points of a sweep one after the other: to start another process takes longer."""
    for job in jobs:
        done(job, do_job(job))


def coarsely(target: Target, _element_size_mm: float) -> Evaluation:
    """Evaluate a web: what its picture shows is not the subject."""
    return evaluate(target, 24.0)


def coarse_sensitivities(target: str, **_: float) -> Sensitivities:
    return evaluate_sensitivities(target, element_size_mm=20.0)


with_optimise = Scene.with_optimise


def few_iterations(scene: Scene, **settings: Any) -> Scene:
    return with_optimise(scene, **settings | ({"max_iterations": 2} if "max_iterations" in settings else {}))


@pytest.fixture(scope="module")
def out(tmp_path_factory: pytest.TempPathFactory, default_run: Path) -> Path:
    """One folder for all, with the run that several read."""
    folder = tmp_path_factory.mktemp("examples")
    (folder / "run").symlink_to(default_run, target_is_directory=True)
    return folder


def runs(script: Path, out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Run a script, which has to write the picture that the gallery shows of it."""
    monkeypatch.setattr(sys, "argv", [str(script), str(out)])
    runpy.run_path(str(script), run_name="__main__")
    plt.close("all")
    (shown,) = GALLERY.glob(f"{script.stem}.*")
    assert (out / shown.name).stat().st_size > 4000


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda script: script.stem)
def test_an_example_writes_its_picture(script: Path, out: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cranktopo.tasks.sweep.computed.compute", in_this_process)
    for room in ("sweep.fineness", "throw_fea.stage"):
        monkeypatch.setattr(f"cranktopo.tasks.{room}.evaluate", coarsely)
    monkeypatch.setattr("cranktopo.evaluate_sensitivities", coarse_sensitivities)
    monkeypatch.setattr("cranktopo.bodies.solid.files._FACET_MM", 4.0)
    monkeypatch.setattr(Scene, "with_optimise", few_iterations)
    runs(script, out, monkeypatch)


@pytest.mark.slow
@pytest.mark.parametrize("name", OWN_WORK)
def test_an_example_does_its_own_work(name: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    runs(ROOT / "examples" / f"{name}.py", tmp_path, monkeypatch)


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
