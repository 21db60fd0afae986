"""The workshop drawing of a design as a file."""

from __future__ import annotations

from pathlib import Path

from cranktopo.cad.solid_files import surface_of
from cranktopo.report.figures.drawing import write_drawing
from cranktopo.scene import Scene
from cranktopo.store.files import replacing

_FACETS = 40.0
"""Facets along the thinner journal's diameter."""


def export_drawing(scene: Scene, path: Path) -> None:
    """Write the drawing of a scene's half throw (.pdf, .svg or .png); the file appears only when complete.

    Raises:
        CranktopoError: impossible dimensions, or a file that cannot be written.
    """
    journals = (journal for journal, _ in scene.throw.journals)
    half = surface_of(scene, "half", min(journal.outer_diameter_mm for journal in journals) / _FACETS)
    with replacing(path) as temporary:
        write_drawing(scene, half, [temporary])
