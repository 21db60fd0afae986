"""The parametric web fitted to an extracted body, and the scene that has it.

Cells, spreads and least sizes of the fit are millimetres that suit journals of 42 to 84 mm. A fit is a matter
of shape alone, so any other throw is brought to that size first, and the web is scaled back.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.companion import ALONE, Companion
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.near_ties import best_first
from cranktopo.base.notes import Pace, note
from cranktopo.base.reproducible import SEED
from cranktopo.design.free_dimensions import (
    COUNTERWEIGHT_RANGES,
    moved_ranges_text,
    with_counterweight_ranges,
)
from cranktopo.design.halves import usual_scale
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import bounds, web_of
from cranktopo.tasks.refit.search import FitProblem, VoxelFill, voxel_fill
from cranktopo.tasks.refit.select import (
    Candidate,
    FitTask,
    FitTrial,
    ResidualRegion,
    fits_from,
    model_fill,
    residual_regions,
    searches,
    select,
)
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

if TYPE_CHECKING:
    from manifold3d import Manifold

    from cranktopo.numerics.surfaces.mesh import SurfaceMesh


_DIGITS = 6


def usual_limits(scene: Scene, **chosen: float | int | None) -> ManufacturingLimits:
    """Return manufacturing limits of a throw: those given, and the usual ones in proportion to it."""
    usual = _scaled_limits(ManufacturingLimits(), 1 / usual_scale(scene))
    kept: dict[str, Any] = {key: value for key, value in chosen.items() if value is not None}
    return replace(usual, **kept)


def _scaled_limits(limits: ManufacturingLimits, factor: float) -> ManufacturingLimits:
    """Return the limits with their lengths multiplied."""
    return replace(limits, **scaled_lengths(vars(limits), factor))


def scaled_throw(scene: Scene, factor: float) -> Scene:
    """Return the throw, web and material of a scene, all lengths multiplied; the rest is left out."""
    data = scene.model_dump(mode="json", include={"name", "throw", "web", "material"}, exclude_none=True)
    return scene_from_dict(scaled_lengths(data, factor), f"{scene.name}, scaled")


def scaled_region(region: ResidualRegion, factor: float) -> ResidualRegion:
    """Return a region with its place and volume multiplied accordingly."""
    lengths = scaled_lengths(vars(region), factor)
    return ResidualRegion(**{**lengths, "volume_mm3": region.volume_mm3 * factor**3})


def scaled_lengths(data: Any, factor: float, key: str = "") -> Any:
    """Return plain data with every value under a key that ends with `_mm` multiplied, kept to six digits."""
    if isinstance(data, dict):
        return {name: scaled_lengths(value, factor, name) for name, value in data.items()}
    if isinstance(data, (list, tuple)):
        return type(data)(scaled_lengths(value, factor, key) for value in data)
    if factor != 1 and isinstance(data, float) and key.endswith("_mm"):
        return float(f"{data * factor:.{_DIGITS}g}")
    return data


_SEARCH_CELL_MM, _SCALED_DOWN_CELL_MM = 2.0, 4.0
"""Cells of the search for features and stations; of throws of usual size, and of those scaled down, which
have the largest usual journals and so get as many cells across as the smallest."""
_SPREAD = 1.0
"""Standard deviation of the further initial guesses about the first, mm or degrees."""
_SUFFIX = "-remodel"
FIT_LIBRARIES = ("nlopt", "cranktopo.tasks.refit.select")
"""Modules that a second process takes for a fit."""
_ANGLE = "draft"
"""Ending of the parameters that are degrees."""


@dataclass(frozen=True)
class FittedWeb:
    """A web of the family, and how it was reached.

    Attributes:
        values: of the parameters before rounding, mm or degrees.
        overlaps: overlap of the fills from each initial guess of the final fit, the best first.
    """

    scene: Scene
    names: tuple[str, ...]
    values: tuple[float, ...]
    trials: tuple[FitTrial, ...]
    overlaps: tuple[float, ...]
    residual_regions: tuple[ResidualRegion, ...]


def fit_web(
    surface: SurfaceMesh,
    scene: DesignLike,
    limits: ManufacturingLimits | None = None,
    beside: Companion = ALONE,
) -> FittedWeb:
    """Fit a web that a die or a mill can make to an extracted body.

    Args:
        surface: closed surface of the half throw (`WebSurface.half_throw`), mm.
        beside: a second process, best with `FIT_LIBRARIES`, for a part of the searches; the web is the same.

    Raises:
        CranktopoError: nothing of the surface lies between the web faces, or no web keeps the limits.
    """
    from cranktopo.numerics.surfaces.mesh import SurfaceMesh, solid_of

    scene = as_scene(scene, whole=False)
    scale, limits = usual_scale(scene), limits or usual_limits(scene)
    throw = scene if scale == 1 else scaled_throw(scene, scale)
    usual = SurfaceMesh(surface.vertices_mm * scale, surface.faces)
    body, within = solid_of(usual, "surface to be re-modelled"), _scaled_limits(limits, scale)
    coarse_mm = _SCALED_DOWN_CELL_MM if scale < 1 else _SEARCH_CELL_MM
    coarse = Pace("features and stations, search", searches(within))
    chosen, trials = select(fit_problem(body, throw, within, coarse_mm, coarse), beside)
    final = Pace("final fit on finer cells, search", within.starts)
    fine = fit_problem(body, throw, within, within.cell_mm, final)
    fits = _final_fits(fine, chosen, beside)
    best = fits[0]
    rest = residual_regions(fine, model_fill(fine, best))
    factors = [1.0 if name.endswith(_ANGLE) else 1 / scale for name in best.layout.names]
    found = scene_with_web(scene, scaled_lengths(web_of(best.layout, best.values, throw), 1 / scale))
    note_moved_ranges(found, scene)
    return FittedWeb(
        found,
        best.layout.names,
        tuple(float(value * factor) for value, factor in zip(best.values, factors, strict=True)),
        trials,
        tuple(found.overlap for found in fits),
        tuple(scaled_region(region, 1 / scale) for region in rest),
    )


def scene_with_web(scene: Scene, web: dict[str, Any]) -> Scene:
    """Return the scene with another web, checked as if it were read from a file.

    Ranges of the counterweight's dimensions begin where the web leaves it something to add.

    Raises:
        CranktopoError: the web does not fit the throw.
    """
    left_out: dict[str, Any] = {"web": True, "published": True, "shape": {"free": COUNTERWEIGHT_RANGES}}
    data = scene.model_dump(mode="json", exclude=left_out, exclude_none=True)
    name = f"{scene.name.removesuffix(_SUFFIX)}{_SUFFIX}"
    found = scene_from_dict({**data, "name": name, "web": web}, f"re-model of {scene.name}")
    return with_counterweight_ranges(found, scene)


def note_moved_ranges(scene: Scene, before: Scene) -> None:
    """Pass on which free ranges another web has moved."""
    text = moved_ranges_text(scene, before)
    if text:
        note(f"note: {text}.")


def fit_problem(
    body: Manifold, scene: Scene, limits: ManufacturingLimits, cell_mm: float, pace: Pace | None = None
) -> FitProblem:
    """Return what a fit to a body has to match, on cells of at most the given edge."""
    cells = voxel_fill(body, scene, cell_mm)
    free = _free_of_bores(scene, cells)[:, :, None] * _free_of_drillings(scene, cells)
    return FitProblem(cells, free, scene, limits, pace or Pace("fit", 1))


def _final_fits(problem: FitProblem, chosen: Candidate, beside: Companion) -> list[Candidate]:
    """Return the fits from the chosen web and from scattered copies of it, best first.

    All usually end at the same web: then the one from the chosen web itself comes first.
    """
    random = np.random.default_rng(SEED)
    low, high = bounds(chosen.layout, problem.scene, problem.limits)
    guesses = [chosen.values]
    for _ in range(problem.limits.starts - 1):
        scattered = chosen.values + random.normal(0.0, _SPREAD, len(chosen.values))
        guesses.append(np.clip(scattered, low, high))
    found = fits_from(problem, [FitTask(chosen.layout, guess, "final") for guess in guesses], beside)
    fits = [candidate for candidate in found if candidate is not None]
    if not fits:
        raise CranktopoError(
            "remodel: no web keeps the manufacturing limits on the finer cells.",
            hint="Lower the least wall or the least radius.",
            code=ExitCode.CRITERION_NOT_MET,
        )
    return best_first(fits, lambda candidate: candidate.overlap)


def _free_of_bores(scene: Scene, cells: VoxelFill) -> Array:
    """Share of each cell that no bore takes, (nx, ny), from 5 x 5 points."""
    offsets = (np.arange(5) - 2) / 5
    x = (cells.x_mm[:, None] + cells.cell_mm[0] * offsets).ravel()[:, None]
    y = (cells.y_mm[:, None] + cells.cell_mm[1] * offsets).ravel()[None, :]
    free = np.ones((x.size, y.size))
    for journal, centre in scene.throw.journals:
        free *= x**2 + (y - centre) ** 2 > journal.bore_radius_mm**2
    return np.asarray(free.reshape(len(cells.x_mm), 5, len(cells.y_mm), 5).mean(axis=(1, 3)))


def _free_of_drillings(scene: Scene, cells: VoxelFill) -> Array:
    """Share of each cell that no oil drilling takes, mean of both sides of x = 0, (nx, ny, nz)."""
    free, edge = np.ones((2, *cells.filled.shape)), float(cells.cell_mm.mean())
    y, z = cells.y_mm[:, None], cells.z_mm
    for bore in drill_bores(scene):
        for side, sign in zip(free, (1.0, -1.0), strict=True):
            away = bore.off_axis_mm(sign * cells.x_mm[:, None, None], y, z)
            side *= np.clip((away - bore.radius_mm) / edge + 0.5, 0.0, 1.0)
    return np.asarray(free.mean(axis=0))
