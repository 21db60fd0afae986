"""The density-to-modulus chain of a scene: which blocks it is made of."""

from __future__ import annotations

from dataclasses import replace

import jax
import numpy as np

from cranktopo.bodies.cells.domain import Domain
from cranktopo.design.schema import Scene
from cranktopo.numerics.filters.density_filter import ConeFilter, share_within
from cranktopo.tasks.density.length_scale import filter_radius_mm, projection_for
from cranktopo.tasks.density.manufacturing import designable, process_block
from cranktopo.tasks.density.material import Block, Interpolation, build_interpolation


def build_chain(scene: Scene, domain: Domain) -> Interpolation:
    """The density-to-modulus chain of a scene on a domain; call inside `double_precision()`."""
    radius = filter_radius_mm(scene, domain)
    chain = build_interpolation(domain, radius, designable(scene, domain))
    return replace(
        chain,
        process=process_block(scene, domain),
        projection=projection_for(scene, radius),
        penalty=scene.optimise.penalty,
        within=_within(chain.density_filter, scene, domain),
    )


def _within(density_filter: Block, scene: Scene, domain: Domain) -> jax.Array | None:
    """What keeps a member as thick as asked where it lies along a wall of the design space."""
    if scene.optimise.min_member_mm is None or not isinstance(density_filter, ConeFilter):
        return None
    (first, last), reach = domain.web_layers, density_filter.kernel.shape[2] // 2
    main, pin = (
        np.repeat(domain.passive_fraction[:, :, layer, None], reach, axis=2) for layer in (first - 1, last)
    )
    return share_within(
        density_filter, np.concatenate([main, domain.passive_fraction[:, :, first:last], pin], axis=2)
    )
