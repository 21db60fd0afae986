"""Load cases handed to the optimiser and the evaluation, derived from the engine or unit loads."""

from __future__ import annotations

from cranktopo.design.schema import Scene
from cranktopo.engine.load_case import LoadCase, LoadKind
from cranktopo.engine.states import extreme_states

__all__ = ["DEFAULT_EFFECTS", "LoadCase", "LoadKind", "load_cases"]

DEFAULT_EFFECTS = frozenset({"bending", "torsion", "reciprocating_inertia", "rotating_rod_mass"})


def load_cases(scene: Scene, enabled: frozenset[str] | None = None) -> tuple[LoadCase, ...]:
    """The load cases of a scene.

    Args:
        scene: the scene; without an engine the cases carry unit loads (1000 N, 1 N m).
        enabled: names of the effects that are on; bending, torsion and the inertia of piston and rod when
            not given.

    Returns:
        One case per kind that is enabled, in the order bending, torsion, tangential, centrifugal, named
        after its kind.

    Raises:
        CranktopoError: gas data that cannot be used.
    """
    effects = DEFAULT_EFFECTS if enabled is None else enabled
    states = extreme_states(scene, effects)
    return tuple(state.case for state in states if not state.redundant and state.case.kind in effects)
