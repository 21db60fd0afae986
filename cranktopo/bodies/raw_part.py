"""Mass and volume of the raw part that a die forges of a throw, and what is machined out of it."""

from __future__ import annotations

from functools import lru_cache

from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.design.halves import WebName, halves, named_in_throw, of_halves
from cranktopo.design.schema import Scene
from cranktopo.throw.moments import Moments, body_moments
from cranktopo.throw.raw_part.half import machined, raw_half
from cranktopo.throw.raw_part.table import Forging


def forging_of(scene: Scene) -> Forging:
    """Return the forging of a scene; raises CranktopoError where it has none."""
    if scene.forging is None:
        raise CranktopoError(
            f"{scene.name}: [forging] is missing: the raw part needs its allowance and draft.",
            hint="Add [forging] with allowance_mm, draft_deg and flash_mm.",
        )
    return scene.forging


@lru_cache(maxsize=8)
def raw_half_moments(scene: Scene) -> Moments:
    """Return the moments of a raw half throw, of unit density."""
    return body_moments([raw_half(scene, forging_of(scene))])


def raw_half_volume_mm3(scene: Scene) -> float:
    """Return the volume of a raw half throw, mm3."""
    return raw_half_moments(scene).volume


def raw_mass_kg(scene: Scene) -> float:
    """Return the mass of the raw part of a throw."""
    volume = sum(of_halves(scene, raw_half_volume_mm3))
    return volume * density_kg_per_mm3(scene.material.density_kg_m3)


def machined_out(scene: Scene) -> tuple[str, ...]:
    """Return the keys of what is machined out of the raw part, those of the second half last."""
    return tuple(dict.fromkeys([*machined_of_half(scene, "first"), *machined_of_half(scene, "second")]))


def machined_of_half(scene: Scene, side: WebName) -> tuple[str, ...]:
    """Return the keys of what is machined out of the raw part of a half, as the scene has them."""
    half = halves(scene)[side == "second"]
    return tuple(named_in_throw(key, scene, side) for key in machined(half, forging_of(half)))
