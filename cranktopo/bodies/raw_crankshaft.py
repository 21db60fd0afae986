"""The raw part of the whole crank: its parting planes, ends, volume and mass, and what is machined out of it.

Each throw is forged with its own parting plane; where planes differ, the crank is twisted after forging.
"""

from __future__ import annotations

from collections.abc import Iterable
from functools import lru_cache

from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.crank_ends import SIDES
from cranktopo.bodies.raw_part import forging_of, machined_out, raw_half_volume_mm3
from cranktopo.design.crank import Side
from cranktopo.design.crank_throws import end_journal, throw_scenes
from cranktopo.design.halves import of_halves
from cranktopo.design.schema import Scene
from cranktopo.throw.crank_end import EndStep
from cranktopo.throw.moments import body_moments
from cranktopo.throw.raw_part.bodies import RawHalf
from cranktopo.throw.raw_part.end import machined_in_end, raw_end

_SAME_PLANE_DEG = 1e-6


def parting_planes_deg(angles_deg: Iterable[float]) -> tuple[float, ...]:
    """Return the directions of the planes that throws at these angles lie in, in the sense of rotation."""
    found: list[float] = []
    for angle in angles_deg:
        turned = angle % 180.0
        if all(min((turned - one) % 180.0, (one - turned) % 180.0) > _SAME_PLANE_DEG for one in found):
            found.append(turned)
    return tuple(found)


def parting_text(angles_deg: Iterable[float]) -> str:
    """Return what a die can release of a crank with throws at these angles, in a sentence."""
    planes = parting_planes_deg(angles_deg)
    if len(planes) == 1:
        return "all throws lie in one parting plane"
    angles = ", ".join(f"{plane:g}" for plane in planes)
    return (
        f"the throws lie in {len(planes)} planes ({angles} deg), and a die releases one: each throw is that "
        "of its own parting plane, and the crank is twisted into place after forging"
    )


def end_steps(scene: Scene, side: Side) -> dict[str, EndStep]:
    """Return the steps of an end of the crank by their key paths, from the outer main journal outwards."""
    ends = scene.crank.end if scene.crank else ()
    return {
        f"crank.end[{number}].step[{index}]": step
        for number, end in enumerate(ends)
        if end.side == side
        for index, step in enumerate(end.step)
    }


@lru_cache(maxsize=8)
def raw_crank_end(scene: Scene, side: Side) -> RawHalf | None:
    """Return a raw end, heights outwards from the middle of its main journal; None where it has no end."""
    journal = end_journal(scene, side)
    if journal is None:
        return None
    steps = end_steps(scene, side)
    return raw_end(journal.radius_mm, journal.length_mm / 2, steps, forging_of(scene))


def raw_end_lines(scene: Scene) -> list[str]:
    """Return each raw step of both ends in words, from the outer main journals outwards."""
    more = 2 * forging_of(scene).allowance_mm
    return [
        f"{side} {' to '.join(f'⌀{2 * radius + more:g}' for radius in dict.fromkeys(step.radii_mm))}"
        for side in SIDES
        for step in end_steps(scene, side).values()
    ]


@lru_cache(maxsize=8)
def raw_crank_volume_mm3(scene: Scene) -> float:
    """Return the volume of the raw crank by quadrature: that of its throws and ends."""
    forging_of(scene)
    ends = [end for side in SIDES if (end := raw_crank_end(scene, side))]
    throws = sum(sum(of_halves(throw, raw_half_volume_mm3)) for throw in throw_scenes(scene))
    return throws + sum(body_moments([end]).volume for end in ends)


def raw_crank_mass_kg(scene: Scene) -> float:
    """Return the mass of the raw crank."""
    return raw_crank_volume_mm3(scene) * density_kg_per_mm3(scene.material.density_kg_m3)


def machined_out_of_crank(scene: Scene) -> tuple[str, ...]:
    """Return the keys of what is machined out of the raw crank, those of a throw that differs by its name."""
    throws = [
        key if throw.name == scene.name else f"{throw.name} {key}"
        for throw in dict.fromkeys(throw_scenes(scene))
        for key in machined_out(throw)
    ]
    ends = [key for side in SIDES for key in machined_in_end(end_steps(scene, side))]
    return (*throws, *ends)
