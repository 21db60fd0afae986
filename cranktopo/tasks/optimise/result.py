"""metrics.json of an optimise run, from the results of the stages."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from statistics import fmean, median
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.machine import peak_memory_MiB
from cranktopo.bodies.cells.domain import Domain
from cranktopo.design.goal.outcome import goal_json
from cranktopo.design.goal.wanted import wanted
from cranktopo.design.schema import Scene
from cranktopo.tasks.density.assessment import Assessment
from cranktopo.tasks.density.connectivity import is_connected
from cranktopo.tasks.density.error_bound import model_error_percent
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.stage import Prepared
from cranktopo.tasks.density.state import State
from cranktopo.tasks.extraction.checked_surface import CheckedSurface
from cranktopo.tasks.extraction.surface_checks import surface_json
from cranktopo.tasks.extraction.walls import measures_walls

SCHEMA_VERSION = 1
_PER_MASS_UNIT = {"torsion": "torsion_Nm_per_rad_kg", "bending": "bending_N_per_mm_kg"}


@dataclass(frozen=True)
class Timing:
    """Wall times of a run.

    Attributes:
        total_s: from the start to the last file; the report, written then, is added afterwards.
        outputs_s: assessment and bound, and surface and files beside them.
    """

    total_s: float
    outputs_s: float
    compile_s: float


def optimise_metrics(
    run_name: str,
    prepared: Prepared,
    problem: DensityProblem,
    state: State,
    density: NDArray[np.float64],
    result: Assessment,
    original: Assessment,
    surface: Mapping[str, Any],
    timing: Timing,
    assumed: Sequence[Mapping[str, Any]],
) -> dict[str, Any]:
    """The metrics of a finished optimisation.

    Args:
        prepared: the scene with its plan and cells.
        problem, state: the optimisation and its final state.
        density: physical density of the web's layers.
        result, original: the design and the scene's own web on the same grid.
        surface: from `surface_metrics`.
        assumed: entries of the manifest: what the design does not say.
    """
    scene, domain = prepared.scene, prepared.domain
    goal = wanted(scene)
    return {
        "schema_version": SCHEMA_VERSION,
        "run": run_name,
        "design": scene.name,
        "status": state.status,
        "stop_reason": state.reason,
        "iterations": len(state.history),
        **({} if state.coarse_start is None else {"coarse_start": asdict(state.coarse_start)}),
        "volume_fraction": {"target": problem.target, "reached": state.last.volume_fraction},
        "mass_kg": {"throw": result.throw_kg, "web": result.web_kg},
        "greyness": state.last.greyness,
        "connected": is_connected(domain, density),
        "grid": _grid(domain),
        "load_cases": _load_cases(scene, problem, result, domain),
        "stiffness_per_mass": _per_mass(result),
        "original_web": _original(scene, problem, result, original, domain),
        **({} if goal is None else {"goal": goal_json(goal, result.quantities, original.quantities)}),
        "surface": dict(surface),
        "solver": _solver(problem, state, result),
        "seconds": _seconds(state, timing),
        "peak_memory_MiB": peak_memory_MiB(),
        "files": {"metrics": "metrics.json", "manifest": "manifest.json", "log": "run.log"},
        "effects": prepared.plan.as_json(),
        "notices": list(prepared.notices),
        "assumed": [dict(entry) for entry in assumed],
    }


def _grid(domain: Domain) -> dict[str, Any]:
    dx, dy, dz = domain.grid.steps_mm
    mirrors = (["x = 0"] if domain.mirrored_x else []) + (["mid-pin plane"] if domain.mirrored_z else [])
    return {
        "cells": list(domain.grid.cells),
        "cell_mm": domain.grid.largest_edge_mm,
        "cell_size_mm": {
            "x": float(dx[0]),
            "y": float(dy[0]),
            "z_min": float(dz.min()),
            "z_max": float(dz.max()),
        },
        "padding_cells": list(domain.grid.padding),
        "design_cells": int(np.count_nonzero(domain.design_fraction)),
        "symmetry": mirrors,
        "extent": domain.extent,
    }


def _stiffness_key(kind: str) -> str:
    return "stiffness_Nm_per_rad" if kind == "torsion" else "stiffness_N_per_mm"


def _load_cases(scene: Scene, problem: DensityProblem, result: Assessment, domain: Domain) -> dict[str, Any]:
    supports = scene.supports
    errors = model_error_percent(scene, domain.grid.largest_edge_mm)
    return {
        case.name: {
            **({} if case.stiffness is None else {_stiffness_key(case.kind): case.stiffness}),
            **({"error_estimate_percent": errors[case.kind]} if case.kind in errors else {}),
            "compliance_N_mm": case.compliance_N_mm,
            "support": supports.torsion if case.kind == "torsion" else supports.bending,
            "load": load.as_json(),
        }
        for case, load in zip(result.cases, problem.model.cases, strict=True)
    }


def _per_mass(result: Assessment) -> dict[str, float]:
    ratios = result.stiffness_per_mass()
    return {_PER_MASS_UNIT.get(name, f"{name}_N_per_mm_kg"): value for name, value in ratios.items()}


def _original(
    scene: Scene, problem: DensityProblem, result: Assessment, original: Assessment, domain: Domain
) -> dict[str, Any]:
    """The scene's own web in the same model, and what the optimised one gains on it."""
    gain = {
        name: 100 * (value / original.stiffness_per_mass()[name] - 1)
        for name, value in result.stiffness_per_mass().items()
    }
    return {
        "mass_kg": {"throw": original.throw_kg, "web": original.web_kg},
        "load_cases": _load_cases(scene, problem, original, domain),
        "stiffness_per_mass": _per_mass(original),
        "gain_of_stiffness_per_mass_percent": gain,
    }


def surface_metrics(surface: CheckedSurface | str, scene: Scene) -> dict[str, Any]:
    """What the extracted surface measures, or why the density has none."""
    if isinstance(surface, str):
        return {"refusal": surface}
    known = surface_json(surface.surface, surface.report)
    found = {**known, "undercuts": surface.undercuts(scene).as_json()}
    return {**found, "walls": {**surface.walls(scene), **_asked(scene)}} if measures_walls(scene) else found


def _asked(scene: Scene) -> dict[str, float]:
    """Least member and gap that the scene asks for."""
    lengths = {"member": scene.optimise.min_member_mm, "gap": scene.optimise.min_gap_mm}
    return {f"asked_{name}_mm": length for name, length in lengths.items() if length is not None}


def _solver(problem: DensityProblem, state: State, result: Assessment) -> dict[str, Any]:
    counts = [row.cg_iterations for row in state.history]
    return {
        "precision": "float64 conjugate gradients, float32 multigrid cycle",
        "tolerance": problem.solving.tolerance,
        "cg_iterations": {"mean": fmean(counts), "max": max(counts)},
        "levels": problem.model.levels,
        "final_relative_residual": max(case.relative_residual for case in result.cases),
    }


def _seconds(state: State, timing: Timing) -> dict[str, float]:
    times = [row.seconds for row in state.history]
    return {
        "total": timing.total_s,
        "compile": timing.compile_s,
        "per_iteration_median": median(times),
        "iterations": sum(times),
        "outputs": timing.outputs_s,
    }
