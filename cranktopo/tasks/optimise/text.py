"""Text of a finished run."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from cranktopo.report.goal_table import (
    evaluated_changes,
    evaluation_note,
    goal_line,
    goal_words,
    limits_table,
    unjudged_line,
    unknown_limits,
    violated_limits,
)
from cranktopo.report.page import Fact, FactStatus
from cranktopo.report.result_table import terminal, text_table
from cranktopo.tasks.bound.text import bound_lines
from cranktopo.tasks.extraction.result import NoSurface, RunSurface, WallMeasures
from cranktopo.tasks.extraction.text import (
    kept,
    length_lines,
    length_text,
    manufacturing_obstacles,
    release_verdict,
    released_words,
    required_lengths,
    without_draft_text,
)
from cranktopo.tasks.fatigue.criteria import shortfall_words
from cranktopo.tasks.optimise.result import RunMetrics
from cranktopo.tasks.throw_fatigue.result import FatigueResult
from cranktopo.tasks.throw_fea.quantities import (
    MASS,
    NOTICEABLE_PERCENT,
    TORSION,
    comparison_sentence,
    percent_change,
    worse_line,
)

if TYPE_CHECKING:
    from cranktopo.tasks.optimise.run_record import RunRecord

_NO_FILLETS = (
    "a density result has no fillets: 'cranktopo remodel {run}' gives it some, then "
    "'cranktopo fatigue' with the re-modelled design and '--out' this run"
)


def headline(metrics: RunMetrics) -> str:
    """Return the verdict: limits not judged, then a balance that moved, then what is worse."""
    unjudged = unjudged_line(metrics.goal)
    first = f"{unjudged[0].upper()}{unjudged[1:]}. " if unjudged else ""
    first += f"{metrics.balance.words.capitalize()}. " if metrics.balance else ""
    verdict = comparison_sentence("The optimised throw", metrics.changes_percent, "the original")
    if evaluated := evaluated_changes(metrics.goal):
        verdict += f" This is on cells; {evaluated}."
    return first + verdict


def facts(record: RunRecord) -> tuple[Fact, ...]:
    """Return the answers of the verdict, mass first."""
    metrics = record.metrics
    return (
        _mass(metrics),
        *_stiffness(metrics),
        *_balance(metrics),
        *_limits(metrics),
        fatigue_fact(record.fatigue, _NO_FILLETS.format(run=record.folder)),
        run_undercuts_fact(metrics),
        *_lengths(metrics),
        _end(metrics),
    )


def fatigue_fact(fatigue: FatigueResult | None, otherwise: str) -> Fact:
    """Return the safety against fatigue beside that of the baseline, if any, or why it was not assessed."""
    entries, baseline = (fatigue.fatigue, fatigue.baseline) if fatigue else ((), None)
    assessed = next((entry for entry in entries if entry.target != baseline), None)
    if assessed is None:
        return Fact("Fatigue", "not assessed", otherwise, "unknown")
    original = next((entry.safety for entry in entries if entry.target == baseline), None)
    note = f"least safety of {assessed.target}"
    note += "" if original is None else f"; {baseline} has {original:.2f}"
    short = shortfall_words(fatigue.method, assessed.safety) if fatigue else ""
    note += f"; it {short}" if short else ""
    return Fact("Fatigue", f"{assessed.safety:.2f}", note, "bad" if short else "good")


def run_undercuts_fact(metrics: RunMetrics) -> Fact:
    """Tell whether a die or a cutter can make it."""
    surface, label = metrics.surface, "Released by a die"
    if isinstance(surface, NoSurface):
        return Fact(label, "no", "the density has no surface", "bad")
    found = manufacturing_obstacles(surface.cavities, surface.undercuts)
    if found:
        return Fact(label, "no", "; ".join(found), "bad")
    if surface.undercuts is None:  # a run of an earlier version
        return Fact(label, "not checked", "the topology was free; undercuts are possible", "unknown")
    note = released_words(surface.undercuts)
    status: FactStatus = "neutral" if surface.undercuts.without_draft else "good"
    return Fact(label, release_verdict(surface.undercuts), f"{note}{_walls_text(surface.walls)}", status)


def _walls_text(walls: WallMeasures | None) -> str:
    """Return the minimum draft, member and gap of a web; nothing where they were not measured."""
    if walls is None:
        return ""
    known = (
        ("draft", walls.least_draft_deg, "deg"),
        ("member", walls.least_member_mm, "mm"),
        ("gap", walls.least_gap_mm, "mm"),
    )
    parts = [f"{name} {value:.1f} {unit}" for name, value, unit in known if value is not None]
    return f"; least {', '.join(parts)}" if parts else ""


def _lengths(metrics: RunMetrics) -> list[Fact]:
    return [
        Fact(
            name.capitalize(),
            length_text(found),
            f"{required:g} mm asked",
            "good" if kept(found, required) else "bad",
        )
        for name, (found, required) in required_lengths(metrics.walls).items()
    ]


def _limits(metrics: RunMetrics) -> list[Fact]:
    """Tell whether the limits of a goal hold in the optimiser's model; nothing without a goal."""
    goal = metrics.goal
    if goal is None:
        return []
    if goal.not_evaluated is not None:
        return [Fact("Limits", "not judged", unjudged_line(goal), "bad")]
    violated, unknown, count = violated_limits(goal), unknown_limits(goal), len(goal.limits)
    note = "; ".join(violated) if violated else f"{goal_words(goal)} within them"
    note += f"; not assessed: {', '.join(unknown)}" if unknown else ""
    value = f"{count - len(violated) - len(unknown)} of {count} hold"
    return [Fact("Limits", value, note, "bad" if violated else "unknown" if unknown else "good")]


def _mass(metrics: RunMetrics) -> Fact:
    now, before = metrics.mass_kg.throw, metrics.original_web.mass_kg.throw
    change = percent_change(now, before)
    note = f"{change:+z.1f} % against the original's {before:.3f} kg"
    return Fact("Mass of the throw", f"{now:.3f} kg", note, _status(-change))


def _balance(metrics: RunMetrics) -> list[Fact]:
    """Tell where the balance factor went, if no limit holds it there."""
    moved = metrics.balance
    if moved is None:
        return []
    value = f"{moved.original_percent:z.0f} -> {moved.balance_factor_percent:z.0f} %"
    return [Fact("Balance factor", value, moved.told, "bad")]


def _stiffness(metrics: RunMetrics) -> list[Fact]:
    """Return absolute stiffnesses; per mass only in the note, since a softer web may look good by it."""
    found = []
    gains = metrics.original_web.gain_of_stiffness_per_mass_percent
    for quantity, change in metrics.changes_percent.items():
        if quantity is MASS:
            continue
        webs = (metrics, metrics.original_web)
        now, before = (web.load_cases[quantity.key].stiffness / 1000 for web in webs)
        unit = "kN m/rad" if quantity is TORSION else "kN/mm"
        note = f"{change:+z.1f} % against the original's {before:.1f} {unit}"
        if quantity.key in gains:
            note += f"; per mass {gains[quantity.key]:+z.1f} %"
        found.append(Fact(quantity.label.capitalize(), f"{now:.1f} {unit}", note, _status(change)))
    return found


def _end(metrics: RunMetrics) -> Fact:
    done, value = metrics.status == "converged", metrics.ended
    if not metrics.connected:
        return Fact("Optimisation", value, "journal and crankpin are not connected", "bad")
    return Fact("Optimisation", value, metrics.stop_reason, "good" if done else "bad")


def _status(gain_percent: float) -> FactStatus:
    if abs(gain_percent) < NOTICEABLE_PERCENT:
        return "neutral"
    return "good" if gain_percent > 0 else "bad"


def _worse(metrics: RunMetrics) -> list[str]:
    line = worse_line(metrics.changes_percent, "the original web")
    evaluated = evaluated_changes(metrics.goal)
    moved = [f"worse than the original web: {metrics.balance.words}"] if metrics.balance else []
    return [*moved, *([f"{line} on cells; {evaluated}" if evaluated else line] if line else [])]


_SHOWN_FILES = ("report", "stl", "picture", "vtu", "history", "metrics")


def run_summary(metrics: RunMetrics, folder: Path) -> str:
    """Return a finished optimise run in words."""
    lines = [
        *filter(None, [unjudged_line(metrics.goal)]),
        f"{metrics.ended}: {metrics.stop_reason}",
        *_worse(metrics),
        "",
        _changes(metrics),
    ]
    lines += _goal_lines(metrics)
    bound = bound_lines(metrics.bound)
    lines += ["", *bound] if bound else []
    seconds = metrics.seconds
    report = "" if seconds.report is None else f", report {seconds.report:.1f} s"
    lines += [
        "",
        f"{seconds.total:.1f} s in all (compiling {seconds.compile:.1f} s, "
        f"{seconds.per_iteration_median:.2f} s per iteration{report}), "
        f"{metrics.peak_memory_MiB:.0f} MiB",
        f"connected: {'yes' if metrics.connected else 'NO'}; greyness {metrics.greyness:.3f}",
        *(f"note: {notice}" for notice in metrics.notices),
        *_surface_warning(metrics.surface),
        *length_lines(metrics.walls),
        *(f"{folder / metrics.files[name]}" for name in _SHOWN_FILES if name in metrics.files),
    ]
    return "\n".join(lines)


def _goal_lines(metrics: RunMetrics) -> list[str]:
    goal = metrics.goal
    if goal is None:
        return []
    return ["", goal_line(goal), terminal(limits_table(goal)), *filter(None, [evaluation_note(goal)])]


def _changes(metrics: RunMetrics) -> str:
    header = ("", "optimised", "original web", "change", "estimate", "gain per kg")
    rows = [_case_row(name, metrics) for name in metrics.original_web.gain_of_stiffness_per_mass_percent]
    for part, now in metrics.mass_kg:
        before = getattr(metrics.original_web.mass_kg, part)
        change = f"{percent_change(now, before):+z.1f} %"
        rows.append([f"mass of {part}, kg", f"{now:.3f}", f"{before:.3f}", change, "", ""])
    return text_table("lrrrrr", header, rows)


def _case_row(name: str, metrics: RunMetrics) -> list[str]:
    original, case = metrics.original_web, metrics.load_cases[name]
    unit = "kN/mm" if case.stiffness_Nm_per_rad is None else "kN m/rad"
    now, before = (web.load_cases[name].stiffness for web in (metrics, original))
    values = [f"{now / 1000:.1f}", f"{before / 1000:.1f}", f"{percent_change(now, before):+z.1f} %"]
    error = case.error_estimate_percent
    estimate = "" if error is None else f"+-{error:.2g} %"
    gain = original.gain_of_stiffness_per_mass_percent[name]
    return [f"{name}, {unit}", *values, estimate, f"{gain:+z.1f} %"]


def _surface_warning(surface: RunSurface | NoSurface) -> list[str]:
    if isinstance(surface, NoSurface):
        return [f"no STL: {surface.refusal}"]
    undercuts = surface.undercuts
    straight = without_draft_text(undercuts) if undercuts else ""
    return [*manufacturing_obstacles(surface.cavities, undercuts), *filter(None, [straight])]
