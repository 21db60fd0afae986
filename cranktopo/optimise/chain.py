"""The density-to-modulus chain of a scene: which blocks it is made of."""

from __future__ import annotations

from dataclasses import replace

from cranktopo.domain.build import Domain
from cranktopo.optimise.length_scale import filter_radius_mm, projection_for
from cranktopo.optimise.manufacturing import designable, process_block
from cranktopo.optimise.material import Interpolation, build_interpolation
from cranktopo.scene.schema import Scene


def build_chain(scene: Scene, domain: Domain) -> Interpolation:
    """The density-to-modulus chain of a scene on a domain; call inside `double_precision()`."""
    radius = filter_radius_mm(scene, domain)
    chain = build_interpolation(domain, radius, designable(scene, domain))
    return replace(
        chain,
        process=process_block(scene, domain),
        projection=projection_for(scene, radius),
        penalty=scene.optimise.penalty,
    )
