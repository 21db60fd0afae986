"""The scene's table `[goal]`: the one statement of what is wanted, for every optimiser."""

from __future__ import annotations

from typing import Annotated, Any, Literal, Self, get_args

from pydantic import (
    BeforeValidator,
    Field,
    ValidationInfo,
    WithJsonSchema,
    field_validator,
    model_validator,
)

from cranktopo.base.table import SceneTable
from cranktopo.design.goal.limit import read_limits, refused
from cranktopo.design.goal.quantities import QUANTITIES, nearest_quantity, quantity_named

_Minimised = Literal["mass", "inertia", "unbalance"]
_Maximised = Literal["torsion", "bending", "torsion_per_mass", "bending_per_mass", "fatigue_safety"]
_LimitText = Annotated[
    str | tuple[str, ...], WithJsonSchema({"type": "string", "kind": "text, or a list of two texts"})
]
"""Such as `>= 100 %`; two of them for a range."""


def _goal_word(value: Any, sense: Literal["minimise", "maximise"]) -> Any:
    """Return a quantity that may be minimised or maximised, as it is.

    Raises:
        PydanticCustomError: another one, with what is meant.
    """
    allowed = get_args(_Minimised if sense == "minimise" else _Maximised)
    if not isinstance(value, str):
        raise refused("must be the name of a quantity", f"Valid: {', '.join(allowed)}.")
    if value in allowed:
        return value
    if value not in QUANTITIES:
        raise refused("unknown quantity", nearest_quantity(value))
    quantity = QUANTITIES[value]
    if not quantity.as_goal:
        raise refused(
            "can be limited but is no goal", f"Maximise '{quantity.load_case}': that makes it least."
        )
    other = "Maximise" if sense == "minimise" else "Minimise"
    raise refused(f"{quantity.label} is wanted {quantity.better}", f"{other} it.")


def _minimised(value: Any) -> Any:
    return value if value is None else _goal_word(value, "minimise")


def _maximised(value: Any) -> Any:
    return value if value is None else _goal_word(value, "maximise")


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
    fatigue_safety: _LimitText | None = Field(default=None, examples=[">= 100 %"])
    """Least safety against fatigue; the density optimisation leaves it to the evaluation."""

    @field_validator("*", mode="before")
    @classmethod
    def _readable(cls, value: Any, info: ValidationInfo) -> Any:
        if value is not None:
            read_limits(quantity_named(str(info.field_name)), value)
        return value


class GoalTable(SceneTable):
    """What an optimiser is asked for: one quantity as low or as high as the limits allow.

    Without this table `optimise` minimises the weighted compliance at `optimise.volume_fraction`.
    """

    minimise: Annotated[_Minimised | None, BeforeValidator(_minimised)] = Field(
        default=None, examples=["mass"], json_schema_extra={"shown": True}
    )
    """Quantity to be made as low as possible; this or `maximise`."""
    maximise: Annotated[_Maximised | None, BeforeValidator(_maximised)] = Field(
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
