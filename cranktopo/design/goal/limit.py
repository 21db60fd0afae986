"""A goal and its limits, how a limit is read off its text, and the scene's table `[goal]`."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import partial
from typing import Annotated, Any, Literal, Self, get_args

from pydantic import BeforeValidator, Field, ValidationInfo, WithJsonSchema, field_validator, model_validator
from pydantic_core import PydanticCustomError

from cranktopo.base.errors import quoted, suggest
from cranktopo.base.table import SHOWN, SceneTable
from cranktopo.base.units import plain_number
from cranktopo.design.goal.constraint import Constraint, LimitSense, minimum_scale
from cranktopo.design.goal.quantities import (
    QUANTITIES,
    GoalQuantity,
    Optimiser,
    QuantityName,
    nearest_quantity,
    quantity_named,
    unit_size,
)

_NO_LIMIT = "none"
"""Text of a limit that takes a default one away."""
_LARGEST = 1e15
_LARGEST_PERCENT = 1e4
_TEXT = re.compile(r"([<>=!~≤≥]*)\s*([+-]?(?:nan|inf|[0-9.,_]+(?:e[+-]?[0-9]+)?))?(.*)", re.I | re.S)
_SENSES: dict[str, LimitSense] = {"<=": "<=", "≤": "<=", ">=": ">=", "≥": ">="}
_MEANT = {"<": "<=", "=<": "<=", ">": ">=", "=>": ">="}


@dataclass(frozen=True)
class Limit:
    """A quantity that may not exceed a value, or not fall below one, as a user writes it.

    It is apart from the `Constraint` that is solved since percent of the original mean another number in each
    model; `constraint` returns that of one model.

    Attributes:
        value: in the quantity's internal unit, or in percent of the original web, evaluated in the same
            model.
        assumed: whether the user left it out and the goal brings it.
    """

    quantity: QuantityName
    sense: LimitSense
    value: float
    percent: bool = False
    assumed: bool = False

    @property
    def unit(self) -> str:
        """Unit of the value; empty for a pure number."""
        return "%" if self.percent else QUANTITIES[self.quantity].unit

    @property
    def condition(self) -> str:
        """The limit without its quantity, as the scene's table has it."""
        return f"{self.sense} {plain_number(self.value, 6)} {self.unit}".rstrip()

    def required(self, original: float | None) -> float | None:
        """Return the value in the internal unit; None for percent of an unknown original."""
        if not self.percent:
            return self.value
        return None if original is None else self.value / 100 * original

    def constraint(self, original: Mapping[str, float]) -> Constraint | None:
        """Return the limit in the numbers of a model; None for percent of an unknown original.

        Args:
            original: quantities of the original web in that model.
        """
        own = original.get(self.quantity)
        bound = self.required(own)
        if bound is None:
            return None
        least = minimum_scale(self.quantity, original)
        return Constraint(self.quantity, self.sense, bound, own or 0.0, least)

    def __str__(self) -> str:
        return f"{self.quantity} {self.condition}"


@dataclass(frozen=True)
class Goal:
    """Task of an optimiser: one quantity as low or as high as the limits allow."""

    sense: Literal["minimise", "maximise"]
    quantity: QuantityName
    limits: tuple[Limit, ...] = ()

    @property
    def quantities(self) -> frozenset[QuantityName]:
        """Quantities of the goal and of its limits."""
        return frozenset((self.quantity, *(limit.quantity for limit in self.limits)))

    @property
    def load_cases(self) -> frozenset[str]:
        """Names of the load cases that the goal and its limits are read off."""
        return frozenset(QUANTITIES[name].load_case for name in self.quantities) - {""}

    @property
    def held_by_elements_alone(self) -> bool:
        """True if less is better and only limits that cells cannot tell keep it from nothing at all."""
        limited = [QUANTITIES[limit.quantity] for limit in self.limits]
        on_cells = [quantity for quantity in limited if "density" in quantity.optimisers]
        held = any(quantity.load_case for quantity in on_cells)
        return QUANTITIES[self.quantity].better == "low" and not held and len(on_cells) < len(limited)

    def limits_of(self, quantity: QuantityName) -> tuple[Limit, ...]:
        """Return the limits of one quantity: none, one, or a range."""
        return tuple(limit for limit in self.limits if limit.quantity == quantity)


def goal_text(goal: Goal, optimiser: Optimiser) -> str:
    """Return the goal, its limits and those left to the evaluation in a line or two."""
    most = "least" if goal.sense == "minimise" else "largest"
    kept = [limit for limit in goal.limits if optimiser in QUANTITIES[limit.quantity].optimisers]
    bearings = [one for one in goal.limits if one not in kept and QUANTITIES[one.quantity].of_bearings]
    stresses = [one for one in goal.limits if one not in kept and one.quantity == "stress"]
    left = [limit for limit in goal.limits if limit not in (*kept, *bearings, *stresses)]
    lines = [f"goal: {most} {QUANTITIES[goal.quantity].label}; {_listed(kept) or 'no limits'}"]
    if bearings:
        lines.append(f"not judged, `cranktopo shape` changes what the bearings have: {_listed(bearings)}")
    if stresses:
        lines.append(f"of `cranktopo shape` alone, `optimise` refuses it: {_listed(stresses)}")
    if left:
        lines.append(f"not known to the {optimiser} optimisation, left to the evaluation: {_listed(left)}")
    return "\n".join(lines)


def _listed(limits: list[Limit]) -> str:
    text = ", ".join(str(limit) for limit in limits)
    return f"{text} (% of the original web)" if any(limit.percent for limit in limits) else text


def refused(why: str, hint: str = "Correct that value.") -> PydanticCustomError:
    """Return a mistake in a goal or limit as the scene's messages show it: what is wrong, and what to do."""
    return PydanticCustomError("statement", "{why}", {"why": why, "hint": hint})


def read_limits(quantity: GoalQuantity, value: Any) -> tuple[Limit, ...]:
    """Read the limits of a quantity off a text, or two for a range; none where it takes the limit away."""
    texts = value if isinstance(value, tuple | list) else (value,)
    if texts == (_NO_LIMIT,):
        return ()
    limits = tuple(_read(quantity, text) for text in texts)
    if not limits:
        raise refused("no limit is given", f"Write {_example(quantity)}, or leave the key out.")
    _check_range(limits)
    return limits


def _read(quantity: GoalQuantity, text: Any) -> Limit:
    if not isinstance(text, str):
        number = f"{text:g}" if isinstance(text, float | int) and not isinstance(text, bool) else "100"
        raise refused(
            "must be text with a sign, a number and a unit", f"Write {_example(quantity, number=number)}."
        )
    found = _TEXT.fullmatch(text.strip())
    sign, number, rest = (part or "" for part in (found.groups() if found else ("", "", text.strip())))
    sense = _sense(quantity, sign, f"{number}{rest}".strip())
    value = _number(quantity, number, f"{number}{rest}")
    unit = rest.strip()
    if unit == "%" and unit not in quantity.units:
        return Limit(quantity.name, sense, _in_percent(quantity, value), percent=True)
    return Limit(quantity.name, sense, _in_unit(quantity, value, unit, sense))


def _sense(quantity: GoalQuantity, sign: str, rest: str) -> LimitSense:
    if sign in _SENSES:
        return _SENSES[sign]
    if sign in _MEANT:
        raise refused(f"'{sign}' is no sign of a limit", f"Write '{_MEANT[sign]} {_clipped(rest)}'.")
    if "=" in sign:
        raise refused(
            f"'{sign}' is no sign of a limit",
            f"For a fixed value give two limits, '>= {_clipped(rest)}' and '<= {_clipped(rest)}'.",
        )
    raise refused("must begin with <= or >=", f"Write {_example(quantity)}.")


def _number(quantity: GoalQuantity, number: str, rest: str) -> float:
    if not number:
        raise refused("a number must follow the sign", f"Write {_example(quantity)}.")
    try:
        value = float(number.replace("_", "x"))
    except ValueError:
        raise refused(f"'{number}' is not a number", "Write a decimal point and no separators.") from None
    if not math.isfinite(value):
        raise refused("the number must be finite", f"Write {_example(quantity)}.")
    return value


def _in_percent(quantity: GoalQuantity, value: float) -> float:
    lowest = -_LARGEST_PERCENT if quantity.signed else 0.0
    if lowest < value <= _LARGEST_PERCENT:
        return value
    least = f">= {lowest:g}" if lowest else "> 0"
    raise refused(f"the percentage must be {least} and <= {_LARGEST_PERCENT:g}")


def _in_unit(quantity: GoalQuantity, value: float, unit: str, sense: LimitSense) -> float:
    size = unit_size(quantity, unit)
    if size is None:
        named = any(quantity.units)
        names = list(dict.fromkeys([*filter(None, quantity.units), "%"]))
        valid = f"valid: {', '.join(names)}" if named else "valid: none, or %"
        if not unit:
            percent = "it" if quantity.unit == "%" else "percent of the original"
            raise refused(f"the unit is missing; {valid}", f"For {percent} write '{sense} {value:g} %'.")
        near = suggest(_clipped(unit), names)
        hint = near if near.startswith("Did") else f"Write {_example(quantity)}."
        raise refused(f"unknown unit '{_clipped(unit)}'; {valid}", hint)
    if not quantity.signed and value <= 0:
        raise refused("the number must be > 0")
    if abs(value * size) > _LARGEST:
        raise refused(f"the number must be <= {_LARGEST / size:g}")
    return value * size


def _check_range(limits: tuple[Limit, ...]) -> None:
    quantity = QUANTITIES[limits[0].quantity]
    upper = [limit for limit in limits if limit.sense == "<="]
    lower = [limit for limit in limits if limit.sense == ">="]
    if len(upper) > 1 or len(lower) > 1:
        side = "above" if len(upper) > 1 else "below"
        raise refused(f"two limits from {side}", "Keep the tighter one; a range has one <= and one >=.")
    if upper and lower:
        low, high = lower[0], upper[0]
        if low.percent == high.percent and low.value > high.value:
            raise refused(
                f"contradictory: nothing is >= {low.value:g} and <= {high.value:g} {low.unit}".rstrip()
            )
        return
    wrong = upper if quantity.better == "high" else lower
    if wrong and not quantity.either_limit:
        other = ">=" if quantity.better == "high" else "<="
        raise refused(
            f"{quantity.label} is wanted {quantity.better}: a limit on its own is {other}",
            f"Write '{other} {wrong[0].value:g} {wrong[0].unit}'".rstrip() + ", or give both for a range.",
        )


def _clipped(text: str) -> str:
    return quoted(text, 50)[1:-1]


def _example(quantity: GoalQuantity, number: str = "100") -> str:
    sense = ">=" if quantity.better == "high" else "<="
    return f"'{sense} {number} %'"


_Minimised = Literal["mass", "inertia", "unbalance"]
_Maximised = Literal[
    "torsion",
    "bending",
    "torsion_per_mass",
    "bending_per_mass",
    "natural_frequency",
    "fatigue_safety",
    "balance_factor",
]
_LimitText = Annotated[
    str | tuple[str, ...], WithJsonSchema({"type": "string", "kind": "text, or a list of two texts"})
]
"""Such as `>= 100 %`; two of them for a range."""


def _goal_word(value: Any, sense: str) -> Any:
    if value is None:
        return None
    allowed = get_args(_Minimised if sense == "minimise" else _Maximised)
    if not isinstance(value, str):
        raise refused("must be the name of a quantity", f"Valid: {', '.join(allowed)}.")
    if value in allowed:
        return value
    if value not in QUANTITIES:
        raise refused("unknown quantity", nearest_quantity(value))
    quantity = QUANTITIES[value]
    if not quantity.as_goal:
        instead = (
            f"Maximise '{quantity.load_case}': that makes it least." if quantity.load_case else "Limit it."
        )
        raise refused("can be limited but is no goal", instead)
    other = "Maximise" if sense == "minimise" else "Minimise"
    raise refused(f"{quantity.label} is wanted {quantity.better}", f"{other} it.")


class LimitsTable(SceneTable):
    """Limits, each as text: "<=" or ">=", a number, and a unit or % of the original web.

    A list of two limits is a range, and "none" takes away a limit that the goal brings by default.
    """

    mass: _LimitText | None = Field(default=None, examples=["<= 100 %"])
    """Mass of the throw between its two mid-journal planes."""
    inertia: _LimitText | None = Field(default=None, examples=["<= 2500 kg mm2"])
    """Inertia of the throw about the crank axis."""
    unbalance: _LimitText | None = Field(default=None, examples=["<= 40 kg mm"])
    """Mass times distance of the centre of mass from the crank axis, positive toward the crankpin."""
    balance_factor: _LimitText | None = Field(default=None, examples=[[">= 48 %", "<= 52 %"]])
    """Percent of the oscillating mass that a throw balances beyond its rotating masses."""
    torsion: _LimitText | None = Field(default=None, examples=[">= 100 %"])
    """Torsional stiffness of the throw."""
    bending: _LimitText | None = Field(default=None, examples=[">= 100 %"])
    """Bending stiffness of the throw."""
    torsion_per_mass: _LimitText | None = Field(default=None, examples=[">= 100 %"])
    """Torsional stiffness over mass."""
    bending_per_mass: _LimitText | None = Field(default=None, examples=[">= 100 %"])
    """Bending stiffness over mass."""
    pin_displacement: _LimitText | None = Field(default=None, examples=["<= 0.15 mm"])
    """Displacement of the crankpin under the engine's largest radial force."""
    twist: _LimitText | None = Field(default=None, examples=["<= 0.3 deg"])
    """Twist between the mid-journal planes under the engine's largest torque."""
    natural_frequency: _LimitText | None = Field(default=None, examples=[">= 300 Hz"])
    """First natural frequency of the shaft in torsion, as `vibration` computes it; of `shape`."""
    fatigue_safety: _LimitText | None = Field(default=None, examples=[">= 100 %"])
    """Least safety against fatigue; the density optimisation leaves it to the evaluation."""
    stress: _LimitText | None = Field(default=None, examples=["<= 250 MPa"])
    """Largest von Mises stress of fillets, outlets and faces over the load states of the fatigue safety, by
    linear elasticity; of `shape`."""
    oil_film: _LimitText | None = Field(default=None, examples=[">= 1.5 um"])
    """Least oil film of main bearings and big ends over the cycle, of throws that stand alone; of `shape`."""
    bearing_pressure: _LimitText | None = Field(default=None, examples=["<= 200 MPa"])
    """Largest pressure in those films; of `shape`."""

    @field_validator("*", mode="before")
    @classmethod
    def _readable(cls, value: Any, info: ValidationInfo) -> Any:
        if value is not None:
            read_limits(quantity_named(str(info.field_name)), value)
        return value


class GoalTable(SceneTable):
    """The task of an optimiser: one quantity as low or as high as the limits allow.

    Without this table `optimise` minimises the weighted compliance at `optimise.volume_fraction`.
    """

    minimise: Annotated[_Minimised | None, BeforeValidator(partial(_goal_word, sense="minimise"))] = Field(
        default=None, examples=["mass"], json_schema_extra=SHOWN
    )
    """Quantity to be made as low as possible; this or `maximise`."""
    maximise: Annotated[_Maximised | None, BeforeValidator(partial(_goal_word, sense="maximise"))] = Field(
        default=None, examples=["torsion_per_mass"]
    )
    """Quantity to be made as high as possible; this or `minimise`."""
    limits: LimitsTable = LimitsTable()

    @model_validator(mode="after")
    def _one_goal(self) -> Self:
        if self.minimise and self.maximise:
            raise refused("minimise and maximise are both given", "Keep one of them; limit the other.")
        if not (self.minimise or self.maximise):
            raise refused("neither minimise nor maximise is given", "Add minimise = 'mass', for example.")
        return self

    @property
    def quantity(self) -> _Minimised | _Maximised:
        """Quantity that is minimised or maximised."""
        found = self.minimise or self.maximise
        assert found is not None
        return found
