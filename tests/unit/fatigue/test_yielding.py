"""A word about stresses that no material carries."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

from cranktopo.base.notes import redirected
from cranktopo.tasks.throw_fatigue.remarks import note_yielding


def told(amplitude_MPa: float, mean_MPa: float, yield_MPa: float | None) -> list[str]:
    critical = SimpleNamespace(amplitude_MPa=amplitude_MPa, mean_MPa=mean_MPa, place="pin fillet")
    field: Any = SimpleNamespace(model=SimpleNamespace(name="mine"), critical=critical)
    lines: list[str] = []
    with redirected(lines.append):
        note_yielding(field, yield_MPa)
    return lines


def test_local_stress_above_yield_is_said() -> None:
    (line,) = told(2000.0, -1575.0, 900.0)
    assert line.startswith("warning: mine: 3575 MPa by linear elasticity at pin fillet, 4.0 times the yield")
    assert told(450.0, 449.0, 900.0) == []
    assert told(2000.0, 0.0, None) == []
