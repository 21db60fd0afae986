"""Quantities of a parametric web on one body-fitted mesh that moves with it, with exact discrete gradients.

The elements stay the same while the parameters change, so that a search sees none of the noise of new
meshes; the gradients are those of these very numbers.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.evaluate.condense import Lateral, condense
from cranktopo.evaluate.elasticity import Elasticity, assemble, centrifugal_force
from cranktopo.meshing.solid_mesh import MeshedThrow, TetMesh, mesh_throw
from cranktopo.remodel.family import Layout, exact_web_of
from cranktopo.remodel.fit import scene_with_web
from cranktopo.scene import Scene
from cranktopo.shape.mesh_fatigue import FilletFatigue
from cranktopo.shape.mesh_stiffness import bending_slopes, torsion_slopes
from cranktopo.shape.moved_mesh import MovedMesh
from cranktopo.shape.node_gradients import moments
from cranktopo.units import MPA_PER_GPA, density_kg_per_mm3, density_tonne_per_mm3

Array = NDArray[np.float64]


@dataclass(frozen=True)
class MeshResponses:
    """Quantities of a web on a body-fitted mesh and their gradients by its parameters.

    Attributes:
        values: by quantity: torsion N m/rad, bending N/mm, mass kg, inertia kg mm2, unbalance kg mm, and both
            stiffnesses per mass; with fatigue fatigue_safety, smooth, and the least one where the mesh was
            made.
        slopes: the same, each (parameters,), per mm or degree.
        quality: least Jacobian of an element over its own in the new mesh; make a new one when it falls.
    """

    values: dict[str, float]
    slopes: dict[str, Array]
    quality: float


class MeshModel:
    """A web of a layout on one mesh, as functions of its parameters."""

    def __init__(
        self,
        scene: Scene,
        layout: Layout,
        values: Array,
        element_size_mm: float,
        fillet_fraction: float | None = None,
    ) -> None:
        """Mesh the web with these values.

        Args:
            fillet_fraction: element size on a fillet over its radius; with it the fatigue safety is found.

        Raises:
            CranktopoError: they make no sound web, or there is no valid mesh.
        """
        self.scene = scene_with_web(scene, exact_web_of(layout, values, scene))
        meshed = mesh_throw(self.scene, element_size_mm, fillet_fraction=fillet_fraction)
        self.moved = MovedMesh(meshed.mesh, self.scene, layout, values)
        self._parts = 2 if meshed.mesh.mirrored else 1
        self._missing = _exact(meshed) - self._parts * moments(self._model(self.moved.mesh))[0]
        self._fatigue = FilletFatigue(self.scene) if fillet_fraction is not None else None
        self._smoothing: float | None = None

    def responses(self, values: Array) -> MeshResponses:
        """Quantities of the web with these values, and their gradients.

        Raises:
            CranktopoError: the mesh folds, or a failed solve.
        """
        mesh = self.moved.at(values)
        model = self._model(mesh)
        found, by_nodes = self._masses(model)
        sides: tuple[Lateral, Lateral] = ("odd", "even") if mesh.mirrored else ("none", "none")
        twist = condense(model, self.scene, "antisymmetric", sides[0])
        found["torsion"], by_nodes["torsion"] = torsion_slopes(model, self.scene, twist)
        bend = condense(model, self.scene, "symmetric", sides[1], self._spin(model))
        found["bending"], by_nodes["bending"] = bending_slopes(model, self.scene, bend)
        if self._fatigue is not None:
            safety = self._fatigue.safety(model, bend, twist)
            if self._smoothing is None:
                self._smoothing = safety.least / safety.smooth
            found["fatigue_safety"] = self._smoothing * safety.smooth
            by_nodes["fatigue_safety"] = self._smoothing * safety.slopes
        motion = self.moved.velocities(mesh, values)
        slopes = {name: np.einsum("in,inp->p", slope, motion) for name, slope in by_nodes.items()}
        for name in ("torsion", "bending"):
            ratio = found[name] / found["mass"]
            found[f"{name}_per_mass"] = ratio
            slopes[f"{name}_per_mass"] = (slopes[name] - ratio * slopes["mass"]) / found["mass"]
        return MeshResponses(found, slopes, self.moved.quality(mesh))

    def _model(self, mesh: TetMesh) -> Elasticity:
        material = self.scene.material
        return assemble(mesh, material.E_GPa * MPA_PER_GPA, material.poisson)

    def _spin(self, model: Elasticity) -> Array | None:
        """Nodal forces of the centrifugal load, if the fatigue safety needs them."""
        if self._fatigue is None or not self._fatigue.spins:
            return None
        return centrifugal_force(model, density_tonne_per_mm3(self.scene.material.density_kg_m3))[:, None]

    def _masses(self, model: Elasticity) -> tuple[dict[str, float], dict[str, Array]]:
        """Mass, inertia and unbalance of the whole throw, exact where the mesh was made, and their slopes."""
        kg = 2 * density_kg_per_mm3(self.scene.material.density_kg_m3)
        integrals, slopes = moments(model)
        names = ("mass", "unbalance", "inertia")
        found = kg * (self._parts * integrals + self._missing)
        return (
            dict(zip(names, found.tolist(), strict=True)),
            {name: kg * self._parts * slope for name, slope in zip(names, slopes, strict=True)},
        )


def _exact(meshed: MeshedThrow) -> Array:
    """Volume of the half throw, its moment in y and that of x2 + y2, from the exact solid."""
    half = meshed.half
    return np.array([half.volume_mm3, half.volume_mm3 * half.centre_mm[1], half.inertia_z_mm5])
