"""`cranktopo bound` on coarse cells: what it prints, what it refutes and what it refuses."""

from __future__ import annotations

import json
from typing import Any

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import ExitCode

COARSE = ["--resolution-mm", "4.5", "--quiet"]


def test_the_bound_as_json(capsys: Any) -> None:
    goal = ["--maximise", "torsion", "--limit", "bending none", "--limit", "unbalance <= 100 %"]
    assert main(["bound", "mikron-iiic-plain", *goal, *COARSE, "--json"]) == ExitCode.DONE
    found = json.loads(capsys.readouterr().out)
    assert {"schema_version", "design", "goal", "original", "weights", "cells", "seconds"} <= set(found)
    assert found["resolution_mm"] == 4.5
    assert (found["process"], found["die"]) == ("forged", True)
    bound, own = found["bound"], found["original"]["torsion"]
    assert (bound["quantity"], bound["unit"]) == ("torsion", "N m/rad")
    assert bound["percent_of_original"] == pytest.approx(100 * bound["value"] / own)
    assert 110 < found["variable_stiffness"]["percent_of_original"] < bound["percent_of_original"] < 140
    assert set(found["weights"]) == {"mass", "unbalance"}
    assert [entry["limit"] for entry in found["goal"]["dropped"]] == ["fatigue_safety >= 100 %"]
    assert set(found["model_error_percent"]) == {"torsion", "bending"}


@pytest.mark.slow
def test_the_bound_as_text(capsys: Any) -> None:
    assert main(["bound", *COARSE]) == ExitCode.DONE
    text = capsys.readouterr().out
    assert "least mass" in text
    assert "not below 1." in text
    assert "whatever its topology" in text
    assert "fatigue_safety >= 100 %: stress is not part of the proof" in text


def test_limits_that_no_web_keeps_are_refuted(capsys: Any) -> None:
    limit = ["--limit", "torsion >= 500 %"]
    assert main(["bound", "--minimise", "mass", *limit, *COARSE]) == ExitCode.CRITERION_NOT_MET
    assert "NO WEB of this envelope keeps these limits" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("arguments", "code", "text"),
    [
        (
            ["--maximise", "fatigue_safety", *COARSE],
            ExitCode.INVALID_INPUT,
            "stress is not part of the proof",
        ),
        (["--resolution-mm", "12"], ExitCode.INVALID_INPUT, "too coarse"),
    ],
)
def test_what_is_refused(arguments: list[str], code: ExitCode, text: str, capsys: Any) -> None:
    assert main(["bound", *arguments]) == code
    assert text in capsys.readouterr().err
