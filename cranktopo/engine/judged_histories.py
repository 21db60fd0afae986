"""Load histories that are judged one by one, of every throw and speed.

Joined extremes have no tangential force. Where one counts, few states that bound each throw's cycle are
judged beside them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array, Index
from cranktopo.design.misfire import all_firing
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse, at_speed, engine_of
from cranktopo.engine.bounding_states import bounding_states
from cranktopo.engine.histories import (
    CURVES,
    HistoryKind,
    LoadHistory,
    Loads,
    LoadsName,
    WebLoads,
    cycle_histories,
    extremes_at,
    rated_histories,
    speed_words,
    throw_histories,
)
from cranktopo.engine.judged_speeds import slow_speed_rpm
from cranktopo.engine.states import extreme_states

_WORDS: dict[LoadsName, str] = {
    "extremes": "the extremes of the loads joined",
    "cycle": "every angle of the cycle",
    "shaft": "every angle of the cycle in the shaft on all its bearings",
}


def states_words(loads: LoadsName) -> str:
    """Return load states in words, to stand behind a safety as in `0.642 over every angle of the cycle`."""
    return f"over {_WORDS[loads]}"


def histories_of(scene: Scene, loads: Loads, enabled: frozenset[str]) -> Sequence[LoadHistory]:
    """Return the load histories that are judged one by one; errors as of `load_history`."""
    return [one for of_speed in histories_by_speed(scene, loads, enabled) for one in of_speed]


def histories_by_speed(
    scene: Scene, loads: Loads, enabled: frozenset[str]
) -> tuple[Sequence[LoadHistory], ...]:
    """Return the histories of the engine's speed, then of its overspeed and of its `slow_speed_rpm`, if any.

    The pull of the masses grows with the square of the speed, and at low speed they take less off the gas.
    The rule of a classification society judges the first alone. Those of webs in their shaft belong together,
    whatever their speeds.
    """
    if isinstance(loads, WebLoads):
        return (loads.histories,)
    rated, engine = [*rated_histories(scene, loads, enabled)], engine_of(scene)
    if loads == "extremes" and counts_tangential(scene, loads, enabled):
        rated += _bounding(cycle_histories(scene, enabled))
    further = [*engine.own_speeds_rpm[1:], slow_speed_rpm(scene, enabled)]
    return rated, *(_at_further_speed(scene, rpm, loads, enabled) for rpm in further if rpm is not None)


def _at_further_speed(
    scene: Scene, speed_rpm: float, kind: HistoryKind, enabled: frozenset[str]
) -> list[LoadHistory]:
    """Return the histories of another speed; extremes of a vibrating shaft join the torques of all speeds."""
    at = at_speed(all_firing(scene), speed_rpm)
    if kind == "cycle":
        found = throw_histories(at, enabled)
    else:
        loaded = scene if "torsional_vibration" in enabled else at
        extremes = extreme_states(all_firing(loaded), enabled)
        found = [extremes_at(at, extremes, enabled)]
        if counts_tangential(at, kind, enabled):
            found += _bounding(throw_histories(at, enabled))
    return [
        replace(one, labels=tuple(f"{label}{speed_words(speed_rpm)}" for label in one.labels))
        for one in found
    ]


def counts_tangential(scene: Scene, kind: HistoryKind, enabled: frozenset[str]) -> bool:
    """Tell whether the histories have a tangential force: it needs the effect, and a cycle that is known."""
    if "tangential" not in enabled or scene.engine is None:
        return False
    return kind == "cycle" or analyse(scene, enabled).cycle is not None


def counts_swing(scene: Scene, loads: Loads, enabled: frozenset[str]) -> bool:
    """Tell whether in the histories the mass of a throw pushes that swings with the shaft."""
    if isinstance(loads, WebLoads):
        return any(one.swing_Nm is not None for one in loads.histories)
    if not {"torsional_vibration", "torsion"} <= enabled:
        return False
    return loads == "cycle" or counts_tangential(scene, loads, enabled)


def _bounding(cycles: Sequence[LoadHistory]) -> list[LoadHistory]:
    """Return of each cycle the few states that bound it."""
    return [_states(one, _bound(one)) for one in cycles]


def _bound(history: LoadHistory) -> Index:
    """Return states that bound a cycle; of a throw that swings by the torque between its ends and at each."""
    ends = (0.0,) if history.swing_Nm is None else (-0.5, 0.0, 0.5)
    found = [bounding_states(_loads(history, end)) for end in ends]
    return np.unique(np.concatenate(found))


def _loads(history: LoadHistory, end: float) -> Array:
    torque = history.torque_Nm + end * history.own_swing_Nm
    return np.stack([history.radial_N, history.tangential_N, torque], axis=1)


def _states(history: LoadHistory, numbers: Index) -> LoadHistory:
    kept = {name: getattr(history, name)[numbers] for name in CURVES}
    return LoadHistory(
        **kept,
        labels=tuple(history.labels[number] for number in numbers),
        swing_Nm=None if history.swing_Nm is None else history.swing_Nm[numbers],
    )
