"""Oil films that are thinner, or whose pressure is higher, than the design permits."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any

from cranktopo.design.plain_bearings import PlainBearings


@dataclass(frozen=True)
class LeastFilm:
    """The film of one bearing over the cycle at a speed: its least thickness and its largest pressure."""

    bearing: str
    speed_rpm: float
    film_um: float
    below_um: float
    """Least thickness that is resolved."""
    pressure_MPa: float


def films_hold(table: PlainBearings, films: Iterable[LeastFilm]) -> bool | None:
    """Tell whether all films are within what is permitted; None where nothing is."""
    least, most = table.permitted_film_um, table.permitted_pressure_MPa
    if least is None and most is None:
        return None
    return all(
        one.film_um >= (least or 0.0) and one.pressure_MPa <= (math.inf if most is None else most)
        for one in films
    )


def permitted_films(table: PlainBearings | None, films: Sequence[LeastFilm]) -> dict[str, Any]:
    """Return what is permitted of films, and whether they keep to it, as results name it; none of no film."""
    if table is None or not films:
        return {}
    return {
        "permitted_film_um": table.permitted_film_um,
        "permitted_pressure_MPa": table.permitted_pressure_MPa,
        "films_hold": films_hold(table, films),
    }


def beyond_permitted(least_um: float | None, most_MPa: float | None, films: Sequence[LeastFilm]) -> list[str]:
    """Return a line for each film that is too thin, then for each whose pressure is too high."""
    thin = [
        f"below the permitted {least_um:g} um: {one.bearing} {film_words(one.film_um, one.below_um)} um at "
        f"{one.speed_rpm:g} rpm"
        for one in films
        if least_um is not None and one.film_um < least_um
    ]
    return thin + [
        f"above the permitted {most_MPa:g} MPa: {one.bearing} {one.pressure_MPa:.1f} MPa at "
        f"{one.speed_rpm:g} rpm"
        for one in films
        if most_MPa is not None and one.pressure_MPa > most_MPa
    ]


def film_words(film_um: float, below_um: float) -> str:
    """Return a least film; below what is resolved it has no value of its own."""
    return f"< {below_um:.2g}" if film_um <= below_um else f"{film_um:.2f}"
