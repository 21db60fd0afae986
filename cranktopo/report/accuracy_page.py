"""The page of `cranktopo accuracy`: tables, plot, and which rung to take."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.report.accuracy import ladder_pictures, limit_lines, recommendation_table, rung_tables
from cranktopo.report.page import Fact, Page, Section

_LEGEND = (
    "A star marks the efficient frontier: no cheaper rung has a smaller error. Errors are against the "
    "extrapolated value; its uncertainty spans all plausible orders of convergence. Memory is the largest of "
    "the rung. Time is without JAX's compilation, which is stored for the next run."
)


def accuracy_page(result: Mapping[str, Any], written: str) -> Page:
    """The ladders of a design as content.

    Args:
        result: what `cranktopo accuracy --json` prints.
        written: date.
    """
    machine = result["machine"]
    subtitle = f"{machine['processor']}, {machine['cores']} cores, {written}"
    return Page(
        title=f"What accuracy costs in time: {result['design']}",
        subtitle=subtitle,
        headline=headline(result),
        facts=tuple(
            Fact(ladder.capitalize(), *_cheapest(result, ladder), "neutral") for ladder in result["limits"]
        ),
        sections=(
            Section(
                "ladders",
                "Rungs",
                " ".join([_LEGEND, *(f"{line}." for line in limit_lines(result))]),
                tuple(rung_tables(result)),
                ladder_pictures(result),
            ),
            Section(
                "recommendation",
                "Which rung to take",
                tables=(("Cheapest rung whose error is surely below", recommendation_table(result)),),
            ),
        ),
    )


def headline(result: Mapping[str, Any]) -> str:
    """The outcome in one sentence.

    Args:
        result: what `cranktopo accuracy --json` prints.
    """
    ended = "interrupted after" if result["interrupted"] else "in"
    return (
        f"{len(result['rungs'])} rungs {ended} {result['spent_s']:.0f} of {result['budget_s']:g} s; "
        f"{sum(rung['efficient'] for rung in result['rungs'])} of them are worth their time."
    )


def _cheapest(result: Mapping[str, Any], ladder: str) -> tuple[str, str]:
    """The most exact recommendation of a ladder that its budget reached."""
    rows = [r for r in result["recommendations"] if r["ladder"] == ladder and r["rung"]]
    if not rows:
        return "no accuracy reached", "give it a larger budget"
    best = rows[-1]
    return f"{best['accuracy_percent']:g} % in {best['seconds']:.3g} s", best["rung"]
