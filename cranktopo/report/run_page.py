"""The report of an optimise run as content."""

from __future__ import annotations

from typing import Any

from cranktopo.report.accuracy import accuracy_section
from cranktopo.report.convergence import PANELS
from cranktopo.report.page import Page, Picture, Section
from cranktopo.report.picture import views_figure
from cranktopo.report.record import RunRecord
from cranktopo.report.scatter import BENDING_LABEL, TORSION_LABEL, Point
from cranktopo.report.sections import (
    effects_section,
    loads_section,
    origin_rows,
    pairs,
    picture,
    scatter_pictures,
    versions_table,
)
from cranktopo.report.stress_scale import stress_scales
from cranktopo.report.stress_section import stress_section
from cranktopo.report.tables import ResultTable
from cranktopo.report.verdict import facts, headline
from cranktopo.report.viewer import Body, Scene3D

_NAMES = ("original web", "optimised")
_LABELS = {"torsion": TORSION_LABEL, "bending": BENDING_LABEL}
_UNITS = {"torsion": "kNm_per_rad", "bending": "kN_per_mm"}
_CURVE_ALT = (
    "Compliance of every load case over the iterations, as a share of its first value",
    "Volume fraction over the iterations",
    "Greyness over the iterations",
)


def run_page(record: RunRecord) -> Page:
    """The report of a finished run.

    Args:
        record: from `read_record`.
    """
    metrics, manifest = record.metrics, record.manifest
    scenery = _scenery(record)
    return Page(
        title=f"Crank web of {metrics['design']}",
        subtitle=f"Run {metrics['run']}, {manifest['started'][:10]}",
        headline=headline(metrics),
        facts=facts(record),
        sections=(
            _variants(metrics),
            _convergence(record),
            loads_section(record.scene, [case["load"] for case in metrics["load_cases"].values()]),
            stress_section(scenery, f"cranktopo report {record.folder} --stress"),
            accuracy_section(metrics, record.accuracy, record.folder),
            effects_section(metrics["effects"]),
            _provenance(record),
        ),
        scenery=scenery,
        picture=_still(record),
    )


def _variants(metrics: dict[str, Any]) -> Section:
    rows = (metrics["original_web"], metrics)
    kinds = [kind for kind in _UNITS if kind in metrics["load_cases"]]
    columns = ["design", "mass_of_throw_kg", "mass_of_web_kg"]
    columns += [f"{kind}_{_UNITS[kind]}" for kind in kinds]
    columns += [f"{kind}_per_mass_{_UNITS[kind]}_kg" for kind in kinds]
    values = [[row["mass_kg"]["throw"], row["mass_kg"]["web"]] for row in rows]
    for row, cells in zip(rows, values, strict=True):
        stiffness = [_stiffness(row, kind) for kind in kinds]
        cells += [*stiffness, *(value / cells[0] for value in stiffness)]
    absolute = tuple((name, *cells) for name, cells in zip(_NAMES, values, strict=True))
    change = tuple(100 * (now / before - 1) for before, now in zip(*values, strict=True))
    points = {
        _LABELS[kind]: [
            Point(name, row["mass_kg"]["throw"], _stiffness(row, kind))
            for name, row in zip(_NAMES, rows, strict=True)
        ]
        for kind in kinds
    }
    names = tuple(f"{name.split('_k')[0]}_percent" for name in columns[1:])
    return Section(
        "variants",
        "Against the original",
        "Both webs in the optimiser's own model, on the same cells, so that their ratio counts more than "
        "either value. 'cranktopo evaluate' judges the surface on body-fitted elements.",
        (
            ("Values", ResultTable(tuple(columns), absolute, (0, 3, 3, *[1] * (2 * len(kinds))))),
            ("Change", ResultTable(("design", *names), ((_NAMES[1], *change),), (0, *[1] * len(change)))),
        ),
        scatter_pictures(points, 0),
    )


def _stiffness(row: dict[str, Any], kind: str) -> float:
    """Stiffness of a load case in kN m/rad or kN/mm."""
    case = row["load_cases"][kind]
    return float(next(value for key, value in case.items() if key.startswith("stiffness_"))) / 1000


def _convergence(record: RunRecord) -> Section:
    return Section(
        "convergence",
        "Convergence",
        f"{record.metrics['status'].capitalize()}: {record.metrics['stop_reason']}. Dotted lines: the "
        "projection gets steeper there.",
        pictures=tuple(
            picture(f"convergence-{number}", alt, panel, record.history)
            for number, (panel, alt) in enumerate(zip(PANELS, _CURVE_ALT, strict=True), start=1)
        ),
    )


def _provenance(record: RunRecord) -> Section:
    manifest, metrics = record.manifest, record.metrics
    rows = [
        *origin_rows(manifest),
        ("seed of random starts", manifest["seed"]),
        ("cells", " x ".join(str(n) for n in metrics["grid"]["cells"])),
        ("largest cell edge", f"{metrics['grid']['cell_mm']:.3g} mm"),
        ("solver", metrics["solver"]["precision"]),
        ("time, without this page", f"{metrics['seconds']['total']:.1f} s"),
        ("peak memory", f"{metrics['peak_memory_MiB']:.0f} MiB"),
    ]
    files = [(what, name) for what, name in metrics["files"].items()]
    return Section(
        "provenance",
        "Where this comes from",
        tables=(
            ("Run", pairs(rows)),
            ("Versions", versions_table(manifest["versions"])),
            ("Files beside this page", pairs(files)),
        ),
    )


def _scenery(record: RunRecord) -> Scene3D | None:
    if record.mesh is None:
        return None
    rows = {row["iteration"]: row for row in record.history}
    notes = tuple(_note(rows.get(step.iteration, {})) for step in record.steps)
    scene, stress = record.scene, record.stress
    body = Body("optimised", record.mesh, scene.web_z_mm, scene.pitch_mm / 2, stress)
    scales = stress_scales([(record.mesh, stress)] if stress else [])
    return Scene3D((body,), record.steps, notes, scales)


def _note(row: dict[str, Any]) -> str:
    if not row:
        return ""
    volume, grey = row["volume_fraction"], row["greyness"]
    return f"objective {row['objective']:.4g}, volume {volume:.3f}, greyness {grey:.3f}"


def _still(record: RunRecord) -> Picture | None:
    if record.mesh is None:
        return None
    alt = (
        f"Half throw of {record.metrics['design']} with the optimised web, from the journal side, from the "
        "crankpin side, from the front and from the side; journals grey, web blue"
    )
    return Picture("views", views_figure(record.mesh, record.scene.web_z_mm), alt)
