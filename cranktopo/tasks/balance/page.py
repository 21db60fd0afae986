"""The page of `cranktopo balance`: what is free, and what would balance it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from cranktopo.base.units import change_text, number_text
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.whole_engine import AS_IT_IS, COUNTERWEIGHTED, EngineBalance
from cranktopo.report.page import Fact, FactStatus, Page, Section, pairs
from cranktopo.report.result_table import ResultTable
from cranktopo.tasks.balance.plot import balance_pictures
from cranktopo.tasks.balance.proposal import ProposedCounterweight
from cranktopo.tasks.balance.result import balance_result
from cranktopo.tasks.balance.text import (
    angle_lines,
    arrangement_words,
    balance_factor_words,
    balance_headline,
    bearing_table,
    bearings_caption,
    bearings_words,
    counterweight_table,
    counterweights_caption,
    free_table,
    inner_moment_table,
    order_table,
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
        headline=balance_headline(data),
        facts=_facts(balance, proposal),
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
                f"{_WEBS} {balance_factor_words(data)} {crank_words(data.crank)}".rstrip(),
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
    "needed beyond it: for its throw, so that each throw is balanced on its own; for the shaft, the least "
    "that leaves the whole shaft without free force and moment but lets it bend."
)


def _proposed(found: ProposedCounterweight | None) -> list[tuple[str, ResultTable]]:
    """Return the counterweight that was asked for as a table; none where none was."""
    if found is None:
        return []
    rows = [
        ("outer_radius_mm", f"{found.outer_radius_mm:g} mm"),
        ("half_angle_deg", f"{found.half_angle_deg:g} deg"),
        ("thickness of the web", f"{found.thickness_mm:g} mm"),
        ("engine.arrangement.balanced_oscillating_share", f"{found.share_percent / 100:g}"),
        ("balanced share of the oscillating mass", f"{found.balance_factor_percent:z.1f} %"),
        ("room for it", found.refused or "yes"),
    ]
    if found.own_angle_refused:
        rows.append(("room with the half-angle of the web", found.own_angle_refused))
    return [("Proposed [web.counterweight] of each web", pairs(rows))]


def _proposed_fact(found: ProposedCounterweight) -> Fact:
    size = f"radius {found.outer_radius_mm:.1f} mm, {found.half_angle_deg:g} deg to each side"
    if found.refused:
        return Fact("Proposed counterweight", "does not fit", f"{size}: {found.refused}", "bad")
    return Fact("Proposed counterweight", size, f"balances {share_words(found)}", "good")


def _facts(balance: EngineBalance, proposal: ProposedCounterweight | None) -> tuple[Fact, ...]:
    forces, moments = (
        {state: max(getattr(part, name).largest for part in parts) for state, parts in balance.free.items()}
        for name in ("force", "moment")
    )
    last = list(balance.free)[-1]
    bearings, share = balance.bearings, engine_of(balance.scene).arranged.balanced_oscillating_share
    index = bearings[AS_IT_IS].most_loaded
    plain, weighted = (bearings[state].largest(index)[0] for state in (AS_IT_IS, COUNTERWEIGHTED))
    fits = proposal is None or not proposal.refused
    oscillating = f" and {100 * share:g} % of the oscillating" if share else ""
    return (
        *([_proposed_fact(proposal)] if proposal else []),
        Fact("Free force", f"{number_text(forces[AS_IT_IS])} N", *_against(last, forces, "N", fits)),
        Fact("Free moment", f"{number_text(moments[AS_IT_IS])} N m", *_against(last, moments, "N m", fits)),
        Fact(
            "Counterweights of a throw",
            f"{number_text(float(np.abs(balance.masses.counterweight_kg_mm).max()))} kg mm",
            f"to balance its rotating{oscillating} masses, beyond what it has",
            "neutral",
        ),
        Fact(
            f"Largest load, main bearing {index + 1}",
            f"{number_text(plain)} N",
            *_against(COUNTERWEIGHTED, {AS_IT_IS: plain, COUNTERWEIGHTED: weighted}, "N", fits),
        ),
    )


def _against(state: str, sizes: Mapping[str, float], unit: str, fits: bool) -> tuple[str, FactStatus]:
    """Return what a state makes of something that is better small, and whether that is good.

    Nothing is good with counterweights that do not fit.
    """
    before, after = sizes[AS_IT_IS], sizes[state]
    note = f"{state}{'' if fits else ', which do not fit'}: {number_text(after)} {unit}"
    if number_text(after) == number_text(before):
        return note, "neutral"
    change = f", {change_text(100 * (after / before - 1))}" if before else ""
    return f"{note}{change}", "bad" if after > before else "good" if fits else "neutral"
