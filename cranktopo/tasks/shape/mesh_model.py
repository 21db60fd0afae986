"""Quantities of a parametric web on one body-fitted mesh that moves with it, with exact discrete gradients.

The elements stay the same while the parameters change, so that a search sees none of the noise of new
meshes; the gradients are those of these very numbers. A stiffness needs no adjoint solve: its compliance is a
minimum of energy, so that with the displacements held its derivative is that of the energy, and the supports
are algebra on the condensed matrices.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import MPA_PER_GPA, density_kg_per_mm3, density_tonne_per_mm3
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, mesh_throw
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.goal.quantities import quantity_named
from cranktopo.design.halves import require_equal_halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble, centrifugal_force
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.tasks.fea.condense import RZ, Lateral, Superelement, condense
from cranktopo.tasks.fea.node_gradients import mean_slopes, moments, section_slopes, work_slopes
from cranktopo.tasks.fea.support_stiffness import (
    bending_motion,
    bending_stiffness_N_per_mm,
    torsion_motion,
    torsional_stiffness_Nm_per_rad,
)
from cranktopo.tasks.fea.unit_fields import support_spring
from cranktopo.tasks.refit.dimensions import scene_at
from cranktopo.tasks.refit.family import Layout, exact_web_of
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.tasks.shape.mesh_fatigue import FilletFatigue
from cranktopo.tasks.shape.moved_mesh import MovedMesh
from cranktopo.tasks.shape.search_goal import Quantities

_RESIDUAL = 1e-4
"""Accepted in a search: errors far below those of its mesh; solves aim at a hundredth of it."""
_ByNodes = dict[str, tuple[float, Array]]
"""Quantities by name with their derivatives by the nodes, (3, nodes)."""


class MeshResponses(Quantities):
    """Quantities of a web on a body-fitted mesh and their gradients by its parameters.

    Torsion N m/rad, bending N/mm, mass kg, inertia kg mm2, unbalance kg mm, and both stiffnesses per mass;
    fatigue_safety where it is wanted: smooth, and the minimum one for the first web asked for.
    """

    def scaled(self, shares: Mapping[str, float]) -> MeshResponses:
        """Return the same with every quantity times its share, by default 1."""
        share = {name: shares.get(name, 1.0) for name in self.values}
        return MeshResponses(
            {name: share[name] * value for name, value in self.values.items()},
            {name: share[name] * slope for name, slope in self.gradients.items()},
        )

    def calibrated(self, truth: Mapping[str, float]) -> MeshResponses:
        """Return with the values of a truth; slopes in proportion, but as they are for what may be 0."""
        both = self.values.keys() & truth.keys()
        signed = {name for name in both if quantity_named(name).signed}
        found = self.scaled({name: truth[name] / self.values[name] for name in both - signed})
        return MeshResponses(found.values | {name: truth[name] for name in signed}, found.gradients)


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
        require_equal_halves(scene)
        sized = scene_at(scene, layout, values)
        self.scene = scene_with_web(sized, exact_web_of(layout, values, sized))
        meshed = mesh_throw(self.scene, element_size_mm, fillet_fraction=fillet_fraction)
        self._layout = layout
        self.moved = MovedMesh(meshed.mesh, self.scene, layout, values)
        self._parts = 2 if meshed.mesh.mirrored else 1
        self._unmoved = self._model(self.moved.mesh)
        self._missing = _exact(meshed) - self._parts * moments(self._unmoved)[0]
        self._fatigue = FilletFatigue(self.scene) if fillet_fraction is not None else None
        self._smoothing = 0.0

    def responses(self, values: Array, quantities: Collection[str] | None = None) -> MeshResponses:
        """Return quantities of the web with these values, and their gradients.

        Args:
            quantities: those that are wanted, by default all; masses cost next to nothing and are always
                there, fatigue safety where the mesh was made for it.

        Raises:
            CranktopoError: the mesh folds, or a failed solve.
        """
        mesh = self.moved.at(values)
        model = self._unmoved if mesh is self.moved.mesh else self._model(mesh)
        scene = scene_at(self.scene, self._layout, values)
        found = {**self._masses(model), **self._solved(model, scene, mesh.mirrored, quantities)}
        motion = self.moved.velocities(mesh, values)
        numbers = {name: value for name, (value, _) in found.items()}
        gradients = {name: np.einsum("in,inp->p", slope, motion) for name, (_, slope) in found.items()}
        for name in [name for name in ("torsion", "bending") if name in found]:
            ratio = numbers[name] / numbers["mass"]
            numbers[f"{name}_per_mass"] = ratio
            gradients[f"{name}_per_mass"] = (gradients[name] - ratio * gradients["mass"]) / numbers["mass"]
        return MeshResponses(numbers, gradients)

    def _solved(
        self, model: Elasticity, scene: Scene, mirrored: bool, quantities: Collection[str] | None
    ) -> _ByNodes:
        """Return what needs displacements, of the quantities that are wanted."""
        found: _ByNodes = {}
        safety = self._fatigue if quantities is None or "fatigue_safety" in quantities else None

        def block(kind: str) -> Superelement | None:
            asked = quantities is None or {kind, f"{kind}_per_mass"} & set(quantities)
            return self._condensed(model, scene, kind, mirrored) if safety or asked else None

        twist, bend = side_by_side(lambda: block("torsion"), lambda: block("bending"))
        if twist:
            found["torsion"] = _torsion_gradient(model, scene, twist)
        if bend:
            found["bending"] = _bending_gradient(model, scene, bend)
        if safety and twist and bend:
            fillets = safety.safety(model, scene, bend, twist)
            self._smoothing = self._smoothing or fillets.minimum / fillets.smooth
            found["fatigue_safety"] = self._smoothing * fillets.smooth, self._smoothing * fillets.gradients
        return found

    def _condensed(self, model: Elasticity, scene: Scene, kind: str, mirrored: bool) -> Superelement:
        """Return the block of a stiffness."""
        if kind == "torsion":
            return condense(model, scene, "antisymmetric", "odd" if mirrored else "none", None, _RESIDUAL)
        side: Lateral = "even" if mirrored else "none"
        return condense(model, scene, "symmetric", side, self._spin(model), _RESIDUAL)

    def _model(self, mesh: TetMesh) -> Elasticity:
        material = self.scene.material
        return assemble(mesh, material.E_GPa * MPA_PER_GPA, material.poisson)

    def _spin(self, model: Elasticity) -> Array | None:
        """Return nodal forces of the centrifugal load, if the fatigue safety needs them."""
        if self._fatigue is None or not self._fatigue.spins:
            return None
        return centrifugal_force(model, density_tonne_per_mm3(self.scene.material.density_kg_m3))[:, None]

    def _masses(self, model: Elasticity) -> _ByNodes:
        """Return mass, inertia and unbalance of the throw and gradients, exact where the mesh was made."""
        kg, bolted = 2 * density_kg_per_mm3(self.scene.material.density_kg_m3), bolted_mass(self.scene)
        integrals, gradients = moments(model)
        names = ("mass", "unbalance", "inertia")
        parts = np.array([bolted.volume, bolted.first_y, bolted.polar])
        found = kg * (self._parts * integrals + self._missing) + 2 * parts
        pairs = zip(found.tolist(), kg * self._parts * gradients, strict=True)
        return dict(zip(names, pairs, strict=True))


def _exact(meshed: MeshedThrow) -> Array:
    """Return the volume of the half throw, its moment in y and that of x2 + y2, from the exact solid."""
    half = meshed.body
    return np.array([half.volume_mm3, half.volume_mm3 * half.centre_mm[1], half.inertia_z_mm5])


def _torsion_gradient(model: Elasticity, scene: Scene, block: Superelement) -> tuple[float, Array]:
    """Return the torsional stiffness, N m/rad, with the scene's support, and its derivative by the nodes.

    Args:
        block: antisymmetric condensation.
    """
    support = scene.supports.torsion
    spring = support_spring(scene, support)
    value = torsional_stiffness_Nm_per_rad(block, support, spring)
    motion = torsion_motion(block, support, spring)
    field = block.displacement[:, : len(motion)] @ motion
    twist = float(motion[block.motions.index(RZ)])
    return value, value / twist * block.parts * _work(model, scene, field)


def _bending_gradient(model: Elasticity, scene: Scene, block: Superelement) -> tuple[float, Array]:
    """Return the bending stiffness, N/mm, with the scene's support, and its derivative by the nodes.

    Args:
        block: symmetric condensation.
    """
    support = scene.supports.bending
    spring = support_spring(scene, support)
    value = bending_stiffness_N_per_mm(block, support, spring)
    motion = bending_motion(block, block.load, support, spring)
    count = len(motion)
    field = block.displacement[:, :count] @ motion + block.displacement[:, count] / block.parts
    sunk = -2 * mean_slopes(model, 1, scene.web_z_mm[1], field) - block.parts * _work(model, scene, field)
    return value, -(value**2) / 2 * sunk


def _work(model: Elasticity, scene: Scene, field: Array) -> Array:
    """Return the derivative of field' K field by the nodes, the section moving rigidly as it does."""
    inner = work_slopes(model, scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson, field, field)
    return inner + 2 * section_slopes(model, model.stiffness @ field, field)
