"""First natural frequency of the shaft in a search: it follows the torsional stiffness and the inertia.

The search takes the stiffness of a throw that stands alone. Between its neighbours on rigid bearings a throw
is stiffer, by nearly the same factor whatever its web; the evaluation tells the frequency of that shaft.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

from cranktopo.base.arrays import Array
from cranktopo.design.goal.quantities import QuantityName
from cranktopo.design.goal.scene_goal import asks_for
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.first_frequency import FirstFrequency, first_frequency

NAME: QuantityName = "natural_frequency"
_FOLLOWED = ("torsion", "inertia")


def needed_for(quantities: Collection[str]) -> set[str]:
    """Return quantities with those that the frequency among them follows."""
    return {*quantities, *(_FOLLOWED if NAME in quantities else ())}


def frequency_of(scene: Scene, values: Mapping[str, float]) -> FirstFrequency | None:
    """Return the frequency for quantities of a throw; None where no goal or limit of the scene is of it."""
    if not asks_for(scene, NAME) or not values.keys() >= {*_FOLLOWED}:
        return None
    return first_frequency(scene, *(values[name] for name in _FOLLOWED))


def slope_of(frequency: FirstFrequency, slopes: Mapping[str, Array]) -> Array:
    """Return the derivative of the frequency by those of torsional stiffness and inertia."""
    torsion, inertia = (slopes[name] for name in _FOLLOWED)
    return frequency.by_torsion * torsion + frequency.by_inertia * inertia
