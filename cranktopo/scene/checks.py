"""Consistency of a scene beyond single values: journals, bores, web and envelope must fit together."""

from __future__ import annotations

from cranktopo.errors import invalid
from cranktopo.scene.geometry import Journal
from cranktopo.scene.schema import Scene


def check_scene(scene: Scene) -> None:
    """Check that the parts of a scene fit together.

    Raises:
        CranktopoError: first inconsistency found.
    """
    _check_journal("throw.main_journal", scene.throw.main_journal)
    _check_journal("throw.crankpin", scene.throw.crankpin)
    _check_bores_apart(scene)
    _check_engine(scene)
    _check_shaft(scene)
    _check_supports(scene)
    _check_profile(scene)
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


def _check_engine(scene: Scene) -> None:
    engine = scene.engine
    if engine is not None and engine.rod_length_mm <= scene.throw.radius_mm:
        raise invalid(
            "engine.rod_length_mm",
            engine.rod_length_mm,
            f"must be longer than throw.radius_mm = {scene.throw.radius_mm:g} mm",
        )


def _check_shaft(scene: Scene) -> None:
    shaft = scene.shaft
    if shaft is not None and sorted(shaft.firing_order) != list(range(1, len(shaft.firing_order) + 1)):
        raise invalid(
            "shaft.firing_order",
            list(shaft.firing_order),
            f"must name each cylinder from 1 to {len(shaft.firing_order)} once",
        )


def _check_supports(scene: Scene) -> None:
    supports = scene.supports
    if "spring" in (supports.torsion, supports.bending) and supports.bearing_spring_N_per_mm is None:
        raise invalid("supports.bearing_spring_N_per_mm", None, "must be > 0 N/mm when a support is 'spring'")


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
