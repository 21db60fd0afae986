"""The re-model of a run as content: how close the parametric web is to the optimised body."""

from __future__ import annotations

from collections.abc import Mapping

from cranktopo.report.page import Fact, Page, Section, pairs, versions_section
from cranktopo.report.result_table import ResultTable
from cranktopo.report.viewer.scene3d import Scene3D, ShownBody, gallery_picture
from cranktopo.tasks.refit.result import RefitResult
from cranktopo.tasks.refit.text import fit_lines, fit_trials_table, rest_table, shape_rows, stiffness_rows

_KINDS = {"torsion": "Torsional stiffness", "bending": "Bending stiffness"}


def refit_page(
    data: RefitResult, bodies: tuple[ShownBody, ...], versions: Mapping[str, str | None], written: str
) -> Page:
    """Return the report of a re-model.

    Args:
        bodies: the fitted half throw, and the body that it was fitted to.
        written: a date.
    """
    return Page(
        title=f"Re-modelled web {data.design}",
        subtitle=f"Fitted to the body of run {data.run}, {written}",
        headline=f"The parametric web overlaps the body by {100 * data.iou.web:.1f} % (IoU).",
        facts=_facts(data),
        sections=(refit_section(data), _limits(data), versions_section(versions, data.files)),
        scene3d=Scene3D(bodies),
        picture=gallery_picture(bodies),
    )


def refit_section(data: RefitResult) -> Section:
    """Return the shape error, stiffnesses, what was tried and what is left over."""
    tables: list[tuple[str, ResultTable]] = [
        ("Web against body", pairs([*shape_rows(data), *stiffness_rows(data.stiffness)])),
        ("Features tried, each kept only for what it gains", fit_trials_table(data)),
    ]
    if data.not_represented:
        tables.append(("Not represented by the parametric web", rest_table(data)))
    text = (
        "The body has no fillets, so the web is compared without its own. "
        + " ".join(f"{line[0].upper()}{line[1:]}." for line in fit_lines(data))
        + " Places: x across, y along the throw from the crank axis, z along the crank from the middle of "
        "the main journal."
    )
    return Section("remodel", "Re-modelled web", text, tuple(tables))


def _facts(data: RefitResult) -> tuple[Fact, ...]:
    mass, stiffness = data.web_mass_kg, data.stiffness
    facts = [
        Fact(
            "Mass of the web",
            f"{mass.fitted:.3f} kg",
            f"{mass.difference_percent:+.1f} % against the body",
            "neutral",
        )
    ]
    changes = {} if stiffness is None else stiffness.difference_percent
    for kind, label in _KINDS.items() if changes else ():
        change = f"{changes[kind]:+.1f} %"
        facts.append(Fact(label, change, "without fillets, against the body", "neutral"))
    distance = data.distance_mm
    note = f"{distance.mean:.2f} mm on average"
    return (*facts, Fact("Largest distance to the body", f"{distance.max:.1f} mm", note, "neutral"))


def _limits(data: RefitResult) -> Section:
    rows = [(name.replace("_", " "), f"{value:g}") for name, value in vars(data.rules).items()]
    return Section("limits", "Limits of the fit", tables=(("As it was asked for", pairs(rows)),))
