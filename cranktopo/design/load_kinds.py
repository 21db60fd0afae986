"""Kinds of load cases that a design switches and weighs: one line each."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class LoadKeys:
    """The keys of a kind of load case in `[effects]` and `[optimise.weights]`.

    Attributes:
        meaning: of its switch, in the reference of all keys.
        weight: in the objective, where the design gives none; at 0 the plan leaves it out.
        by_mass: a load of the throw's own mass, listed after the inertia of piston and rod.
        main: it always counts where sizes cannot be compared, and the others are compared with it.
    """

    meaning: str
    weight: float = 0.5
    by_mass: bool = False
    main: bool = False


LOAD_KINDS = {
    "bending": LoadKeys("Load case of the largest radial force.", main=True),
    "torsion": LoadKeys("Load case of the largest torque.", main=True),
    "tangential": LoadKeys("Load case of the force across the throw on the crankpin."),
    "centrifugal": LoadKeys(
        "Load case of the rotating throw's own body force, at the overspeed if one is given.",
        weight=0.0,
        by_mass=True,
    ),
}
"""Load cases in the order in which they are listed; `engine/load_cases/` has a file of the name of each."""
MAIN_KINDS = tuple(name for name, keys in LOAD_KINDS.items() if keys.main)
