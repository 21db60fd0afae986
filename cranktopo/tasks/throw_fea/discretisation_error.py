"""Energy of the condensed blocks of a throw that its mesh misses."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.base.notes import at_work
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity
from cranktopo.numerics.tetrahedra.hierarchical_error import (
    DiscretisationError,
    hierarchical_estimator,
    straightened,
)
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.tasks.throw_fea.condense import loaded_mm


def volume_error(model: Elasticity, meshed: MeshedThrow) -> float:
    """Return the volume of a model over that of its body, less one."""
    return model.volume_error(2 if meshed.mesh.mirrored else 1, meshed.body.volume_mm3)


@at_work("error bounds of the mesh")
def discretisation_errors(
    model: Elasticity, meshed: MeshedThrow, blocks: Sequence[Superelement], scene: Scene
) -> list[DiscretisationError]:
    """Return what a mesh misses by the fields of each block that was condensed from it."""
    youngs, poisson = scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson
    surplus = hierarchical_estimator(model, blocks, youngs, poisson, loaded_mm(scene, meshed.whole))
    straight, added_mm3 = straightened(model, meshed.mesh, blocks, youngs, poisson)
    left = volume_error(model, meshed) - added_mm3 / model.volume_mm3
    return [DiscretisationError(*forms, left) for forms in zip(surplus, straight, strict=True)]
