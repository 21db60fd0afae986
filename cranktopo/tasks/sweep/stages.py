"""Stages of a point: evaluation, fatigue, optimisation, re-model or shape, each judged alike."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import write_text
from cranktopo.base.progress import Json
from cranktopo.bodies.prisms import with_bolted
from cranktopo.bodies.solid.files import coarse_facet_mm
from cranktopo.design.goal.outcome import GoalOutcome
from cranktopo.design.halves import halves
from cranktopo.design.loading import stored_scene
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.engine.plan.planning import planned_scene
from cranktopo.report.goal_table import violated_limits
from cranktopo.report.viewer.scene3d import PARTNERS, ShownBody
from cranktopo.report.viewer.small_web import packed_web
from cranktopo.runs.directories import open_run, status_of
from cranktopo.runs.stored import unchanged
from cranktopo.tasks.bound.result import BoundStatement, NoBound
from cranktopo.tasks.importing.imported_body import half_surfaces
from cranktopo.tasks.optimise.result import RunMetrics, read_metrics
from cranktopo.tasks.sweep.fineness import Fineness
from cranktopo.tasks.sweep.plan import Stage
from cranktopo.tasks.sweep.result import IMPOSSIBLE, VIEW
from cranktopo.tasks.throw_fea.result import EvaluationResult
from cranktopo.tasks.throw_fea.targets import Target, simulated

if TYPE_CHECKING:
    from cranktopo.tasks.web_shape.result import ShapeResult

_COARSER = 2
"""Than what a page shows of a single web: a quarter of the triangles, in half the time."""


def web_view(target: Target) -> str:
    """Return the half throw of a target, or both where they differ, as text that a browser draws."""
    scene = target.scene
    meshes = half_surfaces(scene, target.file, _COARSER * coarse_facet_mm(scene))
    half_meshes = zip(meshes, halves(scene), PARTNERS[len(meshes)], strict=False)
    return packed_web(
        *(
            ShownBody(target.name, with_bolted(mesh, half), half.web_z_mm, half.pitch_mm / 2, partner=partner)
            for mesh, half, partner in half_meshes
        )
    )


DESIGN, RUN, REMODEL = "design.toml", "run", "remodel"
"""In the directory of a point: its scene, the run of its optimisation, the web re-modelled of it."""
COMMAND = ("cranktopo", "sweep")
"""In the manifests of the runs below a sweep; the sweep's own manifest has the whole line."""
_BOUNDED = {
    "mass": "mass_kg",
    "torsion": "torsion_Nm_per_rad",
    "bending": "bending_N_per_mm",
    "torsion_per_mass": "torsion_per_mass_Nm_per_rad_kg",
    "bending_per_mass": "bending_per_mass_N_per_mm_kg",
}
"""Number of a point that the bound of a quantity is beside."""


def run_stage(stage: Stage, scene: Scene, folder: Path, fineness: Fineness) -> Json:
    """Return what a stage tells of a scene: quantities, units in the names, `target` for `compare`, `view`.

    What an interrupted stage left in the directory of the point is continued.

    Raises:
        CranktopoError: a web that cannot be, a failed solve, or an optimisation without a body.
    """
    scene = fineness.scene(scene)
    write_text(folder / DESIGN, toml_text(scene, f"Point of a sweep: {stage} of this design"))
    return _STAGES[stage](scene, folder, fineness)


_WHERE_ASKED = ("natural_frequency_Hz", "stress_MPa", "fatigue_safety", "fatigue_place", "fatigue_loads")
"""Quantities that an evaluation has where a goal asks for them."""


def _columns_of(entry: EvaluationResult) -> Json:
    mass, second = entry.mass_kg.throw, entry.mass_kg.second_web
    torsion, bending = entry.torsion_Nm_per_rad, entry.bending_N_per_mm
    return {
        "mass_kg": mass,
        "web_mass_kg": entry.mass_kg.web,
        **({} if second is None else {"second_web_mass_kg": second}),
        "inertia_kg_mm2": entry.inertia_kg_mm2,
        "unbalance_kg_mm": entry.unbalance_kg_mm,
        "torsion_Nm_per_rad": torsion,
        "bending_N_per_mm": bending,
        "torsion_per_mass_Nm_per_rad_kg": torsion / mass,
        "bending_per_mass_N_per_mm_kg": bending / mass,
        "torsion_error_percent": entry.error_estimate_percent["torsion"],
        "bending_error_percent": entry.error_estimate_percent["bending"],
        **{name: value for name in _WHERE_ASKED if (value := getattr(entry, name)) is not None},
    }


def _evaluated(scene: Scene, folder: Path, fineness: Fineness) -> Json:
    web = Target(scene.name, simulated(scene))
    return {**_judged(web, fineness), "target": DESIGN, VIEW: web_view(web)}


def _fatigue(scene: Scene, folder: Path, fineness: Fineness) -> Json:
    from cranktopo.tasks.throw_fatigue.stage import assess_fatigue

    web = Target(scene.name, simulated(scene, fillets=True))
    found = assess_fatigue([web])
    least = found.fields[0].critical
    judged = _judged(Target(scene.name, simulated(scene)), fineness)
    safety = {"fatigue_safety": least.safety, "fatigue_place": least.place}
    safety |= {"fatigue_loads": "shaft" if found.fields[0].on_bearings else found.loads}
    return {**judged, **safety, "target": DESIGN, VIEW: web_view(web)}


def _optimised(scene: Scene, folder: Path, fineness: Fineness) -> Json:
    metrics = _densities(scene, folder)
    surface = Target(scene.name, planned_scene(scene), folder / RUN / metrics.files["stl"], folder / RUN)
    judged = _judged(surface, fineness)
    return {
        **judged,
        **_limits(metrics.goal),
        **_optimiser_columns(metrics),
        "target": RUN,
        VIEW: web_view(surface),
    }


def _densities(scene: Scene, folder: Path) -> RunMetrics:
    from cranktopo.tasks.optimise.stage import optimise_design, resume_optimisation

    run, status = folder / RUN, status_of(folder / RUN)
    metrics = read_metrics(open_run(str(run))) if status == "done" else None
    if metrics is None:
        done = resume_optimisation(str(run)) if status else optimise_design(scene, run, command=COMMAND)
        metrics = done.metrics
    if metrics.refusal:
        raise CranktopoError(f"the optimisation has no web: {metrics.refusal}", code=ExitCode.NOT_CONVERGED)
    return metrics


def _remodelled(scene: Scene, folder: Path, fineness: Fineness) -> Json:
    from cranktopo.tasks.refit.result import RefitResult
    from cranktopo.tasks.refit.stage import remodel_run

    metrics = _densities(scene, folder)
    done = folder / REMODEL / "remodel.json"
    if done.is_file():
        refit = RefitResult.read(unchanged(done))
    else:
        refit = remodel_run(str(folder / RUN), folder / REMODEL, evaluated=False)
    file = f"{REMODEL}/{refit.files.design}"
    web = Target(scene.name, simulated(stored_scene(folder / file)))
    return {**_judged(web, fineness), **_optimiser_columns(metrics), "target": file, VIEW: web_view(web)}


def _shaped(scene: Scene, folder: Path, fineness: Fineness) -> Json:
    from cranktopo.design.goal.scene_goal import with_goal
    from cranktopo.tasks.web_shape.run import shape_in, shape_settings

    run, stated = folder / RUN, scene if scene.goal is not None else with_goal(scene, minimise="mass")
    settings = fineness.shape_settings(shape_settings(stated), stated)
    data = shape_in(run, stated, settings, COMMAND)
    file = f"{RUN}/{data.files.design}"
    shaped = stored_scene(folder / file)
    return {
        **_columns_of(data.result),
        **_limits(data.goal),
        **_bound(data.bound),
        **_optimiser_columns(data),
        **_in_shaft(data),
        "target": file,
        VIEW: web_view(Target(shaped.name, simulated(shaped, fillets=True))),
    }


_STAGES: Mapping[Stage, Callable[[Scene, Path, Fineness], Json]] = {
    "evaluate": _evaluated,
    "fatigue": _fatigue,
    "optimise": _optimised,
    "remodel": _remodelled,
    "shape": _shaped,
}


def _judged(target: Target, fineness: Fineness) -> Json:
    return _columns_of(fineness.evaluation(target).result)


def _optimiser_columns(result: RunMetrics | ShapeResult) -> Json:
    return {"optimiser_status": result.status, "iterations": result.iterations}


def _in_shaft(data: ShapeResult) -> Json:
    """Return the safety in the shaft where the search judged a throw alone, and whether the web lost some."""
    from cranktopo.tasks.web_shape.shaft_text import less_safe_in_shaft

    one = data.shaft_check
    if one is None:
        return {}
    lost = {"less_safe_in_shaft": words} if (words := less_safe_in_shaft(data)) else {}
    return {"safety_in_shaft": one.result, "safety_in_shaft_of_original": one.original, **lost}


def _limits(goal: GoalOutcome | None) -> Json:
    """Tell whether every limit of the goal, if any, holds; a web that breaks one is no answer to it."""
    if not goal:
        return {}
    if not (violated := violated_limits(goal)):
        return {"limits_hold": True}
    reason = f"no web found that holds {'; '.join(violated)}"
    return {"limits_hold": False, "status": IMPOSSIBLE, "reason": reason}


def _bound(bound: BoundStatement | NoBound | None) -> Json:
    """Return what no web of the point's envelope can beat, named after its quantity."""
    if not isinstance(bound, BoundStatement) or bound.value is None:
        return {}
    name = _BOUNDED.get(bound.quantity)
    return {} if name is None else {f"bound_{name}": bound.value}
