"""The workshop drawing of a design as a file."""

from __future__ import annotations

from pathlib import Path

from cranktopo.base.files import replacing
from cranktopo.bodies.solid.files import half_surfaces, surface_of
from cranktopo.design.halves import difference, halves
from cranktopo.design.schema import Scene
from cranktopo.design.symmetry import mirror_image
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.tasks.drawing.sheet import write_drawing
from cranktopo.tasks.drawing.views import Sheet


def export_drawing(scene: Scene, path: Path) -> int:
    """Write the drawing of a scene's throw (.pdf, .svg or .png); the file appears only when complete.

    Returns:
        Number of its sheets.

    Raises:
        CranktopoError: impossible dimensions, or a file that cannot be written.
    """
    sheets = throw_sheets(scene)
    with replacing(path) as temporary:
        write_drawing(sheets, throw_balance(scene), [temporary])
    return len(sheets)


def throw_sheets(scene: Scene) -> list[Sheet]:
    """Return what a drawing of a throw shows: half of it, or both halves where they differ.

    The second half is turned half a turn about the throw direction, so that it too has its main journal on
    the left and is seen from the crankpin.

    Raises:
        CranktopoError: impossible dimensions.
    """
    if not difference(scene):
        return [Sheet(scene, solid_of(surface_of(scene, "half"), "half throw"))]
    near, far = halves(scene)
    first, second = (solid_of(mesh, "half throw") for mesh in half_surfaces(scene))
    turned = second.mirror((1.0, 0.0, 0.0))
    return [Sheet(near, first, half="first"), Sheet(mirror_image(far), turned, half="second")]
