"""Torsional vibration of a target's shaft, and its page and table."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Literal

import numpy as np

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.files import as_path_if_any, replacing
from cranktopo.base.notes import note, warn
from cranktopo.design.assumed import LOADS, VIBRATION
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.misfire import all_firing, with_misfire
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.performance import note_pressure
from cranktopo.engine.vibration.first_frequency import first_mode
from cranktopo.engine.vibration.shaft_chain import ShaftChain, estimated_chain, shaft_chain
from cranktopo.engine.vibration.study import (
    VibrationStudy,
    check_vibration,
    misfire_warnings,
    misfires_of_each,
    study_vibration,
)
from cranktopo.report.report_file import check_report_path, write_report
from cranktopo.runs.destination import check_file
from cranktopo.runs.manifest import timestamp
from cranktopo.tasks.shaft.assembly import Bearings
from cranktopo.tasks.shaft.result import ShaftEvaluation
from cranktopo.tasks.shaft.stage import evaluate_shaft, shaft_tables, stiffness_source
from cranktopo.tasks.throw_fea.stage import print_assumed
from cranktopo.tasks.throw_fea.targets import Target, TargetLike, resolve_target
from cranktopo.tasks.vibration.page import vibration_page


def shaft_vibration(
    target: TargetLike,
    bearings: Bearings | None = None,
    element_size_mm: float | None = None,
    report: Path | str | None = None,
    csv: Path | str | None = None,
    design: str | None = None,
    align: bool = False,
    run_up_s: float | None = None,
    misfire: Sequence[int] | Literal["worst"] = (),
) -> VibrationStudy:
    """Steady torsional vibration of a shaft over its range of speeds, by finite elements of its throw.

    A design that gives `shaft.throw_stiffness_Nm_per_rad` needs no elements.

    Args:
        target: a design, a run, or an STL or STEP file of the half throw.
        bearings: radial support of the mid-journal sections; rigid by default.
        report: page to write, HTML or Markdown.
        csv: file for the torque of every section by speed and order.
        run_up_s: time in which the speed rises through its range; None for the steady vibration alone.
        misfire: cylinders that do not fire, in place of those of the design; "worst": also what each one
            would do that alone does not fire.

    Raises:
        CranktopoError: no engine or gas, bearings or elements beside a given stiffness, a cylinder that the
            engine does not have, a failed solve, or a file that cannot be written.
    """
    report = as_path_if_any(report)
    csv = as_path_if_any(csv)
    if report is not None:
        check_report_path(report)
    if csv is not None:
        check_file(csv, "--csv")
    resolved = resolve_target(target, design, align=align, whole=True, crank=True)
    resolved = replace(resolved, scene=_misfiring(resolved.scene, misfire))
    _ = resolved.scene.shaft_angles_deg  # refuses a scene without an engine before anything is solved
    _check_solved(resolved, bearings, element_size_mm)
    check_vibration(resolved.scene, run_up_s)
    support = bearings or "rigid"
    print_assumed([resolved], (*shaft_tables(resolved.scene, support), LOADS, VIBRATION))
    note_pressure(resolved.name, resolved.scene, every_speed=True)
    study = _studied(resolved, support, element_size_mm, run_up_s)
    if misfire == "worst":
        note(f"{resolved.name}: misfire of each of {study.cylinders} cylinders")
        study = _with_misfires(study)
    for line in study.warnings:
        warn(f"{resolved.name}: {line}")
    if report is not None:
        write_report(vibration_page(study, timestamp()[:10]), report)
        note(str(report))
    if csv is not None:
        _write_orders(study, csv)
        note(str(csv))
    return study


def _with_misfires(study: VibrationStudy) -> VibrationStudy:
    """Return the study with the misfire of every cylinder, and what these warn of."""
    found = replace(study, misfires=misfires_of_each(study))
    return replace(found, warnings=(*found.warnings, *misfire_warnings(found)))


def _misfiring(scene: Scene, misfire: Sequence[int] | Literal["worst"]) -> Scene:
    if isinstance(misfire, str):
        return all_firing(scene)
    return with_misfire(scene, misfire)


def misfire_option(values: Sequence[int | str]) -> tuple[int, ...] | Literal["worst"]:
    """Return what repeated `--misfire` asks for; raises CranktopoError for a word beside numbers."""
    numbers = tuple(one for one in values if isinstance(one, int))
    if len(numbers) == len(values):
        return numbers
    if len(values) > 1:
        raise CranktopoError(
            "--misfire worst: looks at every cylinder alone.",
            hint="Give worst once, or numbers of cylinders.",
            code=ExitCode.USAGE,
        )
    return "worst"


def _gives_stiffness(target: Target) -> bool:
    """Tell whether the design gives the stiffness of its throw, so that no elements are needed."""
    shaft = target.scene.shaft
    return target.file is None and shaft is not None and shaft.gives_stiffness


def _check_solved(target: Target, bearings: Bearings | None, size_mm: float | None) -> None:
    options = {"--bearings": bearings, "--element-size-mm": size_mm}
    for option in (name for name, value in options.items() if value is not None and _gives_stiffness(target)):
        raise CranktopoError(
            f"{option}: {_key_of_stiffness(target.scene)} gives the stiffness of a throw, so none is solved.",
            hint=f"Leave out {option}, or that key of '{target.name}'.",
            code=ExitCode.USAGE,
        )


def _studied(
    target: Target, bearings: Bearings, size_mm: float | None, run_up_s: float | None
) -> VibrationStudy:
    scene = target.scene
    if _gives_stiffness(target):
        inertia = _mean(throw_balance(throw).inertia_kg_mm2 for throw in throw_scenes(scene))
        source = target.throw_stiffness_source or _key_of_stiffness(scene)
        return study_vibration(scene, estimated_chain(scene), inertia, source, run_up_s)
    note(f"{target.name}: condensing one throw")
    shaft = evaluate_shaft(target, bearings, size_mm)
    inertia = _mean(shaft.throw_inertias_kg_mm2)
    return study_vibration(scene, _chain(scene, shaft), inertia, stiffness_source(shaft), run_up_s)


def first_frequency_Hz(target: Target, element_size_mm: float | None = None) -> float:
    """Return the first natural frequency that `vibration` tells of a target, on rigid bearings.

    Raises:
        CranktopoError: no engine, a shaft in which nothing swings, or a failed solve.
    """
    shaft = evaluate_shaft(target, "rigid", element_size_mm)
    return first_mode(target.scene, _chain(target.scene, shaft)).frequency_Hz


def _chain(scene: Scene, shaft: ShaftEvaluation) -> ShaftChain:
    return shaft_chain(scene, shaft.throw_inertias_kg_mm2, shaft.stiffness.throws_Nm_per_rad)


def _key_of_stiffness(scene: Scene) -> str:
    one = scene.shaft is not None and scene.shaft.throw_stiffness_Nm_per_rad is not None
    return f"shaft.throw_{'stiffness' if one else 'stiffnesses'}_Nm_per_rad"


def _mean(values: Iterable[float]) -> float:
    """The mean; of equal values the value itself."""
    found = list(values)
    return found[0] if min(found) == max(found) else sum(found) / len(found)


def _write_orders(study: VibrationStudy, path: Path) -> None:
    """One row per speed and order: amplitude of the torque of every section."""
    response = study.response
    speeds, orders = (
        grid.ravel() for grid in np.meshgrid(response.speeds_rpm, response.orders, indexing="ij")
    )
    torque = np.abs(response.torque_Nm).reshape(len(speeds), -1)
    names = [f"{name.replace(' - ', ' to ').replace(' ', '_')}_Nm" for name in study.shaft.sections]
    with replacing(path) as temporary:
        np.savetxt(
            temporary,
            np.column_stack([speeds, orders, torque]),
            fmt="%.8g",
            delimiter=",",
            header=",".join(["speed_rpm", "order", *names]),
            comments="",
        )
