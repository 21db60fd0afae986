"""The balance of a scene's engine: what is free as it is, with counterweights, and with balancer shafts."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any

import numpy as np

from cranktopo.base.errors import invalid
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.balancer_shafts import SizedShaft, needed_shafts, size_shafts
from cranktopo.engine.balance.free_forces import (
    ORDERS,
    Counterweight,
    FreeForce,
    InnerMoment,
    TurningMasses,
    counterweights,
    free_forces,
    inner_moment,
    oscillating_force,
    rotating_force,
    turning_masses,
)
from cranktopo.engine.balance.main_bearings import MainBearings, main_bearings
from cranktopo.engine.bearings import equivalent_load_N, rating_life_h

SCHEMA_VERSION = 1
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
    counterweights: tuple[Counterweight, ...]
    inner_moments: dict[str, InnerMoment]
    bearings: dict[str, MainBearings]
    shafts: tuple[SizedShaft, ...]

    def as_json(self) -> dict[str, Any]:
        """The object that `balance --json` prints, but for what is assumed."""
        engine = engine_of(self.scene)
        kinds = ["rotating", *["oscillating"] * len(ORDERS)]
        return {
            "schema_version": SCHEMA_VERSION,
            "design": self.scene.name,
            "speed_rpm": engine.speed_rpm,
            "arrangement": {
                "layout": engine.arranged.layout,
                "cylinders": engine.cylinders,
                "throws": engine.throws,
                "bank_angle_deg": engine.bank_angle_deg,
                "cylinder_pitch_mm": engine.arranged.cylinder_pitch_mm or self.scene.pitch_mm,
                "throw_angles_deg": list(engine.throw_angles_deg),
                "firing_angles_deg": list(engine.firing_angles_deg),
                "balanced_oscillating_share": engine.arranged.balanced_oscillating_share,
            },
            "orders": [
                {**part.as_json(), "kind": kind} for kind, part in zip(kinds, self.parts, strict=True)
            ],
            "free": [
                {"state": state, **part.as_json()} for state, parts in self.free.items() for part in parts
            ],
            "counterweights": [asdict(weight) for weight in self.counterweights],
            "inner_moment": [{"state": state, **m.as_json()} for state, m in self.inner_moments.items()],
            "balancer_shafts": [shaft.as_json() for shaft in self.shafts],
            "gas_in_bearing_loads": self.bearings[AS_IT_IS].gas,
            "main_bearings": [self._bearing_json(i) for i in range(engine.throws + 1)],
        }

    def _bearing_json(self, index: int) -> dict[str, Any]:
        """A main bearing: loads of the engine as it is, and those with counterweights apart."""
        plain, weighted = (self._bearing_loads(self.bearings[s], index) for s in (AS_IT_IS, COUNTERWEIGHTED))
        return {"bearing": index + 1, **plain, "counterweighted": weighted}

    def _bearing_loads(self, bearings: MainBearings, index: int) -> dict[str, float | None]:
        largest, deg = bearings.largest(index)
        roller = self.scene.supports.roller_bearing
        life = None
        if roller is not None and roller.dynamic_rating_kN is not None:
            equivalent = equivalent_load_N(np.abs(bearings.load_N[index]))
            life = rating_life_h(roller.dynamic_rating_kN, equivalent, engine_of(self.scene).speed_rpm)
        return {"max_N": largest, "deg": deg, "mean_N": bearings.mean_N(index), "life_h": life}


def engine_balance(scene: Scene) -> EngineBalance:
    """The balance of a scene's engine at its speed.

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
