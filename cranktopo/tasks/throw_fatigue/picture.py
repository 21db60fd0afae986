"""Picture of a fatigue assessment: safety over the throw beside a diagram of the critical point."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.files import write_bytes
from cranktopo.design.halves import halves
from cranktopo.report.plot import png
from cranktopo.tasks.fatigue.criteria import criterion, safety_method
from cranktopo.tasks.fatigue.plane_criterion import PlaneDiagram
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.vtu import throw_surface

if TYPE_CHECKING:
    from cranktopo.report.shading import ShadedMesh


_VIEWS = (
    ("pin fillet", (0.45, -0.55, 0.9)),
    ("journal fillet", (0.45, 0.55, -0.9)),
)
_TOP = 4.0
"""Safety above which the picture's colours stay the same, over the least safety."""


def save_fatigue_picture(path: Path, field: FatigueField) -> None:
    """Write the safety over the throw from two sides and a diagram of the critical point's stresses as PNG.

    Raises:
        CranktopoError: the file cannot be written.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(15, 5.4), dpi=150, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    c, method = field.critical, safety_method(field.method)
    figure.suptitle(
        f"{field.model.name}: least safety {c.safety:.3f} by {method.title or method.name}, {c.place}",
        fontsize=13,
    )
    left, middle, right = figure.subplots(1, 3)
    _draw_sides(figure, (left, middle), field)
    if field.diagram is None:
        _draw_haigh(right, field)
    else:
        _draw_history(right, field.diagram, c.safety)
    write_bytes(path, png(figure))


def _draw_sides(figure: Any, axes: tuple[Any, Any], field: FatigueField) -> None:
    """The half throw that holds the critical point, seen towards either fillet."""
    from matplotlib import colormaps
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LogNorm

    from cranktopo.report.shading import draw, view_axes, visible

    least, point = field.critical.safety, np.array(field.critical.point_mm)
    far = bool(point[2] > _middle_mm(field))
    norm, colours = LogNorm(least, _TOP * least, clip=True), colormaps["turbo_r"]
    body = _half(field, far, lambda safety: colours(norm(safety))[:, :3])
    for panel, (name, (x, y, z)) in zip(axes, _VIEWS, strict=True):
        side = -1.0 if point[0] < 0 else 1.0
        view = view_axes((side * x, y, -z if far else z), (0.0, 1.0, 0.0))
        draw(panel, _inside(body), view)
        draw(panel, body, view)
        if visible(body, view, point):
            panel.plot(*(view @ point)[:2, None], "o", ms=11, mfc="none", mec="black", mew=1.6)
        panel.set_title(f"towards the {name}")
        panel.set_axis_off()
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=list(axes), location="bottom", shrink=0.7)
    bar.set_label("safety; circle: where it is least; grey: inside of the body, which is cut at its ends")
    ticks = least * np.array([1.0, 1.5, 2.0, 3.0, 4.0])
    bar.set_ticks(ticks, labels=[f"{t:.2f}" for t in ticks])
    bar.minorticks_off()


def _middle_mm(field: FatigueField) -> float:
    """Place of the cylinder's plane along the crank."""
    return halves(field.model.scene)[0].pitch_mm / 2


def _half(field: FatigueField, far: bool, paint: Callable[[Array], Array]) -> ShadedMesh:
    """Return one half of the throw, four flat triangles to a face, coloured by its safety."""
    from cranktopo.report.shading import shaded_faces

    points, faces = throw_surface(field)
    kept = faces[(points[faces[:, :3], 2].mean(axis=1) > _middle_mm(field)) == far]
    normals = np.concatenate(
        [
            field.model.surface.normals * [-1 if i.flip_x else 1, 1, -1 if i.flip_z else 1]
            for i in field.model.images
        ]
    )
    safety = field.safety.ravel()
    return shaded_faces(points, normals, kept, lambda triangles: paint(safety[triangles].mean(axis=1)))


def _draw_history(axes: Any, diagram: PlaneDiagram, safety: float) -> None:
    """Shear over normal stress: the critical point in every state, and the line of safety 1."""
    normal, shear = diagram.normal_MPa, diagram.shear_MPa
    axes.plot(normal, shear, ".", ms=3, color="#d1632a", label=f"critical point in every state, {safety:.3f}")
    ends = np.array([min(0.0, float(normal.min())), max(diagram.limit_MPa, 1.1 * float(normal.max()))])
    axes.plot(ends, diagram.limit_MPa - diagram.slope * ends, color="#1f6fb4", label="safety 1")
    axes.set(
        xlabel=f"{diagram.abscissa}, MPa",
        ylabel="shear stress about the middle of its path, MPa",
        ylim=(0, 1.4 * max(diagram.limit_MPa, float(shear.max()))),
        title="shear and normal stress through the load states",
    )
    axes.grid(color="0.9")
    axes.legend(loc="upper right")


def _inside(body: ShadedMesh) -> ShadedMesh:
    """Return the body's faces from behind, grey: what an open end lets see."""
    return replace(
        body, faces=body.faces[:, ::-1], normals=-body.normals, colours=np.full_like(body.colours, 0.75)
    )


def _draw_haigh(axes: Any, field: FatigueField) -> None:
    """Amplitude over mean stress: the critical point, every node that counts, and the line of safety 1."""
    c, scene, found = field.critical, field.model.scene, criterion(field.method)
    on = field.model.judged
    axes.plot(field.mean_MPa[:, on].ravel(), field.amplitude_MPa[:, on].ravel(), ",", color="0.6")
    means = np.linspace(
        min(0.0, float(field.mean_MPa[:, on].min())), scene.material.ultimate_MPa or np.nan, 200
    )
    limit = found.haigh_limit_MPa(scene, c.strength_MPa, c.gradient_per_mm, means)
    axes.plot(means, limit, color="#1f6fb4", label="safety 1 at the critical point")
    scale = c.safety
    axes.plot([0, c.mean_MPa * scale], [0, c.amplitude_MPa * scale], "--", color="0.4", lw=1)
    axes.plot([c.mean_MPa], [c.amplitude_MPa], "o", color="#d1632a", label=f"critical point, {c.safety:.3f}")
    axes.set(
        xlabel="mean stress (MPa)",
        ylabel="stress amplitude (MPa)",
        ylim=(0, 1.15 * c.strength_MPa * max(1.0, c.amplitude_MPa / c.strength_MPa)),
        title=f"Haigh diagram, line of {found.line_of or found.title or found.name}",
    )
    axes.grid(color="0.9")
    axes.legend(loc="upper center", bbox_to_anchor=(0.5, -0.13), ncols=2, frameon=False)
