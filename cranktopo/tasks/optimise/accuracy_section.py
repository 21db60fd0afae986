"""How accurate the numbers of a run are, and what the next digit costs."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.report.page import Section
from cranktopo.report.plot import Picture
from cranktopo.report.sections import pairs
from cranktopo.tasks.accuracy.plot import error_picture, study_pictures
from cranktopo.tasks.accuracy.text import level_tables, recommendation_table


def accuracy_section(metrics: Mapping[str, Any], studies: Mapping[str, Any] | None, folder: str) -> Section:
    """Residuals and volume errors of a run, and error against seconds where the run has studies.

    Args:
        studies: what `cranktopo accuracy --json` prints; None without.
    """
    solver, surface = metrics["solver"], metrics["surface"]
    rows = [
        ("largest cell edge", f"{metrics['grid']['cell_mm']:.3g} mm"),
        *_estimates(metrics["load_cases"]),
        ("relative residual of the reported solve", f"{solver['final_relative_residual']:.1e}"),
        ("cycles per solve, mean and most", "{mean:.1f}, {max}".format(**solver["cg_iterations"])),
    ]
    if "web_volume_error_percent" in surface:
        error = surface["web_volume_error_percent"]
        rows.append(("volume of the surface against the density", f"{error:+.4f} %"))
    text = (
        "Cells cut by a cylinder make the optimiser's model a little too stiff; the error falls with the "
        "cell size and is nearly the same for both webs. 'cranktopo evaluate' gives a value with an error "
        "estimate."
    )
    tables = [("This run", pairs(rows))]
    pictures: tuple[Picture, ...] = _own_picture(metrics)
    if not studies:
        text += f" 'cranktopo accuracy {folder}' adds what each digit costs, from cheap to exact."
    if studies and studies.get("rungs"):
        tables += [*level_tables(studies), ("Cheapest level", recommendation_table(studies))]
        pictures = study_pictures(studies)
    return Section("accuracy", "Accuracy and what it costs", text, tuple(tables), pictures)


def _own_picture(metrics: Mapping[str, Any]) -> tuple[Picture, ...]:
    """The run's own error estimates against its seconds, where it has estimates."""
    seconds = metrics["seconds"]["total"]
    found = [
        {"name": name, "seconds": seconds, "error_percent": case["error_estimate_percent"]}
        for name, case in metrics["load_cases"].items()
        if "error_estimate_percent" in case
    ]
    return (error_picture(found),) if found else ()


def _estimates(load_cases: Mapping[str, Any]) -> list[tuple[str, str]]:
    return [
        (f"error estimate, {name}", f"{case['error_estimate_percent']:.2g} %")
        for name, case in load_cases.items()
        if "error_estimate_percent" in case
    ]
