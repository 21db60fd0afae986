"""Settings of a loop, and their form in a manifest."""

from __future__ import annotations

from dataclasses import asdict, dataclass, field
from typing import Any

from cranktopo.base.errors import CranktopoError
from cranktopo.design.manufacturing_limits import ManufacturingLimits
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.fit import usual_limits

_THIN_SHARE = 0.4
"""Least thickness beside a journal over that of the web, by default."""
_LIMITS = "rules"
"""Key of the limits in a manifest."""


@dataclass(frozen=True)
class Settings:
    """Settings of a loop.

    Attributes:
        steps: number of steps in which the volume falls to the design's volume fraction.
        least_transition_mm: thickness of the web around its journals below which the loop ends.
        element_size_mm: of the body-fitted mesh; None for its default.
        limits: of the re-modelled webs.
        shape: whether the dimensions of the best web are optimised in the end.
    """

    steps: int
    least_transition_mm: float
    element_size_mm: float | None = None
    limits: ManufacturingLimits = field(default_factory=ManufacturingLimits)
    shape: bool = True

    @classmethod
    def from_json(cls, data: dict[str, Any]) -> Settings:
        """Return the settings as a manifest keeps them; one of an older version has the usual limits.

        Raises:
            CranktopoError: keys are missing or unknown.
        """
        try:
            others = {key: value for key, value in data.items() if key != _LIMITS}
            return cls(**others, limits=ManufacturingLimits(**data.get(_LIMITS, {})))
        except (TypeError, AttributeError):
            raise CranktopoError(
                "manifest.json: the loop's settings are damaged.", hint="Start a new loop."
            ) from None

    def as_json(self) -> dict[str, Any]:
        """Return the settings as a manifest keeps them."""
        data = asdict(self)
        limits = data.pop("limits")
        return {**data, _LIMITS: limits}


def loop_settings(
    scene: Scene,
    steps: int = 6,
    least_transition_mm: float | None = None,
    element_size_mm: float | None = None,
    limits: ManufacturingLimits | None = None,
    shape: bool = True,
) -> Settings:
    """Return the settings of a loop over a design; the least thickness is 40 % of the web's by default."""
    least_mm = least_transition_mm or _THIN_SHARE * scene.web.thickness_mm
    return Settings(steps, least_mm, element_size_mm, limits or usual_limits(scene), shape)
