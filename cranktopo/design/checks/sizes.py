"""Dimensions that no unit or typing error explains away: each against the size of the throw."""

from __future__ import annotations

from collections.abc import Iterator

from cranktopo.base.errors import invalid
from cranktopo.design.schema import Scene
from cranktopo.throw.feature import SMALLEST, SMALLEST_FILLET

_LARGEST = 50.0
"""Largest dimension of the throw over its size, throw radius plus larger journal radius."""
ENVELOPE = 10.0
"""Reach of the design space over the size of the throw; counterweights need about 2."""
_UNITS = {25.4: "inches", 1000.0: "metres", 10.0: "centimetres"}


def _throw_size_mm(scene: Scene) -> float:
    """Throw radius plus the larger journal radius, mm: what dimensions are compared with."""
    throw = scene.throw
    return throw.radius_mm + max(throw.main_journal.radius_mm, throw.crankpin.radius_mm)


def check_proportions(scene: Scene) -> None:
    """Check that no dimension of the throw is far from all others.

    Raises:
        CranktopoError: first one found.
    """
    for key, value, smallest in _dimensions(scene):
        _check(scene, key, value, smallest)


def check_web_extent(scene: Scene) -> None:
    """Check that a sound web is not far larger than the throw; raises CranktopoError."""
    low, high = scene.web.y_range_mm(scene.throw.radius_mm)
    _check(scene, "web (its length along the throw)", high - low, SMALLEST)
    _check(scene, "web (half of its width)", scene.web.largest_half_width_mm, SMALLEST)


def check_envelope_reach(scene: Scene, bounds_mm: tuple[float, float, float, float]) -> None:
    """Check that a design space is not many times larger than the throw.

    Args:
        bounds_mm: ranges that hold the design space (x_min, x_max, y_min, y_max).

    Raises:
        CranktopoError: it is, with the unit that would explain it.
    """
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
        yield f"throw.{name}.fillet_axial_mm", journal.fillet_axial_mm or 0.0, SMALLEST_FILLET
    for key, feature in throw.features():
        yield from feature.dimensions_mm(key)
    yield "web.thickness_mm", scene.web.thickness_mm, SMALLEST
    for key, feature in scene.web.features():
        yield from feature.dimensions_mm(key)


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
