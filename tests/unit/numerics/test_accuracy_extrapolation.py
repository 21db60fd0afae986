"""Limits of sequences whose limit is known."""

from __future__ import annotations

import pytest

from cranktopo.numerics.extrapolation import extrapolate, observed_order

SIZES = (9.0, 6.0, 4.5)
"""Not a constant ratio."""


def values(limit: float, slope: float, order: float) -> list[float]:
    return [limit + slope * size**order for size in SIZES]


@pytest.mark.parametrize("order", [1.05, 1.6, 2.1])
@pytest.mark.parametrize("slope", [0.3, -0.02])
def test_a_power_law_gives_its_limit_and_order(order: float, slope: float) -> None:
    found = extrapolate(SIZES, values(140.0, slope, order))
    assert found is not None
    assert found.order == pytest.approx(order, abs=1e-6)
    assert found.value == pytest.approx(140.0, rel=1e-9)
    assert found.error_percent(141.4) == pytest.approx(1.0, rel=1e-6)


@pytest.mark.parametrize("order", [1.0, 1.3, 1.8, 2.2])
def test_two_values_bracket_the_limit_of_every_plausible_order(order: float) -> None:
    row = values(140.0, 0.3, order)[-2:]
    found = extrapolate(SIZES[-2:], row)
    assert found is not None
    assert found.order is None
    assert abs(found.error_percent(140.0)) <= found.uncertainty_percent + 1e-9
    # No wider than it has to be: the two ends of the band are the limits of the extreme orders.
    assert found.uncertainty_percent < 100 * abs(row[1] - row[0]) * 4 / 140.0


def test_an_order_out_of_range_is_not_believed() -> None:
    """Values that seem to converge with order 6 by chance: the limit keeps its distance from the last."""
    row = values(140.0, 1e-5, 6.0)
    found = extrapolate(SIZES, row)
    assert found is not None
    assert found.order == pytest.approx(6.0, abs=1e-6)
    assert abs(found.value - row[-1]) > 2 * abs(140.0 - row[-1])
    assert abs(found.error_percent(140.0)) <= found.uncertainty_percent


def test_a_steady_approach_without_an_order_is_still_extrapolated() -> None:
    """Equal steps on sizes that fall by the same factor: no power law, but the limit lies ahead."""
    found = extrapolate((9.0, 6.0, 4.0), [142.0, 141.7, 141.4])
    assert found is not None
    assert found.order is None
    assert 141.4 - 0.6 < found.value < 141.4 - 0.3 / (1.5**2.2 - 1)
    assert abs(found.error_percent(141.4 - 0.6)) <= found.uncertainty_percent + 1e-9


def test_scatter_is_reported_as_such() -> None:
    found = extrapolate(SIZES, [140.0, 141.0, 139.5])
    assert found is not None
    assert (found.value, found.order) == (139.5, None)
    assert found.uncertainty_percent == pytest.approx(100 * 1.5 / 139.5)
    assert observed_order(SIZES, [140.0, 140.0, 141.0]) is None
    assert extrapolate((4.0,), [140.0]) is None


def test_two_values_that_scatter_hold_their_limit_in_the_band() -> None:
    """Peak stress in a fillet of 0.5 and 0.35 elements a radius; 345.8 and 344.3 with 0.12 and 0.085."""
    found = extrapolate((0.5, 0.35), [334.83, 343.83])
    assert found is not None
    assert abs(found.error_percent(345.0)) <= found.uncertainty_percent


SINGLE = (10.35, 6.9, 4.6), {"bending": (970.027, 961.397, 955.645), "torsion": (353.404, 352.634, 352.195)}
"""A single-cylinder diesel on three coarse meshes. `evaluate --element-size-mm 2.6` tells 953.36 kN/mm
+-0.12 % and 352.00 kN m/rad +-0.023 %; the bounds of the mesh of 4.6 mm are 0.49 and 0.10 %."""


@pytest.mark.parametrize(("name", "truth", "bound"), [("bending", 953.36, 0.49), ("torsion", 352.0, 0.10)])
def test_a_chance_order_of_coarse_meshes_does_not_exclude_the_truth(
    name: str, truth: float, bound: float
) -> None:
    """Orders of 1.0 and 1.4, where quadratic elements have 2 to 4."""
    sizes, rows = SINGLE
    fine = rows[name][-1]
    believed = extrapolate(sizes, rows[name])
    assert believed is not None
    assert abs(believed.error_percent(truth)) > believed.uncertainty_percent, "else this tests nothing"
    for told in (None, bound):
        found = extrapolate(sizes, rows[name], (2.0, 4.0), told)
        assert found is not None
        assert abs(found.error_percent(truth)) <= found.uncertainty_percent
    assert abs(found.value / fine - 1) <= bound / 100 + 1e-9
    for end in (1 - bound / 100, 1 + bound / 100):
        assert abs(found.error_percent(fine * end)) <= found.uncertainty_percent + 1e-9


def test_an_order_of_theory_keeps_its_band_within_the_bound() -> None:
    row = values(140.0, 0.02, 2.1)
    plain, bounded = (extrapolate(SIZES, row, (2.0, 4.0), bound) for bound in (None, 0.5))
    assert plain == extrapolate(SIZES, row)
    assert plain is not None
    assert bounded is not None
    assert bounded.value == pytest.approx(140.0, rel=1e-9)
    assert bounded.uncertainty_percent == plain.uncertainty_percent
    contradicted = extrapolate(SIZES, row, (2.0, 4.0), 0.1)
    assert contradicted is not None
    assert contradicted.value == pytest.approx(row[-1] * 0.999), "a limit outside the bound is not believed"
    assert contradicted.uncertainty_percent == pytest.approx(0.2, rel=2e-3)
