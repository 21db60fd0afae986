"""The table of `fatigue` tells outlets of oil bores where a throw has them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from cranktopo.report.result_table import terminal
from cranktopo.tasks.fatigue.text import field_table


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
