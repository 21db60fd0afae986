"""Every script of examples/ runs and writes its picture; the gallery shows all of them."""

from __future__ import annotations

import ast
import runpy
import sys
from collections.abc import Callable, Sequence
from pathlib import Path

import matplotlib.pyplot as plt
import pytest

from cranktopo.tasks.sweep.job import Job, do_job
from cranktopo.tasks.throw_fea.evaluation import Evaluation, evaluate
from cranktopo.tasks.throw_fea.targets import Target

ROOT = Path(__file__).resolve().parents[3]
GALLERY = ROOT / "docs" / "pages" / "images" / "examples"
SCRIPTS = sorted((ROOT / "examples").glob("*.py"))
LARGEST_PICTURE_BYTES = 60_000
OWN_WORK = ("07_sweep", "08_finished_run")
"""Scripts that start processes or a run, for which the quick tests have a cheaper one."""


def in_this_process(jobs: Sequence[Job], engine: object, done: Callable[..., None], enough: object) -> None:
    """Compute the points of a sweep one after the other: to start another process takes longer."""
    for job in jobs:
        done(job, do_job(job))


def coarsely(target: Target, _element_size_mm: float) -> Evaluation:
    """Evaluate a point of a sweep: what its picture shows is not the subject."""
    return evaluate(target, 24.0)


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
    monkeypatch.setattr("cranktopo.tasks.sweep.fineness.evaluate", coarsely)
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
