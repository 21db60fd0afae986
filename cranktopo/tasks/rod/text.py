"""The strength of the rod as tables and text."""

from __future__ import annotations

from collections.abc import Iterator, Mapping

from cranktopo.base.units import N_PER_KN, change_text
from cranktopo.report.result_table import Column, labelled, tabulate, terminal
from cranktopo.tasks.bolts.result import BoltChecks
from cranktopo.tasks.bolts.text import bolts_text
from cranktopo.tasks.rod.element_text import EYES, elements_text, opening
from cranktopo.tasks.rod.pin import PinCheck
from cranktopo.tasks.rod.result import (
    Buckling,
    FreeDimension,
    LighterRod,
    ObliqueSplit,
    RodSectionCheck,
    RodStrength,
    SplitForce,
)

_SECTIONS: tuple[Column[RodSectionCheck], ...] = (
    Column("section", 0, lambda s: s.section),
    Column("place_mm", 1, lambda s: s.place_mm),
    Column("area_mm2", 1, lambda s: s.area_mm2),
    Column("push_kN", 2, lambda s: s.push_N / N_PER_KN),
    Column("pull_kN", 2, lambda s: s.pull_N / N_PER_KN),
    Column("whip_MPa", 1, lambda s: s.whip_MPa),
    Column("highest_MPa", 1, lambda s: s.max_MPa),
    Column("lowest_MPa", 1, lambda s: s.min_MPa),
    Column("yield", 2, lambda s: s.yield_safety),
    Column("fatigue", 2, lambda s: s.fatigue_safety),
)
_BUCKLING: tuple[Column[Buckling], ...] = (
    Column("plane", 0, lambda b: b.plane),
    Column("length_mm", 1, lambda b: b.length_mm),
    Column("slenderness", 1, lambda b: b.slenderness),
    Column("euler_kN", 1, lambda b: b.euler_N / N_PER_KN),
    Column("rankine_kN", 1, lambda b: b.rankine_N / N_PER_KN),
    Column("stress_MPa", 1, lambda b: b.stress_MPa),
    Column("yield", 2, lambda b: b.yield_safety),
)
_FREE: tuple[Column[FreeDimension], ...] = (
    Column("dimension", 0, lambda d: d.name.removesuffix("_mm").replace("_", " ")),
    Column("start_mm", 2, lambda d: d.start_mm),
    Column("found_mm", 2, lambda d: d.value_mm),
    Column("low_mm", 2, lambda d: d.low_mm),
    Column("high_mm", 2, lambda d: d.high_mm),
)


def rod_text(rod: RodStrength) -> str:
    """Return what `cranktopo rod` prints: what is worse than permitted first."""
    failing, holding = verdicts(rod)
    masses = rod.masses
    speeds = " and ".join(f"{speed:g}" for speed in rod.speeds_rpm)
    kg = f"{masses.reciprocating_kg:.4f} kg oscillate, {masses.rotating_kg:.4f} kg rotate"
    rows = (
        ("mass", f"{masses.total_kg:.4f} kg; {kg}"),
        ("centre of mass", f"{masses.centre_from_big_end_mm:.2f} mm from the axis of the big end"),
        ("push of the pin", f"{rod.push_N:,.0f} N at {rod.push_deg:g} deg"),
        ("pull of the pin", f"{rod.pull_N:,.0f} N at {rod.pull_deg:g} deg"),
        ("small end", f"held {rod.held_deg:.0f} deg from its crown; bush {rod.bush_pressure_MPa:.1f} MPa"),
    )
    parts = [
        *(["\n".join(failing)] if failing else []),
        *([_lighter(rod.lighter)] if rod.lighter else []),
        "\n".join([f"{rod.design}: {rod.shank} shank at {speeds} rpm", *holding]),
        labelled(rows),
        *([_split(rod.oblique_split)] if rod.oblique_split else []),
        f"Stresses over the cycle, tension positive; fatigue by method {rod.method}",
        terminal(tabulate(_SECTIONS, rod.sections)),
        "Shank under the largest push, by Navier and Rankine",
        terminal(tabulate(_BUCKLING, rod.buckling)),
        "Change of the bores' diameters, pressed by the cosine",
        terminal(tabulate(EYES, rod.eyes)),
    ]
    parts += [elements_text(rod.elements, rod)] if rod.elements else []
    parts += [_pin(rod.pin)] if rod.pin else []
    if rod.bolt:
        parts.append(bolts_text(BoltChecks(design=rod.design, joints=(rod.bolt,), assumed=rod.assumed)))
    return "\n\n".join(parts)


def verdicts(rod: RodStrength) -> tuple[list[str], list[str]]:
    """Return the lines on what fails, and on what holds."""
    told = [
        (_is_safe(_least_safeties(rod)), least_safety(rod)),
        *((False, line) for line in _too_oval(rod)),
        *((False, line) for line in opening(rod.elements.preload if rod.elements else None)),
        *_way_through(rod),
    ]
    return [line for holds, line in told if not holds], [line for holds, line in told if holds]


def least_safety(rod: RodStrength) -> str:
    """Return the least safeties of closed form, elements and bolts, with their places; NOT SAFE below 1."""
    worst = _least_safeties(rod)
    words = "; ".join(f"{what} {safety:.2f} ({place})" for what, (place, safety) in worst.items())
    return f"{'' if _is_safe(worst) else 'NOT SAFE: '}least safety: {words}"


def _is_safe(worst: Mapping[str, tuple[str, float]]) -> bool:
    return min(safety for _, safety in worst.values()) >= 1


def _least_safeties(rod: RodStrength) -> dict[str, tuple[str, float]]:
    """Return place and value of the least safety of each kind."""
    places = [(f"{one.place}, by elements", one) for one in (rod.elements.places if rod.elements else ())]
    every = [(one.section, one) for one in rod.sections] + places
    yielding = [(name, one.yield_safety) for name, one in every]
    yielding += [(f"shank buckling, {one.plane}", one.yield_safety) for one in rod.buckling]
    worst = {
        "yield": min(yielding, key=lambda one: one[1]),
        f"fatigue by {rod.method}": min(
            ((name, one.fatigue_safety) for name, one in every), key=lambda one: one[1]
        ),
    }
    if rod.bolt:
        worst["bolts by VDI 2230"] = rod.bolt.governing, rod.bolt.smallest_safety
    return worst


def _too_oval(rod: RodStrength) -> Iterator[str]:
    """Yield a line for each bore that changes by more than is permitted."""
    judges = (("", rod.eyes), (", by elements", rod.elements.eyes if rod.elements else ()))
    for by, eyes in judges:
        for eye in eyes:
            if eye.permitted_um and eye.ovalisation_um > eye.permitted_um:
                changed = f"the bore of the {eye.eye} changes by {eye.ovalisation_um:.1f} um"
                yield f"TOO OVAL: {changed} under the {eye.load}{by}; permitted are {eye.permitted_um:g} um"


def _way_through(rod: RodStrength) -> Iterator[tuple[bool, str]]:
    """Yield whether the big end goes through the cylinder, and how, where not or of an oblique split."""
    way = rod.passage
    size = f"{way.width_mm:.1f} mm across the rod, {way.over_corners_mm:.1f} mm over its corners"
    end, bore = f"the big end without its cap, {size}", f"the bore of {way.bore_mm:g} mm"
    if not way.passes:
        yield False, f"NOT THROUGH THE CYLINDER: {end}, does not pass {bore} from above"
    elif rod.oblique_split:
        yield True, f"{end}, passes {bore}"


def _split(split: ObliqueSplit) -> str:
    """Table of the oblique joint at its worst angles, and what friction alone holds."""
    states = (("parting", split.parting), ("shear", split.shear), ("sliding", split.sliding))
    columns: tuple[Column[tuple[str, SplitForce]], ...] = (
        Column("largest", 0, lambda s: s[0]),
        Column("parting_N", 0, lambda s: s[1].parting_N),
        Column("shear_N", 0, lambda s: s[1].shear_N),
        Column("speed_rpm", 0, lambda s: s[1].speed_rpm),
        Column("at_deg", 1, lambda s: s[1].crank_angle_deg),
    )
    table = terminal(tabulate(columns, [(name, one) for name, one in states if one]))
    lines = [
        f"Split oblique by {split.angle_deg:g} deg: force of the cap along the bolts and along the joint"
    ]
    lines.append(table)
    if split.sliding_safety is None:
        lines.append(
            f"serrations, a shoulder or dowels must carry {split.shear.shear_N:,.0f} N: no bolts are given"
        )
    elif split.left_for_shape_N:
        needed = f"serrations, a shoulder or dowels must carry {split.left_for_shape_N:,.0f} N beside it"
        lines.append(
            f"NOT HELD BY FRICTION: {split.sliding_safety:.2f} of the shear at {split.friction:g}; {needed}"
        )
    else:
        lines.append(f"friction of {split.friction:g} alone holds {split.sliding_safety:.2f} times the shear")
    return "\n\n".join(lines)


def _pin(pin: PinCheck) -> str:
    rows = (
        ("bending", f"{pin.bending_MPa:.1f} MPa"),
        ("shear", f"{pin.shear_MPa:.1f} MPa"),
        ("ovalisation", f"{pin.ovalisation_um:.1f} um, {pin.hoop_MPa:.1f} MPa"),
        ("pressure in the eye", f"{pin.eye_pressure_MPa:.1f} MPa"),
        ("pressure in the bosses", f"{pin.boss_pressure_MPa:.1f} MPa"),
    )
    return f"Piston pin under {pin.force_N:,.0f} N\n\n{labelled(rows)}"


def _by_elements(lighter: LighterRod) -> list[tuple[str, str]]:
    """Rows of what finite elements say of both rods, where they were asked."""
    safeties = (
        ("smallest against yield, elements", lighter.elements_yield_safety),
        ("smallest for fatigue, elements", lighter.elements_fatigue_safety),
    )
    return [(name, "{:.2f} -> {:.2f}".format(*pair)) for name, pair in safeties if pair]


def _ovalisations(lighter: LighterRod) -> Iterator[tuple[str, str]]:
    """Rows of what bores change by, and of what their limits cost."""
    rows = (
        ("small end's bore, um", lighter.small_end_ovalisation_um),
        ("big end's bore, um", lighter.big_end_ovalisation_um),
        ("small end's bore, um, elements", lighter.elements_small_end_ovalisation_um),
        ("big end's bore, um, elements", lighter.elements_big_end_ovalisation_um),
    )
    yield from ((name, "{:.1f} -> {:.1f}".format(*pair)) for name, pair in rows if pair)
    if lighter.result_without_limits_kg is not None:
        cost = lighter.result_kg - lighter.result_without_limits_kg
        yield "cost of the ovalisation's limits", f"{cost:.4f} kg"


def _lighter(lighter: LighterRod) -> str:
    change = 100 * (lighter.result_kg / lighter.start_kg - 1)
    rows = (
        ("mass", f"{lighter.start_kg:.4f} -> {lighter.result_kg:.4f} kg ({change_text(change)})"),
        ("smallest against yield", "{:.2f} -> {:.2f}".format(*lighter.smallest_yield_safety)),
        ("smallest for fatigue", "{:.2f} -> {:.2f}".format(*lighter.smallest_fatigue_safety)),
        *_by_elements(lighter),
        *_ovalisations(lighter),
        ("rod's unbalance", "{:.2f} -> {:.2f} kg mm".format(*lighter.rotating_unbalance_kg_mm)),
        (
            f"pull on the crankpin at {lighter.speed_rpm:g} rpm",
            "{:,.0f} -> {:,.0f} N".format(*lighter.crankpin_pull_N),
        ),
    )
    changed = terminal(tabulate(_FREE, lighter.dimensions))
    rods = lighter.rods_by_elements
    judged = f", by elements too: {rods} rods were judged" if rods else ""
    return f"A lighter rod at no less safety{judged}\n\n{labelled(rows)}\n\n{changed}"
