"""From the results of the stages to the metrics of a run."""

from __future__ import annotations

from statistics import fmean, median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.machine import peak_memory_MiB
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.cells.domain import Domain
from cranktopo.design.draft import kept_without_draft
from cranktopo.design.goal.balance_moved import MovedBalance, balance_moved
from cranktopo.design.schema import Scene
from cranktopo.engine.load_type import load_type
from cranktopo.engine.plan.planning import left_off
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.density.problem import Assessment, DensityProblem, model_error_percent
from cranktopo.tasks.density.stage import Prepared
from cranktopo.tasks.density.state import State
from cranktopo.tasks.extraction.checked_surface import CheckedSurface
from cranktopo.tasks.extraction.result import (
    NoSurface,
    RunSurface,
    ThrowMasses,
    UndercutMeasures,
    WallMeasures,
    quality,
)
from cranktopo.tasks.extraction.walls import measures_walls
from cranktopo.tasks.optimise.result import (
    CaseMetrics,
    CellSize,
    Cycles,
    GridSummary,
    OriginalWeb,
    RunMetrics,
    RunSeconds,
    SolverMetrics,
    VolumeFraction,
)
from cranktopo.tasks.refit.masses import throw_of_body, throw_of_scene

SOLID = 0.5
_SAME_MASS = 0.01
"""Difference of mass from which webs are no longer compared at the same mass."""

_PER_MASS_UNIT = {"torsion": "torsion_Nm_per_rad_kg", "bending": "bending_N_per_mm_kg"}


def run_metrics(
    run_name: str,
    prepared: Prepared,
    problem: DensityProblem,
    state: State,
    density: Array,
    result: Assessment,
    original: Assessment,
    surface: RunSurface | NoSurface,
    half_throw: SurfaceMesh | None,
    **others: Any,
) -> RunMetrics:
    """Return the metrics of a finished optimisation, `others` among their fields.

    The density is the physical one of the web's layers; result and original are on the same grid. The half
    throw is the surface itself, where there is one.
    """
    scene, domain = prepared.scene, prepared.domain
    moved = None if half_throw is None else _balance_moved(scene, half_throw)
    remarks = (
        moved.told if moved else "",
        "" if scene.goal else _other_mass(scene, domain, state.last.volume_fraction, result, original),
    )
    return RunMetrics(
        run=run_name,
        design=scene.name,
        status=state.status,
        stop_reason=state.reason,
        iterations=len(state.history),
        coarse_start=state.coarse_start,
        volume_fraction=VolumeFraction(target=problem.target, reached=state.last.volume_fraction),
        mass_kg=ThrowMasses(throw=result.throw_kg, web=result.web_kg),
        greyness=state.last.greyness,
        connected=is_connected(domain, density),
        grid=_grid(domain),
        load_cases=_load_cases(scene, problem, result, domain),
        stiffness_per_mass=_per_mass(result),
        original_web=_original(scene, problem, result, original, domain),
        surface=surface,
        solver=_solver(problem, state, result),
        peak_memory_MiB=peak_memory_MiB(),
        effects=prepared.plan.effects,
        left_off=left_off(scene, prepared.plan) or None,
        notices=[*prepared.notices, *filter(None, remarks)],
        balance=moved,
        **others,
    )


def _balance_moved(scene: Scene, half_throw: SurfaceMesh) -> MovedBalance | None:
    """Return what `balance_moved` does of the surface, as `evaluate` tells it of the run.

    The original's is that of `balance`, with its fillets.
    """
    result, original = throw_of_body(scene, half_throw), throw_of_scene(scene)
    return balance_moved(scene, result.quantities, original.quantities)


def _other_mass(
    scene: Scene, domain: Domain, reached: float, result: Assessment, original: Assessment
) -> str:
    """Return the volume fraction with which a web weighs what the original's does; empty where this one does.

    The mass of a web is a straight line over the share of its design space that is filled.
    """
    if abs(result.throw_kg / original.throw_kg - 1) < _SAME_MASS:
        return ""
    layers = slice(*domain.web_layers)
    space_mm3 = (
        (domain.design_fraction * domain.volume_mm3)[:, :, layers].sum() / domain.symmetry_fraction / 2
    )
    space_kg = float(space_mm3) * density_kg_per_mm3(scene.material.density_kg_m3)
    own = reached + (original.web_kg - result.web_kg) / space_kg
    if not 0 < own <= 1:
        return ""
    return f"with --volume-fraction {own:.3f} the web weighs what the original's does"


def run_seconds(state: State, total: float, outputs: float, compile_s: float, **others: float) -> RunSeconds:
    """Return the wall times of a run.

    `total` ends with the last file but the page; `outputs` are assessment and bound, surface and files.
    """
    times = [row.seconds for row in state.history]
    return RunSeconds(
        total=total,
        compile=compile_s,
        per_iteration_median=median(times),
        iterations=sum(times),
        outputs=outputs,
        **others,
    )


def _grid(domain: Domain) -> GridSummary:
    dx, dy, dz = domain.grid.steps_mm
    return GridSummary(
        cells=list(domain.grid.cells),
        cell_mm=domain.grid.largest_edge_mm,
        cell_size_mm=CellSize(x=float(dx[0]), y=float(dy[0]), z_min=float(dz.min()), z_max=float(dz.max())),
        padding_cells=list(domain.grid.padding),
        design_cells=int(np.count_nonzero(domain.design_fraction)),
        symmetry=["x = 0"] * domain.mirrored_x + ["mid-pin plane"] * domain.mirrored_z,
        extent=domain.extent,
    )


def _load_cases(
    scene: Scene, problem: DensityProblem, result: Assessment, domain: Domain
) -> dict[str, CaseMetrics]:
    errors = model_error_percent(scene, domain.grid.largest_edge_mm)
    supports = {"torsion": scene.supports.torsion}
    return {
        case.name: CaseMetrics(
            stiffness_Nm_per_rad=case.stiffness if load_type(case.kind).turns else None,
            stiffness_N_per_mm=None if load_type(case.kind).turns else case.stiffness,
            error_estimate_percent=errors.get(case.kind),
            compliance_N_mm=case.compliance_N_mm,
            support=supports.get(case.kind, scene.supports.bending),
            load=load,
        )
        for case, load in zip(result.cases, problem.model.cases, strict=True)
    }


def _per_mass(result: Assessment) -> dict[str, float]:
    ratios = result.stiffness_per_mass()
    return {_PER_MASS_UNIT.get(name, f"{name}_N_per_mm_kg"): value for name, value in ratios.items()}


def _original(
    scene: Scene, problem: DensityProblem, result: Assessment, original: Assessment, domain: Domain
) -> OriginalWeb:
    before = original.stiffness_per_mass()
    return OriginalWeb(
        mass_kg=ThrowMasses(throw=original.throw_kg, web=original.web_kg),
        load_cases=_load_cases(scene, problem, original, domain),
        stiffness_per_mass=_per_mass(original),
        gain_of_stiffness_per_mass_percent={
            name: 100 * (value / before[name] - 1) for name, value in result.stiffness_per_mass().items()
        },
    )


def run_surface(surface: CheckedSurface | str, scene: Scene) -> RunSurface | NoSurface:
    """Return what the extracted surface measures, or why the density has none."""
    if isinstance(surface, str):
        return NoSurface(refusal=surface)
    minimum_lengths = {
        "asked_member_mm": scene.optimise.min_member_mm,
        "asked_gap_mm": scene.optimise.min_gap_mm,
    }
    walls = surface.walls(scene) if measures_walls(scene) else None
    return RunSurface(
        **vars(quality(surface.surface, surface.report)),
        undercuts=UndercutMeasures.of(surface.undercuts(scene), kept_without_draft(scene)),
        walls=WallMeasures(**vars(walls), **minimum_lengths) if walls else None,
    )


def _solver(problem: DensityProblem, state: State, result: Assessment) -> SolverMetrics:
    counts = [row.cg_iterations for row in state.history]
    return SolverMetrics(
        precision="float64 conjugate gradients, float32 multigrid cycle",
        tolerance=problem.solving.tolerance,
        cg_iterations=Cycles(mean=fmean(counts), max=max(counts)),
        levels=problem.model.levels,
        final_relative_residual=max(case.relative_residual for case in result.cases),
    )


def is_connected(domain: Domain, density: NDArray[np.float64]) -> bool:
    """Tell whether one face-connected body of solid cells holds both journals."""
    from scipy.ndimage import label

    first, last = domain.web_layers
    solid = domain.passive_fraction >= SOLID
    solid[:, :, first:last] |= (density >= SOLID) & (domain.design_fraction > 0)[:, :, first:last]
    labels, _ = label(solid)
    start, end = labels[:, :, 0][solid[:, :, 0]], labels[:, :, -1][solid[:, :, -1]]
    return bool(np.intersect1d(start, end).size > 0)
