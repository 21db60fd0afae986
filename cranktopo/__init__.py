"""Topology and shape optimisation workbench for crankshaft webs.

The stages, in the order in which data flows through them; each takes what the one before returned:

    load_scene -> plan -> load_cases -> prepare -> optimise_density -> checked_surface
    -> fit_web -> evaluate_target -> compare

What a command does is one call as well: `optimise_design`, `resume_optimisation`, `extract_surface`,
`remodel_run`, `shape_design`, `resume_shape`, `shape_each_web`, `resume_each_web`, `bound_of`,
`start_loop`, `continue_loop`, `evaluate_targets`, `compare_targets`, `assess_fatigue`, `shaft_vibration`,
`shaft_modes`, `sweep`, `check_bolts`, `check_rod_strength`, `check_rod_elements`, `lighten_rod`,
`lighten_rod_by_elements`, `draw_rod`, `check_balancer`, `redesign_balancer`, `draw_balancer`, `oil_films`,
`study_accuracy`, `evaluate_shaft`, `assess_shaft`, `loads_at_speeds`, `engine_balance`, `report_balance`,
`report_run`, `report_comparison`, `export_solid`, `draw_crank`, `summarise_runs`, `clean_runs`,
`check_machine`.

A design is a `Scene`, the path of a file or a name, whatever the function; a target may be a `Target` too.
What they return is a class of this list (`Loads`, `EvaluationResult`, `FatigueResult`, `RunMetrics`, ...).

A name loads its module when it is first used, so that importing the package costs nothing.
"""

from __future__ import annotations

TYPE_CHECKING = (
    False  # as type checkers know it; `typing` would take longer to load than the command's own start
)
if TYPE_CHECKING:
    from typing import Any

    from cranktopo.base.errors import CranktopoError
    from cranktopo.bodies.solid.files import export_solid
    from cranktopo.design.goal.limit import Goal, Limit
    from cranktopo.design.loading import load_scene
    from cranktopo.design.named import wanted, with_goal, with_values
    from cranktopo.design.schema import Scene
    from cranktopo.design.writing import save_scene
    from cranktopo.engine.balance.whole_engine import EngineBalance, engine_balance
    from cranktopo.engine.load_case import LoadCase
    from cranktopo.engine.plan.effect import PhysicsPlan
    from cranktopo.engine.plan.planning import plan
    from cranktopo.engine.states import load_cases
    from cranktopo.engine.vibration.study import VibrationStudy
    from cranktopo.numerics.precision import double_precision
    from cranktopo.numerics.surfaces.files import write_stl
    from cranktopo.tasks.accuracy.stage import AccuracyStudy, study_accuracy
    from cranktopo.tasks.balance.result import Balance, balance_result
    from cranktopo.tasks.balance.stage import report_balance
    from cranktopo.tasks.balancer.drawing import draw_balancer
    from cranktopo.tasks.balancer.redesign import redesign_balancer
    from cranktopo.tasks.balancer.result import BalancerStrength
    from cranktopo.tasks.balancer.stage import check_balancer
    from cranktopo.tasks.bolts.result import BoltChecks
    from cranktopo.tasks.bolts.stage import check_bolts
    from cranktopo.tasks.bound.result import BoundResult
    from cranktopo.tasks.bound.stage import bound_of
    from cranktopo.tasks.compare.result import Comparison, ComparisonResult, Entry, compare
    from cranktopo.tasks.compare.stage import ComparedTargets, compare_targets, report_comparison
    from cranktopo.tasks.compare.text import comparison_result
    from cranktopo.tasks.crank_drawing.sheet import draw_crank
    from cranktopo.tasks.crank_import.result import CrankImport
    from cranktopo.tasks.crank_import.stage import import_crank
    from cranktopo.tasks.density.stage import Optimum, Prepared, optimise_density, prepare
    from cranktopo.tasks.designs.run_webs import WebTarget, web_target
    from cranktopo.tasks.doctor.stage import Check, check_machine
    from cranktopo.tasks.evaluate.sensitivities import Sensitivities, evaluate_sensitivities
    from cranktopo.tasks.extraction.checked_surface import CheckedSurface, checked_surface
    from cranktopo.tasks.extraction.result import Extraction
    from cranktopo.tasks.extraction.stage import extract_surface
    from cranktopo.tasks.film.result import FilmResult
    from cranktopo.tasks.film.stage import oil_films
    from cranktopo.tasks.iterate.loop import continue_loop, loop_scene, start_loop
    from cranktopo.tasks.iterate.result import LoopResult, LoopRun, loop_settings
    from cranktopo.tasks.loads.result import Loads
    from cranktopo.tasks.loads.stage import loads_at_speeds, plot_load_curves, write_load_curves
    from cranktopo.tasks.modes.result import ShaftModes
    from cranktopo.tasks.modes.stage import shaft_modes
    from cranktopo.tasks.optimise.result import OptimisedRun, RunMetrics
    from cranktopo.tasks.optimise.stage import optimise_design, resume_optimisation, with_cells_for
    from cranktopo.tasks.refit.fit import FittedWeb, fit_web
    from cranktopo.tasks.refit.result import RefitResult
    from cranktopo.tasks.refit.stage import remodel_run
    from cranktopo.tasks.report.stage import report_run
    from cranktopo.tasks.rod.drawing import draw_rod
    from cranktopo.tasks.rod.element_search import lighten_rod_by_elements
    from cranktopo.tasks.rod.element_stage import check_rod_elements
    from cranktopo.tasks.rod.lighter import lighten_rod
    from cranktopo.tasks.rod.result import LighterRod, RodElements, RodStrength
    from cranktopo.tasks.rod.stage import check_rod_strength
    from cranktopo.tasks.run_list.stage import RunEntry, clean_runs, summarise_runs
    from cranktopo.tasks.shaft.result import ShaftEvaluation
    from cranktopo.tasks.shaft.stage import evaluate_shaft
    from cranktopo.tasks.shaft_safety.result import ShaftAssessment
    from cranktopo.tasks.shaft_safety.stage import assess_shaft
    from cranktopo.tasks.sweep.run import sweep
    from cranktopo.tasks.throw_fatigue.assessment import FatigueAssessment
    from cranktopo.tasks.throw_fatigue.result import FatigueResult
    from cranktopo.tasks.throw_fatigue.stage import assess_fatigue
    from cranktopo.tasks.throw_fea.evaluation import Evaluation
    from cranktopo.tasks.throw_fea.result import EvaluationResult
    from cranktopo.tasks.throw_fea.stage import Evaluations, MeshRequest, evaluate_target, evaluate_targets
    from cranktopo.tasks.throw_fea.studies import StudyResult
    from cranktopo.tasks.throw_fea.targets import Target, resolve_target, resolve_targets
    from cranktopo.tasks.vibration.result import ShaftVibration
    from cranktopo.tasks.vibration.stage import shaft_vibration
    from cranktopo.tasks.web_shape.each_web.result import EachWebResult
    from cranktopo.tasks.web_shape.each_web.run import EachWebRun, resume_each_web, shape_each_web
    from cranktopo.tasks.web_shape.result import ShapeResult
    from cranktopo.tasks.web_shape.run import ShapedRun, resume_shape, shape_design, shape_settings
    from cranktopo.throw.manufacturing_limits import ManufacturingLimits

_HOMES = {
    "Loads": "tasks.loads.result",
    "Balance": "tasks.balance.result",
    "BoundResult": "tasks.bound.result",
    "ComparedTargets": "tasks.compare.stage",
    "ComparisonResult": "tasks.compare.result",
    "AccuracyStudy": "tasks.accuracy.stage",
    "StudyResult": "tasks.throw_fea.studies",
    "FatigueAssessment": "tasks.throw_fatigue.assessment",
    "FatigueResult": "tasks.throw_fatigue.result",
    "OptimisedRun": "tasks.optimise.result",
    "RunMetrics": "tasks.optimise.result",
    "ShapeResult": "tasks.web_shape.result",
    "LoopRun": "tasks.iterate.result",
    "LoopResult": "tasks.iterate.result",
    "RefitResult": "tasks.refit.result",
    "Extraction": "tasks.extraction.result",
    "Evaluations": "tasks.throw_fea.stage",
    "EvaluationResult": "tasks.throw_fea.result",
    "ShaftEvaluation": "tasks.shaft.result",
    "ShaftAssessment": "tasks.shaft_safety.result",
    "VibrationStudy": "engine.vibration.study",
    "ShaftModes": "tasks.modes.result",
    "ShaftVibration": "tasks.vibration.result",
    "RunEntry": "tasks.run_list.stage",
    "Check": "tasks.doctor.stage",
    "CranktopoError": "base.errors",
    "Scene": "design.schema",
    "load_scene": "design.loading",
    "with_values": "design.named",
    "save_scene": "design.writing",
    "Goal": "design.goal.limit",
    "Limit": "design.goal.limit",
    "with_goal": "design.named",
    "wanted": "design.named",
    "PhysicsPlan": "engine.plan.effect",
    "plan": "engine.plan.planning",
    "LoadCase": "engine.load_case",
    "load_cases": "engine.states",
    "EngineBalance": "engine.balance.whole_engine",
    "engine_balance": "engine.balance.whole_engine",
    "double_precision": "numerics.precision",
    "Prepared": "tasks.density.stage",
    "prepare": "tasks.density.stage",
    "Optimum": "tasks.density.stage",
    "optimise_density": "tasks.density.stage",
    "CheckedSurface": "tasks.extraction.checked_surface",
    "checked_surface": "tasks.extraction.checked_surface",
    "write_stl": "numerics.surfaces.files",
    "FittedWeb": "tasks.refit.fit",
    "fit_web": "tasks.refit.fit",
    "ManufacturingLimits": "throw.manufacturing_limits",
    "ShapedRun": "tasks.web_shape.run",
    "shape_design": "tasks.web_shape.run",
    "shape_settings": "tasks.web_shape.run",
    "Sensitivities": "tasks.evaluate.sensitivities",
    "evaluate_sensitivities": "tasks.evaluate.sensitivities",
    "WebTarget": "tasks.designs.run_webs",
    "web_target": "tasks.designs.run_webs",
    "resume_shape": "tasks.web_shape.run",
    "EachWebResult": "tasks.web_shape.each_web.result",
    "EachWebRun": "tasks.web_shape.each_web.run",
    "resume_each_web": "tasks.web_shape.each_web.run",
    "shape_each_web": "tasks.web_shape.each_web.run",
    "import_crank": "tasks.crank_import.stage",
    "CrankImport": "tasks.crank_import.result",
    "bound_of": "tasks.bound.stage",
    "sweep": "tasks.sweep.run",
    "balance_result": "tasks.balance.result",
    "comparison_result": "tasks.compare.text",
    "report_balance": "tasks.balance.stage",
    "export_solid": "bodies.solid.files",
    "draw_crank": "tasks.crank_drawing.sheet",
    "Target": "tasks.throw_fea.targets",
    "resolve_target": "tasks.throw_fea.targets",
    "resolve_targets": "tasks.throw_fea.targets",
    "Evaluation": "tasks.throw_fea.evaluation",
    "evaluate_shaft": "tasks.shaft.stage",
    "assess_shaft": "tasks.shaft_safety.stage",
    "Comparison": "tasks.compare.result",
    "Entry": "tasks.compare.result",
    "compare": "tasks.compare.result",
    "MeshRequest": "tasks.throw_fea.stage",
    "evaluate_target": "tasks.throw_fea.stage",
    "evaluate_targets": "tasks.throw_fea.stage",
    "compare_targets": "tasks.compare.stage",
    "report_comparison": "tasks.compare.stage",
    "assess_fatigue": "tasks.throw_fatigue.stage",
    "study_accuracy": "tasks.accuracy.stage",
    "optimise_design": "tasks.optimise.stage",
    "resume_optimisation": "tasks.optimise.stage",
    "with_cells_for": "tasks.optimise.stage",
    "report_run": "tasks.report.stage",
    "extract_surface": "tasks.extraction.stage",
    "remodel_run": "tasks.refit.stage",
    "loop_scene": "tasks.iterate.loop",
    "loop_settings": "tasks.iterate.result",
    "start_loop": "tasks.iterate.loop",
    "continue_loop": "tasks.iterate.loop",
    "loads_at_speeds": "tasks.loads.stage",
    "write_load_curves": "tasks.loads.stage",
    "plot_load_curves": "tasks.loads.stage",
    "summarise_runs": "tasks.run_list.stage",
    "clean_runs": "tasks.run_list.stage",
    "check_machine": "tasks.doctor.stage",
    "BalancerStrength": "tasks.balancer.result",
    "BoltChecks": "tasks.bolts.result",
    "RodElements": "tasks.rod.result",
    "RodStrength": "tasks.rod.result",
    "check_balancer": "tasks.balancer.stage",
    "draw_balancer": "tasks.balancer.drawing",
    "redesign_balancer": "tasks.balancer.redesign",
    "check_bolts": "tasks.bolts.stage",
    "draw_rod": "tasks.rod.drawing",
    "check_rod_elements": "tasks.rod.element_stage",
    "check_rod_strength": "tasks.rod.stage",
    "LighterRod": "tasks.rod.result",
    "lighten_rod": "tasks.rod.lighter",
    "lighten_rod_by_elements": "tasks.rod.element_search",
    "shaft_vibration": "tasks.vibration.stage",
    "shaft_modes": "tasks.modes.stage",
    "FilmResult": "tasks.film.result",
    "oil_films": "tasks.film.stage",
}

__all__ = [
    "AccuracyStudy",
    "Balance",
    "BalancerStrength",
    "BoltChecks",
    "BoundResult",
    "Check",
    "CheckedSurface",
    "ComparedTargets",
    "Comparison",
    "ComparisonResult",
    "CrankImport",
    "CranktopoError",
    "EachWebResult",
    "EachWebRun",
    "EngineBalance",
    "Entry",
    "Evaluation",
    "EvaluationResult",
    "Evaluations",
    "Extraction",
    "FatigueAssessment",
    "FatigueResult",
    "FilmResult",
    "FittedWeb",
    "Goal",
    "LighterRod",
    "Limit",
    "LoadCase",
    "Loads",
    "LoopResult",
    "LoopRun",
    "ManufacturingLimits",
    "MeshRequest",
    "OptimisedRun",
    "Optimum",
    "PhysicsPlan",
    "Prepared",
    "RefitResult",
    "RodElements",
    "RodStrength",
    "RunEntry",
    "RunMetrics",
    "Scene",
    "Sensitivities",
    "ShaftAssessment",
    "ShaftEvaluation",
    "ShaftModes",
    "ShaftVibration",
    "ShapeResult",
    "ShapedRun",
    "StudyResult",
    "Target",
    "VibrationStudy",
    "WebTarget",
    "assess_fatigue",
    "assess_shaft",
    "balance_result",
    "bound_of",
    "check_balancer",
    "check_bolts",
    "check_machine",
    "check_rod_elements",
    "check_rod_strength",
    "checked_surface",
    "clean_runs",
    "compare",
    "compare_targets",
    "comparison_result",
    "continue_loop",
    "double_precision",
    "draw_balancer",
    "draw_crank",
    "draw_rod",
    "engine_balance",
    "evaluate_sensitivities",
    "evaluate_shaft",
    "evaluate_target",
    "evaluate_targets",
    "export_solid",
    "extract_surface",
    "fit_web",
    "import_crank",
    "lighten_rod",
    "lighten_rod_by_elements",
    "load_cases",
    "load_scene",
    "loads_at_speeds",
    "loop_scene",
    "loop_settings",
    "oil_films",
    "optimise_density",
    "optimise_design",
    "plan",
    "plot_load_curves",
    "prepare",
    "redesign_balancer",
    "remodel_run",
    "report_balance",
    "report_comparison",
    "report_run",
    "resolve_target",
    "resolve_targets",
    "resume_each_web",
    "resume_optimisation",
    "resume_shape",
    "save_scene",
    "shaft_modes",
    "shaft_vibration",
    "shape_design",
    "shape_each_web",
    "shape_settings",
    "start_loop",
    "study_accuracy",
    "summarise_runs",
    "sweep",
    "wanted",
    "web_target",
    "with_cells_for",
    "with_goal",
    "with_values",
    "write_load_curves",
    "write_stl",
]


def __getattr__(name: str) -> Any:
    """Return a public name, its module imported now."""
    from importlib import import_module

    if name not in _HOMES:
        raise AttributeError(f"module 'cranktopo' has no attribute '{name}'")
    return getattr(import_module(f"cranktopo.{_HOMES[name]}"), name)


def __dir__() -> list[str]:
    return sorted(__all__)
