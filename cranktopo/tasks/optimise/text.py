"""What a user wants to know of a finished run, as lines of text."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from cranktopo.report.goal_table import evaluation_note, goal_line, goal_of, limits_table, unjudged_line
from cranktopo.report.result_table import terminal
from cranktopo.tasks.bound.result import read_bound
from cranktopo.tasks.bound.text import bound_lines
from cranktopo.tasks.extraction.length_text import length_lines
from cranktopo.tasks.extraction.undercut_table import obstacles
from cranktopo.tasks.fea.verdict_sentence import ended, percent_change, run_changes_percent, worse_line

_SHOWN_FILES = ("report", "stl", "picture", "vtu", "history", "metrics")


def run_summary(metrics: Mapping[str, Any], folder: Path) -> str:
    """A finished optimise run; `metrics` as metrics.json holds it."""
    original = metrics["original_web"]
    lines = [
        *filter(None, [unjudged_line(goal_of(metrics))]),
        f"{ended(metrics)}: {metrics['stop_reason']}",
        *filter(None, [worse_line(run_changes_percent(metrics), "the original web")]),
        "",
        f"{'':24}{'optimised':>14}{'original web':>14}{'change':>12}{'estimate':>12}{'gain per kg':>14}",
        *(_case_line(name, metrics) for name in original["gain_of_stiffness_per_mass_percent"]),
    ]
    for part in ("throw", "web"):
        now, before = metrics["mass_kg"][part], original["mass_kg"][part]
        masses = f"{now:14.3f}{before:14.3f}{percent_change(now, before):+10.1f} %"
        lines.append(f"{'mass of ' + part + ', kg':24}{masses}")
    lines += _goal_lines(metrics)
    bounds = bound_lines(read_bound(metrics))
    lines += ["", *bounds] if bounds else []
    seconds = metrics["seconds"]
    report = f", report {seconds['report']:.1f} s" if "report" in seconds else ""
    lines += [
        "",
        f"{seconds['total']:.1f} s in all (compiling {seconds['compile']:.1f} s, "
        f"{seconds['per_iteration_median']:.2f} s per iteration{report}), "
        f"{metrics['peak_memory_MiB']:.0f} MiB",
        f"connected: {'yes' if metrics['connected'] else 'NO'}; greyness {metrics['greyness']:.3f}",
        *(f"note: {notice}" for notice in metrics.get("notices", ())),
        *_surface_warning(metrics["surface"]),
        *length_lines(metrics["surface"]),
        *(f"{folder / metrics['files'][name]}" for name in _SHOWN_FILES if name in metrics["files"]),
    ]
    return "\n".join(lines)


def _goal_lines(metrics: Mapping[str, Any]) -> list[str]:
    """Goal and limits of a run that has them."""
    goal = goal_of(metrics)
    if goal is None:
        return []
    return ["", goal_line(goal), terminal(limits_table(goal)), *filter(None, [evaluation_note(goal)])]


def _case_line(name: str, metrics: Mapping[str, Any]) -> str:
    """Stiffness under a load case beside that of the original web."""
    original, case = metrics["original_web"], metrics["load_cases"][name]
    key = next(key for key in case if key.startswith("stiffness_"))
    unit = "kN m/rad" if key.endswith("rad") else "kN/mm"
    now, before = case[key], original["load_cases"][name][key]
    values = f"{now / 1000:14.1f}{before / 1000:14.1f}{percent_change(now, before):+10.1f} %"
    estimate = f"+-{case['error_estimate_percent']:.2g} %" if "error_estimate_percent" in case else ""
    gain = original["gain_of_stiffness_per_mass_percent"][name]
    return f"{name + ', ' + unit:24}{values}{estimate:>12}{gain:+12.1f} %"


def _surface_warning(surface: Mapping[str, Any]) -> list[str]:
    if "refusal" in surface:
        return [f"no STL: {surface['refusal']}"]
    return obstacles(surface["cavities"], surface.get("undercuts"))
