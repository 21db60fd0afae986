"""Cross-sections of the design envelope."""

from __future__ import annotations

from cranktopo.base.polygons import polygon_section
from cranktopo.base.spans import Section
from cranktopo.bodies.envelope_file import bounds_mm, section
from cranktopo.throw.geometry import Envelope

SECTIONS = 32
"""Layers of a body of triangles, whose section changes along the crank axis."""


def envelope_section(envelope: Envelope, z_mm: float) -> Section:
    """Cross-section of the design envelope at a height; only a mesh changes along the crank axis."""
    return (
        polygon_section(section(envelope.stl_file, z_mm, not envelope.asymmetry))
        if envelope.stl_file
        else envelope.spans
    )


def envelope_sections(envelope: Envelope) -> int:
    """Layers that the envelope is cut into."""
    return SECTIONS if envelope.stl_file else 1


def envelope_bounds_mm(envelope: Envelope) -> tuple[float, float, float, float]:
    """Ranges that hold the envelope: (x_min, x_max, y_min, y_max), mm."""
    return bounds_mm(envelope.stl_file, not envelope.asymmetry) if envelope.stl_file else envelope.bounds_mm
