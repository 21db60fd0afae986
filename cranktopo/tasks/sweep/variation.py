"""Variations of a sweep: a key of the scene with its values, or the two ends between which it is sampled."""

from __future__ import annotations

import math
import re
import tomllib
from collections.abc import Sequence
from typing import Any

from cranktopo.base.errors import CranktopoError, ExitCode, decimal_comma, invalid, quoted
from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.design.goal.scene_goal import limits_by_quantity, with_goal
from cranktopo.design.loading import key_parts, scene_from_dict

Value = str | float | int | bool
STAGE = "stage"
"""Beside the keys of a scene, how far a point goes may vary."""
_FORM = "must be KEY=A:B:N, KEY=A:B with samples, or KEY=a,b,c"
_LIMIT = re.compile(r"(?P<sign>[<>]=)\s*(?P<numbers>[^\s:,]+:[^\s:,]+:[^\s:,]+)\s*(?P<unit>[^:,\d]*)")
"""A limit of a goal with a range in place of its number: `>= 90:130:5 %`."""
MOST = 100_000
"""Points of a sweep; whoever asks for more has a slip in a count."""


class Variation(Result):
    """A key and what it takes."""

    key: str
    """Path in the scene, `web.pocket[0].diameter_mm`, or `stage`."""
    values: tuple[Value, ...] = ()
    """In order; empty where the key is sampled between two ends."""
    ends: tuple[float, float] | None = UNLESS_NONE
    """Lowest and highest value of a sampled key."""

    def at(self, share: float) -> Value:
        """Return the value at a share from 0 up to 1 of the range, or of the list."""
        if self.ends is None:
            return self.values[min(int(share * len(self.values)), len(self.values) - 1)]
        low, high = self.ends
        return float(f"{low + share * (high - low):.6g}")


def read_option(text: str) -> Variation:
    """Return a variation as `--vary` takes it: `KEY=A:B:N`, `KEY=A:B` or `KEY=a,b,c`."""
    key, equals, rest = text.partition("=")
    if not equals or not key.strip() or not rest.strip():
        raise _refused(f"--vary {quoted(text)}")
    return read_text(key.strip(), rest.strip())


def read_text(key: str, text: str) -> Variation:
    """Return a variation from what stands behind its key; raises CranktopoError for numbers without sense."""
    key_parts(key)
    limit = _LIMIT.fullmatch(text.strip())
    if limit is not None:
        numbers = _range(key, limit["numbers"].split(":")).values
        return _listed(key, [f"{limit['sign']} {n:g} {limit['unit']}".rstrip() for n in numbers])
    parts = text.split(":")
    if len(parts) in (2, 3) and all(_number(part) is not None for part in parts):
        return _range(key, parts)
    comma = next(filter(None, map(decimal_comma, parts)), "") if len(parts) in (2, 3) else ""
    if comma:
        raise CranktopoError(f"{key} = {quoted(text)}: must be A:B:N.", hint=comma)
    return _listed(key, [_value(part.strip()) for part in text.split(",")])


def read_entry(key: str, entry: object) -> Variation:
    """Return a variation from the table `[vary]` of a file: text as of an option, a list, or one value."""
    if isinstance(entry, str):
        return read_text(key, entry)
    values: list[Any] = list(entry) if isinstance(entry, list | tuple) else [entry]
    key_parts(key)
    if not values or not all(isinstance(value, str | int | float) for value in values):
        raise _refused(f"vary.{key} = {quoted(entry)}")
    return _listed(key, values)


def _range(key: str, parts: list[str]) -> Variation:
    numbers = [_number(part) for part in parts]
    low, high = float(numbers[0] or 0), float(numbers[1] or 0)
    if len(parts) == 2:
        if not low < high:
            raise _refused(f"{key} = {':'.join(parts)}", "the first end must be below the second")
        return Variation(key=key, ends=(low, high))
    count = numbers[2]
    if not isinstance(count, int) or not 2 <= count <= MOST:
        raise _refused(f"{key} = {':'.join(parts)}", f"N must be an integer >= 2 and <= {MOST}")
    whole = all(isinstance(end, int) for end in numbers[:2]) and (high - low) % (count - 1) == 0
    found = [float(f"{low + (high - low) * n / (count - 1):.12g}") for n in range(count)]
    return _listed(key, [int(value) for value in found] if whole else found)


def _listed(key: str, values: Sequence[Value]) -> Variation:
    for value in values:
        if isinstance(value, float) and not math.isfinite(value):
            raise invalid(key, value, "must be a finite number")
    return Variation(key=key, values=tuple(values))


def _number(text: str) -> int | float | None:
    value = _value(text.strip())
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        return None
    return value


def _value(text: str) -> Value:
    """Return a number, `true` or `false` as in TOML; anything else is text."""
    try:
        found = tomllib.loads(f"value = {text}")
    except ValueError:
        return text
    value = found["value"]
    return value if len(found) == 1 and isinstance(value, str | int | float) else text


def _refused(what: str, why: str = _FORM) -> CranktopoError:
    hint = 'Such as --vary "web.width_mm=44:56:7" or --vary "throw.crankpin.fillet_mm=2,2.5,3".'
    return CranktopoError(f"{what}: {why}.", hint=hint, code=ExitCode.USAGE)


LIMITS = "goal.limits"


def varied_limits(limits: Sequence[str]) -> tuple[list[str], list[Variation]]:
    """Return limits that stay, and those with several values, such as `torsion >= 90:130:5 %`."""
    fixed: list[str] = []
    varied: list[Variation] = []
    for name, value in limits_by_quantity(limits).items():
        texts = [value] if isinstance(value, str) else list(value)
        found = read_text(f"{LIMITS}.{name}", texts[0])
        if len(texts) == 1 and len(found.values) > 1:
            varied.append(found)
        else:
            fixed += [f"{name} {text}" for text in texts]
    return fixed, varied


def with_goal_tables(
    tables: dict[str, Any], design: str, minimise: str | None, maximise: str | None, limits: Sequence[str]
) -> dict[str, Any]:
    """Return the tables of a scene with another goal or other limits, as `with_goal` changes a scene."""
    if minimise is None and maximise is None and not limits:
        return tables
    scene = scene_from_dict(tables, design, whole=True)
    goal = with_goal(scene, minimise=minimise, maximise=maximise, limits=limits).goal
    return tables if goal is None else {**tables, "goal": goal.model_dump(mode="json", exclude_defaults=True)}
