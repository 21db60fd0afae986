"""Check that the uniform first web carries load until steps have made members of it."""

from __future__ import annotations

import jax

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.numerics.filters.density_filter import projected
from cranktopo.numerics.grid.diagnosis import VOID_STIFFNESS_RATIO
from cranktopo.tasks.density.material import MaterialInterpolation
from cranktopo.tasks.density.problem import Schedule

_SOFTEST = 5 * VOID_STIFFNESS_RATIO
"""Least stiffness of a uniform web over that of the material: below it is void, which carries nothing."""


def check_start(chain: MaterialInterpolation, start: float, schedule: Schedule) -> None:
    """Refuse settings that make nothing of the uniform first web; raises CranktopoError.

    The steeper projection of each stage thins what is below its threshold. Before that makes void of the
    uniform density, steps must be long enough to lift members above the threshold.
    """
    threshold, beta, moved = chain.projection.eroded, schedule.projection_first, 0.0
    while moved < threshold - start:
        density = float(_projected(start, beta, threshold))
        if density**chain.penalty < _SOFTEST:
            raise _short_steps(start, beta, schedule) if moved else _too_soft(start, density, chain.penalty)
        if beta >= schedule.projection_last:
            return
        moved += schedule.stage_iterations * schedule.largest_move(beta)
        beta = min(2 * beta, schedule.projection_last)


_projected = jax.jit(projected)


def _too_soft(start: float, density: float, penalty: float) -> CranktopoError:
    return invalid(
        "optimise.volume_fraction",
        start,
        f"the first web is void: projection_first makes it a density of {density:.2g}, penalty = {penalty:g} "
        f"{density**penalty:.0e} of the material's stiffness; must be at least {_SOFTEST:.0e}",
        "Take more material, a lower penalty or projection_first = 1.",
    )


def _short_steps(start: float, beta: float, schedule: Schedule) -> CranktopoError:
    return invalid(
        "optimise.move",
        schedule.move,
        f"too short with stage_iterations = {schedule.stage_iterations}: at projection steepness {beta:g} "
        f"members have not grown out of the uniform density {start:g}, and all is void",
        "Take a larger move or more stage_iterations.",
    )
