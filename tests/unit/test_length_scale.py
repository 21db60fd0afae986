"""Thresholds for a least member and gap: plates and rods filtered numerically; what may be asked."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import brentq

from cranktopo.domain.build import build_domain
from cranktopo.errors import CranktopoError
from cranktopo.optimise.chain import build_chain
from cranktopo.optimise.density_filter import cone_kernel
from cranktopo.optimise.length_scale import (
    check_lengths,
    eroded_threshold,
    filter_radius_mm,
    least_width,
    projection_for,
)
from cranktopo.optimise.material import dilated_density, eroded_density
from cranktopo.optimise.notices import notices
from cranktopo.optimise.projection import Projection
from cranktopo.scene import Scene

Array = np.ndarray
STEP = 1 / 24  # of the filter radius
KERNEL = cone_kernel((STEP, STEP, STEP), 1.0)
PLACES = np.stack(
    np.meshgrid(*(STEP * (np.arange(n) - n // 2) for n in KERNEL.shape), indexing="ij"), axis=-1
)
TILTED = np.array([0.6, 0.48, 0.64])


def filtered(inside: Callable[[Array], Array], at: Array) -> float:
    """Filtered density of a body at a point: the kernel's weights in the body, no formula."""
    return float(KERNEL[inside(PLACES + at)].sum() / KERNEL.sum())


def made_width(distance: Callable[[Array], Array], eroded: float, way: Array) -> float:
    """Width of the made design, along a direction, of the body whose eroded design just vanishes."""
    half = brentq(lambda s: filtered(lambda p: distance(p) < s, np.zeros(3)) - eroded, 0.1, 1.5, xtol=1e-3)
    edge = brentq(lambda t: filtered(lambda p: distance(p) < half, t * way) - 0.5, 0.0, 1.5, xtol=1e-3)
    return float(2 * edge)


@pytest.mark.parametrize("eroded", [0.6, 0.7, 0.75])
def test_least_width_is_that_of_a_tilted_plate(eroded: float) -> None:
    found = made_width(lambda p: np.abs(p @ TILTED), eroded, TILTED)
    assert least_width(eroded) == pytest.approx(found, rel=0.02)


def test_rods_vanish_before_plates() -> None:
    rod = made_width(lambda p: np.hypot(p[..., 0], p[..., 1]), 0.7, np.array([1.0, 0.0, 0.0]))
    assert rod > 1.05 * least_width(0.7)


def test_threshold_is_the_inverse_of_the_width() -> None:
    for width in (0.05, 0.4, 0.8):
        assert least_width(eroded_threshold(width)) == pytest.approx(width, rel=1e-9)
    with pytest.raises(ValueError, match="signs"):
        eroded_threshold(1.2)


def test_gaps_are_members_of_the_void(float64: None, mikron: Scene) -> None:
    """The dilated design of a field is what the eroded one leaves of its void."""
    scene = mikron.with_optimise(min_member_mm=10.0, min_gap_mm=10.0)
    chain = build_chain(scene, build_domain(scene, 4.5))
    x = jnp.asarray(np.random.default_rng(4).random(chain.design.shape))
    free = np.asarray(chain.design) > 0
    thick, thin = dilated_density(chain, x, 8.0), eroded_density(chain, 1 - x, 8.0)
    np.testing.assert_allclose(np.asarray(thick)[free], 1 - np.asarray(thin)[free], atol=1e-12)


def test_each_length_has_its_own_threshold(mikron: Scene) -> None:
    member, gap = (
        projection_for(mikron.with_optimise(**{key: 8.0}), 10.0) for key in ("min_member_mm", "min_gap_mm")
    )
    assert (member.made, member.dilated, gap.made, gap.eroded) == (0.5, 0.5, 0.5, 0.5)
    assert member.eroded == 1 - gap.dilated == eroded_threshold(0.8)
    assert projection_for(mikron, 10.0) == Projection()


def test_the_filter_grows_with_the_lengths(mikron: Scene) -> None:
    domain = build_domain(mikron, 4.5)
    usual = filter_radius_mm(mikron, domain)
    assert usual == pytest.approx(2.5 * domain.grid.largest_edge_mm)
    short, long = (mikron.with_optimise(resolution_mm=4.5, min_gap_mm=gap) for gap in (9.0, 16.0))
    assert filter_radius_mm(short, domain) == usual
    assert filter_radius_mm(long, domain) == pytest.approx(16.0 / least_width(0.75))
    assert not [text for text in notices(short, domain) if "filter" in text]
    (told,) = [text for text in notices(long, domain) if "filter" in text]
    assert "18.1 mm instead of" in told
    assert "optimise.min_gap_mm = 16" in told


@pytest.mark.parametrize(
    ("settings", "parts"),
    [
        ({"min_member_mm": 3.0}, ("optimise.min_member_mm = 3.0", "at least 4 mm (2 cells", "at most 19 mm")),
        ({"min_gap_mm": 25.0}, ("optimise.min_gap_mm = 25.0", "at most 19 mm (web.thickness_mm)")),
        (
            {"min_member_mm": 8.0, "min_gap_mm": 6.0, "filter_radius_mm": 5.0},
            (
                "optimise.filter_radius_mm = 5.0",
                "at least 9.07 mm",
                "min_member_mm = 8 and optimise.min_gap_mm = 6",
            ),
        ),
    ],
)
def test_what_cannot_be_asked(mikron: Scene, settings: dict[str, Any], parts: tuple[str, ...]) -> None:
    with pytest.raises(CranktopoError) as refused:
        check_lengths(mikron.with_optimise(resolution_mm=2.0, **settings))
    for part in parts:
        assert part in str(refused.value)
