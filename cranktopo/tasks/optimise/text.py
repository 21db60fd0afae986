"""Text of a finished run."""

from __future__ import annotations

from pathlib import Path

from cranktopo.report.goal_table import evaluation_note, goal_line, limits_table, unjudged_line
from cranktopo.report.result_table import terminal
from cranktopo.tasks.bound.text import bound_lines
from cranktopo.tasks.extraction.result import NoSurface, RunSurface
from cranktopo.tasks.extraction.text import length_lines, manufacturing_obstacles
from cranktopo.tasks.fea.quantities import percent_change, worse_line
from cranktopo.tasks.optimise.result import RunMetrics

_SHOWN_FILES = ("report", "stl", "picture", "vtu", "history", "metrics")


def run_summary(metrics: RunMetrics, folder: Path) -> str:
    """Return a finished optimise run in words."""
    original = metrics.original_web
    lines = [
        *filter(None, [unjudged_line(metrics.goal)]),
        f"{metrics.ended}: {metrics.stop_reason}",
        *filter(None, [worse_line(metrics.changes_percent, "the original web")]),
        "",
        f"{'':24}{'optimised':>14}{'original web':>14}{'change':>12}{'estimate':>12}{'gain per kg':>14}",
        *(_case_line(name, metrics) for name in original.gain_of_stiffness_per_mass_percent),
    ]
    for part, now in metrics.mass_kg:
        before = getattr(original.mass_kg, part)
        masses = f"{now:14.3f}{before:14.3f}{percent_change(now, before):+10.1f} %"
        lines.append(f"{'mass of ' + part + ', kg':24}{masses}")
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
    """Return goal and limits of a run that has them."""
    goal = metrics.goal
    if goal is None:
        return []
    return ["", goal_line(goal), terminal(limits_table(goal)), *filter(None, [evaluation_note(goal)])]


def _case_line(name: str, metrics: RunMetrics) -> str:
    """Return the stiffness under a load case beside that of the original web."""
    original, case = metrics.original_web, metrics.load_cases[name]
    unit = "kN/mm" if case.stiffness_Nm_per_rad is None else "kN m/rad"
    now, before = (web.load_cases[name].stiffness for web in (metrics, original))
    values = f"{now / 1000:14.1f}{before / 1000:14.1f}{percent_change(now, before):+10.1f} %"
    error = case.error_estimate_percent
    estimate = "" if error is None else f"+-{error:.2g} %"
    gain = original.gain_of_stiffness_per_mass_percent[name]
    return f"{name + ', ' + unit:24}{values}{estimate:>12}{gain:+12.1f} %"


def _surface_warning(surface: RunSurface | NoSurface) -> list[str]:
    if isinstance(surface, NoSurface):
        return [f"no STL: {surface.refusal}"]
    return manufacturing_obstacles(surface.cavities, surface.undercuts)
