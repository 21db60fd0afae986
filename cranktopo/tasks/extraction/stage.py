"""Any design of a run as a checked surface: the last one, or that of an earlier iteration."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.files import as_path_if_any
from cranktopo.base.formats import SurfaceFormat
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.cells.domain import Domain, build_domain
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.draft import kept_without_draft
from cranktopo.design.schema import Scene
from cranktopo.design.writing import design_from_run
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.numerics.precision import double_precision
from cranktopo.numerics.surfaces.files import write_surface
from cranktopo.runs.checkpoint import load_checkpoint, load_iteration
from cranktopo.runs.directories import RunStore, open_run
from cranktopo.runs.kind import require_kind, resume_command
from cranktopo.tasks.density.build import build_chain
from cranktopo.tasks.density.loop import WebDensities, design_of
from cranktopo.tasks.density.material import MaterialInterpolation
from cranktopo.tasks.density.state import damaged, from_checkpoint
from cranktopo.tasks.extraction.checked_surface import CheckedSurface, SurfaceReport, checked_surface
from cranktopo.tasks.extraction.cutter import build_cutter, fine_field, iso_surface_distances_mm
from cranktopo.tasks.extraction.half_throw import WebSurface
from cranktopo.tasks.extraction.result import (
    ExtractedSurface,
    Extraction,
    IsoDistance,
    ThrowMasses,
    UndercutMeasures,
    quality,
)


def extract_surface(
    reference: str | Path,
    iteration: int | None = None,
    out: Path | str | None = None,
    form: SurfaceFormat = "stl",
) -> tuple[Extraction, Path]:
    """Extract the surface of a design of a run and write it; by default into `surface` of the run.

    Raises:
        CranktopoError: a loop, no density of that iteration, a surface that fails a check, or a file that
            cannot be written.
    """
    out = as_path_if_any(out)
    run = open_run(reference)
    require_kind(run, "optimise")
    with double_precision():
        scene, number, checked = _checked(run, iteration)
        path = out or run.path / "surface" / f"iteration-{number:04d}.{form}"
        found = Extraction(
            run=run.name,
            design=scene.name,
            iteration=number,
            mass_kg=_masses(scene, checked.report),
            surface=_measured(scene, checked),
            files={form: str(path)},
        )
    if out is None:
        path.parent.mkdir(exist_ok=True)
    write_surface(path, checked.surface.half_throw, form)
    return found, path


def _checked(run: RunStore, iteration: int | None) -> tuple[Scene, int, CheckedSurface]:
    scene = planned_scene(design_from_run(run))
    domain = build_domain(scene, scene.optimise.resolution_mm)
    number, design = _design(run, scene, domain, iteration)
    return scene, number, checked_surface(scene, domain, design)


def _masses(scene: Scene, report: SurfaceReport) -> ThrowMasses:
    kg_per_mm3 = density_kg_per_mm3(scene.material.density_kg_m3)
    bolted_kg = bolted_mass(scene).volume
    return ThrowMasses(
        throw=2 * (report.volume_mm3 * kg_per_mm3 + bolted_kg),
        web=report.web_volume_mm3 * kg_per_mm3 + bolted_kg,
    )


def _measured(scene: Scene, checked: CheckedSurface) -> ExtractedSurface:
    distances = iso_distance_mm(checked.surface, checked.grid, scene, checked.usable, checked.smooth)
    walls = checked.walls(scene)
    member, gap = walls.least_member_mm, walls.least_gap_mm
    return ExtractedSurface(
        **vars(quality(checked.surface, checked.report)),
        vertices=checked.report.vertices,
        distance_to_iso_surface_mm=IsoDistance(mean=float(distances.mean()), max=float(distances.max())),
        minimum_member_mm=member,
        minimum_member_cells=None if member is None else member / checked.cell_mm,
        minimum_gap_mm=gap,
        minimum_gap_cells=None if gap is None else gap / checked.cell_mm,
        undercuts=UndercutMeasures.of(checked.undercuts(scene), kept_without_draft(scene)),
    )


def _design(run: RunStore, scene: Scene, domain: Domain, iteration: int | None) -> tuple[int, WebDensities]:
    if iteration is None:
        number, x, beta = _last(run)
    else:
        number, (x, beta) = iteration, load_iteration(run.path, iteration)
    return number, stored_design(run, build_chain(scene, domain), x, beta)


def stored_design(run: RunStore, density_chain: MaterialInterpolation, x: Array, beta: float) -> WebDensities:
    """Return a design that a run keeps; raises CranktopoError where it is on other cells."""
    cells = density_chain.design_fraction.shape
    if x.shape != cells:
        raise CranktopoError(
            f"run '{run.path}': its density has {x.shape} cells, its design {cells}.",
            hint="The run was made by another version: optimise again.",
        )
    return design_of(density_chain, x, beta)


def _last(run: RunStore) -> tuple[int, np.ndarray, float]:
    if not run.checkpoint.is_file():
        raise CranktopoError(
            f"run '{run.path}': holds no density (checkpoint missing).",
            hint=f"Continue it with: {resume_command(run)}",
        )
    saved = load_checkpoint(run.checkpoint)
    state = from_checkpoint(saved.arrays, saved.state)
    if not state.history:
        raise damaged("it holds no design")
    return state.last.iteration, state.evaluated, state.last.beta


def iso_distance_mm(
    surface: WebSurface,
    grid: DensityGrid,
    scene: Scene,
    solid_fraction: Array | None = None,
    smooth: Array | None = None,
) -> Array:
    """Return distances from the unsmoothed iso-surface to the final one, as `iso_surface_distances_mm`."""
    cutter = build_cutter(grid, scene, solid_fraction, smooth)
    field = fine_field(cutter, grid, scene, solid_fraction, smooth)
    return iso_surface_distances_mm(cutter, field, surface.iso_value, surface.web)
