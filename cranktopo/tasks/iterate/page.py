"""The report of a loop as content: the best step, every step beside the original, the webs to turn."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from cranktopo.report.gallery import gallery_picture
from cranktopo.report.page import Fact, FactStatus, Page, Section
from cranktopo.report.plot import Picture
from cranktopo.report.sections import assumed_tables, origin_rows, pairs, versions_section
from cranktopo.report.viewer.scene3d import Scene3D, ShownBody
from cranktopo.runs.kind import SHAPE
from cranktopo.tasks.bound.page import bound_sections
from cranktopo.tasks.bound.result import read_bound
from cranktopo.tasks.designs.run_webs import best_row, row_words
from cranktopo.tasks.fea.quantities import (
    BENDING,
    BENDING_PER_MASS,
    MASS,
    TORSION,
    TORSION_PER_MASS,
    Quantity,
)
from cranktopo.tasks.fea.verdict_sentence import comparison_sentence
from cranktopo.tasks.iterate.plot import steps_figure
from cranktopo.tasks.iterate.text import best_line, shape_line, steps_estimate, steps_tables

_FACTS = (MASS, TORSION, BENDING, TORSION_PER_MASS, BENDING_PER_MASS)


def iterate_page(data: Mapping[str, Any], manifest: Mapping[str, Any], bodies: tuple[ShownBody, ...]) -> Page:
    """The report of a loop, finished or after any of its steps.

    Args:
        bodies: the half throw of every step, the original one first.
    """
    return Page(
        title=f"Loop over the crank web of {data['design']}",
        subtitle=f"Loop {manifest['run']}, {manifest['started'][:10]}",
        headline=_headline(data),
        facts=(*_facts(data), Fact("Ended", f"{_done(data)} steps", data["stop_reason"], "neutral")),
        sections=(
            _steps(data),
            *bound_sections(read_bound(data), "the body-fitted evaluation"),
            _provenance(data, manifest),
            versions_section(manifest["versions"]),
        ),
        scene3d=Scene3D(bodies, first=_shown_step(data)),
        picture=gallery_picture(bodies),
    )


def _headline(data: Mapping[str, Any]) -> str:
    """Which step is best, and all that it changes; what got worse is said first."""
    best = best_row(data)
    if best is None:
        line = best_line(data)
        return f"{line[0].upper()}{line[1:]}."
    share = best["percent_of_original"]
    changes = {quantity: share[quantity.key] - 100 for quantity in (MASS, TORSION, BENDING)}
    gain = share[TORSION_PER_MASS.key] - 100
    return (
        f"{row_words(best).capitalize()} is the best: {gain:+.1f} % torsional stiffness per mass. "
        + comparison_sentence("It", changes, "the original web")
    )


def _shown_step(data: Mapping[str, Any]) -> int:
    """Row of the best web, or the last where none beats the original."""
    return int((best_row(data) or data["steps"][-1])["number"])


def _done(data: Mapping[str, Any]) -> int:
    """Steps of the loop itself."""
    return sum(row_words(row) != SHAPE for row in data["steps"]) - 1


def _facts(data: Mapping[str, Any]) -> tuple[Fact, ...]:
    """The shown step against the original web."""
    step, original = data["steps"][_shown_step(data)], data["steps"][0]
    return tuple(_fact(step, original, quantity) for quantity in _FACTS)


def _fact(step: Mapping[str, Any], original: Mapping[str, Any], quantity: Quantity) -> Fact:
    label = quantity.label.capitalize()
    change = step["percent_of_original"][quantity.key] - 100
    error = f"{quantity.error}_error_percent"
    estimate = max(step[error], original[error]) if quantity.error else 0.0
    note = f"{row_words(step)} against the original web"
    if abs(change) < estimate:
        return Fact(label, f"{change:+.1f} %", f"{note}, less than the error estimate", "neutral")
    status: FactStatus = "good" if quantity.better * change > 0 else "bad"
    return Fact(label, f"{change:+.1f} %", note, status)


def _steps(data: Mapping[str, Any]) -> Section:
    figure = steps_figure(data)
    figure.set_facecolor("none")
    alt = "Mass, stiffnesses and stiffnesses per mass of every step in percent of the original web's"
    return Section(
        "steps",
        "Steps",
        f"Evaluated with fillets on body-fitted meshes; {steps_estimate(data['steps'])}. Every step keeps "
        "its web as TOML, STEP and STL in a folder beside this page."
        + "".join(f" Note: {notice}." for notice in data.get("notices", ()))
        + _handed_over(data),
        steps_tables(data["steps"]),
        (Picture("steps", figure, alt),),
    )


def _handed_over(data: Mapping[str, Any]) -> str:
    line = shape_line(data)
    return f" {line[0].upper()}{line[1:]}; see shape/report.html." if line else ""


def _provenance(data: Mapping[str, Any], manifest: Mapping[str, Any]) -> Section:
    tables = (("Loop", pairs(origin_rows(manifest))), *assumed_tables(data.get("assumed", ())))
    return Section("provenance", "Where this comes from", tables=tables)
