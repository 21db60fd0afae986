"""Words of finished jobs on the parts beside the crank: rod, bolts, balancer shaft."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from cranktopo.base.units import change_text
from cranktopo.tasks.balancer.result import BalancerStrength
from cranktopo.tasks.balancer.text import places_beyond
from cranktopo.tasks.bolts.result import BoltChecks
from cranktopo.tasks.bolts.text import smallest_safety
from cranktopo.tasks.rod.result import RodStrength
from cranktopo.tasks.rod.text import verdicts


def part_words(kind: str, printed: Mapping[str, Any], where: str) -> list[str]:
    """Return what a job on a part found, what fails first; raises CranktopoError for other JSON."""
    return PARTS[kind](printed, where)


def _rod(printed: Mapping[str, Any], where: str) -> list[str]:
    rod = RodStrength.of_json(printed, where)
    failing, holding = verdicts(rod)
    if rod.lighter is None:
        return [*failing, *holding, f"rod {rod.masses.total_kg:.4g} kg"]
    return [_lighter("rod", rod.lighter.start_kg, rod.lighter.result_kg), *failing, *holding]


def _bolts(printed: Mapping[str, Any], where: str) -> list[str]:
    return [smallest_safety(BoltChecks.of_json(printed, where))]


def _balancer(printed: Mapping[str, Any], where: str) -> list[str]:
    shaft = BalancerStrength.of_json(printed, where)
    lines = [beyond] if (beyond := places_beyond(shaft)) else []
    if shaft.redesign is not None:
        lines.insert(0, _lighter("shaft", shaft.redesign.start_kg, shaft.redesign.result_kg))
    lines.append(f"balancer shaft {shaft.mass_kg:.4g} kg, bends {shaft.largest_deflection_mm:.3g} mm")
    safeties = {n.name: min(n.running_safety, n.starting_safety) for n in shaft.notches}
    if safeties:
        worst = min(safeties, key=safeties.__getitem__)
        lines.append(
            f"{'' if safeties[worst] >= 1 else 'NOT SAFE: '}least safety {safeties[worst]:.3g}: {worst}"
        )
    return [*lines, *([smallest_safety(_joints(shaft))] if shaft.joints else [])]


def _joints(shaft: BalancerStrength) -> BoltChecks:
    return BoltChecks(design=shaft.design, joints=shaft.joints, assumed=())


def _lighter(part: str, before_kg: float, after_kg: float) -> str:
    change = change_text(100 * (after_kg / before_kg - 1))
    return f"{part} {before_kg:.4g} to {after_kg:.4g} kg ({change}), no less safe"


PARTS: Mapping[str, Callable[[Mapping[str, Any], str], list[str]]] = {
    "rod": _rod,
    "lighter rod": _rod,
    "bolts": _bolts,
    "balancer": _balancer,
    "lighter balancer": _balancer,
}
"""Readers of what the jobs on parts print."""
