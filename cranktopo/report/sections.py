"""Parts that the report of a run and that of a comparison share."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from cranktopo.loads import analyse
from cranktopo.report.loads_plot import PANELS
from cranktopo.report.page import Picture, Section
from cranktopo.report.picture import gallery_figure
from cranktopo.report.scatter import Point, draw_stiffness_over_mass
from cranktopo.report.tables import ResultTable
from cranktopo.report.viewer import Body
from cranktopo.scene import Scene

_PANEL_INCHES, _AXES = (4.4, 3.0), (0.145, 0.165, 0.83, 0.74)
_LOAD_ALT = (
    "Gas force, inertia force of the piston and their sum over the crank angle",
    "Radial and tangential force on the crankpin over the crank angle",
    "Torque of one throw and of the engine over the crank angle",
)


def picture(name: str, alt: str, draw: Callable[..., None], *arguments: Any) -> Picture:
    """A plot with one pair of axes.

    Args:
        name: file name without ending.
        alt: text for readers who cannot see it.
        draw: function of the axes and the arguments.
        arguments: passed on.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=_PANEL_INCHES, facecolor="none")
    FigureCanvasAgg(figure)
    axes = figure.add_axes(_AXES)
    axes.set_facecolor("none")
    draw(axes, *arguments)
    return Picture(name, figure, alt)


def loads_section(scene: Scene, cases: Sequence[Mapping[str, Any]]) -> Section:
    """Load cases, and the curves over the cycle where the scene has an engine with gas data.

    Args:
        scene: the scene.
        cases: its load cases, as `loads --json` holds them.
    """
    rows = tuple(
        (c["name"], *(c[key] or None for key in ("radial_N", "tangential_N", "torque_Nm")), c["from"])
        for c in cases
    )
    columns = ("load_case", "radial_N", "tangential_N", "torque_Nm", "from")
    table = ResultTable(columns, rows, (0, 0, 0, 1, 0))
    analysis = analyse(scene) if scene.engine else None
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
    """The effects plan with its reasons.

    Args:
        effects: objects of metrics.json.
    """
    rows = tuple(
        (e["name"].replace("_", " "), e["state"], e["estimate_percent"], e["reason"], e["changes"])
        for e in effects
    )
    columns = ("effect", "state", "size_percent", "because", "leaving_it_out_changes")
    return Section(
        "effects",
        "Which physics was simulated, and why",
        "An effect that is off costs nothing: no solve, no cell, no mesh.",
        (("Effects plan", ResultTable(columns, rows, (0, 0, 1, 0, 0))),),
    )


def scatter_pictures(points: Mapping[str, Sequence[Point]], baseline: int) -> tuple[Picture, ...]:
    """Stiffness over mass, one plot per stiffness.

    Args:
        points: by the label of the stiffness.
        baseline: number of the point that counts as 100 %.
    """
    return tuple(
        picture(
            f"scatter-{label.split()[0]}", _words(label, row), draw_stiffness_over_mass, row, baseline, label
        )
        for label, row in points.items()
    )


def _words(label: str, points: Sequence[Point]) -> str:
    values = "; ".join(f"{p.name} {p.mass_kg:.3f} kg, {p.stiffness:.1f}" for p in points)
    return f"{label} over mass: {values}"


def gallery_picture(bodies: Sequence[Body]) -> Picture:
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


def versions_table(versions: Mapping[str, str | None]) -> ResultTable:
    """Versions of what took part; none of what is not installed."""
    return pairs([(name, text or "not installed") for name, text in versions.items()])


def pairs(rows: Sequence[tuple[str, Any]]) -> ResultTable:
    """A table of names and values as text."""
    return ResultTable(("what", "value"), tuple((name, str(value)) for name, value in rows), (0, 0))
