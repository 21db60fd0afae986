"""The workshop drawing of a design as a file."""

from __future__ import annotations

from pathlib import Path

from cranktopo.cad.solid_files import surface_of
from cranktopo.loads.balance import throw_balance
from cranktopo.report.figures.drawing import write_drawing
from cranktopo.scene import Scene
from cranktopo.store.files import replacing


def export_drawing(scene: Scene, path: Path) -> None:
    """Write the drawing of a scene's half throw (.pdf, .svg or .png); the file appears only when complete.

    Raises:
        CranktopoError: impossible dimensions, or a file that cannot be written.
    """
    half = surface_of(scene, "half")
    with replacing(path) as temporary:
        write_drawing(scene, throw_balance(scene), half, [temporary])
