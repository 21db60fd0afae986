"""Consistency of a scene beyond single values: sizes, bearings, journals, bores, web, envelope."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.table import SOFTEST_BEARING_N_PER_MM
from cranktopo.design.checks.engine import check_engine, check_shaft
from cranktopo.design.checks.hardening import check_hardening
from cranktopo.design.checks.plain_bearings import check_bearings_of_free_dimensions, check_plain_bearings
from cranktopo.design.checks.roller_bearings import check_roller_bearings
from cranktopo.design.clearance import check_clearance
from cranktopo.design.free_dimensions import check_free_dimensions
from cranktopo.design.goal.scene_goal import check_goal
from cranktopo.design.halves import halves, of_second
from cranktopo.design.schema import Scene
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.checks import check_across_pin, check_apart
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.feature import SMALLEST, SMALLEST_FILLET, least_shoulder_mm
from cranktopo.throw.journal import ROUNDING_MM, Journal
from cranktopo.throw.raw_part.half import raw_half
from cranktopo.throw.recess import check_recesses_apart
from cranktopo.throw.web import check_inside


def _check_supports(scene: Scene) -> None:
    """Check that the bearing stiffness is given once, and given where a spring support needs it."""
    supports = scene.supports
    stiffness_keys = [
        key
        for key in ("bearing_spring_N_per_mm", "bearing_clearance_mm", "roller_bearing")
        if getattr(supports, key) is not None
    ]
    if len(stiffness_keys) > 1:
        raise CranktopoError(
            f"supports: {' and '.join(stiffness_keys)} each give the bearing stiffness.",
            hint="Keep one of them.",
        )
    if "spring" in (supports.torsion, supports.bending) and not stiffness_keys:
        raise scene.invalid(
            "supports.bearing_spring_N_per_mm",
            f"must be at least {SOFTEST_BEARING_N_PER_MM:g} N/mm when a support is 'spring'",
            "Give it, or bearing_clearance_mm, or roller_bearing.",
        )
    if supports.bearing_clearance_mm is not None and scene.engine is None:
        raise scene.invalid(
            "supports.bearing_clearance_mm",
            "needs an [engine]: the spring is half the largest pin force over 0.8 of the clearance",
        )
    check_roller_bearings(scene)


_LARGEST = 50.0
"""Largest dimension of the throw over its size, throw radius plus larger journal radius."""
ENVELOPE = 10.0
"""Reach of the design space over the size of the throw; counterweights need about 2."""
_UNITS = {25.4: "inches", 1000.0: "metres", 10.0: "centimetres"}


def _throw_size_mm(scene: Scene) -> float:
    throw = scene.throw
    return throw.radius_mm + max(throw.main_journal.radius_mm, throw.crankpin.radius_mm)


def _check_proportions(scene: Scene) -> None:
    for key, value, smallest in _dimensions(scene):
        _check(scene, key, value, smallest)


def _check_web_extent(scene: Scene) -> None:
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    _check(scene, "web (its length along the throw)", high - low, SMALLEST)
    _check(scene, "web (half of its width)", scene.web.largest_half_width_mm, SMALLEST)


def check_envelope_reach(scene: Scene, bounds_mm: tuple[float, float, float, float]) -> None:
    """Check that a design space (x_min, x_max, y_min, y_max), mm, is not many times larger than the throw."""
    size = _throw_size_mm(scene)
    reach = max(abs(bound) for bound in bounds_mm)
    if reach <= ENVELOPE * size:
        return
    units = [
        f"{unit} ({factor:g} times)" for factor, unit in _UNITS.items() if 0.5 < reach / size / factor < 4
    ]
    hint = f"Was it drawn in {' or '.join(units)}? " if units else ""
    raise invalid(
        "envelope",
        [round(bound, 3) for bound in bounds_mm],
        f"reaches {reach:.4g} mm from the crank axis, {reach / size:.3g} times the throw ({size:.4g} mm)",
        f"{hint}Give it in mm.",
    )


def _dimensions(scene: Scene) -> Iterator[tuple[str, float, float]]:
    """Key, value (mm) and smallest share of every dimension of the throw; 0 stands for none."""
    throw = scene.throw
    yield "throw.radius_mm", throw.radius_mm, SMALLEST
    for name, journal in (("main_journal", throw.main_journal), ("crankpin", throw.crankpin)):
        yield f"throw.{name}.outer_diameter_mm", journal.outer_diameter_mm, SMALLEST
        yield f"throw.{name}.bore_diameter_mm", journal.bore_diameter_mm, SMALLEST
        yield f"throw.{name}.length_mm", journal.length_mm, SMALLEST
        yield f"throw.{name}.fillet_mm", journal.fillet_mm, SMALLEST_FILLET
        yield f"throw.{name}.recess_mm", journal.recess_mm or 0.0, SMALLEST_FILLET
        yield f"throw.{name}.fillet_axial_mm", journal.fillet_axial_mm or 0.0, SMALLEST_FILLET
    for key, feature in throw.features():
        yield from feature.dimensions_mm(key)
    yield "web.thickness_mm", scene.web.thickness_mm, SMALLEST
    for key, feature in scene.web.features():
        yield from feature.dimensions_mm(key)


def check_proportion(scene: Scene, key: str, value: float) -> None:
    """Refuse a dimension of the crank that is out of proportion to its throw; 0 stands for none."""
    _check(scene, key, value, SMALLEST)


def _check(scene: Scene, key: str, value: float, smallest: float) -> None:
    size = _throw_size_mm(scene)
    if value and not smallest * size <= value <= _LARGEST * size:
        raise invalid(
            key,
            value,
            f"must be >= {smallest * size:.3g} and <= {_LARGEST * size:.3g} mm for a throw of {size:.4g} mm "
            "(throw radius plus journal radius)",
            "Correct that value, or its unit.",
        )


def check_solid(scene: Scene) -> None:
    """Check that the dimensions give one sound body: outline, fillets, bores, pockets, drillings."""
    web = scene.web
    features = list(web.features())
    web.check_outline(scene.throw.radius_mm)
    for key, feature in features:
        feature.check_alone(scene, key)
    outline = _outline_mm(scene)
    _check_journal(scene, "throw.main_journal", scene.throw.main_journal, 0.0, outline)
    _check_journal(scene, "throw.crankpin", scene.throw.crankpin, scene.throw.radius_mm, outline)
    for key, feature in features:
        feature.check_in_web(scene, key)
    for key, drilling in scene.throw.features():
        drilling.check_in_web(scene, key)
    check_apart(scene, drill_bores(scene))


_CLOSER_AT_ENDS = 1 - np.cos(np.linspace(0, np.pi, 4001))
"""Places along a web, over half its length."""


def _outline_mm(scene: Scene) -> tuple[Array, Array]:
    """Return y of places along the web, and its half width there."""
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    y = low + (high - low) * _CLOSER_AT_ENDS / 2
    return y, scene.web.half_width_mm(scene.throw.radius_mm, y)


def _shoulder_mm(scene: Scene, y_mm: float, outline_mm: tuple[Array, Array]) -> float:
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    y, half = outline_mm
    ends = min(y_mm - low, high - y_mm)
    return float(min(np.hypot(half, y - y_mm).min(), ends))


def _check_journal(
    scene: Scene, key: str, journal: Journal, y: float, outline_mm: tuple[Array, Array]
) -> None:
    edge = _shoulder_mm(scene, y, outline_mm)
    least = least_shoulder_mm(scene.throw)
    if edge <= 0:
        allowed = f"does not reach around the axis of {key} at y = {y:g} mm"
        raise scene.invalid("web.outline", allowed, "Widen or lengthen it.")
    if journal.bore_radius_mm >= edge - least:
        raise scene.invalid(
            f"{key}.bore_diameter_mm",
            f"breaks through the web's rim; must be smaller than {2 * (edge - least):.4g} mm",
            "Reduce the bore or widen the web.",
        )
    if journal.fillet_mm and journal.clear_radius_mm > edge - least + ROUNDING_MM:
        room = edge - least - journal.radius_mm - journal.fillet.half_mouth_mm
        allowed = f"at most {room:.4g} mm fits" if room > 0 else "no fillet fits"
        raise scene.invalid(
            f"{key}.fillet_mm",
            f"larger than the shoulder: the web's edge is {edge:.4g} mm from the axis, of which "
            f"{least:.3g} mm stay, {allowed}",
            "Reduce the fillet or widen the web.",
        )


def check_scene(scene: Scene) -> None:
    """Check that the parts of a scene fit together, in each half of its throw."""
    throw = scene.throw
    if throw.second_main_journal is not None and throw.second_main_journal_length_mm is not None:
        raise scene.invalid(
            "throw.second_main_journal_length_mm",
            "[throw.second_main_journal] has a length of its own",
            "Keep one of them.",
        )
    first, second = halves(scene)
    _check_half(first)
    check_plain_bearings(scene)
    if second is not first:
        try:
            _check_half(second)
        except CranktopoError as error:
            raise of_second(error, scene) from None
        bores = _named_bores(scene, first, "second"), _named_bores(scene, second, "first")
        check_across_pin((first, second), bores)


def _named_bores(scene: Scene, half: Scene, other: str) -> list[DrillBore]:
    own = (f"throw.drilling[{i}]" for i, one in enumerate(scene.throw.drilling) if one.web != other)
    return [replace(bore, key=key) for key, bore in zip(own, drill_bores(half), strict=True)]


def _check_drawing(scene: Scene) -> None:
    drawing = scene.drawing
    if drawing.hardening_depth_mm is not None and drawing.hardness_HRC is None:
        allowed = "a depth without a hardness"
        raise scene.invalid("drawing.hardening_depth_mm", allowed, "Give drawing.hardness_HRC, too.")


def _check_half(scene: Scene) -> None:
    scene.throw.main_journal.check("throw.main_journal")
    scene.throw.crankpin.check("throw.crankpin")
    _check_proportions(scene)
    check_recesses_apart(scene)
    scene.throw.check_bores_apart()
    check_engine(scene)
    _check_supports(scene)
    check_shaft(scene)
    _check_drawing(scene)
    check_hardening(scene)
    for key, feature in scene.throw.features():
        feature.check_alone(scene, key)
    check_solid(scene)
    if scene.forging is not None:
        raw_half(scene, scene.forging)
    _check_web_extent(scene)
    _check_envelope(scene)
    _check_optimise(scene)
    _check_tool(scene)
    check_free_dimensions(scene)
    check_bearings_of_free_dimensions(scene)
    check_goal(scene)


def _check_envelope(scene: Scene) -> None:
    envelope = scene.envelope
    if envelope is None:
        return
    envelope.check()
    for name in ("frozen", "removable"):
        for index, zone in enumerate(getattr(envelope, name)):
            if (found := zone.check()) is not None:
                raise scene.invalid(f"envelope.{name}[{index}].{found[0]}", found[1], "Correct it.")
    if envelope.stl_file is None:
        check_envelope_reach(scene, envelope.bounds_mm)
        check_inside(scene, envelope.spans)
    check_clearance(scene)
    clearance = envelope.bearing_clearance_mm + envelope.rod_clearance_mm
    if clearance >= scene.web.thickness_mm:
        raise scene.invalid(
            "envelope.rod_clearance_mm",
            f"with bearing_clearance_mm must leave some of the web's {scene.web.thickness_mm:g} mm",
        )


def _check_optimise(scene: Scene) -> None:
    settings = scene.optimise
    if settings.projection_first > settings.projection_last:
        raise scene.invalid(
            "optimise.projection_first",
            f"must be at most optimise.projection_last = {settings.projection_last:g}",
        )
    plain = scene.goal is None and settings.combine == "sum"
    if settings.method == "optimality_criteria" and not plain:
        raise scene.invalid(
            "optimise.method",
            "finds the least sum of compliances at a volume fraction, and nothing else",
            "Leave it out, or write 'moving_asymptotes'.",
        )


def _check_tool(scene: Scene) -> None:
    radius = scene.optimise.tool_radius_mm
    if radius is not None and radius > scene.throw.radius_mm:
        allowed = f"must be at most throw.radius_mm = {scene.throw.radius_mm:g} mm"
        raise scene.invalid("optimise.tool_radius_mm", allowed, "Give the radius of the mill.")
