"""Thresholds for a least member and gap: plates and rods filtered numerically; what may be asked."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import jax.numpy as jnp
import numpy as np
import pytest
from scipy.optimize import brentq

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design.schema import Scene
from cranktopo.numerics.filters.density_filter import (
    ConeFilter,
    Projection,
    boundary_correction,
    cone_filter,
    cone_kernel,
)
from cranktopo.tasks.density.build import build_chain
from cranktopo.tasks.density.manufacturing import (
    check_lengths,
    eroded_threshold,
    filter_radius_mm,
    least_width,
    projection_for,
)
from cranktopo.tasks.density.material import dilated_density, eroded_density, physical_density
from cranktopo.tasks.density.stage import notices

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


WALL_STEP = 1 / 8


def along_a_wall(cells: float) -> tuple[Array, Array]:
    """Filtered density off the wall x = 0 of a plate so many cells thick that lies along it; share within."""
    kernel = jnp.asarray(cone_kernel((WALL_STEP,) * 3, 1.0))
    n = kernel.shape[0]
    plain = cone_filter(jnp.ones((2 * n, n, n)), kernel, False)
    plate = np.clip(cells - np.arange(2 * n), 0.0, 1.0)[:, None, None] * np.ones((2 * n, n, n))
    fields = plain(jnp.asarray(plate)), boundary_correction(plain, np.zeros((2 * n, n, 2 * n - 1)))
    filtered, within = (np.asarray(field)[:n, n // 2, n // 2] for field in fields)
    return filtered, within


@pytest.mark.slow
@pytest.mark.parametrize("eroded", [0.6, 0.75])
def test_a_wall_thins_no_member_that_lies_along_it(float64: None, eroded: float) -> None:
    """A plate on the wall whose eroded design just vanishes; without the void beyond it is half as thick."""

    def width(power: int) -> float:
        def thickest(cells: float) -> float:
            filtered, within = along_a_wall(cells)
            return float((filtered * within**power).max() - eroded)

        made, _ = along_a_wall(brentq(thickest, 1.0, 12.0, xtol=1e-2))
        return WALL_STEP * float(np.interp(-0.5, -made, np.arange(len(made)) + 0.5))

    assert width(1) > 0.95 * least_width(eroded)
    assert width(0) < 0.65 * least_width(eroded)


def test_only_void_beyond_the_design_space_erodes(float64: None, mikron: Scene) -> None:
    scene = mikron.with_optimise(min_member_mm=10.0)
    domain = build_domain(scene, 4.5)
    density_chain = build_chain(scene, domain)
    assert density_chain.boundary_correction is not None
    assert isinstance(density_chain.density_filter, ConeFilter)
    free, within = (
        np.asarray(density_chain.design_fraction) > 0,
        np.asarray(density_chain.boundary_correction),
    )
    assert 0 < within[free].min() < 0.6 < within[free].max() < 1 + 1e-12
    x, y = ((nodes[1:] + nodes[:-1]) / 2 for nodes in (domain.grid.x_mm, domain.grid.y_mm))
    below = (np.hypot(x[:, None], y) < 18) & (np.hypot(x[:, None], y) > 15)  # the main journal
    assert np.all(within[below][:, 0] > within[below][:, -1])
    full = jnp.ones(density_chain.design_fraction.shape)
    made, thin = (np.asarray(of(density_chain, full, 16.0)) for of in (physical_density, eroded_density))
    assert made[free].min() > 0.999
    assert 0.2 < thin[free].mean() < 0.9
    beyond = density_chain.density_filter.kernel.shape[2] - 1
    solid = np.ones((*free.shape[:2], free.shape[2] + beyond))
    solid[:, :, beyond // 2 : -(beyond // 2)] -= density_chain.design_fraction
    reach = np.asarray(density_chain.density_filter.kernel.shape) // 2
    inner = np.asarray(boundary_correction(density_chain.density_filter, solid))[
        : -reach[0], reach[1] : -reach[1]
    ]
    np.testing.assert_allclose(inner[free[: -reach[0], reach[1] : -reach[1]]], 1.0, rtol=1e-12)
    assert build_chain(mikron.with_optimise(min_gap_mm=10.0), domain).boundary_correction is None


def test_threshold_is_the_inverse_of_the_width() -> None:
    for width in (0.05, 0.4, 0.8):
        assert least_width(eroded_threshold(width)) == pytest.approx(width, rel=1e-9)
    with pytest.raises(ValueError, match="signs"):
        eroded_threshold(1.2)


def test_gaps_are_members_of_the_void(float64: None, mikron: Scene) -> None:
    """The dilated design of a field is what the eroded one leaves of its void."""
    scene = mikron.with_optimise(min_member_mm=10.0, min_gap_mm=10.0)
    density_chain = build_chain(scene, build_domain(scene, 4.5))
    x = jnp.asarray(np.random.default_rng(4).random(density_chain.design_fraction.shape))
    free = np.asarray(density_chain.design_fraction) > 0
    alike = replace(density_chain, boundary_correction=None)
    thick, thin = dilated_density(density_chain, x, 8.0), eroded_density(alike, 1 - x, 8.0)
    np.testing.assert_allclose(np.asarray(thick)[free], 1 - np.asarray(thin)[free], atol=1e-12)


def test_each_length_has_its_own_threshold(mikron: Scene) -> None:
    member, gap = (
        projection_for(mikron.with_optimise(**{key: 8.0}), 10.0) for key in ("min_member_mm", "min_gap_mm")
    )
    assert (member.nominal, member.dilated, gap.nominal, gap.eroded) == (0.5, 0.5, 0.5, 0.5)
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
        ({"filter_radius_mm": 3000.0}, ("optimise.filter_radius_mm = 3000.0", "half of the design space")),
    ],
)
def test_what_cannot_be_asked(mikron: Scene, settings: dict[str, Any], parts: tuple[str, ...]) -> None:
    with pytest.raises(CranktopoError) as refused:
        check_lengths(mikron.with_optimise(resolution_mm=2.0, **settings))
    for part in parts:
        assert part in str(refused.value)
