"""The balance of an engine as tables, for terminal and page, and in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from cranktopo.base.units import number_text
from cranktopo.design.arrangement import banks_words
from cranktopo.design.misfire import silent_words
from cranktopo.engine.balance.balancer_shafts import SizedShaft
from cranktopo.engine.balance.free_forces import NeededCounterweight
from cranktopo.engine.balance.whole_engine import AS_IT_IS, COUNTERWEIGHTED, WITH_SHAFTS
from cranktopo.report.result_table import Column, ResultTable, tabulate, terminal
from cranktopo.tasks.balance.changes import VECTORS, largest_order, order_changes
from cranktopo.tasks.balance.needed import counterweight_words
from cranktopo.tasks.balance.proposal import OTHER_ANGLES_DEG, ProposedCounterweight
from cranktopo.tasks.balance.result import (
    Balance,
    MainBearing,
    MassForces,
    StateForces,
    StateMoment,
)
from cranktopo.tasks.loads.text import crank_words

_VECTOR: tuple[Column[Any], ...] = (
    Column("force_N", 1, lambda e: e.force_N),
    Column("force_least_N", 1, lambda e: e.force_min_N),
    Column("force_along_deg", 1, lambda e: e.force_axis_deg),
    Column("moment_Nm", 2, lambda e: e.moment_Nm),
    Column("moment_least_Nm", 2, lambda e: e.moment_min_Nm),
    Column("moment_along_deg", 1, lambda e: e.moment_axis_deg),
)
_ORDERS: tuple[Column[MassForces], ...] = (
    Column("masses", 0, lambda e: e.kind),
    Column("order", 0, lambda e: e.order),
    *_VECTOR,
)
_FREE: tuple[Column[StateForces], ...] = (
    Column("engine", 0, lambda e: e.state),
    Column("order", 0, lambda e: e.order),
    *_VECTOR,
)
_COUNTERWEIGHTS: tuple[Column[NeededCounterweight], ...] = (
    Column("web", 0, lambda e: str(e.web)),
    Column("throw", 0, lambda e: e.throw),
    Column("web_kg_mm", 2, lambda e: e.web_kg_mm),
    Column("has_kg_mm", 2, lambda e: e.own_kg_mm),
    Column("for_its_throw_kg_mm", 2, lambda e: e.unbalance_kg_mm),
    Column("throw_at_deg", 1, lambda e: e.deg if e.unbalance_kg_mm else None),
    Column("for_the_shaft_kg_mm", 2, lambda e: e.shaft_unbalance_kg_mm),
    Column("shaft_at_deg", 1, lambda e: e.shaft_deg if e.shaft_unbalance_kg_mm else None),
)
_SHAFTS: tuple[Column[SizedShaft], ...] = (
    Column("balances", 0, lambda e: f"{e.balances} of order {e.order}"),
    Column("turns", 0, lambda e: f"{e.turns} the crank"),
    Column("unbalance_kg_mm", 3, lambda e: e.unbalance_kg_mm),
    Column("phase_deg", 1, lambda e: e.phase_deg),
    Column("place_mm", 1, lambda e: e.z_mm if e.balances == "force" else None),
    Column("apart_mm", 1, lambda e: e.distance_mm or None),
    Column("force_N", 1, lambda e: e.force_N),
)
_GEARS: tuple[Column[SizedShaft], ...] = (
    Column("gear_tangential_N", 1, lambda e: e.gear.tangential_N if e.gear else None),
    Column("gear_radial_N", 1, lambda e: e.gear.radial_N if e.gear else None),
    Column("gear_axial_N", 1, lambda e: e.gear.axial_N if e.gear else None),
)
_BEARINGS: tuple[Column[MainBearing], ...] = (
    Column("bearing", 0, lambda e: str(e.bearing)),
    Column("max_N", 0, lambda e: e.max_N),
    Column("max_at_deg", 2, lambda e: e.deg),
    Column("mean_N", 0, lambda e: e.mean_N),
    Column("counterweighted_max_N", 0, lambda e: e.counterweighted.max_N),
    Column("counterweighted_at_deg", 2, lambda e: e.counterweighted.deg),
    Column("counterweighted_mean_N", 0, lambda e: e.counterweighted.mean_N),
)
_LIVES: tuple[Column[MainBearing], ...] = (
    Column("life_h", 0, lambda e: e.life_h),
    Column("counterweighted_life_h", 0, lambda e: e.counterweighted.life_h),
)
_INNER: tuple[Column[StateMoment], ...] = (
    Column("shaft", 0, lambda e: e.state),
    Column("inner_moment_Nm", 2, lambda e: e.moment_Nm),
    Column("place_mm", 1, lambda e: e.z_mm),
    Column("at_deg", 1, lambda e: e.deg),
)
_MASSES = {"piston_group_kg": "piston", "rod_rotating_kg": "rod"}
"""Masses without which a counterweight is that of another engine."""
_ANGLES = (
    "Forces are across the shaft, moments about its middle: along the force at the takeoff's end.",
    "Directions and phases count from the engine's plane of symmetry in the sense of rotation, when the "
    "cylinder that fires first is at top dead centre; those of counterweights and inner moments from the "
    "first throw.",
    "Places count from the middle of the shaft toward the takeoff.",
)


def order_table(data: Balance) -> ResultTable:
    """Free force and moment of rotating and of oscillating masses by order, the engine as it is."""
    return tabulate(_ORDERS, data.orders)


def free_table(data: Balance) -> ResultTable:
    """Free force and moment of all masses by order, and again where counterweights or shafts change it."""
    rows: dict[tuple[object, ...], StateForces] = {}
    for entry in data.free:
        rows.setdefault(tuple(entry.model_dump(exclude={"state"}).values()), entry)
    return tabulate(_FREE, rows.values())


def counterweight_table(data: Balance) -> ResultTable:
    """Return what every web needs beyond what it has."""
    return tabulate(_COUNTERWEIGHTS, data.counterweights)


def inner_moment_table(data: Balance) -> ResultTable:
    """Largest bending moment inside the shaft."""
    return tabulate(_INNER, data.inner_moment)


def shaft_table(data: Balance) -> ResultTable | None:
    """Balancer shafts with the forces of their gears; None where the engine has none and needs none."""
    shafts = data.balancer_shafts
    geared = any(shaft.gear for shaft in shafts)
    return tabulate((*_SHAFTS, *(_GEARS if geared else ())), shafts) if shafts else None


def bearing_table(data: Balance) -> ResultTable:
    """Loads of the main bearings, with the life of roller bearings where it is known."""
    bearings = data.main_bearings
    known = bearings[0].life_h is not None
    return tabulate((*_BEARINGS, *(_LIVES if known else ())), bearings)


def _balance_tables(data: Balance) -> list[tuple[str, ResultTable]]:
    """Return all tables with their captions, in order."""
    shafts = shaft_table(data)
    return [
        ("Free forces and moments, the engine as it is", order_table(data)),
        ("All masses together; orders that stay as they are once", free_table(data)),
        (counterweights_caption(data), counterweight_table(data)),
        ("Bending moment inside the shaft", inner_moment_table(data)),
        *([(shafts_caption(data), shafts)] if shafts is not None else []),
        (bearings_caption(data), bearing_table(data)),
    ]


def counterweights_caption(data: Balance) -> str:
    """Return what the counterweights that the webs need balance, and for which engine."""
    share = 100 * data.arrangement.balanced_oscillating_share
    oscillating = f" and {share:g} % of the oscillating masses" if share else ""
    assumed = {item.key for item in data.assumed}
    engine = "; one cylinder, which is assumed" if "engine.cylinders" in assumed else ""
    missing = [name for key, name in _MASSES.items() if f"engine.masses.{key}" in assumed]
    exception = f"; without {' and '.join(missing)}, whose masses are not given" if missing else ""
    return f"Counterweights that the webs need for the rotating{oscillating or ' masses'}{engine}{exception}"


def balance_factor_words(data: Balance) -> str:
    """Return the balance factor of the throws as they are in a sentence; empty where nothing oscillates."""
    factor = data.balance_factor_percent
    if factor is None:
        return ""
    open_ = "; its rotating masses are not balanced" if round(factor, 1) < 0 else ""
    return f"Balance factor of each throw as it is: {factor:z.1f} % of its oscillating mass{open_}."


def proposal_words(data: Balance) -> str:
    """Return the counterweight that is proposed, as tables of the scene; empty where none is asked for."""
    found = data.proposal
    if found is None:
        return ""
    return "\n".join(
        [
            *_proposal_refusals(data, found),
            *([] if found.refused else [f"Room for the counterweight: {room_of(found)}."]),
            *([f"Draft of the counterweight: {found.draft}."] if found.draft else []),
            f"Counterweight of each web, {found.thickness_mm:g} mm thick, for {share_words(found)} "
            f"(with it {found.balance_factor_percent:z.2f} %); other keys of these tables stay as they are:",
            "[web.counterweight]",
            f"outer_radius_mm = {found.outer_radius_mm:g}",
            f"half_angle_deg = {found.half_angle_deg:g}",
            "[engine.arrangement]",
            f"balanced_oscillating_share = {found.share_percent / 100:g}",
        ]
    )


def room_of(proposed: ProposedCounterweight) -> str:
    """Return the room for a counterweight that nothing refuses."""
    return proposed.room or "not known, as [envelope.clearance] names neither piston skirt nor crankcase"


def share_words(proposed: ProposedCounterweight) -> str:
    """Return what a proposed counterweight is to balance."""
    if not proposed.share_percent:
        return "the rotating masses alone"
    return f"the rotating and {proposed.share_percent:g} % of the oscillating mass"


def proposal_refused(data: Balance) -> str:
    """Return in a sentence that the design has no place for the counterweight asked for; empty if it has."""
    found = data.proposal
    if found is None or not found.refused:
        return ""
    return f"The proposed counterweight does not fit: {found.refused}"


def _proposal_refusals(data: Balance, proposed: ProposedCounterweight) -> list[str]:
    first, last, step = OTHER_ANGLES_DEG
    if proposed.refused:
        others = f"Nor does one with another half-angle ({first:g} to {last:g} deg by {step:g})."
        return [proposal_refused(data), others]
    why = proposed.own_angle_refused
    return [f"The half-angle of the web (60 deg without a counterweight) does not fit: {why}"] if why else []


def shafts_caption(data: Balance) -> str:
    """Tell whether the balancer shafts are those of the scene, and which counterweights go with them."""
    in_scene = any(shaft.in_scene for shaft in data.balancer_shafts)
    beside = ", beside the counterweights for each throw" if _weights_count(data) else ""
    what = "" if in_scene else " that would leave nothing in the first two orders"
    return f"Balancer shafts{what}{beside}"


def _weights_count(data: Balance) -> bool:
    """Tell whether the counterweights that webs lack change what is free; balancer shafts take the rest."""
    return any(order_changes(data, name, COUNTERWEIGHTED) for name in VECTORS)


def _state_words(data: Balance, state: str) -> str:
    with_weights = state == WITH_SHAFTS and _weights_count(data)
    return "with counterweights and balancer shafts" if with_weights else state


def bearings_caption(data: Balance) -> str:
    """Return what the loads of the main bearings hold."""
    if data.misfire:
        silent = silent_words(data.misfire)
        return f"Main bearings; {silent[0].lower()}{silent[1:]}"
    return "Main bearings" if data.gas_in_bearing_loads else "Main bearings, without gas: none is given"


def bearings_words(data: Balance) -> str:
    """Return what the loads of the main bearings leave out; empty for a single throw."""
    if len(data.arrangement.throw_angles_deg) == 1:
        return ""
    return (
        "Loads of main bearings are those of throws that stand alone between two bearings; a shaft that runs "
        "through has others: `cranktopo shaft`."
    )


def arrangement_words(data: Balance) -> str:
    """Layout, throws and firing in one line."""
    engine = data.arrangement
    bank = banks_words(engine.layout, engine.cylinder_directions_deg)
    throws, fires = map(_listed, (engine.throw_angles_deg, engine.firing_angles_deg))
    cylinders = f"{engine.cylinders} cylinder{'s' * (engine.cylinders > 1)}"
    return (
        f"{engine.layout}, {cylinders}{bank}, throws at {throws} deg, {engine.cylinder_pitch_mm:g} mm "
        f"apart, firing at {fires} deg"
    )


def balance_headline(data: Balance) -> str:
    """Return the largest free force and moment, state by state, equal states in one sentence."""
    states_by_rest: dict[str, list[str]] = {}
    for state in dict.fromkeys(entry.state for entry in data.free):
        states_by_rest.setdefault(_left(data, state), []).append(state)
    named = {left: [_state_words(data, state) for state in states] for left, states in states_by_rest.items()}
    left = [f"{' and '.join(states).capitalize()}: {left}." for left, states in named.items()]
    return " ".join([proposal_refused(data), *left]).strip()


def change_sentences(data: Balance) -> list[str]:
    """Return what each state makes of orders that are not the largest before and after, by state."""
    found = []
    for state in dict.fromkeys(entry.state for entry in data.free if entry.state != AS_IT_IS):
        changes = [
            f"free {name} of order {one.order} from {one.words}"
            for name in VECTORS
            for one in order_changes(data, name, state)
            if any(
                largest_order(data, name, named_state)[0] != one.order for named_state in (AS_IT_IS, state)
            )
        ]
        if changes:
            found.append(f"{_state_words(data, state).capitalize()}: {', '.join(changes)}.")
    return found


def balance_text(data: Balance) -> str:
    """Return what `cranktopo balance` prints."""
    first = f"{data.design} at {data.speed_rpm:g} rpm: {arrangement_words(data)}"
    parts = ["\n".join([first, balance_headline(data), *change_sentences(data)])]
    parts += [f"{caption}\n{terminal(table)}" for caption, table in _balance_tables(data)]
    sentences = (
        bearings_words(data),
        crank_words(data.crank),
        counterweight_words(data),
        balance_factor_words(data),
        proposal_words(data),
    )
    return "\n\n".join([*parts, *filter(None, sentences), "\n".join(_ANGLES)])


def angle_lines() -> tuple[str, ...]:
    """Return what directions and places count from."""
    return _ANGLES


def _left(data: Balance, state: str) -> str:
    """Largest free force and moment of one order of a state in words."""
    found = []
    for name, unit in VECTORS.items():
        order, size = largest_order(data, name, state)
        found.append(
            f"free {name} {number_text(size)} {unit} of order {order}" if size else f"no free {name}"
        )
    return ", ".join(found)


def _listed(values: Sequence[float]) -> str:
    return ", ".join(f"{value:g}" for value in values)
