"""The shaft that vibrates, in words and tables beside the one without mass."""

from __future__ import annotations

from cranktopo.base.units import N_PER_KN, plain_number
from cranktopo.report.result_table import ResultTable, Row, terminal
from cranktopo.tasks.dynamics.result import DynamicBearing, DynamicSpeed, Resonance, ShaftDynamics
from cranktopo.tasks.film.permitted import film_words
from cranktopo.tasks.shaft_safety.result import ShaftSafety


def dynamics_text(shaft: ShaftDynamics) -> list[str]:
    """Return what is told of the vibration of a shaft, by paragraph."""
    worst = shaft.worst
    paragraphs = [
        model_words(shaft),
        f"Largest less smallest moments in the middle of each web at {worst.speed_rpm:,.0f} rpm, "
        "beside the quasi-static ones:",
        terminal(web_moments(worst)),
        "Main bearings there, and the motions of the journals: of twist and axial motion "
        "half the largest less the smallest, of tilt and offset the largest:",
        terminal(bearing_forces(worst)),
        terminal(journal_motions(worst)),
    ]
    if len(shaft.speeds) > 1:
        paragraphs += ["Over the speeds, the web and the bearing with the most:", terminal(by_speed(shaft))]
        paragraphs += _resonances(shaft)
    return paragraphs


def model_words(shaft: ShaftDynamics) -> str:
    """Return in sentences what vibrates, and what is assumed."""
    turns = (
        "its output swings with what it drives"
        if shaft.turns_freely
        else "its output turns evenly, as [shaft] joins nothing to it"
    )
    films = f" {_film_words(shaft)}" if shaft.in_films else ""
    light = ", ".join(shaft.torsion_only)
    counts = f" Without a mass_kg in torsion alone: {light}." if light else ""
    return (
        f"With its mass the shaft vibrates in bending, torsion and along its axis: {shaft.unknowns} unknowns "
        f"of each order up to {shaft.highest_order:g}, loss factor {plain_number(shaft.loss_factor, 3)} of "
        f"its material, {turns}.{films}{counts}"
    )


def _film_words(shaft: ShaftDynamics) -> str:
    beyond = f" Of its films, {'; '.join(shaft.beyond_permitted)}." if shaft.beyond_permitted else ""
    return f"Its journals move in oil films, where a disturbance of its cycle dies away.{beyond}"


def _resonances(shaft: ShaftDynamics) -> list[str]:
    if shaft.in_films:
        return ["Between the speeds no resonance is looked for in oil films."]
    if not shaft.resonances:
        return ["No order meets a mode between them so that it is felt."]
    added = shaft.added_speed_rpm
    said = f"{added:,.0f} rpm, the worst of them, is added to the speeds." if added is not None else ""
    words = f"Orders that meet modes between them and change a moment by 5 % or more. {said}".rstrip()
    return [words, terminal(resonance_table(shaft.resonances))]


def web_moments(at: DynamicSpeed) -> ResultTable:
    """Return the ranges of the moments in each web."""
    rows: tuple[Row, ...] = tuple(
        {
            "web": str(web.web),
            "bending_Nm": web.range_Nm.bending,
            "side_bending_Nm": web.range_Nm.side_bending,
            "torque_Nm": web.range_Nm.torque,
            "equivalent_Nm": web.range_Nm.equivalent,
            "quasi_static_Nm": web.quasi_static_Nm.equivalent,
            "ratio": web.ratio,
        }
        for web in at.webs
    )
    digits = {"web": 0, "bending_Nm": 1, "side_bending_Nm": 1, "torque_Nm": 1, "equivalent_Nm": 1}
    return ResultTable({**digits, "quasi_static_Nm": 1, "ratio": 3}, rows)


def bearing_forces(at: DynamicSpeed) -> ResultTable:
    """Return what each main bearing carries."""
    rows: tuple[Row, ...] = tuple(
        {
            "bearing": str(one.bearing),
            "largest_kN": one.largest_N / N_PER_KN,
            "at_deg": one.at_deg,
            "quasi_static_kN": one.quasi_static_N / N_PER_KN,
            "ratio": one.ratio,
            **_film_of(one, at.speed_rpm),
        }
        for one in at.main_bearings
    )
    digits = {"bearing": 0, "largest_kN": 2, "at_deg": 0, "quasi_static_kN": 2, "ratio": 3}
    films = dict.fromkeys(("film_um", "quasi_static_um"), 2) if at.film_work_J is not None else {}
    return ResultTable({**digits, **films}, rows)


def _film_of(bearing: DynamicBearing, speed_rpm: float) -> dict[str, str]:
    least = bearing.least(speed_rpm)
    if least is None or bearing.quasi_static_film_um is None:
        return {}
    films = {"film_um": least.film_um, "quasi_static_um": bearing.quasi_static_film_um}
    return {name: film_words(film_um, least.below_um) for name, film_um in films.items()}


def journal_motions(at: DynamicSpeed) -> ResultTable:
    """Return how the middle of each main journal moves."""
    rows: tuple[Row, ...] = tuple(
        {
            "journal": str(one.section),
            "twist_deg": one.twist_deg,
            "axial_um": one.axial_um,
            "tilt_mrad": one.tilt_mrad,
            "offset_um": one.offset_um,
        }
        for one in at.sections
    )
    digits = {"journal": 0, "twist_deg": 4, "axial_um": 1, "tilt_mrad": 2, "offset_um": 1}
    return ResultTable(digits, rows)


def by_speed(shaft: ShaftDynamics) -> ResultTable:
    """Return the web and the bearing with the most at each speed."""
    rows: tuple[Row, ...] = tuple(
        {
            "speed_rpm": at.speed_rpm,
            "web": str(at.worst_web.web),
            "equivalent_Nm": at.worst_web.range_Nm.equivalent,
            "ratio": at.worst_web.ratio,
            "bearing": str(at.worst_bearing.bearing),
            "largest_kN": at.worst_bearing.largest_N / N_PER_KN,
            "of_quasi_static": at.worst_bearing.ratio,
        }
        for at in shaft.speeds
    )
    digits = {"speed_rpm": 0, "web": 0, "equivalent_Nm": 1, "ratio": 3}
    return ResultTable({**digits, "bearing": 0, "largest_kN": 2, "of_quasi_static": 3}, rows)


def resonance_table(resonances: tuple[Resonance, ...]) -> ResultTable:
    """Return the resonances that are felt."""
    rows: tuple[Row, ...] = tuple(
        {
            "speed_rpm": one.speed_rpm,
            "order": f"{one.order:g}",
            "mode": str(one.mode),
            "frequency_Hz": one.frequency_Hz,
            "kind": one.kind,
            "web": str(one.web),
            "ratio": one.ratio,
        }
        for one in resonances
    )
    digits = {"speed_rpm": 0, "order": 0, "mode": 0, "frequency_Hz": 1, "kind": 0, "web": 0, "ratio": 3}
    return ResultTable(digits, rows)


def dynamic_safety_text(still: ShaftSafety, moving: ShaftSafety) -> list[str]:
    """Return the safety of the shaft that vibrates beside that without its mass, by paragraph."""
    paragraphs = [
        f"Least safety of each web of the shaft that vibrates by method {moving.method!r}, beside the "
        "quasi-static one:",
        terminal(safety_by_web(still, moving)),
        f"{safety_sentence(still, moving)}\n{moving.worst.stress_words}",
    ]
    if len(moving.speeds) > 1:
        paragraphs += ["Over the speeds:", terminal(safety_by_speed(still, moving))]
    return paragraphs


def safety_sentence(still: ShaftSafety, moving: ShaftSafety) -> str:
    """Return where and when the shaft that vibrates is least safe, in three lines."""
    worst = moving.worst
    return (
        f"Least safety {moving.safety:.3f} of the shaft that vibrates, quasi-statically {still.safety:.3f}: "
        f"web {worst.web}\n(throw {worst.throw}) at {worst.speed_rpm:,.0f} rpm, highest stress at "
        f"{worst.highest_deg:g} deg, lowest at {worst.lowest_deg:g} deg:\n{worst.critical.place}."
    )


def safety_by_web(still: ShaftSafety, moving: ShaftSafety) -> ResultTable:
    """Return the least safety of each web with and without the mass of the shaft."""
    rows: tuple[Row, ...] = tuple(
        {
            "web": str(web.web),
            "throw": str(web.throw),
            "safety": web.safety,
            "quasi_static": before.safety,
            "ratio": web.safety / before.safety,
            "part": web.part.replace("_", " "),
            "at_rpm": web.speed_rpm,
        }
        for web, before in zip(moving.webs, still.webs, strict=True)
    )
    digits = {"web": 0, "throw": 0, "safety": 3, "quasi_static": 3, "ratio": 3, "part": 0, "at_rpm": 0}
    return ResultTable(digits, rows)


def safety_by_speed(still: ShaftSafety, moving: ShaftSafety) -> ResultTable:
    """Return the least safety at each speed with and without the mass of the shaft."""
    rows: tuple[Row, ...] = tuple(
        {
            "speed_rpm": at.speed_rpm,
            "safety": at.safety,
            "quasi_static": before.safety,
            "ratio": at.safety / before.safety,
            "web": str(at.web),
            "part": at.part.replace("_", " "),
        }
        for at, before in zip(moving.speeds, still.speeds, strict=True)
    )
    digits = {"speed_rpm": 0, "safety": 3, "quasi_static": 3, "ratio": 3, "web": 0, "part": 0}
    return ResultTable(digits, rows)
