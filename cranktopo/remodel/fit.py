"""The parametric web fitted to an extracted body, and the scene that has it."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cranktopo.remodel.checks import check_solid
from cranktopo.remodel.export import surface_of
from cranktopo.remodel.family import Layout, reaches_mm, web_of
from cranktopo.remodel.occupancy import Occupancy, occupancy
from cranktopo.remodel.rules import Rules
from cranktopo.remodel.search import Problem, search
from cranktopo.remodel.starts import outline_start
from cranktopo.scene import Scene, scene_from_dict

if TYPE_CHECKING:
    from manifold3d import Manifold

    from cranktopo.surface.mesh import SurfaceMesh

Array = NDArray[np.float64]


@dataclass(frozen=True)
class FittedWeb:
    """A web of the family and how well it fits.

    Attributes:
        scene: the design with the fitted web; everything but web and name is as it was.
        iou: overlap of fitted and extracted web, volume of the intersection over that of the union.
    """

    scene: Scene
    iou: float


def fit_web(surface: SurfaceMesh, scene: Scene, rules: Rules = Rules()) -> FittedWeb:  # noqa: B008
    """Fit a web that a die or a mill can make to an extracted body.

    Args:
        surface: closed surface of the half throw (`WebSurface.half_throw`), mm.
        scene: the design it was extracted for: journals, thickness and fillets stay.
        rules: bounds of the web.

    Raises:
        CranktopoError: nothing of the surface lies between the web faces, or no web keeps the rules.
    """
    from cranktopo.fem.precision import double_precision
    from cranktopo.surface.mesh import solid_of

    body = solid_of(surface.vertices_mm, surface.faces, "surface to be re-modelled")
    cells = occupancy(body, scene, rules.cell_mm)
    problem = Problem(cells, _free_of_bores(scene, cells), scene, rules)
    layout = Layout(rules.max_stations)
    with double_precision():
        values, _ = search(
            problem,
            layout,
            outline_start(layout, cells, reaches_mm(scene, rules)),
            (3 * rules.cell_mm, rules.cell_mm),
        )
    fitted = scene_with_web(scene, web_of(layout, values, scene))
    return FittedWeb(fitted, overlap(fitted, body))


def scene_with_web(scene: Scene, web: dict[str, object]) -> Scene:
    """The scene with another web, checked as if it were read from a file.

    Raises:
        CranktopoError: the web does not fit the throw.
    """
    data = scene.model_dump(mode="json", exclude={"web", "published"}, exclude_none=True)
    fitted = scene_from_dict({**data, "web": web}, f"re-model of {scene.name}")
    check_solid(fitted)
    return fitted


def _free_of_bores(scene: Scene, cells: Occupancy) -> Array:
    offsets = (np.arange(5) - 2) / 5
    x = (cells.x_mm[:, None] + cells.cell_mm[0] * offsets).ravel()[:, None]
    y = (cells.y_mm[:, None] + cells.cell_mm[1] * offsets).ravel()[None, :]
    throw = scene.throw
    free = np.ones((x.size, y.size))
    for journal, centre in ((throw.main_journal, 0.0), (throw.crankpin, throw.radius_mm)):
        free *= x**2 + (y - centre) ** 2 > journal.bore_radius_mm**2
    return np.asarray(free.reshape(len(cells.x_mm), 5, len(cells.y_mm), 5).mean(axis=(1, 3)))


def overlap(scene: Scene, body: Manifold) -> float:
    """Intersection over union of the scene's web and a body's part between the web faces."""
    from cranktopo.surface.mesh import solid_of

    mesh = surface_of(scene, "web")
    model = solid_of(mesh.vertices_mm, mesh.faces, "fitted web")
    start, end = scene.web_z_mm
    slab = body.trim_by_plane((0.0, 0.0, 1.0), start).trim_by_plane((0.0, 0.0, -1.0), -end)
    both = (model ^ slab).volume()
    return float(both / (model.volume() + slab.volume() - both))
