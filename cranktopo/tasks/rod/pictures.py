"""Picture and VTU file of the rod's stresses and safeties by finite elements."""

from __future__ import annotations

from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.files import write_bytes
from cranktopo.base.notes import note
from cranktopo.numerics.tetrahedra.stress import outward_faces, turned_faces
from cranktopo.report.plot import png
from cranktopo.report.vtu import write_surface_vtu
from cranktopo.tasks.rod.element_stress import ElementStress, WorstPoint
from cranktopo.tasks.rod.unit_loads import is_quarter

if TYPE_CHECKING:
    from matplotlib.colors import Colormap, Normalize

_Worse = Literal["larger", "smaller"]
_VIEW = (0.0, -0.35, 1.0)
_TOP = 4.0
"""Safety above which colours stay the same, over the least safety."""


def write_rod_files(folder: Path, name: str, stress: ElementStress) -> None:
    """Write the VTU file and the picture of a rod into a folder, named after its design.

    Raises:
        CranktopoError: a file cannot be written.
    """
    folder.mkdir(parents=True, exist_ok=True)
    for suffix, write in ((".vtu", write_rod_vtu), (".png", save_rod_picture)):
        path = folder / f"rod-{name}{suffix}"
        write(path, stress)
        note(str(path))


def write_rod_vtu(path: Path, stress: ElementStress) -> None:
    """Write safety, largest stress and signed extremes over the surface of the whole rod; mm, MPa."""
    points, _, faces = _whole(stress)
    fields: dict[str, tuple[Array, _Worse]] = {
        "largest_von_mises_MPa": (stress.largest_MPa, "larger"),
        "highest_signed_von_mises_MPa": (stress.high_MPa, "larger"),
        "lowest_signed_von_mises_MPa": (stress.low_MPa, "smaller"),
        "fatigue_safety": (stress.fatigue_safety, "smaller"),
        "judged": (np.tile(stress.judged.astype(float), (2, 1)), "larger"),
    }
    data = {name: _at_images(stress, field, worse) for name, (field, worse) in fields.items()}
    write_surface_vtu(path, points, faces, data)


def _images(stress: ElementStress) -> tuple[tuple[int, int], ...]:
    """Signs of x and z of the bodies that make the rod: four quarters or two halves."""
    return tuple(product((1, -1) if is_quarter(stress.fields.model) else (1,), (1, -1)))


def _whole(stress: ElementStress) -> tuple[Array, Array, NDArray[np.intp]]:
    """Nodes and normals (n, 3) and outward six-node faces of the whole rod, image by image."""
    surface, images = stress.surface, _images(stress)
    base, count = outward_faces(surface), surface.points_mm.shape[1]
    signs = [np.array([x, 1.0, z]) for x, z in images]
    faces = [(turned_faces(base) if x != z else base) + image * count for image, (x, z) in enumerate(images)]
    points = np.concatenate([surface.points_mm.T * sign for sign in signs])
    return points, np.concatenate([surface.normals * sign for sign in signs]), np.concatenate(faces)


def _at_images(stress: ElementStress, field: Array, worse: _Worse) -> Array:
    """Values (2, n) at the nodes of the whole rod; of a half the worse of both ways to mount it."""
    if not is_quarter(stress.fields.model):
        field = (field.max if worse == "larger" else field.min)(axis=0, keepdims=True)
    return np.concatenate([field[0 if x > 0 else 1] for x, _ in _images(stress)])


def save_rod_picture(path: Path, stress: ElementStress) -> None:
    """Write largest von Mises stress and fatigue safety over the rod as PNG, a ring at the worst point.

    Raises:
        CranktopoError: the file cannot be written.
    """
    from matplotlib import colormaps
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.colors import LogNorm, Normalize
    from matplotlib.figure import Figure

    worst = list(stress.worst())
    high = max((point for _, point, _ in worst), key=lambda point: point.largest_MPa)
    weak = min((point for _, _, point in worst), key=lambda point: point.fatigue_safety)
    figure = Figure(figsize=(11, 8.2), dpi=150, facecolor="white", layout="constrained")
    FigureCanvasAgg(figure)
    figure.suptitle(f"{stress.fields.scene.name}: rod by finite elements over the cycle", fontsize=13)
    above, below = figure.subplots(2, 1)
    least = weak.fatigue_safety
    _draw(
        (figure, above),
        stress,
        (
            _at_images(stress, stress.largest_MPa, "larger"),
            Normalize(0.0, high.largest_MPa, clip=True),
            colormaps["turbo"],
        ),
        (high, f"largest von Mises stress, MPa; ring: {high.largest_MPa:.0f} MPa"),
    )
    _draw(
        (figure, below),
        stress,
        (
            _at_images(stress, stress.fatigue_safety, "smaller"),
            LogNorm(least, _TOP * least, clip=True),
            colormaps["turbo_r"],
        ),
        (weak, f"fatigue safety; ring: {least:.2f}"),
    )
    write_bytes(path, png(figure))


def _draw(
    place: tuple[Any, Any],
    stress: ElementStress,
    coloured: tuple[Array, Normalize, Colormap],
    marked: tuple[WorstPoint, str],
) -> None:
    """Draw a field over the rod, which lies with its big end at the left."""
    from matplotlib.cm import ScalarMappable
    from matplotlib.ticker import NullLocator

    from cranktopo.report.shading import draw, shaded_faces, view_axes

    (figure, axes), (values, norm, colours), (point, label) = place, coloured, marked
    points, normals, faces = _whole(stress)
    body = shaded_faces(
        points, normals, faces, lambda corners: colours(norm(values[corners].mean(axis=1)))[:, :3]
    )
    view = view_axes(_VIEW, (-1.0, 0.0, 0.0))
    draw(axes, body, view)
    axes.plot(*(view @ np.array(point.point_mm))[:2, None], "o", ms=12, mfc="none", mec="black", mew=1.6)
    axes.set_axis_off()
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=axes, location="right", shrink=0.8)
    bar.set_label(label)
    if norm.vmin:
        ticks = norm.vmin * np.array([1.0, 1.5, 2.0, 3.0, 4.0])
        bar.set_ticks(ticks, labels=[f"{tick:.2f}" for tick in ticks])
        bar.ax.yaxis.set_minor_locator(NullLocator())
