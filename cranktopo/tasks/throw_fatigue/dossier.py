"""The dossier of a check against the crankshaft rule: gathers what the page shows and writes it."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from pathlib import Path

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.engine.analysis import analyse
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.histories import HistoryKind
from cranktopo.engine.plan.planning import plan_for_stress, with_own_reasons
from cranktopo.engine.states import load_cases
from cranktopo.engine.vibration.study import VibrationStudy
from cranktopo.report.pdf_file import write_pdf
from cranktopo.report.plot import Picture
from cranktopo.report.report_file import write_report
from cranktopo.runs.destination import check_file
from cranktopo.runs.manifest import settings_hash, timestamp, versions
from cranktopo.tasks.drawing.sheet import drawing_figures, throw_sheets
from cranktopo.tasks.fatigue.taken_keys import assumed_by
from cranktopo.tasks.throw_fatigue.assessment import FatigueAssessment, FatigueMethod
from cranktopo.tasks.throw_fatigue.rule_page import RuleRecord, rule_page
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.vibration.stage import shaft_vibration

_SUFFIXES = (".html", ".md", ".pdf")
_HISTORY: dict[HistoryKind, str] = {
    "extremes": "largest and smallest radial force on any web joined with largest and smallest torque "
    "ahead of or behind any throw, of a vibrating shaft at its worst speed too, which bounds the amplitude "
    "of every single section",
    "cycle": "radial force of the web, and torque of the section ahead of or behind a throw, whose range "
    "over the cycle at one speed is largest",
}


def check_dossier(method: FatigueMethod, targets: int, path: Path) -> None:
    """Check, before the solves, that a dossier can be written.

    Raises:
        CranktopoError: another method than the rule, several targets, or a path that no report can go to.
    """
    if method != "m53":
        raise CranktopoError(
            f"--report: is the dossier of the rule IACS UR M53, but --method is '{method}'.",
            hint="Take --method m53; 'cranktopo compare --fatigue lsa --report' shows the other methods.",
            code=ExitCode.USAGE,
        )
    if targets > 1:
        raise CranktopoError(
            f"--report: a dossier is of one TARGET, here are {targets}.",
            hint="Name one TARGET, without --baseline.",
            code=ExitCode.USAGE,
        )
    check_file(path, "report", _SUFFIXES)


def write_dossier(assessment: FatigueAssessment, path: Path, command: Sequence[str] = ()) -> None:
    """Write the dossier of one target as HTML, Markdown or PDF, by the ending of the path.

    Args:
        assessment: an assessment by the rule.

    Raises:
        CranktopoError: as `check_dossier`.
    """
    check_dossier(assessment.method, len({id(target) for target in assessment.targets}), path)
    target, scene = assessment.targets[0], assessment.targets[0].scene
    effects = with_own_reasons(plan_for_stress(scene), target.design)
    record = RuleRecord(
        name=target.name,
        checks=assessment.checks,
        scene=scene,
        effects=effects,
        cases=load_cases(scene, effects.enabled),
        loads=analyse(scene, effects.enabled),
        history=_HISTORY[assessment.loads],
        assumed=assumed_by(target.assumed, (assessment.method,)),
        drawings=() if target.file else _drawings(target),
        scene_sha256=settings_hash(scene.model_dump(mode="json"), {}),
        command=shlex.join(command),
        written=timestamp(),
        versions=versions(),
        vibration=_vibration(target),
    )
    if path.suffix.lower() == ".pdf":
        write_pdf(rule_page(record), path, record.document)
    else:
        write_report(rule_page(record), path)


def _vibration(target: Target) -> VibrationStudy | None:
    engine = target.scene.engine
    computable = target.scene.shaft is not None and engine is not None and engine.gas is not None
    if not computable:
        return None
    several = engine is not None and engine.cylinders > 1
    return shaft_vibration(target, misfire="worst" if several else ())


def _drawings(target: Target) -> tuple[Picture, ...]:
    scene, alt = target.scene, f"Workshop drawing of {target.name} with its dimensions"
    found = drawing_figures(throw_sheets(scene), throw_balance(scene), reduced=True)
    return tuple(
        Picture("drawing" if number == 1 else f"drawing-{number}", figure, alt, sheet=True)
        for number, figure in enumerate(found, start=1)
    )
