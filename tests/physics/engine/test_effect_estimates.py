"""The closed-form estimates of the plan against finite elements: none is off by a factor of two."""

from __future__ import annotations

import pytest

from tests.studies.effect_truths import estimates, scenes, truths


@pytest.mark.slow
@pytest.mark.parametrize("index", range(4))
def test_estimates_are_within_a_factor_of_two(float64: None, index: int) -> None:
    scene = scenes()[index]
    computed, estimated = truths(scene), estimates(scene)
    ratios = {
        name: estimate / truth
        for name, truth in computed.items()
        if truth > 1e-9 and (estimate := estimated[name]) is not None
    }
    always = {"bending", "torsion", "tangential", "bearing_compliance", "fillets", "bores", "fatigue"}
    assert always <= set(ratios)
    assert {name: ratio for name, ratio in ratios.items() if not 0.5 < ratio < 2} == {}
