"""Section of a solid in a plane: what has material on both sides of it.

A face that lies in the plane bounds the body there and is not cut: it would be in the limit from one side
alone. In numbers such a face lies some 1e-14 mm off the plane on either side, so that a slice at the plane
itself is one limit or the other by chance.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from manifold3d import CrossSection, Manifold

BESIDE_MM = 1e-3
"""Distance of both limits from the plane: far above rounding, far below what a drawing shows."""


def section_x(solid: Manifold) -> CrossSection:
    """Return the section x = 0 with z to the right and y up, mm."""
    return _section_z(solid.rotate((0.0, -90.0, 0.0)), 0.0).mirror((1.0, 0.0))


def section_y(solid: Manifold, y_mm: float) -> CrossSection:
    """Return the section across y with x to the right and z up, mm."""
    return _section_z(solid.rotate((-90.0, 0.0, 0.0)), -y_mm)


def _section_z(solid: Manifold, z_mm: float) -> CrossSection:
    return solid.slice(z_mm - BESIDE_MM) ^ solid.slice(z_mm + BESIDE_MM)
