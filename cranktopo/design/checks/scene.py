"""Consistency of a scene beyond single values: journals, bores, web and envelope must fit together."""

from __future__ import annotations

from dataclasses import replace

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.design.checks.engine import check_engine
from cranktopo.design.checks.free_dimensions import check_free_dimensions
from cranktopo.design.checks.goal import check_goal
from cranktopo.design.checks.sizes import check_envelope_reach, check_proportions, check_web_extent
from cranktopo.design.checks.web import check_solid
from cranktopo.design.clearance import check_clearance
from cranktopo.design.halves import halves, of_second
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import check_shaft
from cranktopo.design.supports import check_supports
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.checks import check_across_pin
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.feature import ROUNDING_MM
from cranktopo.throw.fillet import ASPECT
from cranktopo.throw.geometry import Journal
from cranktopo.throw.web import check_inside


def check_scene(scene: Scene) -> None:
    """Check that the parts of a scene fit together, in each half of its throw.

    Raises:
        CranktopoError: first inconsistency found.
    """
    first, second = halves(scene)
    _check_half(first)
    if second is not first:
        try:
            _check_half(second)
        except CranktopoError as error:
            raise of_second(error, scene) from None
        bores = _named_bores(scene, first, "second"), _named_bores(scene, second, "first")
        check_across_pin((first, second), bores)


def _named_bores(scene: Scene, half: Scene, other: str) -> list[DrillBore]:
    """The drillings of a half by their keys in the whole scene."""
    own = (f"throw.drilling[{i}]" for i, one in enumerate(scene.throw.drilling) if one.web != other)
    return [replace(bore, key=key) for key, bore in zip(own, drill_bores(half), strict=True)]


def _check_half(scene: Scene) -> None:
    _check_journal("throw.main_journal", scene.throw.main_journal)
    _check_journal("throw.crankpin", scene.throw.crankpin)
    check_proportions(scene)
    _check_bores_apart(scene)
    check_engine(scene)
    check_supports(scene)
    check_shaft(scene)
    for key, feature in scene.throw.features():
        feature.check_alone(scene, key)
    check_solid(scene)
    check_web_extent(scene)
    _check_envelope(scene)
    _check_optimise(scene)
    _check_tool(scene)
    check_free_dimensions(scene)
    check_goal(scene)


def _check_journal(key: str, journal: Journal) -> None:
    if journal.bore_diameter_mm >= journal.outer_diameter_mm:
        raise invalid(
            f"{key}.bore_diameter_mm",
            journal.bore_diameter_mm,
            f"must be smaller than {key}.outer_diameter_mm = {journal.outer_diameter_mm:g} mm",
            "Use 0 for a solid journal.",
        )
    _check_fillet(key, journal)


def _check_fillet(key: str, journal: Journal) -> None:
    fillet, given = journal.fillet, journal.fillet_axial_mm is not None
    key = f"{key}.fillet_axial_mm" if given else f"{key}.fillet_mm"
    low, high = (share * fillet.radial_mm for share in ASPECT)
    if given and not fillet.radial_mm:
        raise invalid(
            key, fillet.axial_mm, "an ellipse needs both semi-axes, and fillet_mm = 0", "Give fillet_mm, too."
        )
    if given and not low - ROUNDING_MM <= fillet.axial_mm <= high + ROUNDING_MM:
        raise invalid(
            key,
            fillet.axial_mm,
            f"must be >= {low:.4g} and <= {high:.4g} mm, {ASPECT[0]:g} to {ASPECT[1]:g} times fillet_mm = "
            f"{fillet.radial_mm:g} mm",
        )
    if fillet.axial_mm >= journal.length_mm / 2:
        raise invalid(
            key,
            fillet.axial_mm,
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


def _check_envelope(scene: Scene) -> None:
    envelope = scene.envelope
    if envelope is None:
        return
    envelope.check()
    if envelope.stl_file is None:
        check_envelope_reach(scene, envelope.bounds_mm)
        check_inside(scene, envelope.spans)
    check_clearance(scene)
    clearance = envelope.bearing_clearance_mm + envelope.rod_clearance_mm
    if clearance >= scene.web.thickness_mm:
        raise invalid(
            "envelope.rod_clearance_mm",
            envelope.rod_clearance_mm,
            f"with bearing_clearance_mm must leave some of the web's {scene.web.thickness_mm:g} mm",
        )


def _check_optimise(scene: Scene) -> None:
    settings = scene.optimise
    if settings.projection_first > settings.projection_last:
        raise invalid(
            "optimise.projection_first",
            settings.projection_first,
            f"must be at most optimise.projection_last = {settings.projection_last:g}",
        )
    plain = scene.goal is None and settings.combine == "sum"
    if settings.method == "optimality_criteria" and not plain:
        raise invalid(
            "optimise.method",
            settings.method,
            "finds the least sum of compliances at a volume fraction, and nothing else",
            "Leave it out, or write 'moving_asymptotes'.",
        )


def _check_tool(scene: Scene) -> None:
    radius = scene.optimise.tool_radius_mm
    if radius is not None and radius > scene.throw.radius_mm:
        allowed = f"must be at most throw.radius_mm = {scene.throw.radius_mm:g} mm"
        raise invalid("optimise.tool_radius_mm", radius, allowed, "Give the radius of the mill.")
