"""Topology and shape optimisation workbench for crankshaft webs.

The stages, in the order in which data flows through them; each takes what the one before returned:

    load_scene -> plan -> load_cases -> prepare -> optimise_density -> checked_surface
    -> fit_web -> evaluate_target -> compare

What a command does is one call as well: `optimise_design`, `resume_optimisation`, `extract_surface`,
`remodel_run`, `shape_design`, `resume_shape`, `bound_of`, `start_loop`, `continue_loop`, `evaluate_targets`,
`compare_targets`, `assess_fatigue`, `shaft_vibration`, `sweep`,
`study_accuracy`, `evaluate_shaft`, `loads_at_speeds`, `engine_balance`, `report_balance`,
`report_run`, `report_comparison`, `export_solid`,
`summarise_runs`, `clean_runs`, `check_machine`. A name loads its module when it is first used, so that
importing the package costs nothing.
"""

from __future__ import annotations

TYPE_CHECKING = (
    False  # as type checkers know it; `typing` would take longer to load than the command's own start
)
if TYPE_CHECKING:
    from typing import Any

    from cranktopo.cad.solid_files import export_solid
    from cranktopo.effects import EffectPlan, plan
    from cranktopo.errors import CranktopoError
    from cranktopo.evaluate.evaluation import Evaluation
    from cranktopo.evaluate.shaft import evaluate_shaft
    from cranktopo.evaluate.targets import Target, resolve_target, resolve_targets
    from cranktopo.fem.precision import double_precision
    from cranktopo.loads import LoadCase, load_cases
    from cranktopo.loads.whole_engine import EngineBalance, engine_balance
    from cranktopo.optimise.stage import Optimum, Prepared, optimise_density, prepare
    from cranktopo.pipeline.accuracy import study_accuracy
    from cranktopo.pipeline.balance import balance_json, report_balance
    from cranktopo.pipeline.bound import bound_of
    from cranktopo.pipeline.compare import compare_targets, report_comparison
    from cranktopo.pipeline.doctor import check_machine
    from cranktopo.pipeline.evaluate import MeshRequest, evaluate_target, evaluate_targets
    from cranktopo.pipeline.extract import extract_surface
    from cranktopo.pipeline.fatigue import assess_fatigue
    from cranktopo.pipeline.iterate import continue_loop, loop_scene, loop_settings, start_loop
    from cranktopo.pipeline.loads import loads_at_speeds, plot_load_curves, write_load_curves
    from cranktopo.pipeline.optimise import optimise_design, resume_optimisation, with_cells_for
    from cranktopo.pipeline.remodel import remodel_run
    from cranktopo.pipeline.run_report import report_run
    from cranktopo.pipeline.run_webs import WebTarget, web_target
    from cranktopo.pipeline.runs import clean_runs, summarise_runs
    from cranktopo.pipeline.sensitivities import Sensitivities, evaluate_sensitivities
    from cranktopo.pipeline.shape import ShapedRun, resume_shape, shape_design, shape_settings
    from cranktopo.pipeline.sweep import sweep
    from cranktopo.pipeline.vibration import shaft_vibration
    from cranktopo.remodel.fit import FittedWeb, fit_web
    from cranktopo.remodel.manufacturing_limits import ManufacturingLimits
    from cranktopo.report.comparison import Comparison, Entry, compare
    from cranktopo.scene import Scene, load_scene
    from cranktopo.scene.goal import Goal, Limit
    from cranktopo.scene.goal.changing import with_goal
    from cranktopo.scene.goal.wanted import wanted
    from cranktopo.surface.checked_surface import CheckedSurface, checked_surface
    from cranktopo.triangles.surface_files import write_stl

_HOMES = {
    "CranktopoError": "errors",
    "Scene": "scene",
    "load_scene": "scene",
    "Goal": "scene.goal",
    "Limit": "scene.goal",
    "with_goal": "scene.goal.changing",
    "wanted": "scene.goal.wanted",
    "EffectPlan": "effects",
    "plan": "effects",
    "LoadCase": "loads",
    "load_cases": "loads",
    "EngineBalance": "loads.whole_engine",
    "engine_balance": "loads.whole_engine",
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
    "ManufacturingLimits": "remodel.manufacturing_limits",
    "ShapedRun": "pipeline.shape",
    "shape_design": "pipeline.shape",
    "shape_settings": "pipeline.shape",
    "Sensitivities": "pipeline.sensitivities",
    "evaluate_sensitivities": "pipeline.sensitivities",
    "WebTarget": "pipeline.run_webs",
    "web_target": "pipeline.run_webs",
    "resume_shape": "pipeline.shape",
    "bound_of": "pipeline.bound",
    "sweep": "pipeline.sweep",
    "balance_json": "pipeline.balance",
    "report_balance": "pipeline.balance",
    "export_solid": "cad.solid_files",
    "Target": "evaluate.targets",
    "resolve_target": "evaluate.targets",
    "resolve_targets": "evaluate.targets",
    "Evaluation": "evaluate.evaluation",
    "evaluate_shaft": "evaluate.shaft",
    "Comparison": "report.comparison",
    "Entry": "report.comparison",
    "compare": "report.comparison",
    "MeshRequest": "pipeline.evaluate",
    "evaluate_target": "pipeline.evaluate",
    "evaluate_targets": "pipeline.evaluate",
    "compare_targets": "pipeline.compare",
    "report_comparison": "pipeline.compare",
    "assess_fatigue": "pipeline.fatigue",
    "study_accuracy": "pipeline.accuracy",
    "optimise_design": "pipeline.optimise",
    "resume_optimisation": "pipeline.optimise",
    "with_cells_for": "pipeline.optimise",
    "report_run": "pipeline.run_report",
    "extract_surface": "pipeline.extract",
    "remodel_run": "pipeline.remodel",
    "loop_scene": "pipeline.iterate",
    "loop_settings": "pipeline.iterate",
    "start_loop": "pipeline.iterate",
    "continue_loop": "pipeline.iterate",
    "loads_at_speeds": "pipeline.loads",
    "write_load_curves": "pipeline.loads",
    "plot_load_curves": "pipeline.loads",
    "summarise_runs": "pipeline.runs",
    "clean_runs": "pipeline.runs",
    "check_machine": "pipeline.doctor",
    "shaft_vibration": "pipeline.vibration",
}

__all__ = [
    "CheckedSurface",
    "Comparison",
    "CranktopoError",
    "EffectPlan",
    "EngineBalance",
    "Entry",
    "Evaluation",
    "FittedWeb",
    "Goal",
    "Limit",
    "LoadCase",
    "ManufacturingLimits",
    "MeshRequest",
    "Optimum",
    "Prepared",
    "Scene",
    "Sensitivities",
    "ShapedRun",
    "Target",
    "WebTarget",
    "assess_fatigue",
    "balance_json",
    "bound_of",
    "check_machine",
    "checked_surface",
    "clean_runs",
    "compare",
    "compare_targets",
    "continue_loop",
    "double_precision",
    "engine_balance",
    "evaluate_sensitivities",
    "evaluate_shaft",
    "evaluate_target",
    "evaluate_targets",
    "export_solid",
    "extract_surface",
    "fit_web",
    "load_cases",
    "load_scene",
    "loads_at_speeds",
    "loop_scene",
    "loop_settings",
    "optimise_density",
    "optimise_design",
    "plan",
    "plot_load_curves",
    "prepare",
    "remodel_run",
    "report_balance",
    "report_comparison",
    "report_run",
    "resolve_target",
    "resolve_targets",
    "resume_optimisation",
    "resume_shape",
    "shaft_vibration",
    "shape_design",
    "shape_settings",
    "start_loop",
    "study_accuracy",
    "summarise_runs",
    "sweep",
    "wanted",
    "web_target",
    "with_cells_for",
    "with_goal",
    "write_load_curves",
    "write_stl",
]


def __getattr__(name: str) -> Any:
    """A public name, its module imported now."""
    from importlib import import_module

    if name not in _HOMES:
        raise AttributeError(f"module 'cranktopo' has no attribute '{name}'")
    return getattr(import_module(f"cranktopo.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
