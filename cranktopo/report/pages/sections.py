"""Parts that the report of a run and that of a comparison share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from cranktopo.loads import LoadAnalysis
from cranktopo.report.figures.loads_plot import PANELS
from cranktopo.report.figures.picture import gallery_figure
from cranktopo.report.figures.plot import Picture, picture
from cranktopo.report.figures.scatter import Point, draw_stiffness_over_mass, most_by_label
from cranktopo.report.pages.page import Section
from cranktopo.report.tables.result_table import Column, ResultTable, tabulate
from cranktopo.report.viewer.scene3d import ShownBody

_Entry = Mapping[str, Any]
_LOAD_COLUMNS: tuple[Column[_Entry], ...] = (
    Column("load_case", 0, lambda case: case["name"]),
    Column("radial_N", 0, lambda case: case["radial_N"] or None),
    Column("tangential_N", 0, lambda case: case["tangential_N"] or None),
    Column("torque_Nm", 1, lambda case: case["torque_Nm"] or None),
    Column("from", 0, lambda case: case["from"]),
)
_EFFECT_COLUMNS: tuple[Column[_Entry], ...] = (
    Column("effect", 0, lambda effect: effect["name"].replace("_", " ")),
    Column("state", 0, lambda effect: effect["state"]),
    Column("size_percent", 1, lambda effect: effect["estimate_percent"]),
    Column("because", 0, lambda effect: effect["reason"]),
    Column("leaving_it_out_changes", 0, lambda effect: effect["changes"]),
)
_LOAD_ALT = (
    "Gas force, inertia force of the piston and their sum over the crank angle",
    "Radial and tangential force on the crankpin over the crank angle",
    "Torque of one throw and of the engine over the crank angle",
)


def loads_section(analysis: LoadAnalysis | None, cases: Sequence[Mapping[str, Any]]) -> Section:
    """Load cases as `loads --json` holds them, and the curves over the cycle of an engine with gas data."""
    table = tabulate(_LOAD_COLUMNS, cases)
    pictures: tuple[Picture, ...] = ()
    text = "The scene names no engine: unit loads, so that stiffnesses are what counts."
    if analysis is not None:
        count = analysis.engine.cylinders
        text = f"{count} cylinder{'s' * (count > 1)} at {analysis.engine.speed_rpm:g} rpm."
        if analysis.cycle is not None:
            pictures = tuple(
                picture(f"loads-{number}", alt, panel, analysis)
                for number, (panel, alt) in enumerate(zip(PANELS, _LOAD_ALT, strict=True), start=1)
            )
    return Section("loads", "Loads", text, (("Load cases", table),), pictures)


def effects_section(effects: Sequence[Mapping[str, Any]]) -> Section:
    """The effects plan with its reasons, as metrics.json holds it."""
    return Section(
        "effects",
        "Which physics was simulated, and why",
        "An effect that is off costs nothing: no solve, no cell, no mesh.",
        (("Effects plan", tabulate(_EFFECT_COLUMNS, effects)),),
    )


def scatter_pictures(
    points: Mapping[str, Sequence[Point]], baseline: int, bound: Mapping[str, Any] | None = None
) -> tuple[Picture, ...]:
    """Stiffness over mass, one plot per stiffness.

    Args:
        points: by the label of the stiffness.
        baseline: number of the point that counts as 100 %.
        bound: whose curves are drawn, where there is one; the baseline is then the original.
    """
    most = most_by_label(bound, {label: row[baseline] for label, row in points.items()})
    return tuple(
        picture(
            f"scatter-{label.split()[0]}",
            _words(label, row),
            draw_stiffness_over_mass,
            row,
            baseline,
            label,
            most.get(label),
        )
        for label, row in points.items()
    )


def _words(label: str, points: Sequence[Point]) -> str:
    values = "; ".join(f"{p.name} {p.mass_kg:.3f} kg, {p.stiffness:.1f}" for p in points)
    return f"{label} over mass: {values}"


def gallery_picture(bodies: Sequence[ShownBody]) -> Picture:
    """Still picture of half throws, side by side."""
    alt = f"Half throws of {', '.join(body.name for body in bodies)}; journals grey, webs blue"
    figure = gallery_figure([(body.name, body.mesh, body.web_z_mm) for body in bodies])
    return Picture("gallery", figure, alt)


def origin_rows(manifest: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Where a run comes from, for `pairs`: its command, start, settings and input files."""
    inputs = manifest.get("inputs", {}).items()
    return [
        ("command", " ".join(manifest["command"])),
        ("started", manifest["started"]),
        ("settings, SHA-256", manifest["settings_sha256"]),
        *((f"{role}, SHA-256", entry["sha256"]) for role, entry in inputs),
    ]


def assumed_tables(entries: Sequence[Mapping[str, Any]]) -> list[tuple[str, ResultTable]]:
    """What the design does not say, as one table with its caption; none where it says all.

    Args:
        entries: `assumed` of metrics.json.
    """
    rows = [(entry["key"], f"{entry['value']} {entry['meaning']}".strip()) for entry in entries]
    return [("Assumed, because the design does not say it", pairs(rows))] if rows else []


def versions_section(versions: Mapping[str, str | None], files: Mapping[str, str] | None = None) -> Section:
    """Versions of what took part, and the files beside the page; left out on paper."""
    found = pairs([(name, text or "not installed") for name, text in versions.items()])
    tables = [("Versions", found)]
    if files:
        tables.append(("Files beside this page", pairs(list(files.items()))))
    title = "Software and files" if files else "Software"
    return Section("software", title, tables=tuple(tables), on_paper=False)


def pairs(rows: Sequence[tuple[str, Any]]) -> ResultTable:
    """A table of names and values as text."""
    cells = tuple({"what": name, "value": str(value)} for name, value in rows)
    return ResultTable({"what": 0, "value": 0}, cells)
