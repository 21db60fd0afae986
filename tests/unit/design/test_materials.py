"""The material library: enough of it, each with its source, and nothing out of order."""

from __future__ import annotations

import pytest

from cranktopo.design.material import Material, material_library

LIBRARY = material_library()


def test_there_are_a_dozen() -> None:
    assert len(LIBRARY) >= 12


@pytest.mark.parametrize("name", LIBRARY)
def test_each_names_its_source_and_is_in_order(name: str) -> None:
    entry, material = LIBRARY[name], Material(name=name)
    assert len(entry["source"]) > 20
    strengths = (material.fatigue_tension_MPa, material.fatigue_bending_MPa, material.yield_MPa)
    assert None not in strengths
    assert material.fatigue_tension_MPa < material.fatigue_bending_MPa < material.ultimate_MPa
    assert 0.5 * material.ultimate_MPa < material.yield_MPa < material.ultimate_MPa
    E_GPa = {"EN-GJS": 176, "EN-AW-": 72}.get(name[:6], 210)
    assert material.E_GPa == pytest.approx(E_GPa, rel=0.015)
