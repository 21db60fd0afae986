"""Cross-sections of the design envelope, and discs, as point membership.

Each shape is a function of coordinate arrays x, y (mm) that returns a boolean array.
"""

from __future__ import annotations

from cranktopo.domain.stl_envelope import bounds_mm, section
from cranktopo.scene.geometry import Envelope
from cranktopo.scene.polygons import Shape, polygons

SECTIONS = 32
"""Layers of a body whose section changes along the crank axis."""


def disc(radius_mm: float, y_mm: float = 0.0, x_mm: float = 0.0) -> Shape:
    """Disc around the point (x, y)."""
    return lambda x, y: (x - x_mm) ** 2 + (y - y_mm) ** 2 <= radius_mm**2


def envelope_outline(envelope: Envelope, z_mm: float) -> Shape:
    """Cross-section of the design envelope at a height; only a mesh changes along the crank axis."""
    return (
        polygons(section(envelope.stl_file, z_mm, not envelope.asymmetry))
        if envelope.stl_file
        else envelope.contains
    )


def envelope_sections(envelope: Envelope) -> int:
    """Layers that the envelope is cut into."""
    return SECTIONS if envelope.stl_file else 1


def envelope_bounds_mm(envelope: Envelope) -> tuple[float, float, float, float]:
    """Ranges that hold the envelope: (x_min, x_max, y_min, y_max), mm."""
    return bounds_mm(envelope.stl_file, not envelope.asymmetry) if envelope.stl_file else envelope.bounds_mm
