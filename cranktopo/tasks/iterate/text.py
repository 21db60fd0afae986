"""Table and lines of the loop."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from cranktopo.base.units import change_text
from cranktopo.design.goal.outcome import GoalOutcome
from cranktopo.design.goal.quantities import QUANTITIES
from cranktopo.engine.judged_histories import states_words
from cranktopo.report.goal_table import goal_words
from cranktopo.report.result_table import Column, ResultTable, tabulate, terminal
from cranktopo.tasks.bound.text import bound_lines
from cranktopo.tasks.extraction.text import release_text, release_verdict
from cranktopo.tasks.iterate.result import LoopResult, ShapeOutcome, StepRow
from cranktopo.tasks.throw_fea.quantities import (
    BENDING,
    BENDING_PER_MASS,
    MASS,
    TORSION,
    TORSION_PER_MASS,
    estimate_line,
)

LOOP_FILES = {"csv": "steps.csv", "plot": "steps.png", "json": "iterate.json", "report": "report.html"}
"""Files of a loop in its directory, beside the folders of its steps."""
_IN_PERCENT = (MASS, TORSION, BENDING, TORSION_PER_MASS, BENDING_PER_MASS)
"""Quantities of every step in percent of the original web."""


def _in_percent(key: str) -> Callable[[StepRow], float]:
    return lambda step: step.percent_of_original[key]


_STEP: Column[StepRow] = Column("step", 0, lambda step: step.name or str(step.number))
_VALUES: tuple[Column[StepRow], ...] = (
    Column("throw_kg", MASS.digits, lambda step: step.throw_kg),
    Column("web_kg", MASS.digits, lambda step: step.web_kg),
    Column(TORSION.column, TORSION.digits, lambda step: step.torsion_Nm_per_rad / 1000),
    Column(BENDING.column, BENDING.digits, lambda step: step.bending_N_per_mm / 1000),
    Column(
        TORSION_PER_MASS.column,
        TORSION_PER_MASS.digits,
        lambda step: step.torsion_per_mass_Nm_per_rad_kg / 1000,
    ),
    Column(
        BENDING_PER_MASS.column,
        BENDING_PER_MASS.digits,
        lambda step: step.bending_per_mass_N_per_mm_kg / 1000,
    ),
)
_SHAPE: tuple[Column[StepRow], ...] = (
    Column("transition_mm", 1, lambda step: step.transition_mm),
    Column("overlap_percent", 1, lambda step: step.overlap_percent),
    Column("die_releases_it", 0, lambda step: release_verdict(step.undercuts) if step.number else None),
)
_PERCENT: tuple[Column[StepRow], ...] = tuple(
    Column(quantity.percent_column, 1, _in_percent(quantity.key)) for quantity in _IN_PERCENT
)


def steps_table(steps: Sequence[StepRow]) -> ResultTable:
    """Return one row per step, the original web first: every column, for a file."""
    return tabulate((_STEP, *_VALUES, *_PERCENT, *_SHAPE), steps)


def steps_tables(steps: Sequence[StepRow]) -> tuple[tuple[str, ResultTable], ...]:
    """Return the same in two tables by caption, for readers: values, and percent of the original web."""
    return (
        ("Every step, the original web first", tabulate((_STEP, *_VALUES, *_SHAPE), steps)),
        ("Percent of the original web", tabulate((_STEP, *_PERCENT), steps)),
    )


def steps_estimate(steps: Sequence[StepRow]) -> str:
    """Return the largest error estimates of the steps' stiffnesses, one line."""
    return estimate_line(
        *([getattr(step, f"{kind}_error_percent") for step in steps] for kind in ("torsion", "bending"))
    )


def best_line(loop: LoopResult) -> str:
    """Tell which web is best and what it gains on the original web."""
    row = loop.best
    if row is None:
        return (
            "no step beats the original web: for that it must be no heavier, no softer in bending, and "
            "stiffer per mass in torsion"
        )
    share = row.percent_of_original
    return (
        f"best: {row.words}, "
        f"torsional stiffness per mass {change_text(share[TORSION_PER_MASS.key] - 100)}, "
        f"mass {change_text(share[MASS.key] - 100)}, "
        f"bending stiffness {change_text(share[BENDING.key] - 100)}"
    )


def shape_lines(loop: LoopResult) -> list[str]:
    """Tell the same, and the safety of its web in the shaft; a web that is less safe there is told first."""
    shape = loop.shape
    told = (shape.less_safe, shape.in_shaft) if shape else (None, None)
    first, last = (f"shape: {words}" if words else "" for words in told)
    return [line for line in (first, shape_line(loop), last) if line]


def shape_line(loop: LoopResult) -> str:
    """Tell what the shape optimisation reached beside the best step; empty for a loop without one."""
    shape = loop.shape
    if shape is None:
        return ""
    step = "the loop" if loop.best_step is None else f"step {loop.best_step}"
    if not shape.found:
        return f"shape: no web that keeps the limits, the result of {step} stands: {shape.reason}"
    goal = shape.goal
    assert isinstance(goal, GoalOutcome)
    reached = f"shape: {goal_words(goal)} {goal.reached_percent:.1f} % of the original web, every limit holds"
    reached += f", safety and stress {states_words(shape.loads)}" if shape.loads else ""
    reached += _thin_words(loop)
    if loop.best_step is None:
        return f"{reached}; no step beats the original web"
    verdict = f"better than {step}" if shape.better_than_best_step else f"{step} is better"
    return f"{reached}; {verdict}{_step_words(shape)}"


def _step_words(shape: ShapeOutcome) -> str:
    """Return what the loop tells of its best step for the goal: ` with 116.6 %, whose fatigue safety ...`."""
    percent, unknown = shape.best_step_percent, shape.not_judged_of_steps
    labels = " and ".join(QUANTITIES[name].label for name in unknown)
    return (" with" + f" {percent:.1f} %" if percent is not None else "") + (
        f", whose {labels} nobody judged" if labels else ""
    )


def _thin_words(loop: LoopResult) -> str:
    """Say that the web is thinner beside a journal than a step may be; the shape optimiser may do so."""
    thickness, least = loop.steps[-1].transition_mm, loop.least_transition_mm
    return (
        f", {thickness:.1f} mm beside a journal where a step keeps {least:g} mm" if thickness < least else ""
    )


def unmade_lines(loop: LoopResult) -> list[str]:
    """Name the steps that the process cannot make, and what holds them."""
    return [
        f"{row.words} CANNOT BE MADE: {release_text(row.undercuts)}" for row in loop.steps if not row.makeable
    ]


def loop_summary(loop: LoopResult, folder: Path) -> str:
    """Return a finished loop in words."""
    lines = []
    for caption, table in steps_tables(loop.steps):
        lines += [caption, terminal(table), ""]
    lines.append(steps_estimate(loop.steps))
    lines += bound_lines(loop.bound)
    lines += unmade_lines(loop)
    lines += [f"ended: {loop.stop_reason}", *shape_lines(loop), best_line(loop)]
    lines += [f"note: {notice}" for notice in loop.notices]
    if loop.best is not None:
        lines.append(str(folder / loop.best.folder / "web.toml"))
    files = (folder / file for file in LOOP_FILES.values())
    return "\n".join([*lines, *(str(file) for file in files if file.is_file())])
