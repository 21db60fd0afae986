"""Consistency of a scene beyond single values: journals, bores, web and envelope must fit together."""

from __future__ import annotations

from dataclasses import replace

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.design.checks.engine import check_engine
from cranktopo.design.checks.free_dimensions import check_free_dimensions
from cranktopo.design.checks.goal import check_goal
from cranktopo.design.checks.shaft import check_shaft
from cranktopo.design.checks.sizes import check_envelope_reach, check_proportions, check_web_extent
from cranktopo.design.checks.supports import check_supports
from cranktopo.design.checks.web import check_solid
from cranktopo.design.clearance import check_clearance
from cranktopo.design.halves import halves, of_second
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.checks import check_across_pin
from cranktopo.throw.drilling.table import drill_bores
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
    """Return the drillings of a half by their keys in the whole scene."""
    own = (f"throw.drilling[{i}]" for i, one in enumerate(scene.throw.drilling) if one.web != other)
    return [replace(bore, key=key) for key, bore in zip(own, drill_bores(half), strict=True)]


def _check_half(scene: Scene) -> None:
    scene.throw.main_journal.check("throw.main_journal")
    scene.throw.crankpin.check("throw.crankpin")
    check_proportions(scene)
    scene.throw.check_bores_apart()
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
