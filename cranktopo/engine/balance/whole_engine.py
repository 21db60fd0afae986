"""The balance of a scene's engine: what is free as it is, with counterweights, and with balancer shafts."""

from __future__ import annotations

from dataclasses import dataclass

from cranktopo.base.errors import invalid
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.balancer_shafts import SizedShaft, needed_shafts, size_shafts
from cranktopo.engine.balance.free_forces import (
    ORDERS,
    FreeForce,
    InnerMoment,
    NeededCounterweight,
    TurningMasses,
    counterweights,
    free_forces,
    inner_moment,
    oscillating_force,
    rotating_force,
    turning_masses,
)
from cranktopo.engine.balance.main_bearings import MainBearings, main_bearings

AS_IT_IS, COUNTERWEIGHTED, WITH_SHAFTS = "as it is", "with counterweights", "with balancer shafts"
"""States of the engine."""


@dataclass(frozen=True)
class EngineBalance:
    """The balance of an engine at its speed; forces about the middle of the shaft.

    Attributes:
        parts: rotating and oscillating masses apart, by order, as the engine is.
        free: by state and order, all masses together.
        counterweights: what every web needs.
        inner_moments, bearings: as the engine is, and with its counterweights.
        shafts: balancer shafts of the scene, or those that the engine would need.
    """

    scene: Scene
    masses: TurningMasses
    parts: tuple[FreeForce, ...]
    free: dict[str, tuple[FreeForce, ...]]
    counterweights: tuple[NeededCounterweight, ...]
    inner_moments: dict[str, InnerMoment]
    bearings: dict[str, MainBearings]
    shafts: tuple[SizedShaft, ...]


def engine_balance(scene: Scene) -> EngineBalance:
    """Return the balance of a scene's engine at its speed.

    Raises:
        CranktopoError: no engine, an engine that stands still, or gas data that cannot be used.
    """
    engine = engine_of(scene)
    if not engine.speed_rpm:
        raise invalid("engine.speed_rpm", engine.speed_rpm, "must be > 0 rpm for inertia forces")
    masses = turning_masses(scene)
    weights = counterweights(masses)
    free = {AS_IT_IS: free_forces(masses), COUNTERWEIGHTED: free_forces(masses, counterweighted=True)}
    given = engine.arranged.balancer_shaft
    if given:
        shafts, free[WITH_SHAFTS] = size_shafts(given, free[COUNTERWEIGHTED], masses.w2)
    else:
        shafts = needed_shafts(free[COUNTERWEIGHTED], masses.w2, masses.layout.length_mm)
    return EngineBalance(
        scene=scene,
        masses=masses,
        parts=(rotating_force(masses), *(oscillating_force(masses, order) for order in ORDERS)),
        free=free,
        counterweights=weights,
        inner_moments={AS_IT_IS: inner_moment(masses), COUNTERWEIGHTED: inner_moment(masses, weights)},
        bearings={
            AS_IT_IS: main_bearings(scene, masses),
            COUNTERWEIGHTED: main_bearings(scene, masses, counterweighted=True),
        },
        shafts=shafts,
    )
