"""A criterion of one's own: one file, one line of the registry, and `fatigue` and `compare` take it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.tasks.compare.printed import comparison_text
from cranktopo.tasks.compare.stage import compare_targets
from cranktopo.tasks.fatigue import criteria
from cranktopo.tasks.throw_fatigue.stage import assess_fatigue
from cranktopo.tasks.throw_fea.stage import MeshRequest

DESIGN = "mikron-iiic-plain"
FILE = '''
"""Gerber's parabola: amplitude / limit * n + (mean / ultimate * n)^2 = 1, solved for the safety n."""

import numpy as np

from cranktopo.tasks.fatigue.criterion import FatigueCriterion, PointSafety


def point_safety(scene, stress):
    limit = scene.material.fatigue_tension_MPa
    amplitude = np.maximum(stress.amplitude_MPa, 1e-9) / limit
    mean = np.maximum(stress.mean_MPa, 0.0) / scene.material.ultimate_MPa
    safety = 2 / (amplitude + np.sqrt(amplitude**2 + 4 * mean**2))
    one = np.ones_like(safety)
    return PointSafety(safety, limit * one, amplitude * safety, {"support": one})


def line(scene, strength_MPa, gradient_per_mm, mean_MPa):
    return strength_MPa * (1 - (np.maximum(mean_MPa, 0.0) / scene.material.ultimate_MPa) ** 2)


GERBER = FatigueCriterion(
    "gerber", ("fatigue_tension_MPa", "ultimate_MPa"), point_safety, line, includes="mean stress as parabola"
)
'''
LINE = '    "gerber": "gerber:GERBER",\n'


@pytest.fixture
def registered(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    """The file where Python finds it, and the registry as its source would make it with one line more."""
    (tmp_path / "gerber.py").write_text(FILE, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    source = Path(criteria.__file__).read_text(encoding="utf-8")
    head = "LOCAL_METHODS = {\n"
    assert source.count(head) == 1
    made: dict[str, Any] = {"__name__": "criteria_with_a_line"}
    exec(source.replace(head, head + LINE), made)
    for name in ("LOCAL_METHODS", "METHODS"):
        monkeypatch.setattr(criteria, name, made[name])


@pytest.mark.slow
@pytest.mark.usefixtures("registered")
def test_a_file_and_a_line_add_a_criterion(tmp_path: Path) -> None:
    found = assess_fatigue([DESIGN], "gerber", fillet_fraction=1.0, out=tmp_path)
    (field,) = found.fields
    steel, fillet = field.model.scene.material, field.model.on_fillet
    critical = field.safety[:, fillet].min()
    n, worst = critical, np.unravel_index(field.safety[:, fillet].argmin(), field.safety[:, fillet].shape)
    amplitude = field.amplitude_MPa[:, fillet][worst] / (steel.fatigue_tension_MPa or 0.0)
    mean = max(field.mean_MPa[:, fillet][worst], 0.0) / (steel.ultimate_MPa or 0.0)
    assert amplitude * n + (mean * n) ** 2 == pytest.approx(1.0)
    told = found.as_json()["fatigue"][0]["critical"]
    assert told["safety"] == pytest.approx(critical)
    assert told["factors"] == {"support": 1.0}
    assert (tmp_path / f"fatigue-gerber-{DESIGN}.png").exists()

    request = MeshRequest(element_size_mm=9.0)
    compared = compare_targets([DESIGN], DESIGN, request, ["lsa", "gerber"], fillet_fraction=1.0)
    assert compared.comparison.entries[0].further_safety["gerber"] == pytest.approx(critical)
    text = comparison_text(compared.comparison, "table")
    assert "lsa: size and survival by factors" in text
    assert "gerber: mean stress as parabola." in text
    assert "Safety by gerber, over " in text
