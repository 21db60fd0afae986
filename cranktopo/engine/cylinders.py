"""Forces of every cylinder of an engine over the cycle: of those that fire, and of those that do not."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from cranktopo.base.arrays import Array, Complex, shared
from cranktopo.design.engine import Engine
from cranktopo.design.schema import Scene
from cranktopo.engine.forces import (
    INERTIA_EFFECTS,
    ShaftTorque,
    ThrowForces,
    by_cylinder,
    shaft_torque,
    throw_forces,
)
from cranktopo.engine.gas import PressureCurve, pressure_curve
from cranktopo.engine.kinematics import Curve, phase_shift
from cranktopo.engine.motored import motored_curve


@dataclass(frozen=True)
class Cylinders:
    """Forces of one cylinder that fires, and of one that does not; None where all fire.

    Those of a throw that has no mass of its own.
    """

    engine: Engine
    firing: ThrowForces
    misfiring: ThrowForces | None

    @property
    def angle_deg(self) -> Array:
        """Crank angles after firing dead centre."""
        return self.firing.angle_deg

    @cached_property
    def torque(self) -> ShaftTorque:
        """Torque along the shaft."""
        found = shaft_torque(self.angle_deg, self.each(lambda one: one.torque_Nm), self.engine.throws)
        shared(found.passed_on_Nm)
        return found

    @cached_property
    def pin_forces_N(self) -> Complex:
        """Force of each rod on its pin, (cylinders, angles): real in the sense of rotation, imaginary out."""
        return shared(self.each(lambda one: one.tangential_force_N - 1j * one.web_force_N))

    def each(self, curve_of: Callable[[ThrowForces], Curve]) -> Curve:
        """Return a curve as every cylinder has it at its own time, (cylinders, angles)."""
        engine, angle = self.engine, self.angle_deg
        fires = engine.firing_angles_deg
        every = by_cylinder(curve_of(self.firing), angle, fires, engine.cycle_deg)
        if self.misfiring is not None:
            unfired = curve_of(self.misfiring)
            for index in (cylinder - 1 for cylinder in engine.misfire):
                every[index] = phase_shift(unfired, angle, fires[index], engine.cycle_deg)
        return np.asarray(every)


def cylinders(scene: Scene, enabled: frozenset[str] = INERTIA_EFFECTS) -> Cylinders | None:
    """Return the forces of a scene's cylinders at its engine's speed; None where it tells no pressures.

    Raises:
        CranktopoError: gas data that cannot be used.
    """
    engine, fired = scene.engine, pressure_curve(scene)
    if engine is None or fired is None:
        return None
    unfired = motored_curve(scene) if engine.misfire else None
    return _cylinders(engine, scene.throw.radius_mm, fired, unfired, enabled & INERTIA_EFFECTS)


@lru_cache(maxsize=16)
def _cylinders(
    engine: Engine,
    radius_mm: float,
    fired: PressureCurve,
    unfired: PressureCurve | None,
    enabled: frozenset[str],
) -> Cylinders:
    """Return cylinders whose curves over the shaft are turned once, whatever web they drive."""
    firing, misfiring = (
        None if curve is None else throw_forces(engine, radius_mm, curve, engine.speed_rpm, enabled)
        for curve in (fired, unfired)
    )
    assert firing is not None
    return Cylinders(engine, firing, misfiring)
