"""A fatigue criterion of local stresses: its needs, the safety of points, its line in the Haigh diagram."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.local_stress import LocalStress


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
class FatigueCriterion:
    """A criterion of local stresses.

    Attributes:
        name: in `fatigue --method`, in JSON and in names of files.
        needs: keys of the material that must have a value.
        point_safety: safety of points of a scene whose material is checked.
        haigh_limit_MPa: amplitude that a point endures at given mean stresses (n,), from its fully reversed
            strength in MPa and its related stress gradient in 1/mm.
        load_packages: loads the optional packages that it takes; fails before any solve where one is missing.
    """

    name: str
    needs: tuple[str, ...]
    point_safety: Callable[[Scene, LocalStress], PointSafety]
    haigh_limit_MPa: Callable[[Scene, float, float, Array], Array]
    load_packages: Callable[[], object] = lambda: None
