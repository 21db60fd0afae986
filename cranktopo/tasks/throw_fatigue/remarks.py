"""Lines on what a fatigue assessment rests on: its mesh, what is not counted, stresses beyond yielding."""

from __future__ import annotations

import re
from collections.abc import Sequence

from cranktopo.base.notes import note, warn
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import joins_extremes, speed_words
from cranktopo.engine.judged_speeds import slow_speed_rpm
from cranktopo.engine.plan.planning import plan_for_stress
from cranktopo.engine.vibration.vibrating_shaft import extreme_speeds_rpm
from cranktopo.tasks.fatigue.criterion import larger_end_MPa
from cranktopo.tasks.throw_fatigue.cut_outlets import judged_places
from cranktopo.tasks.throw_fatigue.result import CriticalPoint
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.stress_model import StressModel

_EFFECT = "torsional_vibration"
_RPM = re.compile(r"(\d+) rpm")
"""Speed in the label of a load state."""


def note_quality(field: FatigueField) -> None:
    """Tell in a line each where the mesh decides; outlets that are not judged stand in results."""
    for remark in _mesh_remarks(field):
        note(f"note: {field.model.name}: {remark}")


def quality_remarks(field: FatigueField) -> tuple[str, ...]:
    """Return where means miss the rule's checks of a mesh, and which places are not counted or judged."""
    return (*_mesh_remarks(field), *filter(None, [cut_outlet_words(field.model)]))


def _mesh_remarks(field: FatigueField) -> tuple[str, ...]:
    missed, sharp = mesh_shortfall(field.model), field.at_sharp_edges
    lower = sharp is not None and sharp.safety < field.critical.safety
    return (
        *([f"{missed}; a smaller --fillet-fraction of `fatigue` may help."] if missed else []),
        *([_sharp_words(sharp)] if sharp is not None and lower else []),
    )


def _sharp_words(sharp: CriticalPoint) -> str:
    return (
        f"{sharp.safety:.3f} at a sharp inner edge ({sharp.place}) is not counted: it falls with every finer "
        "mesh. Give the edge a radius."
    )


def further_speed_words(field: FatigueField) -> str:
    """Return that the least safety is that at the overspeed or at the slow speed; empty where it is not."""
    scene, state = field.model.scene, field.critical.states[0]
    where = next((words for rpm, words in _further_speeds(scene) if state.endswith(speed_words(rpm))), "")
    if not where:
        return ""
    torques = _torque_speeds(scene) if joins_extremes(state) else ""
    beside = f", with the vibrating shaft's largest and smallest torque, of {torques} rpm" if torques else ""
    return f"the least safety is that at {where}{beside}."


def _further_speeds(scene: Scene) -> list[tuple[float, str]]:
    """Return the speeds that are judged beside the engine's own, with their words."""
    engine = scene.engine
    if engine is None:
        return []
    found = [(rpm, f"the overspeed of {rpm:g} rpm") for rpm in engine.own_speeds_rpm[1:]]
    slow = slow_speed_rpm(scene, plan_for_stress(scene).enabled)
    if slow is None or engine.gas is None:
        return found
    taken = "" if engine.gas.map else f" (with the pressure of {engine.speed_rpm:g} rpm)"
    words = f"{slow:g} rpm, the slower speed at which gas less inertia pushes hardest{taken}"
    return [*found, (slow, words)]


def deciding_speed_words(field: FatigueField) -> str:
    """Return the speed of the states that decide, where no further one does; empty where one is judged."""
    judged = {rpm for label in field.labels for rpm in _RPM.findall(label)}
    deciding = dict.fromkeys(rpm for label in field.critical.states for rpm in _RPM.findall(label))
    if not deciding:
        return _joined_torque_words(field.model.scene)
    if len(judged) < 2:
        return ""
    return f"decided at {' and '.join(deciding)} rpm, of {len(judged)} speeds that are judged."


def _joined_torque_words(scene: Scene) -> str:
    """Return the speeds of the torques of joined extremes; empty where all are of the engine's speed."""
    speeds = _torque_speeds(scene)
    if not speeds:
        return ""
    return f"joined extremes decide, with the vibrating shaft's largest and smallest torque, of {speeds} rpm."


def _torque_speeds(scene: Scene) -> str:
    """Return the speeds of a vibrating shaft's largest and smallest torque; empty where none vibrates."""
    enabled = plan_for_stress(scene).enabled
    if scene.engine is None or _EFFECT not in enabled:
        return ""
    return " and ".join(f"{rpm:.0f}" for rpm in extreme_speeds_rpm(scene, enabled))


def vibration_sets_words(fields: Sequence[FatigueField]) -> str:
    """Return which targets are judged with and without torsional vibration; empty where all are alike."""
    sets: dict[bool, list[str]] = {True: [], False: []}
    for field in fields:
        scene = field.model.scene
        if len(fields) > 1 and scene.engine is not None:
            sets[_EFFECT in plan_for_stress(scene).enabled].append(field.model.name)
    if not sets[True] or not sets[False]:
        return ""
    return (
        f"Not judged over the same loads: {' and '.join(sets[True])} with torsional vibration, at the speeds "
        f"where the shaft's torque is largest; {' and '.join(sets[False])} without, at the engine's. "
        f'[effects] {_EFFECT} = "on" or "off" in all of them makes them alike.'
    )


def safety_remarks(field: FatigueField) -> list[str]:
    """Return all that stands beside a least safety: the speed that decides, and `quality_remarks`."""
    return [*filter(None, [further_speed_words(field)]), *quality_remarks(field)]


def mesh_shortfall(model: StressModel) -> str:
    """Return the rule's checks that the mesh of a model misses, else nothing."""
    return "" if model.quality.within_limits else model.quality.shortfall


def cut_outlet_words(model: StressModel) -> str:
    """Return that outlets are not judged because the model ends in them; empty where none is."""
    if not model.at_cut.any():
        return ""
    return (
        "the oil outlet in the middle of the main journal is not judged: the throw is cut there. "
        f"{judged_places(model.scene, model.whole)}"
    )


def note_yielding(field: FatigueField, yield_MPa: float | None) -> None:
    """Warn of a stress that no material carries: the loads, a dimension or a unit may be wrong."""
    if line := yield_warning(field, yield_MPa):
        warn(line)


def yield_warning(field: FatigueField, yield_MPa: float | None) -> str:
    """Return a line on a stress above the yield strength; empty where there is none."""
    place = field.critical
    largest = larger_end_MPa(place.amplitude_MPa, place.mean_MPa)
    if yield_MPa is None or largest <= yield_MPa:
        return ""
    return (
        f"{field.model.name}: {largest:.0f} MPa by linear elasticity at {place.place}, "
        f"{largest / yield_MPa:.1f} times the yield strength of {yield_MPa:g} MPa: the material yields, "
        "and no safety here holds. Check loads, dimensions and units."
    )
