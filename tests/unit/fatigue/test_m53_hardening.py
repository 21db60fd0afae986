"""Surface-treated fillets by Appendix V of the crankshaft rule, by hand."""

from __future__ import annotations

import math
from typing import Any

import pytest

from cranktopo import load_scene
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.criteria import check_method
from cranktopo.tasks.throw_fatigue.hardened_layer import HardenedLayer
from cranktopo.tasks.throw_fatigue.m53 import (
    FilletCheck,
    concentration_factors,
    dimensions,
    nominal_stresses,
)
from cranktopo.tasks.throw_fatigue.m53_hardening import (
    FilletStress,
    local_bending,
    local_torsion,
    pin_stresses,
    surface_strength_MPa,
    transition_mm,
    transition_strength_MPa,
    treated_check,
)
from cranktopo.tasks.throw_fatigue.rule_fillets import fillet_checks
from tests.unit.fatigue.hardened_layers import INDUCTION, NITRIDED


def hardened(**table: Any) -> Scene:
    data = load_scene("mikron-iiic").model_dump(mode="json", exclude_none=True)
    given = {"process": "induction", "case_depth_mm": 2.0, "surface_hardness_HV": 600.0} | table
    return scene_from_dict({**data, "fatigue": {"hardening": given}})


def test_local_factors_by_hand() -> None:
    """alpha_B 3, R_H 10, W 60, S 25 (sqrt = 65) at t = 3; alpha_T 2, D 100."""
    exponent = 0.6 / math.sqrt(3)
    expected = 2 * math.exp(-0.6) + 1 - (6 / 65) ** exponent
    assert local_bending(3.0, 10.0, 65.0, 3.0) == pytest.approx(expected, rel=1e-14)
    assert expected == pytest.approx(1.6593, abs=5e-4)
    assert local_torsion(2.0, 10.0, 100.0, 3.0) == pytest.approx(
        math.exp(-0.3) + 1 - 0.06 ** (1 / math.sqrt(2)), rel=1e-14
    )
    assert local_bending(3.0, 10.0, 65.0, 0.0) == 3.0
    assert local_torsion(2.0, 10.0, 100.0, 0.0) == 2.0
    assert local_bending(3.0, 1.0, 65.0, 60.0) == 0.0


def test_strength_of_the_surface() -> None:
    assert surface_strength_MPa(INDUCTION) == 500.0
    assert surface_strength_MPa(NITRIDED) == 450.0


def test_strength_of_the_transition() -> None:
    """20 % off for 300 MPa of tension, and the local drop of hardness; nitrided: that of the core."""
    assert transition_strength_MPa(NITRIDED, 430.0) == 430.0
    assert transition_strength_MPa(INDUCTION, 430.0) == pytest.approx(430 * 0.9 * 0.8)
    measured = HardenedLayer("induction", 2.0, 600.0, 340.0, 340.0, ((0.0, -200.0), (2.0, 150.0)))
    assert transition_strength_MPa(measured, 430.0) == pytest.approx(430 * 0.9)
    assert (transition_mm(NITRIDED), transition_mm(INDUCTION)) == (pytest.approx(0.48), 2.0)


def test_the_worse_of_surface_and_transition_counts() -> None:
    stress = FilletStress(300.0, 0.0, 3.0, 2.0, 2.5, 42.0, 20.0)
    plain = FilletCheck(310.0, 430.0)
    found = treated_check(plain, NITRIDED, stress, 10.0)
    assert found.hardening is not None
    assert found.hardening.surface_acceptability == pytest.approx(450 / 310)
    below = 10 + 300 * local_bending(3.0, 2.5, 20.0, 0.48) / 3
    assert found.hardening.below_acceptability == pytest.approx(430 / below)
    assert found.acceptability == pytest.approx(450 / 310)
    assert found.hardening.depth_mm == 0.0
    shallow = treated_check(plain, HardenedLayer("induction", 0.2, 700.0, 340.0, 306.0), stress, 10.0)
    assert shallow.hardening is not None
    assert shallow.hardening.depth_mm == 0.2
    assert shallow.acceptability == shallow.hardening.below_acceptability


def test_stress_at_depth_0_is_that_of_the_rule() -> None:
    scene = load_scene("mikron-iiic")
    size = dimensions(scene)
    factors, nominal = concentration_factors(size), nominal_stresses(size, 265500.0, 9000.0, 410000.0)
    plain = fillet_checks(scene, size, factors, nominal)["pin"]
    assert pin_stresses(size, factors, nominal).equivalent_MPa(10.0) == pytest.approx(
        plain.equivalent_MPa, rel=1e-14
    )


def test_one_fillet_alone_is_treated() -> None:
    plain, hard = load_scene("mikron-iiic"), hardened(fillets="journal")
    size = dimensions(plain)
    factors, nominal = concentration_factors(size), nominal_stresses(size, 265500.0, 9000.0, 410000.0)
    before, after = (fillet_checks(scene, size, factors, nominal) for scene in (plain, hard))
    assert after["pin"] == before["pin"]
    assert after["journal"].hardening is not None
    assert after["journal"].acceptability > before["journal"].acceptability


def test_a_treatment_without_a_formula_in_the_rule_is_refused() -> None:
    with pytest.raises(CranktopoError, match="no formula for rolled pin fillets"):
        check_method(hardened(process="rolled", surface_hardness_HV=380.0), "m53")
    with pytest.raises(CranktopoError, match="nitrided surfaces from 600 HV on"):
        check_method(hardened(process="nitrided", case_depth_mm=0.4, surface_hardness_HV=550.0), "m53")
    check_method(hardened(), "m53")
    check_method(hardened(process="rolled", surface_hardness_HV=380.0), "lsa")
