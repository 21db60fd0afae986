"""The body that a scene names as the original: which file, does it fit, and what it is without fillets."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

from cranktopo.base.errors import invalid
from cranktopo.bodies.cells.domain import laterally_symmetric
from cranktopo.bodies.envelope_file import mirror_difference
from cranktopo.bodies.prisms import journal_halves, web_bores, web_region
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of
from cranktopo.tasks.importing.imported_body import half_throw_surface

if TYPE_CHECKING:
    from manifold3d import Manifold

_KEY = "original.file"
_SIDES = 5e-4
"""Share of the volume in which the sides of a body may differ that stands on cells of one side only."""


def original_file(scene: Scene) -> Path | None:
    """Return the file of the body that is the original, if a file is."""
    return None if scene.original is None else Path(scene.original.file)


def check_original(scene: Scene) -> None:
    """Check that the original's body lies where the journals are and suits a model of one side."""
    path = original_file(scene)
    if path is None:
        return
    share = mirror_difference(_body(path, scene))
    if share > _SIDES and scene.envelope is not None and laterally_symmetric(scene, "envelope"):
        raise invalid(
            _KEY,
            str(path),
            f"its sides differ by {100 * share:.3g} % of its volume, and the model has the side x >= 0 only",
            'Set effects.lateral_symmetry = "off".',
        )


def without_its_fillets(path: Path, scene: Scene) -> SurfaceMesh:
    """Return the half throw of a body with sharp corners at its journals, as the surface of a density has.

    Its web stays; journals and bores are those of the scene, which has the fillets and bores of the body.
    """
    web = web_region(_body(path, scene), scene)
    main, pin = journal_halves(scene)
    return mesh_of(web + main + pin - web_bores(scene))


def _body(path: Path, scene: Scene) -> Manifold:
    return solid_of(half_throw_surface(path, scene), f"{_KEY} = '{path}'")
