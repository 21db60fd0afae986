"""Natural vibrations of a target's whole crankshaft, at rest and over speed, and their page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.files import as_path_if_any
from cranktopo.base.notes import note
from cranktopo.bodies.memory import check_element_size
from cranktopo.design.assumed import CARRIED, filter_by_table
from cranktopo.design.checks.engine import speed_range_rpm
from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import ShaftTable
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.bearings import required_bearing_spring_N_per_mm
from cranktopo.engine.vibration.shaft_chain import ShaftChain, moving_inertia_kg_mm2, shaft_chain
from cranktopo.engine.vibration.steady import ORDERS
from cranktopo.numerics.disk_chain import DiskChain
from cranktopo.numerics.section_shapes import SectionShapes
from cranktopo.numerics.turning_body import FreeModes, modes_at_rest
from cranktopo.report.report_file import check_report_path, write_report
from cranktopo.runs.manifest import timestamp
from cranktopo.tasks.modes.campbell import OverSpeed, crossings, over_speed
from cranktopo.tasks.modes.carried import without_mass
from cranktopo.tasks.modes.kinds import energy_shares, kind_of, station_motions
from cranktopo.tasks.modes.likeness import counterparts, likeness, sharing
from cranktopo.tasks.modes.page import modes_page
from cranktopo.tasks.modes.reduced_throw import ReducedThrow, reduced_throw, section_shapes
from cranktopo.tasks.modes.result import CriticalCrossing, ShaftMode, ShaftModes, SharedDisks
from cranktopo.tasks.modes.shaft_model import ShaftModel, shaft_model
from cranktopo.tasks.shaft.assembly import Bearings
from cranktopo.tasks.shaft.condensed_throw import once_each
from cranktopo.tasks.shaft.loaded_throw import ThrowBody, throw_body
from cranktopo.tasks.shaft.result import ShaftEvaluation
from cranktopo.tasks.shaft.stage import evaluate_shaft, shaft_tables, throw_targets
from cranktopo.tasks.throw_fea.evaluation import mesh_target
from cranktopo.tasks.throw_fea.targets import Target, TargetLike, resolve_target

STEPS = 2
"""Steps of the reduction: the second one tells what the first leaves out."""
_MODES = 10
_DISKS_TOLD = 3
"""Frequencies of torsion that a damper with fluid changes most."""
_SPEEDS = 21
"""Over the design's own range."""


def shaft_modes(
    target: TargetLike,
    bearings: Bearings = "rigid",
    element_size_mm: float | None = None,
    *,
    speeds_rpm: Sequence[float] = (),
    report: Path | str | None = None,
) -> ShaftModes:
    """Return the first natural vibrations of a whole crankshaft on its bearings.

    Args:
        target: a design, a run, or an STL or STEP file of the half throw.
        speeds_rpm: rising speeds of the Campbell diagram; by default over the design's range.
        report: page to write, HTML or Markdown.

    Raises:
        CranktopoError: no engine, no bearing spring for "spring", a failed solve, or a file that cannot be
            written.
    """
    report = as_path_if_any(report)
    if report is not None:
        check_report_path(report)
    resolved = resolve_target(target, whole=True, crank=True)
    scene = resolved.scene
    _ = scene.shaft_angles_deg  # refuses a scene without an engine before anything is solved
    spring = required_bearing_spring_N_per_mm(scene) if bearings == "spring" else 0.0
    size = element_size_mm or default_element_size_mm(scene)
    check_element_size(scene, size)
    throws = throw_targets(resolved)
    bodies = {one.name: throw_body(mesh_target(one, size), one.scene) for one in dict.fromkeys(throws)}
    static = evaluate_shaft(resolved, bearings, size, bodies=bodies)
    model = shaft_model(_reduced(throws, bodies, section_shapes(scene)), scene, bearings, spring)
    speeds = tuple(speeds_rpm) or tuple(np.linspace(*speed_range_rpm(scene), _SPEEDS).tolist())
    found = _result(resolved, static, model, speeds)
    if report is not None:
        write_report(modes_page(found, timestamp()[:10]), report)
        note(str(report))
    return found


def _reduced(
    throws: Sequence[Target], bodies: dict[str, ThrowBody], shapes: SectionShapes
) -> list[ReducedThrow]:
    """Return the throws with their mass."""
    return once_each(
        throws,
        lambda one: reduced_throw(bodies[one.name], one.scene, shapes, STEPS, moving_kg(one.scene)),
    )


def moving_kg(scene: Scene) -> float:
    """Mass of rods and pistons on a crankpin: the rotating one and half the reciprocating one."""
    return moving_inertia_kg_mm2(scene) / scene.throw.radius_mm**2


def _result(
    target: Target, static: ShaftEvaluation, model: ShaftModel, speeds: tuple[float, ...]
) -> ShaftModes:
    scene, rest, fewer = target.scene, modes_at_rest(model.body), _one_step_less(model)
    count = min(_MODES, len(rest.frequency_Hz) - rest.rigid)
    shaft = shaft_chain(scene, static.throw_inertias_kg_mm2, static.stiffness.throws_Nm_per_rad)
    disks_Hz, shared = _of_disks(model, rest, shaft, count)
    moved = over_speed(model.body, rest, count, speeds)
    modes = []
    for number in range(count):
        mode = _mode(number, scene, model, rest, fewer, moved, speeds)
        modes.append(mode.model_copy(update={"disks_Hz": disks_Hz.get(number)}))
    tables = (*shaft_tables(scene, static.bearings), *CARRIED)
    return ShaftModes(
        design=target.name,
        bearings=static.bearings,
        speeds_rpm=speeds,
        rigid_motions=rest.rigid,
        highest_order=float(_orders(scene)[-1]),
        unknowns=len(model.step_of),
        steps=STEPS,
        stiffness_error_percent=static.error_percent,
        modes=tuple(modes),
        disks_shared=shared,
        torsion_only=without_mass(scene.shaft or ShaftTable()),
        disks_with_fluid_Hz=_with_fluid(scene, shaft.chain),
        assumed=filter_by_table(target.assumed, tables),
    )


def _of_disks(
    model: ShaftModel, rest: FreeModes, shaft: ShaftChain, count: int
) -> tuple[dict[int, float], tuple[SharedDisks, ...]]:
    """Return the frequency by disks of each of the first modes that has one, and what several share."""
    disks = shaft.chain.modes()
    if not disks:
        return {}, ()
    shapes, square = np.stack([mode.shape for mode in disks], axis=1), rest.frequency_Hz[rest.rigid :] ** 2
    alike = likeness(model.stations, shaft, shapes, rest.shape[:, rest.rigid :], square)
    pairs = counterparts(alike, count)
    shared = tuple(
        SharedDisks(
            disks_Hz=disks[disk].frequency_Hz,
            modes=tuple(number + 1 for number in among),
            shares_percent=tuple(100 * float(alike[disk, number]) for number in among),
        )
        for disk, among in sharing(alike, count, pairs).items()
    )
    return {body: disks[disk].frequency_Hz for disk, body in pairs.items()}, shared


def _with_fluid(scene: Scene, chain: DiskChain) -> tuple[float, ...]:
    """Torsion by disks with all damping, Hz, where a damper has a fluid: the modes leave it out."""
    damper = scene.shaft.damper if scene.shaft else None
    if damper is None or not damper.damping_Nms_per_rad:
        return ()
    return tuple(float(mode.frequency_Hz) for mode in chain.damped_modes()[:_DISKS_TOLD])


def _one_step_less(model: ShaftModel) -> FreeModes:
    return modes_at_rest(model.without_step(STEPS).body)


def _mode(
    number: int,
    scene: Scene,
    model: ShaftModel,
    rest: FreeModes,
    fewer: FreeModes,
    moved: OverSpeed,
    speeds: tuple[float, ...],
) -> ShaftMode:
    at = rest.rigid + number
    frequency, shape = float(rest.frequency_Hz[at]), rest.shape[:, at]
    shares = energy_shares(model.stations, shape)
    crossed = crossings(np.array(speeds), moved.frequency_Hz[number], _orders(scene))
    return ShaftMode(
        mode=number + 1,
        frequency_Hz=frequency,
        kind=kind_of(shares),
        shares_percent=shares,
        disks_Hz=None,
        last_step_percent=100 * (frequency / float(fewer.frequency_Hz[at]) - 1),
        frequencies_Hz=tuple(moved.frequency_Hz[number].tolist()),
        whirl=tuple(moved.whirl[number].tolist()),
        critical_speeds=tuple(CriticalCrossing(speed_rpm=s, order=o) for s, o in crossed),
        shape=station_motions((*model.sections, *model.stations), shape, scene.throw.radius_mm),
    )


def _orders(scene: Scene) -> Array:
    """Orders of forces that repeat with the working cycle, as torsional vibration has them."""
    return np.arange(1.0, ORDERS + 1) * 360.0 / engine_of(scene).cycle_deg
