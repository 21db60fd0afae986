"""The body that a scene names as the original: checked before a run, written as the first step of a loop."""

from __future__ import annotations

from pathlib import Path

from cranktopo.domain.build import laterally_symmetric
from cranktopo.domain.stl_envelope import mirror_difference
from cranktopo.errors import invalid
from cranktopo.meshing.imported_body import half_throw_surface
from cranktopo.pipeline.iterate.solids import HALF, WEB
from cranktopo.scene import Scene
from cranktopo.surface.solids import web_region
from cranktopo.triangles.surface_files import write_stl
from cranktopo.triangles.surface_mesh import mesh_of, solid_of

_KEY = "original.file"
_SIDES = 5e-4
"""Share of the volume in which the sides of a body may differ that stands on cells of one side only."""


def original_file(scene: Scene) -> Path | None:
    """The file of the body that is the original, if a file is."""
    return None if scene.original is None else Path(scene.original.file)


def check_original(scene: Scene) -> None:
    """Check that the original's body is a half throw, lies where the journals are and suits the model.

    Raises:
        CranktopoError: it does not, or its sides differ where the model has one side only.
    """
    path = original_file(scene)
    if path is None:
        return
    share = mirror_difference(solid_of(half_throw_surface(path, scene), f"{_KEY} = '{path}'"))
    if share > _SIDES and scene.envelope is not None and laterally_symmetric(scene, "envelope"):
        raise invalid(
            _KEY,
            str(path),
            f"its sides differ by {100 * share:.3g} % of its volume, and the model has the side x >= 0 only",
            'Set effects.lateral_symmetry = "off".',
        )


def write_original(path: Path, scene: Scene, folder: Path) -> None:
    """Write the half throw of a file and its web as the solids of a loop's step.

    Raises:
        CranktopoError: as `check_original`, or a file cannot be written.
    """
    surface = half_throw_surface(path, scene)
    write_stl(folder / f"{HALF}.stl", surface)
    write_stl(folder / WEB, mesh_of(web_region(solid_of(surface, str(path)), scene)))
