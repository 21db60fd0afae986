"""The density-to-modulus chain of a scene: which blocks it is made of."""

from __future__ import annotations

from dataclasses import replace

from cranktopo.domain.build import Domain
from cranktopo.optimise.manufacturing import designable, process_block
from cranktopo.optimise.material import Interpolation, build_interpolation
from cranktopo.scene.schema import Scene


def build_chain(scene: Scene, domain: Domain) -> Interpolation:
    """The density-to-modulus chain of a scene on a domain; call inside `double_precision()`."""
    radius = scene.optimise.filter_radius_mm or default_filter_radius_mm(domain)
    chain = build_interpolation(domain, radius, designable(scene, domain))
    return replace(chain, process=process_block(scene, domain), penalty=scene.optimise.penalty)


def default_filter_radius_mm(domain: Domain) -> float:
    """Filter radius when the scene gives none: 2.5 cells, and never below 3 mm."""
    return max(3.0, 2.5 * domain.grid.largest_edge_mm)
