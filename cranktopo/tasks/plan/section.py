"""The effects plan as a section of a report."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.engine.plan.effect import Effect
from cranktopo.report.page import Section
from cranktopo.report.result_table import Column, tabulate

_EFFECT_COLUMNS: tuple[Column[Effect], ...] = (
    Column("effect", 0, lambda effect: effect.name.replace("_", " ")),
    Column("state", 0, lambda effect: effect.state),
    Column("size_percent", 1, lambda effect: effect.estimate_percent),
    Column("because", 0, lambda effect: effect.reason),
    Column("leaving_it_out_changes", 0, lambda effect: effect.changes),
)


def effects_section(effects: Sequence[Effect]) -> Section:
    """Return the section of an effects plan with its reasons."""
    return Section(
        "effects",
        "Which physics was simulated, and why",
        "An effect that is off costs nothing: no solve, no cell, no mesh.",
        (("Effects plan", tabulate(_EFFECT_COLUMNS, effects)),),
    )
