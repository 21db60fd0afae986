"""What a mesh misses of the energy of condensed blocks: by its displacements, and by its shape."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cranktopo.base.arrays import Array
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity
from cranktopo.tasks.fea.condense import Superelement, loaded_mm
from cranktopo.tasks.fea.hierarchical_estimator import hierarchical_estimator
from cranktopo.tasks.fea.straightened import straightened


@dataclass(frozen=True)
class DiscretisationError:
    """Twice the energy that the fields of a condensed block miss, as quadratic forms over their amplitudes.

    Attributes:
        surplus: what cubic displacements would add.
        straight: what elements miss that are straight where the surface is not.
        volume_error: volume of the mesh over that of the body, less one, without what straight elements add.
    """

    surplus: Array
    straight: Array
    volume_error: float


def volume_error(model: Elasticity, meshed: MeshedThrow) -> float:
    """Volume of a model of the half or whole throw over that of the body, less one."""
    return model.volume_mm3 * (2 if meshed.mesh.mirrored else 1) / meshed.body.volume_mm3 - 1


def discretisation_errors(
    model: Elasticity, meshed: MeshedThrow, blocks: Sequence[Superelement], scene: Scene
) -> list[DiscretisationError]:
    """Return what a mesh misses by the fields of each block that was condensed from it."""
    youngs, poisson = scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson
    surplus = hierarchical_estimator(model, blocks, youngs, poisson, loaded_mm(scene, meshed.whole))
    straight, added_mm3 = straightened(model, meshed.mesh, blocks, youngs, poisson)
    left = volume_error(model, meshed) - added_mm3 / model.volume_mm3
    return [DiscretisationError(*forms, left) for forms in zip(surplus, straight, strict=True)]
