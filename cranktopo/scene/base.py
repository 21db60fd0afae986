"""Building blocks of the scene schema: frozen tables, number types with units in the field name."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field, JsonValue

Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NonNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Finite = Annotated[float, Field(allow_inf_nan=False)]
Fraction = Annotated[float, Field(gt=0, lt=1, allow_inf_nan=False)]

# What the reference and the template of all keys need to know of a field beside its type.
SHOWN: dict[str, JsonValue] = {"shown": True}
"""An optional key that the template has switched on, with its example."""
UNLESS_IN_LIBRARY: dict[str, JsonValue] = {"unless": "the library has the name"}
"""A required key that a library fills in."""


class SceneTable(BaseModel):
    """A TOML table: immutable, unknown keys refused, numbers not coerced from text.

    The text below a field is its meaning in the reference of all keys; a required one has an example.
    """

    model_config = ConfigDict(frozen=True, extra="forbid", strict=False, use_attribute_docstrings=True)
