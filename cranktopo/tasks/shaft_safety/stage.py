"""A whole shaft on its bearings, and by a method of local stresses the safety of every part of every web."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

from cranktopo.base.files import as_path, as_path_if_any
from cranktopo.base.notes import note
from cranktopo.design.misfire import with_misfire
from cranktopo.design.strength import note_strength
from cranktopo.engine.bearings import radial_play_mm
from cranktopo.engine.performance import note_pressure
from cranktopo.engine.plan.planning import note_left_off
from cranktopo.report.report_file import check_report_path, write_report
from cranktopo.runs.destination import check_file
from cranktopo.runs.manifest import timestamp
from cranktopo.tasks.dynamics.result import ShaftDynamics
from cranktopo.tasks.dynamics.stage import check_dynamics
from cranktopo.tasks.shaft.assembly import ShaftBearings
from cranktopo.tasks.shaft.on_film import check_film
from cranktopo.tasks.shaft.result import ShaftEvaluation
from cranktopo.tasks.shaft.stage import evaluate_shaft, not_on_bearings, shaft_left_off, stands_on_bearings
from cranktopo.tasks.shaft.web_sections import write_web_sections
from cranktopo.tasks.shaft_safety.in_motion import judged_in_motion, shaft_in_motion
from cranktopo.tasks.shaft_safety.judged import check_judged, judged_shaft
from cranktopo.tasks.shaft_safety.page import shaft_page
from cranktopo.tasks.shaft_safety.result import ShaftAssessment, assessment
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
from cranktopo.tasks.throw_fea.targets import Target, TargetLike, resolve_target


def assess_shaft(
    target: TargetLike,
    bearings: ShaftBearings = "rigid",
    element_size_mm: float | None = None,
    *,
    speeds_rpm: Sequence[float] = (),
    method: str | None = None,
    fillet_fraction: float = RULE_FRACTION,
    misfire: Sequence[int] = (),
    report: Path | str | None = None,
    csv: Path | str | None = None,
    dynamic: bool = False,
) -> ShaftAssessment:
    """Assemble the throws of a target and tell what webs and bearings carry over the cycle.

    Args:
        element_size_mm: general element size, where no method makes the mesh follow the fillets.
        speeds_rpm: speeds of the cycle; the engine's own by default. Between several of a vibrating shaft
            that at which its torque swings most is added.
        method: of local stresses, by which every part of every web is judged; None: no safety.
        fillet_fraction: element size in a fillet over its radius.
        misfire: cylinders that do not fire, in place of those of the design.
        report: page to write, HTML or Markdown; it needs a method.
        csv: file of what every web carries at every angle and speed.
        dynamic: also its steady vibration, bending, torsion and axial motion together, beside that; between
            several speeds its worst resonance is added to them, where it is not in oil films.

    Raises:
        CranktopoError: a cylinder that the engine does not have, no engine, no loads or no bearings to judge
            by, missing strength, or a failed solve.
    """
    report = as_path_if_any(report)
    resolved = resolve_target(target, fillets=method is not None, whole=True, crank=True)
    resolved = replace(resolved, scene=with_misfire(resolved.scene, misfire))
    if csv is not None:
        check_file(as_path(csv), "--csv")
    if bearings == "film":
        check_film(resolved.scene)
    if bearings == "clearance":
        radial_play_mm(resolved.scene)
    if dynamic:
        check_dynamics(resolved.scene, bearings)
    if method is None:
        return _unjudged(resolved, bearings, element_size_mm, speeds_rpm, csv, dynamic=dynamic)
    if report is not None:
        check_report_path(report)
    check_judged(resolved, bearings, method)
    note_left_off(resolved.name, shaft_left_off(resolved.scene))
    note_strength(resolved.name, resolved.scene)
    note_pressure(resolved.name, resolved.scene)
    told = resolved, bearings, method, speeds_rpm, fillet_fraction
    if dynamic:
        moved = judged_in_motion(*told)
        found, judged = moved.evaluation, moved.judged
        assessed = assessment(found, judged.safety(), moved.dynamics, moved.moving.safety())
    else:
        found, judged = judged_shaft(*told, add_worst_speed=True)
        assessed = assessment(found, judged.safety())
    write_curves(found, csv, assessed.dynamics)
    if report is not None:
        most = max(found.on_bearings, key=lambda at: at.worst_bearing.largest_N)
        loads = judged.bearing_loads(most.speed_rpm)
        write_report(shaft_page(assessed, loads, resolved.scene, timestamp()[:10]), report)
        note(str(report))
    return assessed


def _unjudged(
    target: Target,
    bearings: ShaftBearings,
    element_size_mm: float | None,
    speeds_rpm: Sequence[float],
    csv: Path | str | None,
    *,
    dynamic: bool,
) -> ShaftAssessment:
    """Return what webs and bearings carry, without any safety."""
    if stands_on_bearings(target.scene, bearings):
        note_pressure(target.name, target.scene)
    dynamics: ShaftDynamics | None = None
    if dynamic:
        found, dynamics = shaft_in_motion(target, bearings, element_size_mm, speeds_rpm)
    else:
        found = evaluate_shaft(target, bearings, element_size_mm, speeds_rpm=speeds_rpm, add_worst_speed=True)
    write_curves(found, csv, dynamics)
    return assessment(found, dynamics=dynamics)


def write_curves(
    evaluation: ShaftEvaluation, csv: Path | str | None, dynamics: ShaftDynamics | None = None
) -> None:
    """Write what the webs carry at every angle, if a file is asked for; raises CranktopoError."""
    if csv is None:
        return
    if not evaluation.on_bearings:
        raise not_on_bearings("--csv: what webs carry over the cycle needs")
    path = as_path(csv)
    moving = [at.curves for at in dynamics.speeds if at.curves] if dynamics else []
    still = [(at.speed_rpm, at.sections) for at in evaluation.on_bearings if at.sections]
    write_web_sections(still, path, moving)
    note(str(path))
