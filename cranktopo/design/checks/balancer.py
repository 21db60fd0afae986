"""Consistency of a balancer shaft as a part: steps, places and notches give a body."""

from __future__ import annotations

from cranktopo.base.errors import CranktopoError
from cranktopo.design.balancer import BalancerPart
from cranktopo.design.schema import Scene


def balancer_of(scene: Scene) -> BalancerPart:
    """Return the balancer shaft of a design; raises CranktopoError where it has none, or no body."""
    part = scene.balancer
    if part is None:
        raise CranktopoError(
            f"{scene.name}: [balancer] is missing.",
            hint="The built-in design balancer-shaft has it: cranktopo designs copy balancer-shaft",
        )
    if not part.step:
        raise scene.invalid("balancer.step", "needs at least one [[balancer.step]]")
    for one in part.placed:
        if not 0 <= one.z_mm <= part.length_mm:
            raise CranktopoError(
                f"{scene.name}: balancer: z_mm = {one.z_mm:g} is beyond its ends, 0 and {part.length_mm:g}.",
                hint="Places count from the end where the first [[balancer.step]] begins.",
            )
    for number, step in enumerate(part.step):
        if step.bore_mm >= step.diameter_mm:
            raise scene.invalid(f"balancer.step[{number}].bore_mm", "must be less than its diameter_mm")
    for number, notch in enumerate(part.notch):
        outer, bore = part.section_at(notch.z_mm)
        low, high = (bore, outer) if notch.kind == "groove" else (0.0, outer / 2)
        if not low < notch.diameter_mm < high:
            raise scene.invalid(
                f"balancer.notch[{number}].diameter_mm", f"must be > {low:g} and < {high:g} mm there"
            )
    return part
