"""What the commands without columns for it say of the error estimates of their stiffnesses."""

from __future__ import annotations

from typing import Any

from cranktopo.tasks.iterate.result import StepRow
from cranktopo.tasks.iterate.text import steps_estimate
from cranktopo.tasks.refit.page import refit_text
from cranktopo.tasks.refit.result import RefitResult
from cranktopo.tasks.throw_fea.quantities import estimate_line
from tests.told_evaluation import told_evaluation


def test_the_largest_of_each() -> None:
    assert estimate_line([0.1, 0.791], [1.394, 0.2]) == (
        "stiffnesses +-0.79 % in torsion, +-1.4 % in bending at most"
    )


def test_steps() -> None:
    steps = [
        {"torsion_error_percent": 0.3, "bending_error_percent": 1.2},
        {"torsion_error_percent": 0.8, "bending_error_percent": 0.7},
    ]
    assert (
        steps_estimate([StepRow.model_construct(None, **step) for step in steps])
        == "stiffnesses +-0.8 % in torsion, +-1.2 % in bending at most"
    )


def evaluation(torsion_percent: float, bending_percent: float) -> dict[str, Any]:
    return told_evaluation(error_percent=(torsion_percent, bending_percent))


def test_remodel_says_it_below_both_stiffnesses() -> None:
    data = {
        "run": "run",
        "design": "demo",
        "web": {},
        "parameters": [],
        "seconds": {},
        "trials": [],
        "rules": {"least_gain_percent": 0.2},
        "overlap_by_start": [0.8],
        "iou": {"half_throw": 0.9, "web": 0.8},
        "distance_mm": {"mean": 1.0, "max": 2.0, "max_at": [0, 0, 0]},
        "web_mass_kg": {"fitted": 0.5, "body": 0.5, "difference_percent": 0.0},
        "stiffness": {
            "body": evaluation(0.1, 0.6),
            "fitted_without_fillets": evaluation(0.9, 0.4),
            "fitted": evaluation(0.2, 1.5),
            "difference_percent": {"torsion": 1.0, "bending": 2.0},
        },
        "not_represented": [],
        "folder": "out",
        "files": dict.fromkeys(("report", "design", "step", "stl", "drawing", "drawing_svg", "json"), "file"),
    }
    lines = refit_text(RefitResult.of_json(data, "remodel.json")).splitlines()
    place = lines.index("stiffnesses +-0.9 % in torsion, +-1.5 % in bending at most")
    above = [line for line in lines[:place] if not line.startswith(" ")]  # without what goes on below
    assert above[-1].startswith("bending, kN/mm     230.0 without fillets")
