"""The balance of an engine: the JSON object of `balance --json`."""

from __future__ import annotations

from typing import Any

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.assumed import LOADS, THROW, Assumption, assumptions
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.misfire import misfire
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.balancer_shafts import SizedShaft
from cranktopo.engine.balance.crank import CrankMass, crank_mass
from cranktopo.engine.balance.free_forces import ORDERS, FreeForce, NeededCounterweight
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.balance.whole_engine import AS_IT_IS, COUNTERWEIGHTED, EngineBalance
from cranktopo.engine.bearings import life_over_cycle_h
from cranktopo.tasks.balance.proposal import ProposedCounterweight


class ArrangementSummary(Result):
    """Cylinders and throws of the engine."""

    layout: str
    cylinders: int
    throws: int
    bank_angle_deg: float
    """Between the two banks of a V or boxer, or the outer ones of a W; 0 of other layouts."""
    cylinder_directions_deg: tuple[float, ...]
    """Direction of each cylinder from the first, in the sense of rotation."""
    cylinder_pitch_mm: float
    throw_angles_deg: tuple[float, ...]
    firing_angles_deg: tuple[float, ...]
    balanced_oscillating_share: float


class OrderForces(Result):
    """Free force and moment of one order: largest and smallest over a turn, direction, turning parts."""

    order: int
    force_N: float
    force_min_N: float
    force_axis_deg: float | None
    force_forward_N: float
    force_backward_N: float
    moment_Nm: float
    moment_min_Nm: float
    moment_axis_deg: float | None
    moment_forward_Nm: float
    moment_backward_Nm: float


class _OfState(Result):
    state: str
    """The engine as it is, with counterweights, or with balancer shafts."""


class MassForces(OrderForces):
    """Free force and moment of the rotating or of the oscillating masses."""

    kind: str


class StateForces(OrderForces, _OfState):
    """Free force and moment of all masses in a state of the engine."""


class StateMoment(Result):
    """Largest bending moment inside the shaft in a state of the engine."""

    state: str
    moment_Nm: float
    z_mm: float
    deg: float


class _Numbered(Result):
    bearing: int


class BearingLoads(Result):
    """Load of a main bearing over the cycle."""

    max_N: float
    deg: float
    mean_N: float
    life_h: float | None


class MainBearing(BearingLoads, _Numbered):
    """A main bearing of the engine as it is, and with counterweights."""

    counterweighted: BearingLoads


class Balance(Result):
    """The balance of an engine at its speed."""

    schema_version: int = 1
    design: str
    speed_rpm: float
    arrangement: ArrangementSummary
    orders: tuple[MassForces, ...]
    free: tuple[StateForces, ...]
    crank: CrankMass | None = UNLESS_NONE
    """Mass properties of the whole crank, where the design has `[crank]`."""
    balance_factor_percent: float | None
    """Percent of the oscillating mass that each throw balances as it is; null where nothing oscillates."""
    counterweights: tuple[NeededCounterweight, ...]
    proposal: ProposedCounterweight | None = UNLESS_NONE
    """The counterweight of each web for the share of `--propose`."""
    inner_moment: tuple[StateMoment, ...]
    balancer_shafts: tuple[SizedShaft, ...]
    gas_in_bearing_loads: bool
    misfire: tuple[int, ...] | None = UNLESS_NONE
    """Cylinders that do not fire in the loads of the main bearings, where there are any."""
    main_bearings: tuple[MainBearing, ...]
    assumed: tuple[Assumption, ...]


def balance_result(balance: EngineBalance, proposal: ProposedCounterweight | None = None) -> Balance:
    """Return the balance of an engine with what its design leaves out."""
    scene, engine = balance.scene, engine_of(balance.scene)
    kinds = ["rotating", *["oscillating"] * len(ORDERS)]
    return Balance(
        design=scene.name,
        speed_rpm=engine.speed_rpm,
        arrangement=ArrangementSummary(
            layout=engine.arranged.layout,
            cylinders=engine.cylinders,
            throws=engine.throws,
            bank_angle_deg=engine.bank_angle_deg,
            cylinder_directions_deg=engine.directions_deg,
            cylinder_pitch_mm=_pitch_mm(balance),
            throw_angles_deg=tuple(engine.throw_angles_deg),
            firing_angles_deg=tuple(engine.firing_angles_deg),
            balanced_oscillating_share=engine.arranged.balanced_share,
        ),
        orders=tuple(
            MassForces(**_forces(part), kind=kind) for kind, part in zip(kinds, balance.parts, strict=True)
        ),
        free=tuple(
            StateForces(state=state, **_forces(part))
            for state, parts in balance.free.items()
            for part in parts
        ),
        crank=crank_mass(scene),
        balance_factor_percent=_factor_percent(scene),
        counterweights=balance.counterweights,
        proposal=proposal,
        inner_moment=tuple(
            StateMoment(state=state, moment_Nm=inner.moment_Nm, z_mm=inner.z_mm, deg=inner.deg)
            for state, inner in balance.inner_moments.items()
        ),
        balancer_shafts=balance.shafts,
        gas_in_bearing_loads=balance.bearings[AS_IT_IS].gas,
        misfire=misfire(scene) or None,
        main_bearings=tuple(
            _bearing(balance, index) for index in range(len(balance.masses.layout.bearing_z_mm))
        ),
        assumed=assumptions(scene, (THROW, LOADS)),
    )


def _pitch_mm(balance: EngineBalance) -> float:
    """Distance of neighbouring throws; the mean where they differ."""
    scene, layout = balance.scene, balance.masses.layout
    if scene.crank is None or scene.crank.uniform:
        return engine_of(scene).arranged.cylinder_pitch_mm or scene.pitch_mm
    return layout.length_mm / len(layout.throw_z_mm)


def _factor_percent(scene: Scene) -> float | None:
    """Balance factor of the throws; the mean where they differ."""
    found = [throw_balance(throw).balance_factor_percent for throw in dict.fromkeys(throw_scenes(scene))]
    factors = [factor for factor in found if factor is not None]
    return sum(factors) / len(factors) if factors else None


def _forces(force: FreeForce) -> dict[str, Any]:
    values: dict[str, Any] = {"order": force.order}
    for name, unit, ellipse in (("force", "N", force.force), ("moment", "Nm", force.moment)):
        values[f"{name}_{unit}"] = ellipse.largest
        values[f"{name}_min_{unit}"] = ellipse.smallest
        values[f"{name}_axis_deg"] = ellipse.axis_deg
        values[f"{name}_forward_{unit}"] = abs(ellipse.forward)
        values[f"{name}_backward_{unit}"] = abs(ellipse.backward)
    return values


def _bearing(balance: EngineBalance, index: int) -> MainBearing:
    plain, weighted = (_loads(balance, state, index) for state in (AS_IT_IS, COUNTERWEIGHTED))
    return MainBearing(bearing=index + 1, **plain, counterweighted=BearingLoads(**weighted))


def _loads(balance: EngineBalance, state: str, index: int) -> dict[str, Any]:
    bearings, roller = balance.bearings[state], balance.scene.supports.roller_bearing
    largest, deg = bearings.largest(index)
    life = life_over_cycle_h(roller, bearings.load_N[index], engine_of(balance.scene).speed_rpm)
    return {"max_N": largest, "deg": deg, "mean_N": bearings.mean_N(index), "life_h": life}
