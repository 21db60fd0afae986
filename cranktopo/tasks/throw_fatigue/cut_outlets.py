"""Outlets of oil drillings where the model of the throw ends, and the place from which they are judged."""

from __future__ import annotations

import math
from collections.abc import Iterator
from functools import lru_cache
from typing import Literal

from cranktopo.design.halves import halves, named_in_throw
from cranktopo.design.schema import Scene
from cranktopo.tasks.throw_fatigue.fillets import is_cut
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.outlet import DrillOutlet
from cranktopo.throw.drilling.table import Drilling, drill_bores

_Field = Literal["start", "end"]
_ENDS: tuple[tuple[_Field, str], ...] = ("start", "from"), ("end", "to")
"""Fields of both ends of a drilling, with their keys."""
_STEP_MM = 0.1
"""Of the least place that is told."""


@lru_cache(maxsize=8)  # the search for the least place takes half a second on a large throw
def judged_places(scene: Scene, whole: bool) -> str:
    """Return from which `place_mm` on each cut outlet is judged, in sentences.

    Args:
        whole: the model is the whole throw, with the outlets of both halves.
    """
    near, far = halves(scene)
    lines = [named_in_throw(line, scene, "first") for line in _of_half(near)]
    if whole and far is not near:
        lines += [named_in_throw(line, scene, "second") for line in _of_half(far)]
    return " ".join(dict.fromkeys(lines))


def _of_half(half: Scene) -> Iterator[str]:
    for drilling, bore in zip(half.throw.drilling, drill_bores(half), strict=True):
        for (field, name), outlet in zip(_ENDS, bore.outlets, strict=True):
            if is_cut(bore, outlet):
                yield _sentence(half, drilling, field, f"{bore.key}.{name}.place_mm")


def _sentence(half: Scene, drilling: Drilling, field: _Field, key: str) -> str:
    least = _least_place_mm(half, drilling, field)
    if least is None:
        return f"On this journal no {key} is judged."
    return f"It is judged from {key} = {least:g} on."


def _least_place_mm(half: Scene, drilling: Drilling, field: _Field) -> float | None:
    """Return the least place of an end, in steps, at which it is judged; None where the throw has none."""
    first = math.floor(getattr(drilling, field).place_mm / _STEP_MM) + 1
    last = math.floor(half.throw.main_journal.length_mm / 2 / _STEP_MM)
    for step in range(first, last + 1):
        place_mm = round(step * _STEP_MM, 6)
        moved = _moved(drilling, field, place_mm)
        (bore,) = moved.bodies(half, "")
        if not is_cut(bore, _outlet(bore, field)) and moved.fits(half):
            return place_mm
    return None


def _moved(drilling: Drilling, field: _Field, place_mm: float) -> Drilling:
    end = getattr(drilling, field).model_copy(update={"place_mm": place_mm})
    return drilling.model_copy(update={field: end})


def _outlet(bore: DrillBore, field: _Field) -> DrillOutlet:
    return bore.outlets[0 if field == "start" else 1]
