"""Extreme load states over the cycle, which of them become load cases, and why the others need none.

The optimiser minimises the compliance of a linear structure. Multiplying a case by a factor multiplies its
compliance by the square of it and leaves the best shape as it is, so a state whose loads are a multiple of
another's needs no case of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from cranktopo.design.load_kinds import LOAD_KINDS, MAIN_KINDS
from cranktopo.design.misfire import all_firing
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import LoadAnalysis, analyse, at_extreme_speeds, at_speed
from cranktopo.engine.extreme_state import ExtremeState, ThrowLoads
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.load_case import LoadCase, LoadKind
from cranktopo.engine.load_type import load_types


def extreme_states(scene: Scene, enabled: frozenset[str]) -> tuple[ExtremeState, ...]:
    """Return the extreme states of a scene, those that become load cases in the order of their kinds.

    All cylinders fire, also where `engine.misfire` names some that do not.

    Args:
        enabled: names of the effects that are on; the inertia effects change the forces, without
            `centrifugal` the overspeed state acts on the pin alone, and with `torsional_vibration` the
            torques are those of the vibrating shaft, each at the speed where it is worst.
    """
    kinds = load_types()
    if scene.engine is None:
        why = "unit load: the scene has no engine"
        return tuple(kind.unit_state(why) for kind in kinds if kind.unit_load)
    scene = all_firing(scene)
    analyses = tuple(analyse(at, enabled) for at in at_extreme_speeds(scene, enabled))
    throw = ThrowLoads(scene, analyses, _at_top_speed(scene, analyses[0], enabled), enabled)
    return _mark_redundant(tuple(state for kind in kinds for state in kind.states(throw)))


def _at_top_speed(scene: Scene, rated: LoadAnalysis, enabled: frozenset[str]) -> LoadAnalysis:
    """Return the loads at the overspeed, those at the engine's speed where it has none above it.

    No torque is taken of them: a vibrating shaft is not solved once more.
    """
    overspeed = rated.engine.overspeed_rpm
    if overspeed is None or overspeed <= rated.engine.speed_rpm:
        return rated
    return analyse(at_speed(scene, overspeed), enabled - {"torsional_vibration"})


def _mark_redundant(states: tuple[ExtremeState, ...]) -> tuple[ExtremeState, ...]:
    """Keep the largest state of each kind as the load case; the others are multiples of it."""
    marked = []
    for state in states:
        rival = max((s for s in states if s.case.kind == state.case.kind), key=lambda s: abs(s.case.size))
        if rival is not state:
            factor = state.case.size / rival.case.size if rival.case.size else 0.0
            why = (
                f"{factor:+z.3f} times {rival.name}: a linear structure has the same best shape, and "
                f"{100 * factor**2:.1f} % of its compliance"
            )
            state = replace(state, redundant=why)
        marked.append(state)
    order = list(LOAD_KINDS)
    return tuple(sorted(marked, key=lambda s: (bool(s.redundant), order.index(s.case.kind))))


def governing(states: Sequence[ExtremeState], kind: str) -> ExtremeState:
    """Return the state that is the load case of a kind."""
    return next(state for state in states if state.case.kind == kind and not state.redundant)


__all__ = [
    "DEFAULT_EFFECTS",
    "ExtremeState",
    "LoadCase",
    "LoadKind",
    "extreme_states",
    "governing",
    "load_cases",
    "main_load_cases",
]

DEFAULT_EFFECTS = INERTIA_EFFECTS | set(MAIN_KINDS)


def load_cases(scene: DesignLike, enabled: frozenset[str] | None = None) -> tuple[LoadCase, ...]:
    """Return the load cases of a scene, one per kind that is enabled, in the order of `LOAD_KINDS`.

    Args:
        scene: the scene; without an engine the cases carry unit loads (1000 N, 1 N m).
        enabled: names of the effects that are on; bending, torsion and the inertia of piston and rod when
            not given.

    Raises:
        CranktopoError: gas data that cannot be used.
    """
    scene = as_scene(scene)
    effects = DEFAULT_EFFECTS if enabled is None else enabled
    states = extreme_states(scene, effects)
    return tuple(state.case for state in states if not state.redundant and state.case.kind in effects)


def main_load_cases(scene: Scene, enabled: frozenset[str]) -> tuple[LoadCase, ...]:
    """Return the load cases of bending and torsion with the other effects as they are, inertia for one.

    Stiffness is read off these two; a bound of it or a search for it needs no other.
    """
    return load_cases(scene, enabled - set(LOAD_KINDS) | set(MAIN_KINDS))
