"""A goal and its limits, and how a limit is read off its text."""

from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any, Literal

from pydantic_core import PydanticCustomError

from cranktopo.base.errors import quoted, suggest
from cranktopo.design.goal.constraint import LimitSense
from cranktopo.design.goal.quantities import QUANTITIES, GoalQuantity, Optimiser, QuantityName, unit_size

_NO_LIMIT = "none"
"""Text of a limit that takes a default one away."""
_LARGEST = 1e15
_LARGEST_PERCENT = 1e4
_TEXT = re.compile(r"([<>=!~≤≥]*)\s*([+-]?(?:nan|inf|[0-9.,_]+(?:e[+-]?[0-9]+)?))?(.*)", re.I | re.S)
_SENSES: dict[str, LimitSense] = {"<=": "<=", "≤": "<=", ">=": ">=", "≥": ">="}
_MEANT = {"<": "<=", "=<": "<=", ">": ">=", "=>": ">="}


@dataclass(frozen=True)
class Limit:
    """A quantity that may not exceed a value, or not fall below one.

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
        return f"{self.sense} {self.value:g} {self.unit}".rstrip()

    def required(self, original: float | None) -> float | None:
        """Return the value in the internal unit; None for percent of an unknown original."""
        if not self.percent:
            return self.value
        return None if original is None else self.value / 100 * original

    def __str__(self) -> str:
        return f"{self.quantity} {self.condition}"


@dataclass(frozen=True)
class Goal:
    """Task of an optimiser: one quantity as low or as high as the limits allow."""

    sense: Literal["minimise", "maximise"]
    quantity: QuantityName
    limits: tuple[Limit, ...] = ()

    @property
    def load_cases(self) -> frozenset[str]:
        """Names of the load cases that the goal and its limits are read off."""
        names = (self.quantity, *(limit.quantity for limit in self.limits))
        return frozenset(QUANTITIES[name].load_case for name in names) - {""}

    def limits_of(self, quantity: QuantityName) -> tuple[Limit, ...]:
        """Return the limits of one quantity: none, one, or a range."""
        return tuple(limit for limit in self.limits if limit.quantity == quantity)


def goal_text(goal: Goal, optimiser: Optimiser) -> str:
    """Return the goal, its limits and those left to the evaluation in a line or two."""
    most = "least" if goal.sense == "minimise" else "largest"
    kept = [limit for limit in goal.limits if optimiser in QUANTITIES[limit.quantity].optimisers]
    left = [limit for limit in goal.limits if limit not in kept]
    lines = [f"goal: {most} {QUANTITIES[goal.quantity].label}; {_listed(kept) or 'no limits'}"]
    if left:
        lines.append(f"not known to the {optimiser} optimisation, left to the evaluation: {_listed(left)}")
    return "\n".join(lines)


def _listed(limits: list[Limit]) -> str:
    """Return limits in one phrase; percent is explained once."""
    text = ", ".join(str(limit) for limit in limits)
    return f"{text} (% of the original web)" if any(limit.percent for limit in limits) else text


def refused(why: str, hint: str = "Correct that value.") -> PydanticCustomError:
    """Return a mistake in a goal or limit as the scene's messages show it: what is wrong, and what to do."""
    return PydanticCustomError("statement", "{why}", {"why": why, "hint": hint})


def read_limits(quantity: GoalQuantity, value: Any) -> tuple[Limit, ...]:
    """Read the limits of a quantity off what the user wrote: a text, or two of them for a range.

    Returns:
        Empty where the text takes the limit away.

    Raises:
        PydanticCustomError: no limit can be read off it, or two that contradict each other.
    """
    texts = value if isinstance(value, tuple | list) else (value,)
    if texts == (_NO_LIMIT,):
        return ()
    limits = tuple(_read(quantity, text) for text in texts)
    if not limits:
        raise refused("no limit is given", f"Write {_example(quantity)}, or leave the key out.")
    _check_together(limits)
    return limits


def _read(quantity: GoalQuantity, text: Any) -> Limit:
    if not isinstance(text, str):
        number = f"{text:g}" if isinstance(text, float | int) and not isinstance(text, bool) else "100"
        raise refused(
            "must be text with a sign, a number and a unit", f"Write {_example(quantity, number=number)}."
        )
    sign, number, rest = (part or "" for part in _whole_match(text.strip()))
    sense = _sense(quantity, sign, f"{number}{rest}".strip())
    value = _number(quantity, number, f"{number}{rest}")
    unit = rest.strip()
    if unit == "%":
        return Limit(quantity.name, sense, _in_percent(quantity, value), percent=True)
    return Limit(quantity.name, sense, _in_unit(quantity, value, unit, sense))


def _whole_match(text: str) -> tuple[str | None, ...]:
    found = _TEXT.fullmatch(text)
    return found.groups() if found else (None, None, text)


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
        names = [name for name in quantity.units if name]
        valid = f"valid: {', '.join([*names, '%'])}" if names else "valid: none, or %"
        if not unit:
            raise refused(
                f"the unit is missing; {valid}", f"For percent of the original write '{sense} {value:g} %'."
            )
        near = suggest(_clipped(unit), [*names, "%"])
        hint = near if near.startswith("Did") else f"Write {_example(quantity)}."
        raise refused(f"unknown unit '{_clipped(unit)}'; {valid}", hint)
    if not quantity.signed and value <= 0:
        raise refused("the number must be > 0")
    if abs(value * size) > _LARGEST:
        raise refused(f"the number must be <= {_LARGEST / size:g}")
    return value * size


def _check_together(limits: tuple[Limit, ...]) -> None:
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
    """Return what the user wrote, for a message: on one line and not too long."""
    return quoted(text, 50)[1:-1]


def _example(quantity: GoalQuantity, number: str = "100") -> str:
    sense = ">=" if quantity.better == "high" else "<="
    return f"'{sense} {number} %'"
