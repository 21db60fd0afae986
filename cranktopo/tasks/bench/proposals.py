"""Changes that answer a wish: a balance factor, a pitch that stays, a rod; pure functions of the tables."""

from __future__ import annotations

import math
from itertools import product
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.design.edits import changed_data
from cranktopo.design.free_dimensions import DIMENSIONS, free_key, journal_of, key_of
from cranktopo.design.loading import scene_from_dict, value_at
from cranktopo.design.pitch import lengths_at_pitch
from cranktopo.design.starting_rod import starting_rod
from cranktopo.engine.gas import pressure_curve
from cranktopo.tasks.balance.proposal import ProposedCounterweight, propose_counterweight
from cranktopo.tasks.bench.live import violated_rules_of
from cranktopo.throw.envelope import BoxEnvelope

_HALVINGS, _STEPS = 12, 100
_RANGES = (0.3, 0.2, 0.1, 0.0)
"""Widths of a range below and above the design's own value that are tried, over that value; of a bore over
the radius of its journal."""


def counterweight_changes(data: dict[str, Any], percent: float) -> dict[str, Any]:
    """Return changes by which a throw balances a share of its oscillating mass, percent.

    A box of design space is enlarged where it has no room for the counterweight.

    Raises:
        CranktopoError: no such counterweight, or no place for it.
    """
    scene = scene_from_dict(data, "design", whole=True)
    found = propose_counterweight(scene, percent)
    changes = {
        "web.counterweight.outer_radius_mm": found.outer_radius_mm,
        "web.counterweight.half_angle_deg": found.half_angle_deg,
        "engine.arrangement.balanced_oscillating_share": found.share_percent / 100,
    }
    if found.refused and isinstance(scene.envelope, BoxEnvelope):
        changes |= _room(scene.envelope, found)
    scene_from_dict(changed_data(data, changes), "design", whole=True)
    return changes


def rod_changes(data: dict[str, Any]) -> dict[str, Any]:
    """Return a connecting rod of usual proportions for the engine and the crankpin of a design.

    Raises:
        CranktopoError: there is no engine, or such a rod does not fit.
    """
    scene = scene_from_dict(data, "design", whole=True)
    engine, pin = scene.engine, scene.throw.crankpin
    if engine is None:
        raise CranktopoError("rod: takes its size from the engine, which is missing.", hint="Add the engine.")
    values: dict[str, Any] = {
        "engine.bore_mm": engine.bore_mm,
        "engine.rod_length_mm": engine.rod_length_mm,
        "throw.crankpin.outer_diameter_mm": pin.outer_diameter_mm,
        "throw.crankpin.length_mm": pin.length_mm,
        "throw.crankpin.fillet_mm": pin.fillet_mm,
    }
    if engine.arrangement is not None:
        values["engine.arrangement.layout"] = engine.arrangement.layout
        values["engine.arrangement.bank_angles_deg"] = engine.arrangement.bank_angles_deg or ()
    changes = starting_rod(values)
    scene_from_dict(changed_data(data, changes), "design", whole=True)
    return changes


def freed_changes(data: dict[str, Any], key: str) -> dict[str, Any]:
    """Return the change that gives `shape` a dimension to change, in the widest range that the rules allow.

    Raises:
        CranktopoError: no such dimension, or the rules refuse every range: what is wrong with the narrowest.
    """
    scene = scene_from_dict(data, "design", whole=True)
    names = {key_of(name): name for name in DIMENSIONS}
    if key not in names:
        raise CranktopoError("free: shape can be given no range of this dimension.")
    name, own = names[key], float(value_at(data, key) or 0.0)
    size = journal_of(scene, name).radius_mm if name.endswith("bore") else own
    refused: list[dict[str, str]] = []
    for below, above in [*product(_RANGES, _RANGES)][:-1]:  # the last has no width
        least, most = max(0.0, own - below * size), own + above * size
        changes = {f"shape.free.{free_key(name)}": [round(least, 2), round(most, 2)]}
        if not (refused := violated_rules_of(changed_data(data, changes))):
            return changes
    raise CranktopoError(refused[0]["message"])


def trace_changes(data: dict[str, Any], path: str) -> dict[str, Any]:
    """Return changes by which a sound pressure trace takes the place of a peak."""
    changes = {
        "engine.gas.indicator_csv": path,
        "engine.gas.peak_pressure_MPa": None,
        "engine.gas.peak_angle_deg": None,
    }
    pressure_curve(scene_from_dict(changed_data(data, changes), "design", whole=True))
    return changes


def nearest_sound(data: dict[str, Any], changes: dict[str, float]) -> dict[str, float]:
    """Return a change of one number as near to what is wanted as the rules allow, from a sound design on.

    To a hundredth; sound is what lies before the first rule that is broken on the way. Nothing where the
    next hundredth breaks one.
    """
    ((key, target),) = changes.items()
    begun = float(value_at(data, key))
    sound, unsound = 0.0, 1.0
    for _ in range(_HALVINGS):
        middle = (sound + unsound) / 2
        kept = not violated_rules_of(changed_data(data, {key: _on_way(begun, target, middle)}))
        sound, unsound = (middle, unsound) if kept else (sound, middle)
    found = _on_way(begun, target, sound)
    return {} if found == begun else {key: found}


def _on_way(begun: float, target: float, share: float) -> float:
    """Return the value at a share of the way, rounded to a hundredth back to where that begins."""
    steps = (begun + share * (target - begun)) * _STEPS
    back = math.floor if target > begun else math.ceil
    return begun if share == 0 else back(round(steps, 6)) / _STEPS


def with_pitch_kept(data: dict[str, Any], changes: dict[str, Any]) -> dict[str, Any]:
    """Return changes, and the lengths of main journals at which the throws stay as far apart."""
    changed = scene_from_dict(changed_data(data, changes), "design")
    pitch = scene_from_dict(data, "design").pitch_mm
    return (
        changes if math.isclose(changed.pitch_mm, pitch) else {**changes, **lengths_at_pitch(changed, pitch)}
    )


def _room(box: BoxEnvelope, proposed: ProposedCounterweight) -> dict[str, Any]:
    radius, turn = proposed.outer_radius_mm, math.radians(min(proposed.half_angle_deg, 90.0))
    room = {
        "envelope.half_width_mm": (box.half_width_mm, radius * math.sin(turn)),
        "envelope.y_min_mm": (-box.y_min_mm, radius),
    }
    lengths = {key: math.ceil(need) for key, (has, need) in room.items() if need > has}
    return {key: -length if key.endswith("y_min_mm") else length for key, length in lengths.items()}
