"""The page of `cranktopo balance`: what is free, and what would balance it."""

from __future__ import annotations

import numpy as np

from cranktopo.base.units import number_text
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.balance.whole_engine import AS_IT_IS, COUNTERWEIGHTED, EngineBalance
from cranktopo.report.page import Fact, Page, Section
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
    counterweight_table,
    counterweights_caption,
    free_table,
    inner_moment_table,
    order_table,
    proposal_words,
    shaft_table,
    shafts_caption,
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
        facts=_facts(balance),
        sections=(
            Section(
                "free",
                "Free forces and moments",
                " ".join(angle_lines()),
                (
                    ("By order, the engine as it is", order_table(data)),
                    ("All masses together; orders that stay as they are once", free_table(data)),
                ),
                tuple(free),
            ),
            Section(
                "counterweights",
                "Counterweights",
                "Beyond what the webs have: for each throw on its own, or the least that leaves the whole "
                f"shaft without free force and moment but lets it bend. {balance_factor_words(data)} "
                f"{proposal_words(data)} {crank_words(data.crank)}".rstrip(),
                (
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
                "Each throw stands between its two bearings; the shaft does not join them.",
                ((bearings_caption(data), bearing_table(data)),),
                (bearing,),
            ),
        ),
    )


def _facts(balance: EngineBalance) -> tuple[Fact, ...]:
    forces, moments = (
        {state: max(getattr(part, name).largest for part in parts) for state, parts in balance.free.items()}
        for name in ("force", "moment")
    )
    last = list(balance.free)[-1]
    bearings, share = balance.bearings, engine_of(balance.scene).arranged.balanced_oscillating_share
    index = bearings[AS_IT_IS].most_loaded
    plain, weighted = (bearings[state].largest(index)[0] for state in (AS_IT_IS, COUNTERWEIGHTED))
    return (
        Fact(
            "Free force",
            f"{number_text(forces[AS_IT_IS])} N",
            f"{last}: {number_text(forces[last])} N",
            "neutral",
        ),
        Fact(
            "Free moment",
            f"{number_text(moments[AS_IT_IS])} N m",
            f"{last}: {number_text(moments[last])} N m",
            "neutral",
        ),
        Fact(
            "Counterweights of a throw",
            f"{number_text(float(np.abs(balance.masses.counterweight_kg_mm).max()))} kg mm",
            f"{100 * share:g} % of the oscillating masses with them",
            "neutral",
        ),
        Fact(
            f"Main bearing {index + 1}",
            f"{number_text(plain)} N",
            f"{COUNTERWEIGHTED}: {number_text(weighted)} N",
            "neutral",
        ),
    )
