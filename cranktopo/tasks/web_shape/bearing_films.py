"""Oil films of a web's bearings where a limit asks for them, and their slopes by free dimensions.

A dimension takes width from a bearing (thickness, fillets) or changes its load (bores, counterweight).
The web's outline changes the load as well, which the slopes leave out and the evaluation counts. An evaluated
web is judged by the same film as in `film`, near a limit the mass-conserving one; the search beside that web
takes the ratio of that film to the mobility method's.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.goal.quantities import QuantityName
from cranktopo.design.goal.scene_goal import asks_for
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import difference_points, from_differences
from cranktopo.tasks.film.stage import films_at
from cranktopo.tasks.refit.family import Layout, scene_at

_NAMES: tuple[QuantityName, ...] = ("oil_film", "bearing_pressure")
_STEP_MM = 0.02
"""Of central differences; degrees where the dimension is an angle."""


def limits_films(scene: Scene) -> bool:
    """Tell whether a limit of the scene's goal is of the oil films."""
    return asks_for(scene, *_NAMES)


def film_values(scene: Scene) -> dict[str, float]:
    """Return the least film, um, and the largest pressure, MPa, where a limit is of them; else nothing."""
    if not limits_films(scene):
        return {}
    return dict(zip(_NAMES, _films([scene], conserving=True)[0].tolist(), strict=True))


def film_slopes(scene: Scene, layout: Layout, values: Array) -> tuple[dict[str, float], dict[str, Array]]:
    """Return film and pressure by the mobility method at a parameter vector, and their derivatives.

    All films of the central differences are solved at once, in the time of two.
    """
    free = [place for place, name in enumerate(layout.names) if name in layout.dimensions]
    tried = [values, *difference_points(values, _STEP_MM, free)]
    own, *moved = _films([scene_at(scene, layout, at) for at in tried])
    slopes = from_differences(moved, _STEP_MM, free, np.zeros((len(_NAMES), len(values))))
    return dict(zip(_NAMES, own.tolist(), strict=True)), dict(zip(_NAMES, slopes, strict=True))


def _films(scenes: Sequence[Scene], *, conserving: bool = False) -> list[Array]:
    judged = [[one.judged for one in every] for every in films_at(scenes, conserving=conserving)]
    return [
        np.array([min(one.film_um for one in every), max(one.pressure_MPa for one in every)])
        for every in judged
    ]
