"""A fatigue method: its needs; of a criterion of local stresses, the safety of points and its Haigh line."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene

TREATMENT = ("surface_treatment_factor", "surface_treatment_source")
"""Keys of `[fatigue]` that every method takes."""
LAYERS = ("hardening", "journal_hardening")
"""Tables of `[fatigue]` that methods take which look below the surface."""
_Stress = TypeVar("_Stress", float, Array)


def larger_end_MPa(amplitude_MPa: _Stress, mean_MPa: _Stress) -> _Stress:
    """Return the larger end, in magnitude, of a range of signed stresses."""
    return amplitude_MPa + abs(mean_MPa)


@dataclass(frozen=True)
class LocalStress:
    """Cyclic stress at points of a surface.

    Attributes:
        amplitude_MPa: half the range of the signed equivalent stress, shape (n,).
        mean_MPa: its mean, shape (n,).
        gradient_per_mm: related stress gradient into the depth, shape (n,).
    """

    amplitude_MPa: Array
    mean_MPa: Array
    gradient_per_mm: Array


Judge = Callable[[LocalStress], Array]
"""Safety of points, (n,)."""


@dataclass(frozen=True)
class PointSafety:
    """Safety of points and what makes it; arrays of shape (n,).

    Attributes:
        strength_MPa: fully reversed strength.
        amplitude_share: fraction of the used strength that the amplitude uses, 0 to 1.
        factors: by their names in tables and JSON.
    """

    safety: Array
    strength_MPa: Array
    amplitude_share: Array
    factors: dict[str, Array]


@dataclass(frozen=True)
class SafetyMethod:
    """A method of `fatigue --method`.

    Attributes:
        name: in `fatigue --method`, in JSON and in names of files.
        needs: keys of the material that must have a value.
        takes: keys and tables of `[fatigue]` that its safety depends on.
        load_packages: loads the optional packages that it takes; fails before any solve where one is missing.
        check: checks what else it needs of a scene.
        title: in words, after "by"; its name where it gives none.
        includes: what its safety counts and the least safety that it asks for.
        asks: that least safety; a part fails below 1 by any method.
    """

    name: str
    needs: tuple[str, ...]
    includes: str = field(kw_only=True)
    takes: tuple[str, ...] = field(default=TREATMENT, kw_only=True)
    load_packages: Callable[[], object] = field(default=lambda: None, kw_only=True)
    check: Callable[[Scene], None] = field(default=lambda _: None, kw_only=True)
    title: str = field(default="", kw_only=True)
    asks: float = field(default=1.0, kw_only=True)


@dataclass(frozen=True)
class FatigueCriterion(SafetyMethod):
    """A method that judges every point of the surface by its local stress.

    Attributes:
        point_safety: safety of points of a scene whose material is checked.
        haigh_limit_MPa: amplitude that a point endures at given mean stresses (n,), from its fully reversed
            strength in MPa and its related stress gradient in 1/mm.
        line_of: whose line that is; that of the method where it gives none.
    """

    point_safety: Callable[[Scene, LocalStress], PointSafety]
    haigh_limit_MPa: Callable[[Scene, float, float, Array], Array]
    line_of: str = field(default="", kw_only=True)
