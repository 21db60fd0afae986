"""The table of `fatigue` tells outlets of oil bores where a throw has them, verdicts what meshes prove."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cranktopo.report.result_table import terminal
from cranktopo.tasks.throw_fatigue.mesh_quality import Quality
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.text import field_table
from cranktopo.tasks.throw_fatigue.verdicts import verdicts


def field(name: str, outlet: float | None) -> Any:
    critical = SimpleNamespace(
        safety=1.1,
        amplitude_MPa=200.0,
        mean_MPa=50.0,
        gradient_per_mm=0.5,
        strength_MPa=300.0,
        decided_by="amplitude",
        place="pin fillet",
    )
    at = None if outlet is None else SimpleNamespace(safety=outlet, place="oil outlet on the crankpin")
    model = SimpleNamespace(name=name, throw_kg=1.5)
    safeties = {"pin": 1.1, "journal": 1.4}
    return SimpleNamespace(model=model, critical=critical, fillet_safety=safeties, at_outlet=at)


def test_outlets_stand_behind_the_fillets() -> None:
    table = field_table([field("drilled", 1.234), field("solid", None)], baseline=None)
    names = list(table.columns)
    assert names[names.index("journal_safety") + 1] == "outlet_safety"
    assert [row["outlet_safety"] for row in table.rows] == [1.234, None]
    assert [row["outlet_place"] for row in table.rows] == ["oil outlet on the crankpin", None]
    lines = terminal(table).splitlines()
    assert max(map(len, lines)) <= 80
    assert any("1.234" in line for line in lines)


def test_without_outlets_the_table_is_as_before() -> None:
    assert not [name for name in field_table([field("solid", None)], None).columns if "outlet" in name]


def judged(name: str, safety: float, normal_percent: float, fitted: bool = False) -> FatigueField:
    """A target with a safety, by means over elements or by polynomials that are fitted to them."""
    quality = Quality(1.0, 0.3, 5000, normal_percent, 2.0, 1.0, 1.0)
    model: Any = SimpleNamespace(name=name, throw_kg=1.5, quality=quality, fitted=fitted)
    critical: Any = SimpleNamespace(safety=safety)
    none = np.zeros(0)
    return FatigueField(model, "lsa", (), none, none, none, critical, None, {}, {})


@pytest.mark.parametrize(
    ("other", "answer"),
    [
        (
            judged("other", 1.033, 4.0),
            "not told apart from base: the mesh of other misses the checks of IACS UR M53",
        ),
        (judged("other", 1.033, 2.0), "safer than base."),
        (judged("other", 1.033, 4.0, fitted=True), "safer than base."),
        (judged("other", 1.01, 4.0), "as safe as base."),
        (judged("other", 0.9, 4.0), "less safe than base."),
    ],
)
def test_a_coarse_mesh_tells_no_small_difference(other: FatigueField, answer: str) -> None:
    """Least values of scattered means: 3 % between webs that the default mesh has as safe as each other."""
    (line,) = verdicts([judged("base", 1.0, 2.0), other], 0)
    assert f" % safety: {answer}" in line
