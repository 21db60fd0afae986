"""A whole shaft as text: torsion, natural frequencies, and what webs and main bearings carry."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cranktopo.base.units import N_PER_KN, plain_number
from cranktopo.report.result_table import ResultTable, Row, labelled, terminal
from cranktopo.tasks.fatigue.criteria import shortfall_words
from cranktopo.tasks.film.permitted import film_words
from cranktopo.tasks.film.result import ConservingFilm
from cranktopo.tasks.shaft.result import ContinuousShaft, ShaftEvaluation
from cranktopo.tasks.shaft_safety.dynamics_text import dynamic_safety_text, dynamics_text
from cranktopo.tasks.shaft_safety.result import ShaftAssessment, ShaftSafety
from cranktopo.tasks.throw_fatigue.least import PARTS

ON_ENDS = "Parts that the ends carry, their weight and inertia left out; largest over the cycle"
_BEARING_DIGITS = {
    "bearing": 0,
    "largest_kN": 2,
    "at_deg": 0,
    "throws_alone_kN": 2,
    "tilt_mrad": 2,
    "offset_um": 1,
    "life_h": 0,
    "reference_life_h": 0,
    "film_um": 2,
    "pressure_MPa": 1,
}


def shaft_text(shaft: ShaftAssessment) -> str:
    """Return what `cranktopo shaft` prints."""
    error = shaft.error_percent
    errors = f"stiffnesses +-{error:.2g} %, frequencies +-{error / 2:.2g} % at most"
    remarks = shaft.silent, shaft.pressure, shaft.added_words
    said = [line for line in remarks if line]
    beyond = ["\n".join(shaft.beyond_permitted)] if shaft.beyond_permitted else []
    left_off = [f"{words}."] if shaft.safety and (words := shaft.safety.left_off) else []
    parts = [*left_off, *beyond, *_torsion(shaft), *said, *_on_bearings(shaft)]
    if shaft.safety is not None:
        parts += safety_text(shaft.safety)
    if shaft.dynamics is not None:
        parts += dynamics_text(shaft.dynamics)
    if shaft.safety is not None and shaft.dynamic_safety is not None:
        parts += dynamic_safety_text(shaft.safety, shaft.dynamic_safety)
    return "\n\n".join((*parts, errors))


def safety_text(shaft: ShaftSafety) -> list[str]:
    """Return what is told of the safety of a shaft, by paragraph."""
    several, short = len(shaft.speeds) > 1, shortfall_words(shaft.method, shaft.safety)
    at_speeds = f"{len(shaft.speeds)} speeds" if several else f"{shaft.worst.speed_rpm:,.0f} rpm"
    paragraphs = [
        f"Least safety of each web by method {shaft.method!r}, over the cycle at {at_speeds}:",
        terminal(web_table(shaft)),
        "\n".join(
            [
                worst_sentence(shaft),
                *unsure_words(shaft),
                *([f"The safety {short}."] if short else []),
                shaft.worst.stress_words,
            ]
        ),
    ]
    if several:
        paragraphs += ["Over the speeds:", terminal(speed_table(shaft))]
    return paragraphs


def web_table(shaft: ShaftSafety) -> ResultTable:
    """Return the least safety of the parts of each web, and the speed of the least."""
    absent = {part for part in PARTS if all(getattr(web, part) is None for web in shaft.webs)}
    parts = [part for part in PARTS if part not in absent]
    rows: tuple[Row, ...] = tuple(
        {
            "web": str(web.web),
            "throw": str(web.throw),
            **{part: getattr(web, part) for part in parts},
            "at_rpm": web.speed_rpm,
        }
        for web in shaft.webs
    )
    return ResultTable({"web": 0, "throw": 0, **dict.fromkeys(parts, 3), "at_rpm": 0}, rows)


def speed_table(shaft: ShaftSafety) -> ResultTable:
    """Return the least safety at each speed."""
    rows: tuple[Row, ...] = tuple(
        {
            "speed_rpm": at.speed_rpm,
            "safety": at.safety,
            "web": str(at.web),
            "part": at.part.replace("_", " "),
        }
        for at in shaft.speeds
    )
    return ResultTable({"speed_rpm": 0, "safety": 3, "web": 0, "part": 0}, rows)


def worst_sentence(shaft: ShaftSafety) -> str:
    """Return where and when the shaft is least safe."""
    worst = shaft.worst
    return (
        f"Least safety {shaft.safety:.3f}: web {worst.web} (throw {worst.throw}) at "
        f"{worst.speed_rpm:,.0f} rpm, highest stress at {worst.highest_deg:g} deg, "
        f"lowest at {worst.lowest_deg:g} deg: {worst.critical.place}."
    )


def unsure_words(shaft: ShaftSafety) -> list[str]:
    """Return in sentences why the safety is not sure, if so, and which outlets it does not count."""
    missed, left = shaft.mesh_shortfall, shaft.not_judged
    unsure = [f"Not sure: {missed}; a smaller --fillet-fraction helps."] if missed else []
    return unsure + ([left[0].upper() + left[1:]] if left else [])


def _torsion(shaft: ShaftEvaluation) -> tuple[str, str]:
    throws: list[Row] = [
        {"throw": str(number), "angle_deg": angle, "torsion_kNm_per_rad": stiffness / 1000}
        for number, (angle, stiffness) in enumerate(
            zip(shaft.throw_angles_deg, shaft.stiffness.throws_Nm_per_rad, strict=True), start=1
        )
    ]
    frequencies = ", ".join(f"{f:.0f}" for f in shaft.natural_frequencies_Hz)
    frequencies_text = (
        f"{frequencies} Hz (shaft and moving masses alone, free ends)" if frequencies else "none: one throw"
    )
    end = shaft.stiffness.end_to_end_Nm_per_rad / 1000
    rows = (
        (shaft.weighed, f"{shaft.mass_kg:.3f} kg"),
        (f"end to end, {shaft.stiffness_bearings} bearings", f"{end:.2f} kN m/rad"),
        *(
            (f"one throw, {name}", f"{value / 1000:.2f} kN m/rad")
            for name, value in shaft.throw_by_bearings_Nm_per_rad.items()
        ),
        ("natural frequencies", frequencies_text),
    )
    return _table({"throw": 0, "angle_deg": 0, "torsion_kNm_per_rad": 2}, throws), labelled(rows)


def _on_bearings(shaft: ShaftEvaluation) -> list[str]:
    """Return tables at the speed where a web carries most, and one over the speeds if there are several."""
    speeds = shaft.on_bearings
    if not speeds:
        return []
    worst = max(speeds, key=lambda at: at.worst_web.range_Nm)
    stiff = "rigid" if worst.spring_N_per_mm is None else f"of {worst.spring_N_per_mm:,.0f} N/mm"
    held = {"film": "in their oil films", "clearance": "rigid, with play"}.get(shaft.bearings, stiff)
    if worst.tilt_spring_Nm_per_rad is not None:
        held += f", with {plain_number(worst.tilt_spring_Nm_per_rad, 3)} N m/rad against tilt"
    paragraphs = [
        f"On all its main bearings, {held}, at {worst.speed_rpm:,.0f} rpm. Bending moment in the middle "
        "of each web, largest less smallest over the cycle, beside a throw alone"
        + (":" if not _swings(worst) else "; torque there, and in the main journal beside it:"),
        terminal(moment_table(worst)),
        "Main bearings, beside the sum of throws alone:",
        terminal(bearing_table(worst)),
        _big_ends(worst),
        *_carried(worst),
        *_conserving(worst),
    ]
    if len(speeds) > 1:
        paragraphs += ["Over the speeds, the web and the bearing with the most:", _over_speeds(speeds)]
    return paragraphs


def moment_table(at: ContinuousShaft) -> ResultTable:
    """Return ranges of moments and torque in the middle of each web; where it swings, at its journal too."""
    rows: tuple[Row, ...] = tuple(
        {
            "web": str(web.web),
            "throw": str(web.throw),
            "moment_range_Nm": web.range_Nm,
            "throw_alone_Nm": web.alone_Nm,
            "share_percent": 100 * web.share,
            "side_range_Nm": web.side_range_Nm,
            "torque_range_Nm": web.torque_range_Nm,
            **({"at_journal_Nm": web.journal_torque_range_Nm} if _swings(at) else {}),
        }
        for web in at.webs
    )
    digits = {"web": 0, "throw": 0, "moment_range_Nm": 1, "throw_alone_Nm": 1, "share_percent": 1}
    journal = {"at_journal_Nm": 1} if _swings(at) else {}
    return ResultTable({**digits, "side_range_Nm": 1, "torque_range_Nm": 1, **journal}, rows)


def _swings(at: ContinuousShaft) -> bool:
    """Tell whether the mass of a vibrating shaft makes the torque of a web another one than its journal's."""
    return any(web.journal_torque_range_Nm != web.torque_range_Nm for web in at.webs)


def bearing_table(at: ContinuousShaft) -> ResultTable:
    """Return what each main bearing carries, and how its journal lies in it; films as they are judged."""
    rows: tuple[Row, ...] = tuple(
        {
            "bearing": str(bearing.bearing),
            "largest_kN": bearing.largest_N / N_PER_KN,
            "at_deg": bearing.at_deg,
            "throws_alone_kN": bearing.halves_N / N_PER_KN,
            "tilt_mrad": bearing.tilt_mrad,
            "offset_um": bearing.offset_um,
            **({} if bearing.life_h is None else {"life_h": bearing.life_h}),
            **({} if (life := bearing.reference_life_h) is None else {"reference_life_h": life}),
            **({} if film is None else {"film_um": film.film_um, "pressure_MPa": film.pressure_MPa}),
        }
        for bearing in at.main_bearings
        for film in (bearing.least(at.speed_rpm),)
    )
    return ResultTable({key: _BEARING_DIGITS[key] for key in rows[0]}, rows)


def _big_ends(at: ContinuousShaft) -> str:
    throw, tilt_mrad = at.big_ends.most_tilted
    told = f"Crankpins tilt by at most {tilt_mrad:.2f} mrad, at throw {throw}"
    film = at.big_ends.least(at.speed_rpm)
    if film is None:
        return f"{told}."
    film_um = film_words(film.film_um, film.below_um)
    return f"{told}; the film of the big ends is {film_um} um, its pressure {film.pressure_MPa:.1f} MPa."


def _carried(at: ContinuousShaft) -> list[str]:
    """Return how the parts move that the ends carry."""
    return [f"{ON_ENDS}:", terminal(carried_table(at))] if at.carried else []


def carried_table(at: ContinuousShaft) -> ResultTable:
    """Return how the parts move that the ends carry."""
    rows: tuple[Row, ...] = tuple(dict(one) for one in at.carried)
    return ResultTable({"part": 0, "offset_um": 1, "tilt_mrad": 2}, rows)


def _conserving(at: ContinuousShaft) -> list[str]:
    """Return the mass-conserving films of those near what is permitted, parallel and with tilt."""
    films = [(one, one.conserving) for one in at.bearings if one.conserving is not None]
    rows: tuple[Row, ...] = tuple(
        {
            "bearing": _bearing_words(one.name, own),
            "film_um": own.film_um,
            "than_mobility_percent": 100 * (own.film_um / one.film_um - 1) if one.film_um else None,
            "pressure_MPa": own.pressure_MPa,
            "tilt_um": own.edge.tilt_um if own.edge else None,
            "edge_film_um": own.edge.film_um if own.edge else None,
            "edge_pressure_MPa": own.edge.pressure_MPa if own.edge else None,
        }
        for one, own in films
    )
    if not rows:
        return []
    digits = {"bearing": 0, "film_um": 2, "than_mobility_percent": 0, "pressure_MPa": 1, "tilt_um": 1}
    touching = any(own.edge and own.edge.pressure_MPa is None for _, own in films)
    told = "Mass-conserving films of those near what is permitted; then with the journal's tilt, at the edge"
    told += ", where 0 is a journal that touches a rigid bearing:" if touching else ":"
    return [
        told,
        terminal(ResultTable({**digits, "edge_film_um": 2, "edge_pressure_MPa": 1}, rows)),
    ]


def _bearing_words(name: str, own: ConservingFilm) -> str:
    """Name a bearing; of the big ends the one that the edge is of."""
    cylinder = own.edge.cylinder if own.edge else None
    return name if cylinder is None else f"{name} {cylinder}"


def _over_speeds(speeds: tuple[ContinuousShaft, ...]) -> str:
    rows: list[Row] = [
        {
            "speed_rpm": at.speed_rpm,
            "web": str(at.worst_web.web),
            "moment_range_Nm": at.worst_web.range_Nm,
            "bearing": str(at.worst_bearing.bearing),
            "largest_kN": at.worst_bearing.largest_N / N_PER_KN,
        }
        for at in speeds
    ]
    return _table({"speed_rpm": 0, "web": 0, "moment_range_Nm": 1, "bearing": 0, "largest_kN": 2}, rows)


def _table(digits: Mapping[str, int], rows: Sequence[Row]) -> str:
    return terminal(ResultTable(dict(digits), tuple(rows)))
