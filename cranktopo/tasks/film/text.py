"""The oil films as text for the terminal."""

from __future__ import annotations

from textwrap import fill

from cranktopo.design.misfire import silent_words
from cranktopo.report.result_table import WIDTH, text_table
from cranktopo.tasks.film.permitted import beyond_permitted, film_words
from cranktopo.tasks.film.result import FilmResult, FilmsAtSpeed


def film_text(result: FilmResult) -> str:
    """Return what is worse than permitted, the oil, and a table of bearings or of speeds."""
    named = result.oil or "oil of the given curve"
    oil = "" if result.temperature_C is None else f"{named} at {result.temperature_C:g} degC, "
    heading = f"{result.design}: oil film, {oil}{result.viscosity_mPas:.2f} mPa s\nloads: {result.loads}"
    gas = "" if result.gas else "\nthe scene tells no gas pressure: inertia alone loads the bearings"
    gas += f"\n{fill(result.pressure, WIDTH)}" if result.pressure else ""
    silent = f"\n{silent_words(result.misfire)}; the big end is of one that does" if result.misfire else ""
    parts = [_verdict(result), heading + gas + silent]
    parts += [_one_speed(result.speeds[0]) if len(result.speeds) == 1 else _by_speed(result.speeds)]
    return "\n\n".join(part for part in parts if part)


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
            film_words(one.film_um, one.below_um),
            f"{one.film_deg:g}",
            f"{one.pressure_MPa:.1f}",
            f"{one.pressure_deg:g}",
            f"{one.friction_W:.0f}",
        ]
        for one in at.bearings
    ]
    return f"at {at.rpm:g} rpm, over the cycle\n" + text_table("l" + "r" * (len(header) - 1), header, rows)


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
        thin, hard = at.thinnest, max(at.bearings, key=lambda one: round(one.pressure_MPa, 6))
        cells = [
            f"{at.rpm:g}",
            film_words(thin.film_um, thin.below_um),
            thin.bearing,
            f"{hard.pressure_MPa:.1f}",
            hard.bearing,
        ]
        rows.append([*cells, f"{at.friction_W:.0f}"])
    return text_table("rrlrlr", header, rows)
