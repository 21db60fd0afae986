"""The oil films as text for the terminal."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.design.misfire import silent_words
from cranktopo.report.result_table import text_table
from cranktopo.tasks.film.permitted import beyond_permitted, film_words
from cranktopo.tasks.film.result import BearingFilm, FilmResult, FilmsAtSpeed


def film_text(result: FilmResult) -> str:
    """Return what is worse than permitted, the oil, and a table of bearings or of speeds."""
    named = result.oil or "oil of the given curve"
    oil = "" if result.temperature_C is None else f"{named} at {result.temperature_C:g} degC, "
    heading = f"{result.design}: oil film, {oil}{result.viscosity_mPas:.2f} mPa s\nloads: {result.loads}"
    gas = "" if result.gas else "\nthe scene tells no gas pressure: inertia alone loads the bearings"
    gas += f"\n{result.pressure}" if result.pressure else ""
    silent = f"\n{silent_words(result.misfire)}; the big end is of one that does" if result.misfire else ""
    parts = [_verdict(result), heading + gas + silent]
    parts += [_one_speed(result.speeds[0]) if len(result.speeds) == 1 else _by_speed(result.speeds)]
    parts += [_conserving(result)]
    return "\n\n".join(part for part in parts if part)


def _conserving(result: FilmResult) -> str:
    """The mass-conserving films, with their difference from those of the mobility method."""
    header = ["bearing", "speed\nrpm", "film\num", "than\nmobility", "pressure\nMPa"]
    header += ["than\nmobility", "least\nfilled", "oil\ncm3/s"]
    rows = []
    for at in result.speeds:
        for one in at.conserving:
            assert one.conserving is not None
            own = one.conserving
            cells = [one.bearing, f"{at.rpm:g}", film_words(own.film_um, one.below_um)]
            cells += [_more(own.film_um, one.film_um), f"{own.pressure_MPa:.1f}"]
            cells += [_more(own.pressure_MPa, one.pressure_MPa), f"{100 * own.least_filled:.0f} %"]
            rows.append([*cells, f"{own.oil_cm3_per_s:.2g}"])
    if not rows:
        return ""
    told = f"mass-conserving film of those within {result.near:g} times of what is permitted"
    return f"{told}\n" + text_table("l" + "r" * (len(header) - 1), header, rows)


def _more(value: float, than: float) -> str:
    return f"{100 * (value / than - 1):+.0f} %"


def _verdict(result: FilmResult) -> str:
    films = [film for at in result.speeds for film in at.least_films]
    return "\n".join(beyond_permitted(result.permitted_film_um, result.permitted_pressure_MPa, films))


def _one_speed(at: FilmsAtSpeed) -> str:
    header = ["bearing", "diameter\nmm", "width\nmm", "load\nN", "at\ndeg", "film\num", "at\ndeg"]
    header += ["pressure\nMPa", "at\ndeg", "friction\nW"]
    rows = [
        [
            one.bearing,
            f"{one.diameter_mm:g}",
            f"{'2 x ' if one.films == 2 else ''}{one.width_mm:.4g}",
            f"{one.max_N:.0f}",
            f"{one.deg:g}",
            film_words(one.judged.film_um, one.below_um),
            f"{one.judged.film_deg:g}",
            f"{one.judged.pressure_MPa:.1f}",
            f"{one.judged.pressure_deg:g}",
            f"{one.friction_W:.0f}",
        ]
        for one in at.bearings
    ]
    return f"at {at.rpm:g} rpm, over the cycle{_by_method(at.bearings)}\n" + text_table(
        "l" + "r" * (len(header) - 1), header, rows
    )


def _by_speed(speeds: tuple[FilmsAtSpeed, ...]) -> str:
    header = [
        "speed\nrpm",
        "least film\num",
        "bearing",
        "largest pressure\nMPa",
        "bearing",
        "friction of all\nW",
    ]
    rows = []
    for at in speeds:
        thin, hard = at.thinnest, at.hardest
        cells = [
            f"{at.rpm:g}",
            film_words(thin.judged.film_um, thin.below_um),
            thin.bearing,
            f"{hard.judged.pressure_MPa:.1f}",
            hard.bearing,
        ]
        rows.append([*cells, f"{at.friction_W:.0f}"])
    told = _by_method([one for at in speeds for one in at.bearings])
    return f"over the cycle at each speed{told}\n{text_table('rrlrlr', header, rows)}"


def _by_method(films: Sequence[BearingFilm]) -> str:
    """Return by which method films are told, as the rest of a heading."""
    conserving = any(one.conserving for one in films)
    return f"; mobility method{', or mass-conserving as below' if conserving else ''}"
