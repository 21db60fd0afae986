"""The report of an optimise run as content."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from cranktopo.design.clearance import clearance_text
from cranktopo.design.goal.constraint import TOLERANCE
from cranktopo.report.goal_table import evaluation_note, goal_line, limits_table
from cranktopo.report.page import (
    Page,
    Section,
    assumed_tables,
    left_off_first,
    origin_rows,
    pairs,
    versions_section,
)
from cranktopo.report.plot import DrawnPicture, Picture, picture
from cranktopo.report.result_table import ResultTable, Row
from cranktopo.report.shading import shaded
from cranktopo.report.viewer.scene3d import Scene3D, ShownBody, stress_scales
from cranktopo.tasks.accuracy.page import (
    level_tables,
    recommendation_table,
    study_pictures,
)
from cranktopo.tasks.bound.text import bound_sections
from cranktopo.tasks.extraction.result import RunSurface
from cranktopo.tasks.loads.section import loads_section
from cranktopo.tasks.optimise.picture import PANELS, views_figure
from cranktopo.tasks.optimise.result import CaseMetrics, OriginalWeb, RunMetrics
from cranktopo.tasks.optimise.run_record import RunRecord
from cranktopo.tasks.optimise.text import facts, headline
from cranktopo.tasks.plan.section import effects_section
from cranktopo.tasks.refit.page import refit_section
from cranktopo.tasks.throw_fea.quantities import MASS, PER_MASS, STIFFNESS, Quantity
from cranktopo.tasks.throw_fea.scatter import LABELS, Point, scatter_pictures
from cranktopo.tasks.throw_fea.section import clearance_sections, stress_section
from cranktopo.tasks.throw_fea.studies import StudyResult

_NAMES = ("original web", "optimised")
_THROW = replace(MASS, key="mass_of_throw")
_WEB = replace(MASS, key="mass_of_web", label="mass of one web")
_CURVE_ALT = (
    "Compliance of every load case over the iterations, as a share of its first value",
    "Volume fraction over the iterations",
    "Greyness over the iterations",
)


def run_page(record: RunRecord, views: bytes | None = None) -> Page:
    """Return the report of a finished run.

    Args:
        views: PNG of the four views, where they are drawn already.
    """
    metrics, manifest = record.metrics, record.manifest
    scene3d = _scene3d(record)
    return Page(
        title=f"Crank web of {metrics.design}",
        subtitle=f"Run {metrics.run}, {manifest.started[:10]}",
        headline=left_off_first(metrics.left_off, headline(metrics)),
        facts=facts(record),
        sections=(
            *_goal(metrics),
            *bound_sections(metrics.bound, "the optimiser's own cells"),
            _variants(metrics),
            _convergence(record),
            *clearance_sections(record.scene, scene3d.bodies if scene3d else ()),
            loads_section(record.loads, [case.load for case in metrics.load_cases.values()]),
            stress_section(scene3d, f"cranktopo report {record.folder} --stress"),
            accuracy_section(metrics, record.accuracy, record.folder),
            *([refit_section(record.refit)] if record.refit else []),
            effects_section(metrics.effects),
            _provenance(record),
            versions_section(manifest.versions, metrics.files),
        ),
        scene3d=scene3d,
        picture=_still(record, views),
    )


def _goal(metrics: RunMetrics) -> tuple[Section, ...]:
    goal = metrics.goal
    if goal is None:
        return ()
    line, note = goal_line(goal), evaluation_note(goal)
    text = (
        f"{line[0].upper()}{line[1:]}. Percent are of the original web in the same model; a limit holds "
        f"within {100 * TOLERANCE:g} %, and decides the design where the web is at it."
    ) + (f" {note[0].upper()}{note[1:]}." if note else "")
    return (Section("goal", "Goal and limits", text, (("Limits", limits_table(goal)),)),)


def _variants(metrics: RunMetrics) -> Section:
    stiffnesses = [quantity for quantity in STIFFNESS if quantity.key in metrics.load_cases]
    values = {_NAMES[0]: _values(metrics.original_web, stiffnesses), _NAMES[1]: _values(metrics, stiffnesses)}
    before, after = values.values()
    points = {
        LABELS[stiffness]: [Point(name, found[_THROW], found[stiffness]) for name, found in values.items()]
        for stiffness in stiffnesses
    }
    absolute: tuple[Row, ...] = tuple(
        {"design": name, **{quantity.column: value for quantity, value in found.items()}}
        for name, found in values.items()
    )
    change = {q.percent_column: 100 * (after[q] / before[q] - 1) for q in before}
    changed: Row = {"design": _NAMES[1], **change}
    return Section(
        "variants",
        "Against the original",
        "Both webs in the optimiser's own model, on the same cells: their ratio is more accurate than "
        "either value. 'cranktopo evaluate' evaluates the surface on body-fitted elements."
        + "".join(f" Note: {notice}." for notice in metrics.notices),
        (
            ("Values", ResultTable({"design": 0, **{q.column: q.digits for q in before}}, absolute)),
            ("Change", ResultTable({"design": 0, **dict.fromkeys(change, 1)}, (changed,))),
        ),
        scatter_pictures(points, 0, metrics.bound.stiffest if metrics.bound else {}),
    )


def _values(web: RunMetrics | OriginalWeb, stiffnesses: Sequence[Quantity]) -> dict[Quantity, float]:
    """Return masses, stiffnesses in thousands and their ratios."""
    throw = web.mass_kg.throw
    found = {quantity: web.load_cases[quantity.key].stiffness / 1000 for quantity in stiffnesses}
    ratios = dict(zip(STIFFNESS, PER_MASS, strict=True))
    return {
        _THROW: throw,
        _WEB: web.mass_kg.web,
        **found,
        **{ratios[quantity]: value / throw for quantity, value in found.items()},
    }


def _convergence(record: RunRecord) -> Section:
    return Section(
        "convergence",
        "Convergence",
        f"{record.metrics.status.capitalize()}: {record.metrics.stop_reason}. Dotted lines: the "
        "projection gets steeper there.",
        pictures=convergence_pictures(record.history),
    )


def convergence_pictures(history: Sequence[Mapping[str, Any]]) -> tuple[Picture, ...]:
    """Return the curves over the iterations, from the rows of history.csv."""
    return tuple(
        picture(f"convergence-{number}", alt, panel, history)
        for number, (panel, alt) in enumerate(zip(PANELS, _CURVE_ALT, strict=True), start=1)
    )


def accuracy_section(metrics: RunMetrics, studies: StudyResult | None, folder: str) -> Section:
    """Return residuals and volume errors of a run, and error against seconds where the run has studies."""
    solver, surface = metrics.solver, metrics.surface
    rows = [
        ("largest cell edge", f"{metrics.grid.cell_mm:.3g} mm"),
        *_estimates(metrics.load_cases),
        ("relative residual of the reported solve", f"{solver.final_relative_residual:.1e}"),
        ("cycles per solve, mean and most", f"{solver.cg_iterations.mean:.1f}, {solver.cg_iterations.max}"),
    ]
    if isinstance(surface, RunSurface):
        error = f"{surface.web_volume_error_percent:+z.4f} %"
        rows.append(("volume of the surface against the density", error))
    text = (
        "Cells cut by a cylinder make the optimiser's model a little too stiff; the error falls with the "
        "cell size and is nearly the same for both webs. 'cranktopo evaluate' gives a value with an error "
        "estimate."
    )
    tables = [("This run", pairs(rows))]
    pictures: tuple[Picture, ...] = ()
    if not studies:
        text += f" 'cranktopo accuracy {folder}' adds what each digit costs, from cheap to exact."
    if studies and studies.rungs:
        tables += [*level_tables(studies), ("Cheapest level", recommendation_table(studies))]
        pictures = study_pictures(studies)
    return Section("accuracy", "Accuracy and what it costs", text, tuple(tables), pictures)


def _estimates(load_cases: Mapping[str, CaseMetrics]) -> list[tuple[str, str]]:
    return [
        (f"error estimate, {name}", f"{case.error_estimate_percent:.2g} %")
        for name, case in load_cases.items()
        if case.error_estimate_percent is not None
    ]


def _provenance(record: RunRecord) -> Section:
    manifest, metrics = record.manifest, record.metrics
    rows = [
        *origin_rows(manifest),
        ("seed of random starts", manifest.seed),
        *([("room of the original web", room)] if (room := clearance_text(record.scene)) else []),
        ("cells", " x ".join(str(n) for n in metrics.grid.cells)),
        ("largest cell edge", f"{metrics.grid.cell_mm:.3g} mm"),
        ("solver", metrics.solver.precision),
        ("time, without this page", f"{metrics.seconds.total:.1f} s"),
        ("peak memory", f"{metrics.peak_memory_MiB:.0f} MiB"),
    ]
    return Section(
        "provenance", "Where this comes from", tables=(("Run", pairs(rows)), *assumed_tables(metrics.assumed))
    )


def _scene3d(record: RunRecord) -> Scene3D | None:
    if record.mesh is None:
        return None
    rows = {row["iteration"]: row for row in record.history}
    notes = tuple(_note(rows.get(step.iteration, {})) for step in record.snapshots)
    scene, stress = record.scene, record.stress
    body = ShownBody("optimised", record.mesh, scene.web_z_mm, scene.pitch_mm / 2, stress)
    scales = stress_scales([(record.mesh, stress)] if stress else [])
    return Scene3D((body,), record.snapshots, notes, scales)


def _note(row: Mapping[str, Any]) -> str:
    if not row:
        return ""
    volume, grey = row["volume_fraction"], row["greyness"]
    return f"objective {row['objective']:.4g}, volume {volume:.3f}, greyness {grey:.3f}"


def _still(record: RunRecord, views: bytes | None) -> Picture | DrawnPicture | None:
    if record.mesh is None:
        return None
    alt = (
        f"Half throw of {record.metrics.design} with the optimised web, from the journal side, from the "
        "crankpin side, from the front and from the side; journals grey, web blue"
    )
    if views is not None:
        return DrawnPicture("views", views, alt)
    return Picture("views", views_figure(shaded(record.mesh, record.scene.web_z_mm)), alt)
