"""Least fatigue safety of a target: its unit loads solved once, every load history judged by itself."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from functools import reduce

import numpy as np

from cranktopo.base.arrays import Array, Index
from cranktopo.base.notes import note
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow
from cranktopo.engine.histories import HistoryKind, LoadHistory, WebLoads
from cranktopo.engine.judged_histories import histories_of, states_words
from cranktopo.tasks.fatigue.criteria import check_method, safety_method
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.throw_fatigue.needs import load_kinds
from cranktopo.tasks.throw_fatigue.result import CriticalPoint
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField, point_safety, safety_field, unit_loads
from cranktopo.tasks.throw_fatigue.spectrum import counts_lives, part_lives, speed_histories
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fea.targets import Target


def fatigue_field(
    target: Target,
    method: str,
    kind: HistoryKind = "extremes",
    fillet_fraction: float = RULE_FRACTION,
    meshed: MeshedThrow | None = None,
) -> FatigueField:
    """Fatigue safety of a throw by a method of local stresses, without the lives by its spectrum.

    Args:
        meshed: as in `solve_stresses`.

    Raises:
        CranktopoError: missing material data or loads, sharp fillets, or a failed solve.
    """
    return _fields(target, (method,), kind, fillet_fraction, lives=False, meshed=meshed)[0]


def fatigue_fields(
    target: Target, methods: Sequence[str], kind: HistoryKind, fillet_fraction: float
) -> tuple[FatigueField, ...]:
    """Return the safety of a throw by each of several methods, and the lives where its scene has a spectrum.

    Its unit loads are solved once.

    Raises:
        CranktopoError: missing material data or loads, sharp fillets, or a failed solve.
    """
    return _fields(target, methods, kind, fillet_fraction, lives=True)


def web_field(
    target: Target, method: str, loads: WebLoads, fillet_fraction: float = RULE_FRACTION
) -> FatigueField:
    """Return the least safety of every place of a web under its loads, each judged by itself.

    Raises:
        CranktopoError: missing material data, sharp fillets, or a failed solve.
    """
    check_method(target.scene, method)
    model = solve_stresses(target, load_kinds(target.scene, loads)[1], fillet_fraction)
    own = replace(model, images=tuple(image for image in model.images if not image.flip_z))
    return least_field(safety_field(own, method, history) for history in loads.histories)


def _fields(
    target: Target,
    methods: Sequence[str],
    kind: HistoryKind,
    fillet_fraction: float,
    *,
    lives: bool,
    meshed: MeshedThrow | None = None,
) -> tuple[FatigueField, ...]:
    for method in methods:
        check_method(target.scene, method)
    lived = lives and any(counts_lives(target.scene, safety_method(method)) for method in methods)
    enabled, kinds = load_kinds(target.scene, "cycle" if lived else kind)
    judged = histories_of(target.scene, kind, enabled)
    speeds = speed_histories(target.scene, enabled) if lived else []
    states = sum(len(one.labels) for one in judged)
    note(f"{target.name}: unit loads {', '.join(kinds)} for {states} load states, {states_words(kind)}")
    model = solve_stresses(target, kinds, fillet_fraction, meshed=meshed)
    fields = tuple(least_field(safety_field(model, method, one) for one in judged) for method in methods)
    return tuple(with_lives(one, speeds) for one in fields) if lived else fields


def with_lives(field: FatigueField, speeds: Sequence[Sequence[LoadHistory]]) -> FatigueField:
    """Return the field with the lives of its parts, where the scene has a spectrum."""
    model = field.model
    if not counts_lives(model.scene, safety_method(field.method)):
        return field

    def judged(local: LocalStress, nodes: Index) -> Array:
        return point_safety(model, field.method, local, nodes)

    def loads_of(history: LoadHistory) -> Array:
        return unit_loads(history, model.kinds)

    return replace(field, lives=part_lives(model, field.safety, judged, loads_of, speeds))


def least_field(fields: Iterable[FatigueField]) -> FatigueField:
    """Return the least safety of every place of a model by a method, over histories judged one by one."""
    return reduce(_less_safe, fields)


def _less_safe(one: FatigueField, other: FatigueField) -> FatigueField:
    worst, mild = sorted((one, other), key=lambda found: found.critical.safety)
    lower = mild.safety < worst.safety

    def of_nodes(name: str) -> Array:
        return np.where(lower, getattr(mild, name), getattr(worst, name))

    return replace(
        worst,
        labels=one.labels + other.labels,
        safety=of_nodes("safety"),
        amplitude_MPa=of_nodes("amplitude_MPa"),
        mean_MPa=of_nodes("mean_MPa"),
        at_sharp_edges=_less_safe_point(worst.at_sharp_edges, mild.at_sharp_edges),
        at_outlet=_less_safe_point(worst.at_outlet, mild.at_outlet),
        fillet_safety={part: min(s, mild.fillet_safety[part]) for part, s in worst.fillet_safety.items()},
        web_safety={web: min(s, mild.web_safety[web]) for web, s in worst.web_safety.items()},
        hardening={
            name: min(found, mild.hardening[name], key=lambda fillet: fillet.safety)
            for name, found in worst.hardening.items()
        },
        scatter={
            name: min(found, mild.scatter[name], key=lambda point: point.reliability_index)
            for name, found in worst.scatter.items()
        },
    )


def _less_safe_point(one: CriticalPoint | None, other: CriticalPoint | None) -> CriticalPoint | None:
    """Return the less safe of two points; of a model that has no such place neither is known."""
    return None if one is None or other is None else min(one, other, key=lambda point: point.safety)
