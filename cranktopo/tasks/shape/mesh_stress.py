"""Quantities read off the stresses of a throw on one mesh, smooth, and their derivatives by the nodes.

One adjoint solve per unit field and quantity, with the matrix that is factorised already, brings a derivative
by the stresses at the surface back to the nodes.
"""

from __future__ import annotations

from collections.abc import Collection

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import MPA_PER_GPA, density_tonne_per_mm3
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import LoadHistory, load_history
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, centrifugal_force
from cranktopo.numerics.tetrahedra.node_gradients import centrifugal_slopes, mean_slopes, work_slopes
from cranktopo.numerics.tetrahedra.stress import nodal_stress, outer_surface, surface_stress
from cranktopo.tasks.fatigue.needs import load_kinds
from cranktopo.tasks.fatigue.safety_field import unit_loads
from cranktopo.tasks.fatigue.stress_model import images_of
from cranktopo.tasks.fea.condense import Superelement, bending_motion, section_slopes, torsion_motion
from cranktopo.tasks.fea.unit_fields import UnitField, loaded, support_spring, twisted
from cranktopo.tasks.shape.smooth_safety import least_safety
from cranktopo.tasks.shape.smooth_stress import judged_surface, largest_stress
from cranktopo.tasks.shape.stress_adjoint import stress_adjoint

_SMOOTH = {"fatigue_safety": least_safety, "stress": largest_stress}


class MeshStress:
    """Quantities over the extreme load states of a scene, by name."""

    def __init__(self, scene: Scene, names: Collection[str]) -> None:
        """Find the load states, which the scene must tell."""
        enabled, kinds = load_kinds(scene, "extremes")
        self.scene, self.kinds = scene, kinds
        self.history: LoadHistory = load_history(scene, "extremes", enabled)
        self.names = tuple(name for name in _SMOOTH if name in names)

    @property
    def spins(self) -> bool:
        """True where the symmetric condensation needs the centrifugal load, as its only further load."""
        return "centrifugal" in self.kinds

    def responses(
        self, model: Elasticity, scene: Scene, bend: Superelement, twist: Superelement
    ) -> dict[str, tuple[float, float, Array]]:
        """Return each quantity on a mesh, by symmetric and antisymmetric condensation.

        Returns:
            Its extreme value; a smooth one, beside it by a factor that hardly changes; the derivative of the
            latter by the nodes, (3, nodes).
        """
        pushed = loaded(bend, self.scene, [kind for kind in self.kinds if kind != "torsion"])
        by_kind = {**pushed, "torsion": twisted(twist, self.scene)}
        fields = [by_kind[kind] for kind in self.kinds]
        moved = np.stack([field.displacement_mm for field in fields])
        found = nodal_stress(model, moved, *self._elastic)
        mirrored = bend.parts == 2
        planes = [(2, 0.0), (2, scene.pitch_mm / 2)] + ([(0, 0.0)] if mirrored else [])
        surface = outer_surface(model, found.elements, tuple(planes))
        loads = unit_loads(self.history, self.kinds)
        states = [loads * image.signs for image in images_of(fields, mirrored)]
        judged = judged_surface(scene, surface, surface_stress(model, surface, found), states)
        told = {}
        for name in self.names:
            smooth = _SMOOTH[name](self.scene, judged)
            forces, gradients = stress_adjoint(model, surface, found, moved, smooth.adjoint, self._elastic)
            gradients += self._through_fields(model, bend, twist, fields, forces)
            told[name] = smooth.extreme, smooth.value, gradients
        return told

    @property
    def _elastic(self) -> tuple[float, float]:
        return self.scene.material.E_GPa * MPA_PER_GPA, self.scene.material.poisson

    def _through_fields(
        self,
        model: Elasticity,
        bend: Superelement,
        twist: Superelement,
        fields: list[UnitField],
        forces: Array,
    ) -> Array:
        """Return the derivative by the nodes through all fields, (3, nodes), whose adjoints are `forces`."""
        pairs = list(zip(fields, forces, strict=True))

        def through(torsion: bool) -> Array:
            chosen = [pair for pair in pairs if (pair[0].kind == "torsion") == torsion]
            found = (self._through_field(model, bend, twist, *pair) for pair in chosen)
            return sum(found, np.zeros(model.nodes_mm.shape))

        one, other = side_by_side(lambda: through(True), lambda: through(False))
        return one + other

    def _through_field(
        self, model: Elasticity, bend: Superelement, twist: Superelement, field: UnitField, force: Array
    ) -> Array:
        """Return the derivative by the nodes through a field, (3, nodes), whose adjoint is `force`."""
        scene, kind = self.scene, field.kind
        block = twist if kind == "torsion" else bend
        count = len(block.motions)
        units = block.displacement[:, :count]
        section = block.parts * units.T @ force
        if kind == "torsion":
            spring = support_spring(scene, scene.supports.torsion)
            motion = torsion_motion(block, scene.supports.torsion, spring, section)
        else:
            spring = support_spring(scene, scene.supports.bending)
            motion = bending_motion(block, section, scene.supports.bending, spring)
        adjoint = block.solve(force[:, None])[:, 0] + units @ motion
        moved, load = field.displacement_mm, np.zeros(len(adjoint))
        gradients = -work_slopes(model, *self._elastic, moved, adjoint)
        if kind == "bending":
            gradients -= mean_slopes(model, 1, scene.web_z_mm[1], adjoint) / (2 * block.parts)
        if kind == "centrifugal":
            density = density_tonne_per_mm3(scene.material.density_kg_m3)
            load = centrifugal_force(model, density)
            gradients += centrifugal_slopes(model, density, adjoint)
        gradients += section_slopes(model, load - model.stiffness @ moved, adjoint)
        gradients += section_slopes(model, force - model.stiffness @ adjoint, moved)
        return gradients
