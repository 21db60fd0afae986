"""The density-to-modulus chain of a scene: which blocks it is made of."""

from __future__ import annotations

from dataclasses import replace

import jax
import numpy as np

from cranktopo.bodies.cells.domain import Domain
from cranktopo.design.schema import Scene
from cranktopo.numerics.filters.density_filter import ConeFilter, boundary_correction
from cranktopo.tasks.density.length_scale import filter_radius_mm, projection_for
from cranktopo.tasks.density.manufacturing import designable, process_block
from cranktopo.tasks.density.material import Block, MaterialInterpolation, build_interpolation


def build_chain(scene: Scene, domain: Domain) -> MaterialInterpolation:
    """Return the density-to-modulus chain of a scene on a domain; call inside `double_precision()`."""
    radius = filter_radius_mm(scene, domain)
    density_chain = build_interpolation(domain, radius, designable(scene, domain))
    return replace(
        density_chain,
        process=process_block(scene, domain),
        projection=projection_for(scene, radius),
        penalty=scene.optimise.penalty,
        boundary_correction=_boundary_correction(density_chain.density_filter, scene, domain),
    )


def _boundary_correction(density_filter: Block, scene: Scene, domain: Domain) -> jax.Array | None:
    """Return what keeps a member as thick as asked along a wall of the design space."""
    if scene.optimise.min_member_mm is None or not isinstance(density_filter, ConeFilter):
        return None
    (first, last), reach = domain.web_layers, density_filter.kernel.shape[2] // 2
    main, pin = (np.repeat(domain.fixed[:, :, layer, None], reach, axis=2) for layer in (first - 1, last))
    return boundary_correction(
        density_filter, np.concatenate([main, domain.fixed[:, :, first:last], pin], axis=2)
    )
