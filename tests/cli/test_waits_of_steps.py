"""Waits of commands whose steps are known: a bar, which step of how many, and the time left."""

from __future__ import annotations

import logging
import re
from itertools import count

import pytest

from cranktopo.base.progress import StageMemory
from cranktopo.design.loading import load_scene
from cranktopo.engine.analysis import at_speed
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.fit import fit_problem
from cranktopo.tasks.refit.search import Fit, minimise_misfit, outline_guess
from cranktopo.tasks.shaft import continuous
from cranktopo.tasks.shaft.condensed_throw import once_each
from cranktopo.tasks.throw_fatigue import stage as fatigue_stage
from cranktopo.tasks.throw_fea.stage import evaluate_targets
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.web_shape.refining import refined
from cranktopo.tasks.web_shape.search_goal import SearchGoal
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from tests.cli.test_comparison_report import invented
from tests.physics.shape.test_shape_refining import EXTENT, LAYOUT, START, bowls
from tests.unit.refit.remodel_cases import body_of

NAMES = ("mikron-iiic-plain", "mikron-iiic-hollow", "mikron-iiic")


@pytest.fixture
def slow(monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> pytest.LogCaptureFixture:
    """Every reading of the clock is 5 s after the one before; lines are kept."""
    clock = count(0.0, 5.0)
    monkeypatch.setattr("cranktopo.base.notes.time.perf_counter", lambda: next(clock))
    caplog.set_level(logging.INFO, logger="cranktopo.notes")
    return caplog


def lines(caplog: pytest.LogCaptureFixture, work: str) -> list[str]:
    return [record.getMessage() for record in caplog.records if record.getMessage().startswith(f"{work}: [")]


def targets() -> list[Target]:
    return [Target(name, load_scene(name)) for name in NAMES]


def test_evaluate_and_compare_tell_their_targets(
    slow: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr("cranktopo.tasks.throw_fea.stage.evaluate", invented)
    evaluate_targets(targets())
    told = lines(slow, "evaluation")
    assert told[1] == "evaluation: [####--------] 2 of 3, mikron-iiic-hollow, about 20 s left"


def test_fatigue_and_compare_tell_their_targets(
    slow: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(fatigue_stage, "_fields", lambda *_, **__: (None,))
    monkeypatch.setattr(fatigue_stage, "_note_fields", lambda *_: None)
    monkeypatch.setattr(fatigue_stage, "FatigueAssessment", lambda *given, **_: given)
    fatigue_stage.assess_by_methods(targets(), ("lsa",))
    assert lines(slow, "fatigue")[2].startswith("fatigue: [########----] 3 of 3, mikron-iiic, about ")


def test_shaft_vibration_and_modes_tell_throws_that_differ(slow: pytest.LogCaptureFixture) -> None:
    assert once_each([*targets(), targets()[0]], lambda throw: throw.name) == [*NAMES, NAMES[0]]
    assert lines(slow, "throws")[1].startswith("throws: [####--------] 2 of 3, mikron-iiic-hollow, about ")


def test_a_shaft_tells_its_speeds(slow: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(continuous, "_at_speed", lambda *_: None)
    monkeypatch.setattr(continuous, "_with_films", lambda every: every)
    scene = load_scene("mikron-iiic")
    continuous.continuous_shafts([], [at_speed(scene, rpm) for rpm in (900.0, 1500.0, 2100.0)], None)
    told = lines(slow, "shaft on its bearings")
    assert told[2].startswith("shaft on its bearings: [########----] 3 of 3, 2100 rpm, about ")


def test_shape_tells_its_steps(slow: pytest.LogCaptureFixture) -> None:
    rough, exact = bowls()
    refined(rough, exact, LAYOUT, START, SearchGoal("mass", 1.0, 100.0, ()), StageMemory(), EXTENT)
    told = lines(slow, "steps judged by elements")
    assert re.fullmatch(r".*: \[#-{11}\] 2 of at most 8, at most \d+ (s|min) left", told[1])


def test_remodel_tells_the_webs_of_its_fits(slow: pytest.LogCaptureFixture) -> None:
    scene = load_scene("mikron-iiic-plain")
    problem = fit_problem(body_of(scene, 3.0), scene, ManufacturingLimits(), 5.0)
    fit = Fit(problem, Layout(7, ()))
    minimise_misfit(fit, outline_guess(problem, 7), (2.5,), "outline")
    told = lines(slow, f"outline, webs of {len(fit.web.layout.names)} dimensions")
    assert re.fullmatch(r".*: \[-{12}\] 2 of at most \d+, at most \d+ (s|min) left", told[1])
