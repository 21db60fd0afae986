"""Any design of a run as a checked surface: the last one, or that of an earlier iteration."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.base.formats import SurfaceFormat
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.cells.domain import Domain, build_domain
from cranktopo.bodies.undercuts import Undercuts
from cranktopo.bodies.web_moments import bolted_mass
from cranktopo.design.of_run import design_from_run
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.numerics.precision import double_precision
from cranktopo.numerics.surfaces.files import write_surface
from cranktopo.runs.checkpoint import load_checkpoint
from cranktopo.runs.directories import RunStore, open_run
from cranktopo.runs.iterations import load_iteration
from cranktopo.runs.kind import require_kind, resume_command
from cranktopo.tasks.density.chain import build_chain
from cranktopo.tasks.density.loop import WebDensities, design_of
from cranktopo.tasks.density.state import from_checkpoint
from cranktopo.tasks.extraction.checked_surface import checked_surface
from cranktopo.tasks.extraction.fidelity import iso_distance_mm
from cranktopo.tasks.extraction.half_throw import WebSurface
from cranktopo.tasks.extraction.surface_checks import SurfaceReport, surface_json

LEAST_MEMBER_CELLS = 2.0
"""Members thinner than this have no bending stiffness of their own on the grid."""


@dataclass(frozen=True)
class Extraction:
    """Surface of one design of a run, and what was measured on it.

    Attributes:
        scene: the scene as it was simulated.
        mean_distance_mm: mean distance of the smoothed density's iso-surface to it.
        minimum_member_mm, minimum_gap_mm: of the walls that were shaped; None where no two face each other.
        undercuts: what a die that parts in x = 0 could not release.
        cell_mm: smallest edge of the run's cells.
    """

    run: str
    scene: Scene
    iteration: int
    surface: WebSurface
    report: SurfaceReport
    mean_distance_mm: float
    max_distance_mm: float
    minimum_member_mm: float | None
    minimum_gap_mm: float | None
    undercuts: Undercuts
    cell_mm: float

    @property
    def throw_kg(self) -> float:
        """Mass of the full throw."""
        return 2 * (self.report.volume_mm3 * self._kg_per_mm3 + bolted_mass(self.scene).volume)

    @property
    def web_kg(self) -> float:
        """Mass of one web."""
        return self.report.web_volume_mm3 * self._kg_per_mm3 + bolted_mass(self.scene).volume

    @property
    def _kg_per_mm3(self) -> float:
        return density_kg_per_mm3(self.scene.material.density_kg_m3)

    def in_cells(self, length_mm: float | None) -> float | None:
        """A length over the smallest edge of the cells; None where there is none."""
        return None if length_mm is None else length_mm / self.cell_mm

    def as_json(self) -> dict[str, Any]:
        """The measured values; units in the names."""
        return {
            "run": self.run,
            "design": self.scene.name,
            "iteration": self.iteration,
            "mass_kg": {"throw": self.throw_kg, "web": self.web_kg},
            "surface": {
                **surface_json(self.surface, self.report),
                "vertices": self.report.vertices,
                "distance_to_iso_surface_mm": {"mean": self.mean_distance_mm, "max": self.max_distance_mm},
                "minimum_member_mm": self.minimum_member_mm,
                "minimum_member_cells": self.in_cells(self.minimum_member_mm),
                "minimum_gap_mm": self.minimum_gap_mm,
                "minimum_gap_cells": self.in_cells(self.minimum_gap_mm),
                "undercuts": self.undercuts.as_json(),
            },
        }


def extract_surface(
    reference: str,
    iteration: int | None = None,
    out: Path | None = None,
    form: SurfaceFormat = "stl",
) -> tuple[Extraction, Path]:
    """Extract the surface of a design of a run and write it; by default into `surface` of the run.

    Raises:
        CranktopoError: as `extract_run`, or the file cannot be written.
    """
    run = open_run(reference)
    with double_precision():
        found = extract_run(run, iteration)
    path = out or run.path / "surface" / f"iteration-{found.iteration:04d}.{form}"
    if out is None:
        path.parent.mkdir(exist_ok=True)
    write_surface(path, found.surface.half_throw, form)
    return found, path


def extract_run(run: RunStore, iteration: int | None = None) -> Extraction:
    """Surface of a design of an optimise run, by default the last one; call inside `double_precision()`.

    Raises:
        CranktopoError: a loop, no density of that iteration, or a surface that fails a check.
    """
    require_kind(run, "optimise")
    scene = planned_scene(design_from_run(run))
    domain = build_domain(scene, scene.optimise.resolution_mm)
    number, design = _design(run, scene, domain, iteration)
    checked = checked_surface(scene, domain, design)
    surface = checked.surface
    distances = iso_distance_mm(surface, checked.grid, scene, checked.usable, checked.smooth)
    walls = checked.walls(scene)
    return Extraction(
        run=run.name,
        scene=scene,
        iteration=number,
        surface=surface,
        report=checked.report,
        mean_distance_mm=float(distances.mean()),
        max_distance_mm=float(distances.max()),
        minimum_member_mm=walls["least_member_mm"],
        minimum_gap_mm=walls["least_gap_mm"],
        undercuts=checked.undercuts(scene),
        cell_mm=checked.cell_mm,
    )


def _design(run: RunStore, scene: Scene, domain: Domain, iteration: int | None) -> tuple[int, WebDensities]:
    if iteration is None:
        number, x, beta = _last(run)
    else:
        number, (x, beta) = iteration, load_iteration(run.path, iteration)
    chain = build_chain(scene, domain)
    if x.shape != chain.design.shape:
        raise CranktopoError(
            f"run '{run.path}': its density has {x.shape} cells, its design {chain.design.shape}.",
            hint="The run was made by another version: optimise again.",
        )
    return number, design_of(chain, x, beta)


def _last(run: RunStore) -> tuple[int, np.ndarray, float]:
    if not run.checkpoint.is_file():
        raise CranktopoError(
            f"run '{run.path}': holds no density (checkpoint missing).",
            hint=f"Continue it with: {resume_command(run)}",
        )
    saved = load_checkpoint(run.checkpoint)
    state = from_checkpoint(saved.arrays, saved.state)
    return state.last.iteration, state.evaluated, state.last.beta
