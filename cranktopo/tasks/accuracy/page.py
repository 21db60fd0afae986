"""The page of `cranktopo accuracy`: tables, plot, and which level to take."""

from __future__ import annotations

from cranktopo.report.page import Fact, Page, Section
from cranktopo.tasks.accuracy.plot import study_pictures
from cranktopo.tasks.accuracy.text import level_tables, limit_lines, recommendation_table, study_name
from cranktopo.tasks.fea.study_result import StudyResult

_LEGEND = (
    "A star marks the Pareto front: no cheaper level has a smaller error. Errors are against the "
    "extrapolated value; its uncertainty spans all plausible orders of convergence. Memory is the largest of "
    "the level. Time is without JAX's compilation, which is stored for the next run."
)


def accuracy_page(result: StudyResult, written: str) -> Page:
    """Return the studies of a design as content, written on a date."""
    machine = result.machine
    return Page(
        title=f"What accuracy costs in time: {result.design}",
        subtitle=f"{machine.processor}, {machine.cores} cores, {written}",
        headline=accuracy_headline(result),
        facts=tuple(
            Fact(study_name(study).capitalize(), *_cheapest(result, study), "neutral")
            for study in result.limits
        ),
        sections=(
            Section(
                "levels",
                "Levels",
                " ".join([_LEGEND, *(f"{line}." for line in limit_lines(result))]),
                tuple(level_tables(result)),
                study_pictures(result),
            ),
            Section(
                "recommendation",
                "Which level to take",
                tables=(("Cheapest level whose error is surely below", recommendation_table(result)),),
            ),
        ),
    )


def accuracy_headline(result: StudyResult) -> str:
    """Return the outcome in one sentence."""
    ended = "interrupted after" if result.interrupted else "in"
    return (
        f"{len(result.rungs)} levels {ended} {result.spent_s:.0f} of {result.budget_s:g} s; "
        f"{sum(level.efficient for level in result.rungs)} of them are on the Pareto front."
    )


def _cheapest(result: StudyResult, study: str) -> tuple[str, str]:
    """Return the most exact recommendation of a study that its budget reached."""
    rows = [r for r in result.recommendations if r.ladder == study and r.rung]
    if not rows:
        return "no accuracy reached", "give it a larger budget"
    best = rows[-1]
    return f"{best.accuracy_percent:g} % in {best.seconds:.3g} s", str(best.rung)
