"""Topology and shape optimisation workbench for crankshaft webs.

The stages, in the order in which data flows through them; each takes what the one before returned:

    load_scene -> plan -> load_cases -> prepare -> optimise_density -> checked_surface
    -> fit_web -> evaluate -> compare

`evaluate` is `cranktopo.evaluate.evaluation.evaluate`: its name is taken here by the package it lives in. A
name loads its module when it is first used, so that importing the package costs nothing.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from cranktopo.cad.solid_files import export_solid
    from cranktopo.effects import EffectPlan, plan
    from cranktopo.errors import CranktopoError
    from cranktopo.evaluate.targets import Target, resolve_target
    from cranktopo.fem.precision import double_precision
    from cranktopo.loads import LoadCase, load_cases
    from cranktopo.optimise.stage import Optimum, Prepared, optimise_density, prepare
    from cranktopo.remodel.fit import FittedWeb, fit_web
    from cranktopo.report.comparison import Comparison, Entry, compare
    from cranktopo.scene import Scene, load_scene
    from cranktopo.surface.checked_surface import CheckedSurface, checked_surface
    from cranktopo.triangles.surface_files import write_stl

_HOMES = {
    "CranktopoError": "errors",
    "Scene": "scene",
    "load_scene": "scene",
    "EffectPlan": "effects",
    "plan": "effects",
    "LoadCase": "loads",
    "load_cases": "loads",
    "double_precision": "fem.precision",
    "Prepared": "optimise.stage",
    "prepare": "optimise.stage",
    "Optimum": "optimise.stage",
    "optimise_density": "optimise.stage",
    "CheckedSurface": "surface.checked_surface",
    "checked_surface": "surface.checked_surface",
    "write_stl": "triangles.surface_files",
    "FittedWeb": "remodel.fit",
    "fit_web": "remodel.fit",
    "export_solid": "cad.solid_files",
    "Target": "evaluate.targets",
    "resolve_target": "evaluate.targets",
    "Comparison": "report.comparison",
    "Entry": "report.comparison",
    "compare": "report.comparison",
}

__all__ = [
    "CheckedSurface",
    "Comparison",
    "CranktopoError",
    "EffectPlan",
    "Entry",
    "FittedWeb",
    "LoadCase",
    "Optimum",
    "Prepared",
    "Scene",
    "Target",
    "checked_surface",
    "compare",
    "double_precision",
    "export_solid",
    "fit_web",
    "load_cases",
    "load_scene",
    "optimise_density",
    "plan",
    "prepare",
    "resolve_target",
    "write_stl",
]


def __getattr__(name: str) -> Any:
    """A public name, its module imported now."""
    if name not in _HOMES:
        raise AttributeError(f"module 'cranktopo' has no attribute '{name}'")
    return getattr(import_module(f"cranktopo.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
