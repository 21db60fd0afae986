"""Consistency of a scene beyond single values: journals, bores, web and envelope must fit together."""

from __future__ import annotations

import numpy as np

from cranktopo.errors import invalid
from cranktopo.scene.bevel import bevel_arc
from cranktopo.scene.checks_engine import check_engine, check_supports
from cranktopo.scene.checks_web import check_solid
from cranktopo.scene.geometry import Journal, ProfileWeb
from cranktopo.scene.outline import y_range_mm
from cranktopo.scene.profile import profile_flank
from cranktopo.scene.schema import Scene


def check_scene(scene: Scene) -> None:
    """Check that the parts of a scene fit together.

    Raises:
        CranktopoError: first inconsistency found.
    """
    _check_journal("throw.main_journal", scene.throw.main_journal)
    _check_journal("throw.crankpin", scene.throw.crankpin)
    _check_bores_apart(scene)
    check_engine(scene)
    check_supports(scene)
    _check_profile(scene)
    _check_bevels(scene)
    check_solid(scene)
    _check_envelope(scene)


def _check_journal(key: str, journal: Journal) -> None:
    if journal.bore_diameter_mm >= journal.outer_diameter_mm:
        raise invalid(
            f"{key}.bore_diameter_mm",
            journal.bore_diameter_mm,
            f"must be smaller than {key}.outer_diameter_mm = {journal.outer_diameter_mm:g} mm",
            "Use 0 for a solid journal.",
        )
    if journal.fillet_mm >= journal.length_mm / 2:
        raise invalid(
            f"{key}.fillet_mm",
            journal.fillet_mm,
            f"must be smaller than half the journal's length ({journal.length_mm / 2:g} mm)",
        )


def _check_bores_apart(scene: Scene) -> None:
    """Main and pin bores both run through the web: they must not meet there."""
    main, pin, radius = scene.throw.main_journal, scene.throw.crankpin, scene.throw.radius_mm
    if main.bore_diameter_mm and pin.bore_diameter_mm and main.bore_radius_mm + pin.bore_radius_mm >= radius:
        raise invalid(
            "throw.crankpin.bore_diameter_mm",
            pin.bore_diameter_mm,
            f"pin and main bores meet in the web; their radii must add up to less than {radius:g} mm",
        )


def _check_profile(scene: Scene) -> None:
    web = scene.web
    if web.outline != "profile":
        return
    if len(web.stations_mm) != len(web.half_widths_mm):
        raise invalid(
            "web.half_widths_mm",
            web.half_widths_mm,
            f"must have one value per station ({len(web.stations_mm)})",
        )
    if any(b <= a for a, b in zip(web.stations_mm, web.stations_mm[1:], strict=False)):
        raise invalid("web.stations_mm", web.stations_mm, "must increase")
    _check_curve(web)


def _check_curve(web: ProfileWeb) -> None:
    """The curve between the stations must have one half-width at each y, and stay off the mid-plane."""
    flank = profile_flank(web)
    u = np.linspace(0, 1, 101)
    rise = flank.derivatives(np, u)[0][..., 1]
    x = flank.at(np, u)[..., 0]
    turned = np.argwhere((rise < -1e-9) | (x < -1e-9))
    if len(turned):
        low, high = web.stations_mm[turned[0, 0] : turned[0, 0] + 2]
        raise invalid(
            "web.half_widths_mm",
            web.half_widths_mm,
            f"the curve folds back between the stations at {low:g} and {high:g} mm",
            "Add a station there, or let the half-width change less.",
        )


def _check_bevels(scene: Scene) -> None:
    """Each bevel must start on the web and turn back nowhere, and the two must not meet."""
    web, radius = scene.web, scene.throw.radius_mm
    if len({bevel.face for bevel in web.bevel}) < len(web.bevel):
        raise invalid("web.bevel", web.bevel[0].face, "one bevel per face")
    starts = {"pin": y_range_mm(web, radius)[0], "journal": y_range_mm(web, radius)[1]}
    for index, bevel in enumerate(web.bevel):
        key, arc = f"web.bevel[{index}]", bevel_arc(web, radius, bevel)
        if bevel.depth_mm >= web.thickness_mm:
            allowed = f"must be smaller than web.thickness_mm = {web.thickness_mm:g} mm"
            raise invalid(f"{key}.depth_mm", bevel.depth_mm, allowed)
        if arc.start_mm >= arc.end_mm:
            end = starts[bevel.face]
            raise invalid(f"{key}.y_mm", bevel.y_mm, f"lies beyond the end of the outline at {end:g} mm")
        if bevel.crown_mm > arc.largest_crown_mm:
            allowed = f"must be at most {arc.largest_crown_mm:.4g} mm, or the arc turns back"
            raise invalid(f"{key}.crown_mm", bevel.crown_mm, allowed)
        starts[bevel.face] = bevel.y_mm
    if starts["pin"] >= starts["journal"]:
        raise invalid(
            "web.bevel", starts["pin"], f"the bevels overlap; the other starts at {starts['journal']:g} mm"
        )


def _check_envelope(scene: Scene) -> None:
    envelope = scene.envelope
    if envelope is None:
        return
    if envelope.shape == "box" and envelope.y_max_mm <= envelope.y_min_mm:
        raise invalid(
            "envelope.y_max_mm", envelope.y_max_mm, f"must be above y_min_mm = {envelope.y_min_mm:g} mm"
        )
    clearance = envelope.bearing_clearance_mm + envelope.rod_clearance_mm
    if clearance >= scene.web.thickness_mm:
        raise invalid(
            "envelope.rod_clearance_mm",
            envelope.rod_clearance_mm,
            f"with bearing_clearance_mm must leave some of the web's {scene.web.thickness_mm:g} mm",
        )
