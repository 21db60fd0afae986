"""Building blocks of the scene schema: frozen tables, numbers in plausible ranges.

Units are in the field names. The ranges hold every engine from a model with 2 mm of bore to a ship's with
1 m; what lies outside is a slip of the unit or of the keyboard.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from typing import Annotated, Any, Self

from pydantic import BeforeValidator, ConfigDict, Field, JsonValue, model_validator
from pydantic_core import PydanticCustomError

from cranktopo.base.described import Described
from cranktopo.base.errors import CranktopoError, suggest

SMALLEST_MM, LARGEST_MM = 0.05, 20_000.0
Length = Annotated[float, Field(ge=SMALLEST_MM, le=LARGEST_MM, allow_inf_nan=False)]
LengthOrZero = Annotated[float, Field(ge=0, le=LARGEST_MM, allow_inf_nan=False)]
Place = Annotated[float, Field(ge=-LARGEST_MM, le=LARGEST_MM, allow_inf_nan=False)]
SmallLength = Annotated[float, Field(ge=1e-4, le=100, allow_inf_nan=False)]
"""Clearances and displacements of bearings, mm."""
Mass = Annotated[float, Field(ge=0, le=1e5, allow_inf_nan=False)]
Pressure = Annotated[float, Field(ge=1e-3, le=50, allow_inf_nan=False)]
"""Absolute, MPa; the largest of any cylinder is about 30."""
Strength = Annotated[float, Field(ge=1, le=1e4, allow_inf_nan=False)]
CrankAngle = Annotated[float, Field(ge=-360, le=360, allow_inf_nan=False)]
Speed = Annotated[float, Field(ge=0, le=2e5, allow_inf_nan=False)]
Force = Annotated[float, Field(ge=1e-3, le=1e9, allow_inf_nan=False)]
Reaction = Annotated[float, Field(ge=0, le=1e9, allow_inf_nan=False)]
"""Of one roller, N."""
Torque = Annotated[float, Field(ge=-1e9, le=1e9, allow_inf_nan=False)]
Stiffness = Annotated[float, Field(ge=1, le=1e12, allow_inf_nan=False)]
"""N/mm."""
SOFTEST_BEARING_N_PER_MM = 1000.0
"""On softer ones a throw moves so much further than it bends that float64 no longer holds how it bends."""
BearingStiffness = Annotated[float, Field(ge=SOFTEST_BEARING_N_PER_MM, le=1e12, allow_inf_nan=False)]
"""Of a main bearing, N/mm."""
Inertia = Annotated[float, Field(ge=1e-9, le=1e7, allow_inf_nan=False)]
"""About the crank axis, kg m2."""
TorsionalStiffness = Annotated[float, Field(ge=1e-3, le=1e12, allow_inf_nan=False)]
"""N m/rad."""
TorsionalDamping = Annotated[float, Field(ge=0, le=1e8, allow_inf_nan=False)]
"""N m s/rad."""
LossFactor = Annotated[float, Field(ge=0, le=2, allow_inf_nan=False)]
"""Energy lost in a cycle over 2 pi times the largest strain energy."""
TurningSpeed = Annotated[float, Field(ge=1, le=2e5, allow_inf_nan=False)]
"""Of a shaft that turns, rpm."""
Weight = Annotated[float, Field(ge=0, le=1e6, allow_inf_nan=False)]
Fraction = Annotated[float, Field(ge=0.01, le=0.99, allow_inf_nan=False)]


def is_unset(value: object) -> bool:
    """Tell whether an optional key stays out of a stored scene: no value, no text, an empty list."""
    return value is None or value in ("", ())


def _no_truth_value(value: Any) -> Any:
    """Python counts `true` as 1, a reader of the file does not.

    Of a ValueError pydantic would keep the traceback, and with it all callers' variables, for ever.
    """
    if isinstance(value, bool | float):
        raise PydanticCustomError("whole_number", "must be an integer")
    return value


WholeNumber = BeforeValidator(_no_truth_value)
"""Beside a `Literal` of integers."""


def filled_in(data: Any, library: Mapping[str, dict[str, Any]], needed: frozenset[str]) -> Any:
    """Return a table with the library's values for the keys that it does not give.

    Raises PydanticCustomError for a name that is not in the library where needed keys are missing.
    """
    if not isinstance(data, dict) or not isinstance(data.get("name"), str):
        return data
    entry = library.get(data["name"])
    if entry is None and not needed <= data.keys():
        keys = ", ".join(sorted(needed - data.keys()))
        hint = suggest(data["name"], list(library))
        raise PydanticCustomError(
            "library", "not in the library, and {keys} not given", {"keys": keys, "hint": hint}
        )
    return {**(entry or {}), **data}


UNSHOWN_TEXT = "unshown_text"
"""Type of the error for a text that cannot be shown; its context has the place in the table."""
_NOT_SHOWN = re.compile(r"[^\t\n\x20-\x7e\xa0-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML holds no more than a terminal does."""
# What the reference and the template of all keys need to know of a field beside its type.
SHOWN: dict[str, JsonValue] = {"shown": True}
"""An optional key that the template has switched on, with its example."""
UNLESS_IN_LIBRARY: dict[str, JsonValue] = {"unless": "the library has the name"}
"""A required key that a library fills in."""
LIKE_WEB: dict[str, JsonValue] = {"like": "web"}
"""A table whose inner tables are those of another one, where they are explained."""


class SceneTable(Described):
    """A TOML table: immutable, unknown keys refused; neither text nor `true` counts as a number.

    The text below a field is its meaning in the reference of all keys; a required one has an example.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, serialize_by_alias=True)

    def model_copy(self, *, update: Mapping[str, Any] | None = None, deep: bool = False) -> Self:
        """Return a copy with other values, of which the names alone are checked; `with_values` checks all.

        Raises:
            CranktopoError: a name that the table does not have, which pydantic takes without a word.
        """
        known = type(self).model_fields
        for name in (update or {}).keys() - known.keys():
            raise CranktopoError(f"{type(self).__name__} has no '{name}'.", hint=suggest(name, list(known)))
        return super().model_copy(update=update, deep=deep)

    @model_validator(mode="before")
    @classmethod
    def _arrays(cls, data: Any) -> Any:
        """Arrays of TOML and JSON are lists; a table that cannot change holds tuples."""
        if not isinstance(data, dict):
            return data
        for key, value in data.items():
            _check_text(value, (key,))
        return {key: _tuple(value) for key, value in data.items()}


def _check_text(value: Any, place: tuple[str | int, ...]) -> None:
    """Refuse text that no page or terminal can show: control characters but tab and new line."""
    if isinstance(value, str) and (found := _NOT_SHOWN.search(value)):
        context = {"place": place, "character": f"U+{ord(found[0]):04X}"}
        raise PydanticCustomError(UNSHOWN_TEXT, "must hold no control character, here {character}", context)
    if isinstance(value, list | tuple):
        for number, item in enumerate(value):
            _check_text(item, (*place, number))


def _tuple(value: Any, depth: int = 3) -> Any:
    return tuple(_tuple(item, depth - 1) for item in value) if isinstance(value, list) and depth else value
