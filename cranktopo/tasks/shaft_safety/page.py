"""The page of `cranktopo shaft`: safety of the webs, what they carry, and the forces on the main bearings."""

from __future__ import annotations

from cranktopo.base.units import N_PER_KN
from cranktopo.bodies.crank_ends import main_journal_places_mm
from cranktopo.design.schema import Scene
from cranktopo.report.page import Fact, FactStatus, Page, Section, left_off_first
from cranktopo.report.plot import Picture
from cranktopo.tasks.fatigue.criteria import shortfall_words
from cranktopo.tasks.film.permitted import film_words
from cranktopo.tasks.shaft.result import ContinuousShaft
from cranktopo.tasks.shaft_safety.dynamics_plots import dynamic_safety_pictures, dynamics_pictures
from cranktopo.tasks.shaft_safety.dynamics_text import (
    bearing_forces,
    by_speed,
    journal_motions,
    model_words,
    resonance_table,
    safety_by_speed,
    safety_by_web,
    safety_sentence,
    web_moments,
)
from cranktopo.tasks.shaft_safety.plots import (
    BearingPolar,
    CrankSide,
    bearing_pictures,
    safety_pictures,
    side_picture,
    stress_picture,
    web_pictures,
)
from cranktopo.tasks.shaft_safety.result import ShaftAssessment, ShaftSafety
from cranktopo.tasks.shaft_safety.text import (
    ON_ENDS,
    bearing_table,
    carried_table,
    moment_table,
    speed_table,
    unsure_words,
    web_table,
    worst_sentence,
)


def shaft_page(shaft: ShaftAssessment, loads: BearingPolar, crank: Scene, written: str) -> Page:
    """Return a judged shaft as content; `written` is a date.

    Args:
        loads: on the main bearings at the speed where one of them carries most.
        crank: of which the shaft is, for its picture.
    """
    found = shaft.safety
    assert found is not None
    moments = max(shaft.on_bearings, key=lambda at: at.worst_web.range_Nm)
    carried = max(shaft.on_bearings, key=lambda at: at.worst_bearing.largest_N)
    over_speed = (("Over speed", speed_table(found)),) if len(found.speeds) > 1 else ()
    return Page(
        title=f"Shaft on its bearings: {shaft.design}",
        subtitle=f"method {found.method}, {_speeds(found)}, {shaft.bearings} bearings; {written}",
        headline=left_off_first(
            found.left_off,
            " ".join([*worst_sentence(found).splitlines(), *unsure_words(found), *_films_words(shaft)]),
        ),
        facts=_facts(shaft, found, carried),
        sections=(
            Section(
                "safety",
                "Safety of every web",
                "The least over all points of a part, all crank angles and all speeds. The shaft stands on "
                "all its main bearings; each cylinder acts at its own phase. "
                f"{found.worst.stress_words} {shaft.silent} {shaft.pressure} {shaft.added_words}".rstrip(),
                (("By web, from the free end", web_table(found)), *over_speed),
                (*safety_pictures(found), *_on_crank(found, crank), stress_picture(found.worst)),
            ),
            Section(
                "moments",
                "Bending moment in the webs",
                f"Largest less smallest value over the cycle at {moments.speed_rpm:,.0f} rpm, where a web "
                "carries most, beside a throw that stands alone between its two bearings.",
                (("In the middle of each web", moment_table(moments)),),
                () if moments.sections is None else web_pictures(moments.speed_rpm, moments.sections),
            ),
            Section(
                "bearings",
                "Main bearings",
                f"At {carried.speed_rpm:,.0f} rpm, where one carries most. Forces of the shaft on its "
                "bearings in the axes of the engine: up is where the cylinder of the first throw stands.",
                (
                    ("Largest forces", bearing_table(carried)),
                    *([(ON_ENDS, carried_table(carried))] if carried.carried else []),
                ),
                bearing_pictures(loads),
            ),
            *_vibration(shaft, found),
        ),
    )


def _vibration(shaft: ShaftAssessment, still: ShaftSafety) -> tuple[Section, ...]:
    """Return the section of the shaft that vibrates; none where that was not asked for."""
    found, moving = shaft.dynamics, shaft.dynamic_safety
    if found is None or moving is None:
        return ()
    over_speed = (
        (
            ("Safety over speed", safety_by_speed(still, moving)),
            ("Moments and forces over speed", by_speed(found)),
        )
        if len(found.speeds) > 1
        else ()
    )
    met = (("Orders that meet modes", resonance_table(found.resonances)),) if found.resonances else ()
    return (
        Section(
            "vibration",
            "The shaft that vibrates",
            f"{model_words(found)} {safety_sentence(still, moving)} {moving.worst.stress_words}",
            (
                ("Safety of each web", safety_by_web(still, moving)),
                *over_speed,
                (f"Moments in the webs at {found.worst.speed_rpm:,.0f} rpm", web_moments(found.worst)),
                ("Main bearings there", bearing_forces(found.worst)),
                ("Motions of the main journals there", journal_motions(found.worst)),
                *met,
            ),
            (
                *dynamic_safety_pictures(still, moving),
                stress_picture(moving.worst, "dynamic-stress-over-cycle"),
                *dynamics_pictures(found),
            ),
        ),
    )


def _on_crank(shaft: ShaftSafety, crank: Scene) -> tuple[Picture, ...]:
    """Return the crank from the side; none of one whose throws differ."""
    if crank.crank is not None and not crank.crank.uniform:
        return ()
    return (side_picture(shaft, main_journal_places_mm(crank), CrankSide.of(crank)),)


def _speeds(shaft: ShaftSafety) -> str:
    first, last = shaft.speeds[0].speed_rpm, shaft.speeds[-1].speed_rpm
    if first == last:
        return f"{first:,.0f} rpm"
    return f"{len(shaft.speeds)} speeds, {first:,.0f} to {last:,.0f} rpm"


def _films_words(shaft: ShaftAssessment) -> list[str]:
    """Return in a sentence which oil films are not as the design permits, if any."""
    beyond = shaft.beyond_permitted
    return [f"Oil films {'; '.join(beyond)}."] if beyond else []


def _films_fact(shaft: ShaftAssessment) -> list[Fact]:
    """Return the least film of all main bearings and speeds with what is beyond the permitted, if any."""
    films = [film for at in shaft.on_bearings for film in at.least_films]
    if not films:
        return []
    thin = min(films, key=lambda one: one.film_um)
    places = [f"{thin.bearing} at {thin.speed_rpm:,.0f} rpm", *shaft.beyond_permitted]
    status: FactStatus = "neutral"
    if shaft.films_hold is not None:
        status = "bad" if not shaft.films_hold else "neutral" if shaft.beyond_permitted else "good"
    return [
        Fact("Least oil film", f"{film_words(thin.film_um, thin.below_um)} um", "; ".join(places), status)
    ]


def _vibration_fact(shaft: ShaftAssessment, still: ShaftSafety) -> list[Fact]:
    """Return the least safety of the shaft that vibrates, if it was asked for."""
    moving = shaft.dynamic_safety
    if moving is None:
        return []
    at = f"web {moving.worst.web} at {moving.worst.speed_rpm:,.0f} rpm"
    short = shortfall_words(moving.method, moving.safety)
    status: FactStatus = "bad" if short else "unknown" if still.mesh_shortfall else "good"
    note = f"{at}; it {short}" if short else at
    return [Fact("With its mass", f"{moving.safety:.3f}", note, status)]


def _facts(shaft: ShaftAssessment, safety: ShaftSafety, carried: ContinuousShaft) -> tuple[Fact, ...]:
    safest = max(safety.webs, key=lambda web: web.safety)
    bearing, short = carried.worst_bearing, shortfall_words(safety.method, safety.safety)
    return (
        Fact(
            "Least safety",
            f"{safety.safety:.3f}",
            "; ".join(
                [
                    f"web {safety.worst.web} at {safety.worst.speed_rpm:,.0f} rpm",
                    *([f"it {short}"] if short else []),
                    *unsure_words(safety),
                ]
            ),
            "bad" if short else "unknown" if safety.mesh_shortfall else "good",
        ),
        Fact("Safest web", f"{safest.safety:.3f}", f"web {safest.web}", "neutral"),
        Fact(
            "Largest bearing force",
            f"{bearing.largest_N / N_PER_KN:.1f} kN",
            f"bearing {bearing.bearing} at {carried.speed_rpm:,.0f} rpm",
            "neutral",
        ),
        *_vibration_fact(shaft, safety),
        *_films_fact(shaft),
        Fact("Mass", f"{shaft.mass_kg:.3f} kg", shaft.weighed, "neutral"),
    )
