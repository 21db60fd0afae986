"""The page of `cranktopo balance`: what is free, and what would balance it."""

from __future__ import annotations

from cranktopo.base.units import change_text, number_text
from cranktopo.engine.balance.whole_engine import (
    AS_IT_IS,
    COUNTERWEIGHTED,
    EngineBalance,
    LoadedMainBearings,
)
from cranktopo.report.page import Fact, FactStatus, Page, Section, pairs
from cranktopo.report.result_table import ResultTable
from cranktopo.tasks.balance.changes import VECTORS, Vector, largest_order, order_changes
from cranktopo.tasks.balance.needed import counterweight_fact, counterweight_words
from cranktopo.tasks.balance.plot import balance_pictures
from cranktopo.tasks.balance.proposal import ProposedCounterweight
from cranktopo.tasks.balance.result import Balance, balance_result
from cranktopo.tasks.balance.text import (
    angle_lines,
    arrangement_words,
    balance_factor_words,
    balance_headline,
    bearing_table,
    bearings_caption,
    bearings_words,
    change_sentences,
    counterweight_table,
    counterweights_caption,
    free_table,
    inner_moment_table,
    order_table,
    room_of,
    shaft_table,
    shafts_caption,
    share_words,
)
from cranktopo.tasks.loads.text import crank_words


def balance_page(balance: EngineBalance, written: str, proposal: ProposedCounterweight | None = None) -> Page:
    """Return the balance of an engine as content; `written` is a date."""
    data = balance_result(balance, proposal)
    *free, bearing = balance_pictures(balance)
    shafts = shaft_table(data)
    return Page(
        title=f"Balance: {data.design}",
        subtitle=f"{data.speed_rpm:g} rpm, {arrangement_words(data)}; {written}",
        headline=" ".join([balance_headline(data), *change_sentences(data)]),
        facts=_facts(balance, data),
        sections=(
            Section(
                "free",
                "Free forces and moments",
                f"{_FORCES} {' '.join(angle_lines())}",
                (
                    ("By order, the engine as it is", order_table(data)),
                    ("All masses together; orders that stay as they are once", free_table(data)),
                ),
                tuple(free),
            ),
            Section(
                "counterweights",
                "Counterweights",
                _counterweights_words(data),
                (
                    *_proposed(data.proposal),
                    (counterweights_caption(data), counterweight_table(data)),
                    ("Largest bending moment inside the shaft", inner_moment_table(data)),
                ),
            ),
            *(
                [Section("shafts", "Balancer shafts", "", ((shafts_caption(data), shafts),))]
                if shafts is not None
                else []
            ),
            Section(
                "bearings",
                "Main bearings",
                bearings_words(data),
                ((bearings_caption(data), bearing_table(data)),),
                (bearing,),
            ),
        ),
    )


_FORCES = (
    "The force of each order runs round an ellipse: its largest and its least size over a turn, and along "
    "which direction it is largest."
)
_WEBS = (
    "Unbalance along its throw of each web alone, what its counterweight has of that already, and what is "
    "needed beyond it for the masses that the table names, a share of the oscillating ones as if it turned "
    "with the crankpin: for its throw, so that each throw is balanced on its own; for the shaft, the least "
    "with which these masses leave the whole shaft without free force and moment, but bend it."
)


def _counterweights_words(data: Balance) -> str:
    sentences = _WEBS, counterweight_words(data), balance_factor_words(data), crank_words(data.crank)
    return " ".join(filter(None, sentences))


def _proposed(proposed: ProposedCounterweight | None) -> list[tuple[str, ResultTable]]:
    """Return the counterweight that was asked for as a table; none where none was."""
    if proposed is None:
        return []
    rows = [
        ("outer_radius_mm", f"{proposed.outer_radius_mm:g} mm"),
        ("half_angle_deg", f"{proposed.half_angle_deg:g} deg"),
        ("thickness of the web", f"{proposed.thickness_mm:g} mm"),
        ("engine.arrangement.balanced_oscillating_share", f"{proposed.share_percent / 100:g}"),
        ("balanced share of the oscillating mass", f"{proposed.balance_factor_percent:z.1f} %"),
        ("room for it", proposed.refused or room_of(proposed)),
    ]
    if proposed.draft:
        rows.append(("draft", proposed.draft))
    if proposed.own_angle_refused:
        rows.append(("room with the half-angle of the web", proposed.own_angle_refused))
    return [("Proposed [web.counterweight] of each web", pairs(rows))]


def _proposed_fact(proposed: ProposedCounterweight) -> Fact:
    size = f"radius {proposed.outer_radius_mm:.1f} mm, {proposed.half_angle_deg:g} deg to each side"
    if proposed.refused:
        return Fact("Proposed counterweight", "does not fit", f"{size}: {proposed.refused}", "bad")
    note = f"balances {share_words(proposed)}; room for it: {room_of(proposed)}"
    return Fact("Proposed counterweight", size, note, "good" if proposed.room else "neutral")


def _facts(balance: EngineBalance, data: Balance) -> tuple[Fact, ...]:
    last, proposal = list(balance.free)[-1], data.proposal
    bearings = balance.bearings
    fits = proposal is None or not proposal.refused
    return (
        *([_proposed_fact(proposal)] if proposal else []),
        *(_free_fact(data, name, last, fits) for name in VECTORS),
        counterweight_fact(data),
        _bearing_fact(bearings[AS_IT_IS], bearings[COUNTERWEIGHTED], fits),
    )


def _bearing_fact(before: LoadedMainBearings, after: LoadedMainBearings, fits: bool) -> Fact:
    """Return the largest load of any main bearing, what counterweights make of it, and where loads rise."""
    index, number = before.most_loaded, len(before.load_N)
    plain, weighted = before.largest(index)[0], after.largest(after.most_loaded)[0]
    note, status = _against(COUNTERWEIGHTED, plain, weighted, "N", fits)
    note += f", main bearing {after.most_loaded + 1}" if after.most_loaded != index else ""
    changes = {i + 1: 100 * (after.largest(i)[0] / before.largest(i)[0] - 1) for i in range(number)}
    rising = {i: change for i, change in changes.items() if change > _RISING_PERCENT}
    if rising and status != "bad":
        note += f"; main bearings {', '.join(map(str, rising))}: up to {change_text(max(rising.values()))}"
        status = "neutral" if status == "good" else status
    return Fact(f"Largest load, main bearing {index + 1}", f"{number_text(plain)} N", note, status)


def _free_fact(data: Balance, name: Vector, state: str, fits: bool) -> Fact:
    """Return the largest free force or moment of an order, and what a state makes of it and of others.

    Orders of which more is left are bad where the largest of all does not fall.
    """
    unit = VECTORS[name]
    (top, before), (_, after) = (largest_order(data, name, one) for one in (AS_IT_IS, state))
    note, status = _against(state, before, after, unit, fits)
    others = [one for one in order_changes(data, name, state) if one.order != top]
    if any(one.after > one.before for one in others):
        status = "neutral" if status == "good" else "bad"
    elif others and fits and status == "neutral":
        status = "good"
    other_orders = "".join(f"; order {one.order} from {one.words}" for one in others)
    return Fact(f"Free {name}", f"{number_text(before)} {unit}", f"{note}{other_orders}", status)


_RISING_PERCENT = 1.0
_ROUNDED = 1e-4
"""Share of a value within which another one is the same: radii of counterweights are rounded to 0.01 mm."""


def _against(state: str, before: float, after: float, unit: str, fits: bool) -> tuple[str, FactStatus]:
    """Return what a state makes of something that is better small, and whether that is good.

    Nothing is good with counterweights that do not fit.
    """
    note = f"{state}{'' if fits else ', which do not fit'}: {number_text(after)} {unit}"
    if number_text(after) == number_text(before) or abs(after - before) <= _ROUNDED * before:
        return note, "neutral"
    change = f", {change_text(100 * (after / before - 1))}" if before else ""
    return f"{note}{change}", "bad" if after > before else "good" if fits else "neutral"
