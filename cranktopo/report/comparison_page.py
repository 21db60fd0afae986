"""The report of a comparison as content."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.cad.solid_files import surface_of
from cranktopo.effects import plan
from cranktopo.evaluate.case_stress import case_stress
from cranktopo.evaluate.evaluation import Progress
from cranktopo.evaluate.targets import Target
from cranktopo.loads import LoadCase, load_cases
from cranktopo.report.accuracy import error_picture
from cranktopo.report.comparison import (
    Comparison,
    leading_rows,
    level_rows,
    percent_table,
    published_table,
    value_table,
)
from cranktopo.report.page import Fact, Page, Section, Status
from cranktopo.report.release_section import Release, release_fact, release_of, release_table
from cranktopo.report.scatter import scatter_points
from cranktopo.report.sections import (
    effects_section,
    gallery_picture,
    loads_section,
    pairs,
    scatter_pictures,
    versions_table,
)
from cranktopo.report.stress_scale import stress_scales
from cranktopo.report.stress_section import stress_section
from cranktopo.report.tables import ResultTable
from cranktopo.report.verdict import fatigue_fact
from cranktopo.report.viewer import Body, Scene3D
from cranktopo.store.manifest import file_hash, settings_hash, timestamp, versions
from cranktopo.triangles.surface_files import read_stl
from cranktopo.triangles.surface_mesh import SurfaceMesh

_FACET_MM = 2.0
# Columns of a comparison that make its verdict, and how they read there.
_VERDICT = {0: "Lightest", 3: "Stiffest in torsion per mass", 4: "Stiffest in bending per mass"}
_TORSION_PER_MASS, _BENDING_PER_MASS, _SAFETY = 3, 4, 7


def comparison_page(
    comparison: Comparison, targets: Sequence[Target], command: Sequence[str], solve: Progress | None = None
) -> Page:
    """The report of a comparison.

    Args:
        comparison: evaluated targets.
        targets: the same targets, in the same order.
        command: the command line that made it.
        solve: solve all targets for the baseline's load cases too; called with lines of progress.

    Raises:
        CranktopoError: a failed solve of the stresses.
    """
    scene = targets[comparison.baseline].scene
    effects = plan(scene)
    cases = load_cases(scene, effects.enabled)
    scenery = _scenery(targets, cases, solve)
    releases = _releases(targets, scenery)
    others = [target.name for row, target in enumerate(targets) if row != comparison.baseline]
    return Page(
        title=f"{', '.join(others)} against {_name(comparison, comparison.baseline)}",
        subtitle=f"MeshResult with quadratic tetrahedra on {timestamp()[:10]}",
        headline=_headline(comparison),
        facts=(*_facts(comparison), release_fact(releases, len(targets))),
        sections=(
            _variants(comparison, releases),
            _accuracy(comparison),
            stress_section(scenery, f"{' '.join(command)} --stress"),
            loads_section(scene, [case.as_json() for case in cases]),
            effects_section(effects.as_json()),
            _provenance(targets, command),
        ),
        scenery=scenery,
        picture=gallery_picture(scenery.bodies) if scenery else None,
    )


def _name(comparison: Comparison, row: int) -> str:
    return comparison.entries[row].evaluation.target


def _change(comparison: Comparison, row: int, column: int) -> str:
    return f"{comparison.percent(row, column) - 100:+.1f} %"


def _headline(comparison: Comparison) -> str:
    row, baseline = leading_rows(comparison)[_TORSION_PER_MASS], _name(comparison, comparison.baseline)
    if row == comparison.baseline:
        return f"None is stiffer in torsion per kilogram than {baseline}."
    level = level_rows(comparison, _TORSION_PER_MASS)
    names = " and ".join(_name(comparison, other) for other in level)
    doubt = f", {names} within the error estimate" if level else ""
    return (
        f"{_name(comparison, row)} is the stiffest in torsion per kilogram{doubt}: "
        f"{_change(comparison, row, _TORSION_PER_MASS)} against {baseline}, bending per kilogram "
        f"{_change(comparison, row, _BENDING_PER_MASS)}, mass {_change(comparison, row, 0)}."
    )


def _facts(comparison: Comparison) -> tuple[Fact, ...]:
    judged = comparison.fatigue is not None
    labels = {**_VERDICT, **({_SAFETY: "Safest against fatigue"} if judged else {})}
    found = tuple(_best(comparison, column, label) for column, label in labels.items())
    return found if judged else (*found, fatigue_fact(None, "stiffness was compared, not life"))


def _best(comparison: Comparison, column: int, label: str) -> Fact:
    """Which entry has the best value of a column, and who is level with it."""
    row, level = leading_rows(comparison)[column], level_rows(comparison, column)
    change = f"{_change(comparison, row, column)} of the baseline"
    rivals = [_name(comparison, other) for other in level if other != comparison.baseline]
    note = "the baseline itself" if row == comparison.baseline else change
    note += ", less than the error estimate" if comparison.baseline in level else ""
    note += f"; {' and '.join(rivals)} within the error estimate" if rivals else ""
    mood: Status = "neutral" if comparison.baseline in (row, *level) else "good"
    return Fact(label, _name(comparison, row), note, mood)


def _variants(comparison: Comparison, releases: Sequence[Release]) -> Section:
    tables = [("Values", value_table(comparison)), ("Percent of the baseline", percent_table(comparison))]
    published = published_table(comparison)
    if published is not None:
        tables.append(("Beside published values", published))
    if releases:
        tables.append(("Release from a die that parts in x = 0", release_table(releases)))
    return Section(
        "variants",
        "Variants",
        "A star marks the best of each column, unless another is within the error estimate. Stiffnesses are "
        "those of the full throw with the supports of its design." + _lives(comparison),
        tuple(tables),
        scatter_pictures(scatter_points(comparison), comparison.baseline),
    )


def _lives(comparison: Comparison) -> str:
    if comparison.fatigue is None:
        return ""
    places = [
        f"{entry['target']}: {entry['critical']['place']}"
        for entry in comparison.fatigue.json["fatigue"]
        if "critical" in entry
    ]
    worst = f" Least safety: {'; '.join(places)}." if places else ""
    return f" {' '.join(comparison.fatigue.verdicts)}{worst}"


def _accuracy(comparison: Comparison) -> Section:
    evaluations = [entry.evaluation for entry in comparison.entries]
    columns = ("target", "element_size_mm", "nodes", "torsion_error_percent", "bending_error_percent")
    rows = tuple(
        (
            e.target,
            e.fine.element_size_mm,
            float(e.fine.nodes),
            e.torsion_error_percent,
            e.bending_error_percent,
            e.total_seconds,
        )
        for e in evaluations
    )
    rungs = [
        {"name": e.target, "seconds": e.total_seconds, "error_percent": e.error_percent} for e in evaluations
    ]
    return Section(
        "accuracy",
        "Accuracy and its price",
        "Errors are estimated from a second, coarser mesh.",
        (("Meshes", ResultTable((*columns, "time_s"), rows, (0, 2, 0, 2, 2, 1))),),
        (error_picture(rungs),),
    )


def _provenance(targets: Sequence[Target], command: Sequence[str]) -> Section:
    hashes = [
        (f"{t.name}, SHA-256 of the scene", settings_hash(t.scene.model_dump(mode="json"), {}))
        for t in targets
    ]
    files = [(f"{t.name}, SHA-256 of {t.file.name}", file_hash(t.file)) for t in targets if t.file]
    rows = [("command", " ".join(command)), ("written", timestamp()), *hashes, *files]
    return Section(
        "provenance",
        "Where this comes from",
        tables=(("Comparison", pairs(rows)), ("Versions", versions_table(versions()))),
    )


def _scenery(targets: Sequence[Target], cases: Sequence[LoadCase], solve: Progress | None) -> Scene3D | None:
    """Every target that has facets, with the stresses of the load cases where they are asked for."""
    bodies = []
    for target in targets:
        mesh = _surface(target)
        if mesh is not None:
            stress = case_stress(target, cases, progress=solve) if solve else None
            scene = target.scene
            bodies.append(Body(target.name, mesh, scene.web_z_mm, scene.pitch_mm / 2, stress))
    stressed = [(body.mesh, body.stress) for body in bodies if body.stress]
    return Scene3D(tuple(bodies), stress_scales=stress_scales(stressed)) if bodies else None


def _releases(targets: Sequence[Target], scenery: Scene3D | None) -> list[Release]:
    scenes = {target.name: target.scene for target in targets}
    bodies = scenery.bodies if scenery else ()
    return [release_of(body.name, body.mesh, scenes[body.name]) for body in bodies]


def _surface(target: Target) -> SurfaceMesh | None:
    """Facets of a target; none for a STEP file, which only the judge reads."""
    if target.file is not None:
        return read_stl(target.file) if target.file.suffix.lower() == ".stl" else None
    return surface_of(target.scene, "half", _FACET_MM)
