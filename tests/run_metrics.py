"""Metrics of a run that never was, for tests of what is said about runs."""

from __future__ import annotations

import copy
from typing import Any

from cranktopo.tasks.optimise.result import RunMetrics

SURFACE: dict[str, Any] = {
    "iso_value": 0.5,
    "web_volume_mm3": 1e5,
    "web_volume_error_percent": 0.01,
    "faces": 1000,
    "bodies": 1,
    "cavities": 0,
    "dropped_islands": 0,
    "dropped_volume_mm3": 0.0,
    "x_symmetric": True,
    "fallback": "",
}


def load_of(name: str) -> dict[str, Any]:
    """A load case of one kind, as `loads --json` prints it."""
    sizes = {"radial_N": 0.0, "tangential_N": 0.0, "torque_Nm": 0.0, "speed_rpm": 0.0}
    return {"name": name, "kind": name, **sizes, "from": ""}


_CASES: dict[str, Any] = {
    name: {unit: 1.0, "compliance_N_mm": 1.0, "support": "free", "load": load_of(name)}
    for name, unit in (("torsion", "stiffness_Nm_per_rad"), ("bending", "stiffness_N_per_mm"))
}
_WEB: dict[str, Any] = {
    "mass_kg": {"throw": 2.0, "web": 0.5},
    "load_cases": _CASES,
    "stiffness_per_mass": {},
}
_RUN: dict[str, Any] = {
    **_WEB,
    "run": "run",
    "design": "demo",
    "status": "converged",
    "stop_reason": "settled",
    "iterations": 13,
    "volume_fraction": {"target": 0.3, "reached": 0.3},
    "greyness": 0.01,
    "connected": True,
    "grid": {
        "cells": [8, 8, 8],
        "cell_mm": 1.5,
        "cell_size_mm": {"x": 1.5, "y": 1.5, "z_min": 1.5, "z_max": 1.5},
        "padding_cells": [0, 0, 0],
        "design_cells": 100,
        "symmetry": [],
        "extent": "half",
    },
    "original_web": {**_WEB, "gain_of_stiffness_per_mass_percent": {}},
    "surface": SURFACE,
    "solver": {
        "precision": "double",
        "tolerance": 1e-3,
        "cg_iterations": {"mean": 8.0, "max": 12},
        "levels": 3,
        "final_relative_residual": 1e-9,
    },
    "seconds": {
        "total": 12.0,
        "compile": 1.0,
        "per_iteration_median": 0.5,
        "iterations": 6.0,
        "outputs": 2.0,
    },
    "peak_memory_MiB": 500.0,
    "files": {},
    "effects": [],
}


def run_metrics(**changes: Any) -> RunMetrics:
    """The metrics of the run with other fields."""
    return RunMetrics.of_json(copy.deepcopy({**_RUN, **changes}), "a run of the tests")
