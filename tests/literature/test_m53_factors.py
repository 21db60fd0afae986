"""Concentration factors from finite elements against the polynomials of IACS UR M53, also with recesses."""

from __future__ import annotations

import pytest

from cranktopo.engine.throw_compliance import web_lever_mm
from cranktopo.tasks.throw_fatigue.m53 import concentration_factors, dimensions, nominal_stresses
from cranktopo.tasks.throw_fatigue.rule_fillets import element_factors
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fea.targets import Target
from tests.studies.example_throws import rule_throws


@pytest.mark.slow
@pytest.mark.parametrize("name", ["rule-example", "recessed", "mikron-iiic-plain", "industrial-gas"])
def test_elements_agree_with_the_rule(name: str) -> None:
    """On the rule's own mesh, whose two checks of quality must hold.

    The shear factor is a small remainder of two large stresses: it is held in the sum it belongs to, which
    the rule's second method takes instead.
    """
    scene = rule_throws()[name]
    size = dimensions(scene)
    model = solve_stresses(Target(name, scene), ("moment", "bending", "torsion"), by_rule=True)
    assert model.quality.within_limits, model.quality
    assert model.quality.longest_edge < 0.25
    found, rule = element_factors(model), concentration_factors(size)
    for factor in ("alpha_bending", "alpha_torsion", "beta_bending", "beta_torsion"):
        assert getattr(found, factor) == pytest.approx(getattr(rule, factor), rel=0.2), factor
    n = nominal_stresses(size, web_lever_mm(scene) / 2, 0.5, 0.0)
    sums = [f.beta_bending * n.bending_MPa + f.beta_shear * n.shear_MPa for f in (found, rule)]
    assert sums[0] == pytest.approx(sums[1], rel=0.2)
