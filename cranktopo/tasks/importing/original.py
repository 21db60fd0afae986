"""The body that a scene names as the original: which file, does it fit, and what it is without fillets."""

from __future__ import annotations

from pathlib import Path

from cranktopo.base.errors import invalid
from cranktopo.bodies.cells.domain import laterally_symmetric
from cranktopo.bodies.envelope_file import mirror_difference
from cranktopo.bodies.prisms import journal_halves, web_bores, web_region
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of
from cranktopo.tasks.importing.imported_body import half_throw_surface

_KEY = "original.file"
_SIDES = 5e-4
"""Share of the volume in which the sides of a body may differ that stands on cells of one side only."""


def original_file(scene: Scene) -> Path | None:
    """Return the file of the body that is the original, if a file is."""
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


def without_its_fillets(path: Path, scene: Scene) -> SurfaceMesh:
    """The half throw of a body with sharp corners at its journals, as the surface of a density has them.

    Its web, between the web's faces, stays; journals and bores are those of the scene.

    Args:
        scene: with the fillets and bores of the body.

    Raises:
        CranktopoError: it is no half throw where the journals are.
    """
    name = f"{_KEY} = '{path}'"
    web = web_region(solid_of(half_throw_surface(path, scene), name), scene)
    main, pin = journal_halves(scene)
    return mesh_of(web + main + pin - web_bores(scene))
