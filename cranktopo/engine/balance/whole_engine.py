"""The balance of an engine: free forces as it is, with counterweights and shafts, and bearing loads."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.errors import invalid
from cranktopo.base.units import MM_PER_M
from cranktopo.design.engine import Engine, Gas
from cranktopo.design.named import DesignLike, as_scene
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
from cranktopo.engine.balance.layout import unit_vectors
from cranktopo.engine.forces import throw_forces
from cranktopo.engine.gas import STEP_DEG, PressureCurve, pressure_curve
from cranktopo.engine.kinematics import phase_shift
from cranktopo.engine.motored import motored_curve


@dataclass(frozen=True)
class LoadedMainBearings:
    """Forces of the shaft on its main bearings over the cycle, from the free end.

    Attributes:
        angle_deg: crank angles from firing top dead centre of the cylinder that fires first.
        load_N: (bearings, angles), real along the engine's plane of symmetry, imaginary ahead of it.
        gas: whether the pressure of the gas is among them; else the scene does not tell it.
    """

    angle_deg: Array
    load_N: Complex
    gas: bool

    def largest(self, bearing: int) -> tuple[float, float]:
        """Largest load of a bearing, N, and the crank angle of it, deg."""
        size = np.abs(self.load_N[bearing])
        return float(size.max()), float(self.angle_deg[int(size.argmax())])

    def mean_N(self, bearing: int) -> float:
        """Mean magnitude of a bearing's load."""
        return float(np.abs(self.load_N[bearing]).mean())

    @property
    def most_loaded(self) -> int:
        """Index of the bearing with the largest load; of equal ones the first."""
        return int(np.argmax([round(self.largest(i)[0], 6) for i in range(len(self.load_N))]))


def main_bearings(scene: Scene, masses: TurningMasses, counterweighted: bool = False) -> LoadedMainBearings:
    """Return the loads of the main bearings of a scene at its engine's speed.

    A rod's force, gas and inertia, acts in the middle of its part of the pin and is shared by the bearings on
    both sides by the lever rule; so is what turns with the throw. Its couple is a pair of forces on them.
    """
    layout, engine = masses.layout, engine_of(scene)
    angle, rod, gas = rod_force(scene, engine)
    unfired = rod_force(scene, engine, fires=False)[1] if engine.misfire else rod
    load = np.zeros((len(layout.bearing_z_mm), len(angle)), dtype=np.complex128)
    directions = unit_vectors(layout.throw_deg)
    pins = unit_vectors(layout.crank_deg)
    places = zip(layout.throw_of, pins, layout.cylinder_z_mm, layout.firing_deg, strict=True)
    for cylinder, (throw, pin, z, fires) in enumerate(places, start=1):
        own = phase_shift(unfired if cylinder in engine.misfire else rod, angle, fires, engine.cycle_deg)
        _share(load, layout.bearing_z_mm, layout.bay_of[throw], z, pin * own)
    shape = layout.throw_z_mm.shape
    spinning = masses.throw_kg_mm - (masses.counterweight_kg_mm if counterweighted else 0.0)
    spinning = np.broadcast_to(spinning, shape)
    couple = masses.couple_kg_mm2 - (masses.counterweight_couple_kg_mm2 if counterweighted else 0.0)
    couple = np.broadcast_to(couple, shape)
    for throw, z in enumerate(layout.throw_z_mm):
        turned = directions[throw] * spinning[throw] * masses.w2 / MM_PER_M
        _share(load, layout.bearing_z_mm, layout.bay_of[throw], z, turned)
        turned = directions[throw] * couple[throw] * masses.w2 / MM_PER_M
        _pair(load, layout.bearing_z_mm, layout.bay_of[throw], turned)
    turned = directions[0] * masses.w2 / MM_PER_M
    bays = (*layout.bay_of, layout.bay_of[-1])
    for beside, bay, z in zip(masses.journals, bays, layout.journal_z_mm, strict=True):
        _share(load, layout.bearing_z_mm, bay, z, turned * beside.unbalance_kg_mm)
        _pair(load, layout.bearing_z_mm, bay, turned * beside.couple_kg_mm2)
    return LoadedMainBearings(angle, load * unit_vectors(angle), gas)


def rod_force(scene: Scene, engine: Engine, *, fires: bool = True) -> tuple[Array, Complex, bool]:
    """Crank angles after a cylinder's firing, the force of its rod on the pin, and whether gas is in it.

    Gas, and the inertia of all that oscillates; real along the throw, imaginary ahead of it.
    """
    curve = pressure_curve(scene) if fires else motored_curve(scene)
    if curve is None:
        still = Gas()
        angle = np.arange(0.0, engine.cycle_deg, STEP_DEG)
        pressure = np.full_like(angle, still.ambient_pressure_MPa)
        engine = engine.model_copy(update={"gas": still})
        known = PressureCurve(angle, pressure, engine.cycle_deg, "no gas")
    else:
        known = curve
    forces = throw_forces(engine, scene.throw.radius_mm, known, engine.speed_rpm)
    return known.angle_deg, -forces.radial_force_N + 1j * forces.tangential_force_N, curve is not None


def _share(load: Complex, bearing_z_mm: Array, bay: int, z_mm: float, force: Complex | complex) -> None:
    """Add a force on a throw to the bearings on both sides of it."""
    before, behind = bearing_z_mm[bay], bearing_z_mm[bay + 1]
    part = (z_mm - before) / (behind - before)
    load[bay] += (1 - part) * force
    load[bay + 1] += part * force


def _pair(load: Complex, bearing_z_mm: Array, bay: int, couple_N_mm: complex) -> None:
    """Add a couple of a throw, the sum of place times force, to the bearings on both sides of it."""
    force = couple_N_mm / (bearing_z_mm[bay + 1] - bearing_z_mm[bay])
    load[bay] -= force
    load[bay + 1] += force


AS_IT_IS, COUNTERWEIGHTED, WITH_SHAFTS = "as it is", "with counterweights", "with balancer shafts"
"""States of the engine."""


@dataclass(frozen=True)
class EngineBalance:
    """The balance of an engine at its speed; forces about the middle of the shaft.

    Attributes:
        parts: rotating and oscillating masses apart, by order, as the engine is.
        free: by state and order, all masses together.
        inner_moments, bearings: as the engine is, and with its counterweights.
        shafts: balancer shafts of the scene, or those that the engine would need.
    """

    scene: Scene
    masses: TurningMasses
    parts: tuple[FreeForce, ...]
    free: dict[str, tuple[FreeForce, ...]]
    counterweights: tuple[NeededCounterweight, ...]
    inner_moments: dict[str, InnerMoment]
    bearings: dict[str, LoadedMainBearings]
    shafts: tuple[SizedShaft, ...]


def engine_balance(scene: DesignLike) -> EngineBalance:
    """Return the balance of a scene's engine at its speed.

    Raises:
        CranktopoError: no engine, an engine that stands still, or gas data that cannot be used.
    """
    scene = as_scene(scene)
    engine = engine_of(scene)
    if not engine.speed_rpm:
        raise invalid("engine.speed_rpm", engine.speed_rpm, "must be > 0 rpm for inertia forces")
    masses = turning_masses(scene)
    weights = counterweights(masses)
    free = {AS_IT_IS: free_forces(masses), COUNTERWEIGHTED: free_forces(masses, counterweighted=True)}
    scene_shafts = engine.arranged.balancer_shaft
    if scene_shafts:
        shafts, free[WITH_SHAFTS] = size_shafts(scene_shafts, free[COUNTERWEIGHTED], masses.w2)
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
