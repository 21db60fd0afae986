"""Quantities of goals and limits: name, units, which way is better, and what it takes to know them.

The only such table: the schema, the command line, the plan and the optimisers look a quantity up here.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass
from math import pi
from typing import Literal

from cranktopo.base.errors import suggest

QuantityName = Literal[
    "mass",
    "inertia",
    "unbalance",
    "balance_factor",
    "torsion",
    "bending",
    "torsion_per_mass",
    "bending_per_mass",
    "pin_displacement",
    "twist",
    "natural_frequency",
    "fatigue_safety",
    "stress",
    "oil_film",
    "bearing_pressure",
]
_Better = Literal["low", "high"]
Optimiser = Literal["density", "shape"]
MOTIONS = {"bending": "pin_displacement", "torsion": "twist"}
"""Motion of each load case's load: the load over the stiffness."""
STIFFNESS_OF = {motion: stiffness for stiffness, motion in MOTIONS.items()}
_DEG_PER_RAD = 180 / pi


@dataclass(frozen=True)
class GoalQuantity:
    """A quantity of the throw that can be wanted.

    Attributes:
        units: units that a limit may have, with their size in the internal one, which comes first.
        better: which way a designer wants it.
        as_goal: whether it may be the goal itself, not only a limit.
        either_limit: whether a limit from below and one from above make sense on their own.
        signed: whether it may be 0 or negative.
        load_case: empty where geometry alone gives it.
        engine_load: whether it depends on the size of the engine's load.
        of_stress: whether it is read off the stresses at fillets and on faces, which cells do not have.
        of_bearings: whether it is of the oil films in the bearings.
        unproven: why no bound is proven with it; empty where one is.
    """

    name: QuantityName
    label: str
    units: Mapping[str, float]
    better: _Better
    as_goal: bool = True
    either_limit: bool = False
    signed: bool = False
    load_case: Literal["", "bending", "torsion"] = ""
    engine_load: bool = False
    of_stress: bool = False
    of_bearings: bool = False
    unproven: str = ""
    optimisers: frozenset[Optimiser] = frozenset({"density", "shape"})

    @property
    def unit(self) -> str:
        """The internal unit; empty for a pure number."""
        return next(iter(self.units))


_TORSION_UNITS = {"N m/rad": 1.0, "kN m/rad": 1e3, "MN m/rad": 1e6, "N m/deg": _DEG_PER_RAD}
_BENDING_UNITS = {"N/mm": 1.0, "kN/mm": 1e3, "N/um": 1e3, "N/m": 1e-3, "MN/m": 1e3}
_STRESS, _FILM = "stress is not part of the proof", "bearings are not part of the proof"

QUANTITIES: dict[QuantityName, GoalQuantity] = {
    quantity.name: quantity
    for quantity in (
        GoalQuantity("mass", "mass", {"kg": 1.0, "g": 1e-3, "t": 1e3}, "low"),
        GoalQuantity(
            "inertia",
            "inertia about the crank axis",
            {"kg mm2": 1.0, "kg cm2": 1e2, "kg m2": 1e6, "g mm2": 1e-3},
            "low",
            either_limit=True,
        ),
        GoalQuantity(
            "unbalance",
            "unbalance",
            {"kg mm": 1.0, "kg m": 1e3, "g mm": 1e-3, "g m": 1.0},
            "low",
            either_limit=True,
            signed=True,
        ),
        GoalQuantity(
            "balance_factor",
            "balance factor, percent of the oscillating mass",
            {"%": 1.0},
            "high",
            either_limit=True,
            signed=True,
            unproven="the masses of the rods are not part of the proof: limit the unbalance",
        ),
        GoalQuantity("torsion", "torsional stiffness", _TORSION_UNITS, "high", load_case="torsion"),
        GoalQuantity("bending", "bending stiffness", _BENDING_UNITS, "high", load_case="bending"),
        GoalQuantity(
            "torsion_per_mass",
            "torsional stiffness per mass",
            {f"{unit}/kg": size for unit, size in _TORSION_UNITS.items()},
            "high",
            load_case="torsion",
        ),
        GoalQuantity(
            "bending_per_mass",
            "bending stiffness per mass",
            {f"{unit}/kg": size for unit, size in _BENDING_UNITS.items()},
            "high",
            load_case="bending",
        ),
        GoalQuantity(
            "pin_displacement",
            "displacement of the crankpin under the largest radial force",
            {"mm": 1.0, "um": 1e-3},
            "low",
            as_goal=False,
            load_case="bending",
            engine_load=True,
        ),
        GoalQuantity(
            "twist",
            "twist of the throw under the largest torque",
            {"deg": 1.0, "rad": _DEG_PER_RAD, "mrad": _DEG_PER_RAD / 1e3},
            "low",
            as_goal=False,
            load_case="torsion",
            engine_load=True,
        ),
        GoalQuantity(
            "natural_frequency",
            "first natural frequency of the shaft in torsion",
            {"Hz": 1.0, "kHz": 1e3, "1/min": 1 / 60},
            "high",
            either_limit=True,
            load_case="torsion",
            unproven="what turns with the throws is not part of the proof",
            optimisers=frozenset({"shape"}),
        ),
        GoalQuantity(
            "fatigue_safety",
            "fatigue safety",
            {"": 1.0},
            "high",
            engine_load=True,
            of_stress=True,
            unproven=_STRESS,
            optimisers=frozenset({"shape"}),
        ),
        GoalQuantity(
            "stress",
            "largest von Mises stress of fillets, outlets and faces",
            {"MPa": 1.0, "N/mm2": 1.0, "GPa": 1e3},
            "low",
            as_goal=False,
            engine_load=True,
            of_stress=True,
            unproven=_STRESS,
            optimisers=frozenset({"shape"}),
        ),
        GoalQuantity(
            "oil_film",
            "least oil film of any bearing over the cycle",
            {"um": 1.0, "mm": 1e3},
            "high",
            as_goal=False,
            engine_load=True,
            of_bearings=True,
            unproven=_FILM,
            optimisers=frozenset({"shape"}),
        ),
        GoalQuantity(
            "bearing_pressure",
            "largest oil-film pressure of any bearing over the cycle",
            {"MPa": 1.0, "bar": 0.1},
            "low",
            as_goal=False,
            engine_load=True,
            of_bearings=True,
            unproven=_FILM,
            optimisers=frozenset({"shape"}),
        ),
    )
}
_MEANT: dict[str, QuantityName] = {
    "weight": "mass",
    "torsional_stiffness": "torsion",
    "bending_stiffness": "bending",
    "safety": "fatigue_safety",
    "displacement": "pin_displacement",
    "rotation": "twist",
    "imbalance": "unbalance",
    "film": "oil_film",
    "film_pressure": "bearing_pressure",
    "frequency": "natural_frequency",
    "von_mises": "stress",
    "torsional_frequency": "natural_frequency",
}
"""Other names of quantities that no likeness of letters finds."""


def quantity_named(name: str) -> GoalQuantity:
    """Return the quantity of a name that is known to be one."""
    return next(quantity for quantity in QUANTITIES.values() if quantity.name == name)


def nearest_quantity(word: str) -> str:
    """Return a sentence that names the quantity which a misspelt word means, or all that there are."""
    plain = word.strip().lower().replace("-", "_").replace(" ", "_")[:100]
    if plain in QUANTITIES or plain in _MEANT:
        return f"Did you mean '{_MEANT.get(plain, plain)}'?"
    return suggest(plain, list(QUANTITIES))


def unit_size(quantity: GoalQuantity, unit: str) -> float | None:
    """Return size of a unit in the quantity's internal one; None for a unit that it cannot have."""
    return next((size for name, size in quantity.units.items() if _plain(name) == _plain(unit)), None)


def _plain(unit: str) -> str:
    """Return a unit without what differs by spelling: `kg·mm²`, `kg*mm^2` and `kg mm2` are the same."""
    unit = re.sub(r"\((\w+)[ *·.](\w+)\)", r"\1/\2", unit)
    for mark in (" ", "\t", "*", "·", "^", "."):
        unit = unit.replace(mark, "")
    for spelling, plain in (("²", "2"), ("µ", "u"), ("μ", "u"), ("°", "deg")):
        unit = unit.replace(spelling, plain)
    return unit
