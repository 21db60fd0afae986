"""The report of a comparison as content, and its plot as a file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from cranktopo.base.files import replacing
from cranktopo.base.formats import PLOTS
from cranktopo.engine.analysis import LoadAnalysis
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.plan.effect import PhysicsPlan
from cranktopo.report.goal_table import goal_line, limits_table
from cranktopo.report.page import (
    Fact,
    FactStatus,
    Page,
    Section,
    assumed_tables,
    clock_words,
    pairs,
    versions_section,
)
from cranktopo.report.plot import save_figure
from cranktopo.report.result_table import Column, ResultTable, tabulate
from cranktopo.report.viewer.scene3d import Scene3D, ShownBody, gallery_picture, stress_scales
from cranktopo.runs.destination import check_file
from cranktopo.tasks.bound.result import AnyBound
from cranktopo.tasks.bound.text import bound_sections
from cranktopo.tasks.compare.cards import best_facts, change_words, method_words
from cranktopo.tasks.compare.result import Comparison
from cranktopo.tasks.compare.text import (
    balance_lines,
    comparison_tables,
    fillet_lines,
    left_off_lines,
    method_lines,
    safety_method,
    safety_places,
    star_lines,
)
from cranktopo.tasks.extraction.text import DesignUndercuts, undercut_table
from cranktopo.tasks.loads.section import loads_section
from cranktopo.tasks.plan.section import effects_section
from cranktopo.tasks.throw_fatigue.text import FatigueComparison
from cranktopo.tasks.throw_fea.quantities import (
    BENDING,
    MASS,
    TORSION,
    TORSION_PER_MASS,
    Quantity,
    comparison_sentence,
)
from cranktopo.tasks.throw_fea.scatter import (
    LABELS,
    Point,
    draw_stiffness_over_mass,
    most_by_label,
    scatter_pictures,
)
from cranktopo.tasks.throw_fea.section import stress_section


@dataclass(frozen=True)
class ComparisonRecord:
    """A finished comparison with everything that its page shows.

    Attributes:
        bodies: surfaces of all entries in order, of two different webs both half throws; with stresses where
            they were solved.
        effects, cases, loads: of the baseline; no loads without an engine.
        hashes: SHA-256 of every scene and file, by what it is of.
        bound: beside the entry that is stiffest in torsion per mass; None where none was asked for.
        no_stresses: why none are solved, whoever asks; empty where they can be.
    """

    comparison: Comparison
    bodies: tuple[ShownBody, ...]
    undercuts: tuple[DesignUndercuts, ...]
    effects: PhysicsPlan
    cases: tuple[LoadCase, ...]
    loads: LoadAnalysis | None
    hashes: Mapping[str, str]
    command: str
    written: str
    versions: Mapping[str, str | None]
    bound: AnyBound | None = None
    no_stresses: str = ""


def comparison_page(record: ComparisonRecord) -> Page:
    """Return the report of a comparison."""
    comparison, bodies = record.comparison, record.bodies
    stressed = [(body.mesh, body.stress) for body in bodies if body.stress]
    best = comparison.leading(TORSION_PER_MASS)
    # two different webs are two bodies
    first = best + sum(entry.evaluation.second_web_kg is not None for entry in comparison.entries[:best])
    scene3d = Scene3D(bodies, stress_scales=stress_scales(stressed), first=first) if bodies else None
    leader, base = comparison.entries[best].name, comparison.base.name
    others = [e.name for row, e in enumerate(comparison.entries) if row != comparison.baseline]
    return Page(
        title=f"{', '.join(others)} against {base}",
        subtitle=f"Evaluated with quadratic tetrahedra on {record.written[:10]}",
        headline=" ".join(
            (
                *filter(None, [comparison.mirrored]),
                *left_off_lines(comparison),
                _headline(comparison),
                *fillet_lines(comparison.bare),
                *comparison.pitches,
            )
        ),
        facts=(*best_facts(comparison), undercut_fact(record.undercuts, len(bodies))),
        sections=(
            _variants(comparison, record.undercuts, record.bound),
            *bound_sections(record.bound, f"{base} and {leader} in the body-fitted evaluation"),
            *_goals(comparison),
            _accuracy(comparison),
            stress_section(scene3d, f"{record.command} --stress", record.no_stresses),
            _of(base, loads_section(record.loads, record.cases, of_stresses=comparison.fatigue is not None)),
            _of(base, effects_section(record.effects.effects)),
            _provenance(record),
            versions_section(record.versions),
        ),
        scene3d=scene3d,
        picture=gallery_picture(bodies) if bodies else None,
    )


def _of(base: str, section: Section) -> Section:
    """Name the design whose loads or effects a section has: those of another web can differ."""
    whose = f"Those of {base}; the torque of a vibrating shaft, and what the masses do, are each web's own."
    return replace(section, title=f"{section.title}: {base}", text=f"{whose} {section.text}")


def undercut_fact(undercuts: Sequence[DesignUndercuts], designs: int) -> Fact:
    """Return how many designs their process can make; `undercuts` are those that have a surface."""
    caught = [one.name for one in undercuts if not one.free]
    unknown = designs - len(undercuts)
    status: FactStatus = "bad" if caught else "unknown" if unknown else "good"
    note = f"hollows or undercuts in {', '.join(caught)}" if caught else "each by its own process"
    note += "; STEP files were not examined" * bool(unknown)
    return Fact("Released by a die", f"{len(undercuts) - len(caught)} of {designs}", note, status)


def _headline(comparison: Comparison) -> str:
    """Return the verdict; what fails by fatigue comes first, then a balance that moved."""
    failing = [f"{name} {what}" for one in comparison.fatigues for name, what in one.failing.items()]
    first = f"FATIGUE: {'; '.join(failing)}. " if failing else ""
    return first + " ".join((*balance_lines(comparison), _stiffest(comparison)))


def _stiffest(comparison: Comparison) -> str:
    row, baseline = comparison.leading(TORSION_PER_MASS), comparison.base.name
    level, best = comparison.level(TORSION_PER_MASS), comparison.entries[row].name
    if row == comparison.baseline:
        return f"None is stiffer in torsion per kilogram than {baseline}. {_others(comparison)}".rstrip()
    if level:
        names = " and ".join(comparison.entries[one].name for one in sorted((row, *level)))
        return f"{names} are level in torsion per kilogram, within the error estimate. {_others(comparison)}"
    return (
        f"{best} is the stiffest in torsion per kilogram: "
        f"{change_words(comparison, row, TORSION_PER_MASS)} against {baseline}. "
        + comparison_sentence("It", _changes(comparison, row), baseline)
    )


def _others(comparison: Comparison) -> str:
    """Return a sentence on the changes of each of the first entries but the baseline."""
    rows = [row for row in range(len(comparison.entries)) if row != comparison.baseline][:_TOLD]
    return " ".join(
        comparison_sentence(comparison.entries[row].name, _changes(comparison, row), comparison.base.name)
        for row in rows
    )


_TOLD = 3
"""Targets that a headline compares."""


def _changes(comparison: Comparison, row: int) -> dict[Quantity, float]:
    """Changes against the baseline that are larger than the bound of their error, %."""
    quantities = (MASS, TORSION, BENDING)
    known = [quantity for quantity in quantities if comparison.differ(row, comparison.baseline, quantity)]
    return {quantity: comparison.percent(row, quantity) - 100 for quantity in known}


def _variants(
    comparison: Comparison, undercuts: Sequence[DesignUndercuts], bound: AnyBound | None
) -> Section:
    names = ("Values", "Percent of the baseline", "Beside published values")
    tables = list(zip(names, comparison_tables(comparison), strict=False))
    if undercuts:
        tables.append(("Release from the die, mould or mill of each design", undercut_table(undercuts)))
    return Section(
        "variants",
        "Variants",
        "A star marks the best of each column, unless another is within the error estimate. Stiffnesses are "
        "those of the full throw with the supports of its design."
        + "".join(f" {line}" for line in (*comparison.pitches, *star_lines(comparison))),
        tuple(tables),
        scatter_pictures(_scatter_points(comparison), comparison.baseline, bound.stiffest if bound else {}),
        more=tuple(_safety(comparison)),
    )


def _goals(comparison: Comparison) -> tuple[Section, ...]:
    if not comparison.goals:
        return ()
    base, goals = comparison.base.name, comparison.goals.items()
    lines = [f"{name}: {goal_line(goal, base)}." for name, goal in goals]
    tables = tuple((name, limits_table(goal)) for name, goal in goals)
    return (Section("goals", "Goals and limits", " ".join([*lines, *safety_method(comparison)]), tables),)


def _safety(comparison: Comparison) -> list[str]:
    """Return a paragraph by method for the verdicts and the worst places, and one about the methods."""
    lines = [line for fatigue in comparison.fatigues for line in _safety_by(fatigue)]
    return [*lines, " ".join(method_lines(comparison))]


def _safety_by(fatigue: FatigueComparison) -> list[str]:
    head, verdicts = f"B{method_words(fatigue)[1:]}", " ".join(fatigue.verdicts)
    return [f"{head}: {verdicts}", " ".join(safety_places(fatigue))]


def _accuracy(comparison: Comparison) -> Section:
    evaluations = [entry.evaluation for entry in comparison.entries]
    table = tabulate(
        (
            Column("target", 0, lambda e: e.target),
            Column("element_size_mm", 2, lambda e: e.fine.element_size_mm),
            Column("nodes", 0, lambda e: float(e.fine.nodes)),
            Column("torsion_error_percent", 2, lambda e: e.torsion_error_percent),
            Column("bending_error_percent", 2, lambda e: e.bending_error_percent),
            Column("time_s", 1, lambda e: e.total_seconds),
        ),
        evaluations,
    )
    return Section(
        "accuracy",
        "Accuracy and what it costs",
        "Errors are bounds by what cubic elements would change, and for triangles by a coarser mesh as well. "
        "A difference between two webs has a smaller one, since errors of like meshes cancel.",
        (("Meshes", table),),
    )


def _assumed(comparison: Comparison) -> list[tuple[str, ResultTable]]:
    """Return what a target does not say, one table for all; fatigue names what it uses as well."""
    fatigue = comparison.fatigue
    known = fatigue.result.fatigue if fatigue else ()
    unknown = [e for e in comparison.entries if fatigue is None or e.name in fatigue.not_judged]
    found = [
        replace(item, key=f"{entry.target}: {item.key}")
        for entry in (*known, *(e.evaluation.result for e in unknown))
        for item in entry.assumed
    ]
    return assumed_tables(found)


def _provenance(record: ComparisonRecord) -> Section:
    rows = [("command", record.command), ("written", clock_words(record.written)), *record.hashes.items()]
    return Section(
        "provenance",
        "Where this comes from",
        tables=(("Comparison", pairs(rows)), *_assumed(record.comparison)),
    )


def plot_stiffness_over_mass(comparison: Comparison, path: Path, bound: AnyBound | None = None) -> None:
    """Draw stiffness over mass, with the curves of a bound; dashed lines join equal stiffness per mass."""
    check_file(path, "--plot", PLOTS)
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(11, 4.8), layout="constrained")
    FigureCanvasAgg(figure)
    plots = _scatter_points(comparison)
    original = {label: points[comparison.baseline] for label, points in plots.items()}
    most = most_by_label(bound.stiffest if bound else {}, original)
    for axes, (label, points) in zip(figure.subplots(1, 2), plots.items(), strict=True):
        draw_stiffness_over_mass(axes, points, comparison.baseline, label, most.get(label))
    figure.legend(*axes.get_legend_handles_labels(), fontsize=8, loc="outside lower center", ncols=3)
    if comparison.bare:
        figure.suptitle("all designs without fillets, as the surface of a run has none", fontsize=9)
    with replacing(path) as temporary:
        save_figure(figure, temporary, dpi=130)


def _scatter_points(comparison: Comparison) -> dict[str, list[Point]]:
    return {
        label: [Point(e.name, e.values[MASS.key], e.values[stiffness.key]) for e in comparison.entries]
        for stiffness, label in LABELS.items()
    }
