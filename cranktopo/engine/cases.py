"""Load cases handed to the optimiser and the evaluation, derived from the engine or unit loads."""

from __future__ import annotations

from cranktopo.design.schema import Scene
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.load_case import MAIN_KINDS, LoadCase, LoadKind
from cranktopo.engine.states import extreme_states

__all__ = ["DEFAULT_EFFECTS", "LoadCase", "LoadKind", "load_cases"]

DEFAULT_EFFECTS = INERTIA_EFFECTS | set(MAIN_KINDS)


def load_cases(scene: Scene, enabled: frozenset[str] | None = None) -> tuple[LoadCase, ...]:
    """Return the load cases of a scene.

    Args:
        scene: the scene; without an engine the cases carry unit loads (1000 N, 1 N m).
        enabled: names of the effects that are on; bending, torsion and the inertia of piston and rod when
            not given.

    Returns:
        One case per kind that is enabled, in the order of `LOAD_TYPES`, named
        after its kind.

    Raises:
        CranktopoError: gas data that cannot be used.
    """
    effects = DEFAULT_EFFECTS if enabled is None else enabled
    states = extreme_states(scene, effects)
    return tuple(state.case for state in states if not state.redundant and state.case.kind in effects)
