"""Fatigue safety of the fillets on one mesh as a smooth quantity, and its derivative by the nodes.

The least safety jumps from node to node, so the used strength, 1 / safety, is summed up over all fillet nodes
and images of the throw by a p-norm. One adjoint solve per unit field, with the matrix that is factorised
already, brings the derivative back to the nodes.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import MPA_PER_GPA, density_tonne_per_mm3
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import LoadHistory, load_history
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, centrifugal_force
from cranktopo.numerics.tetrahedra.stress import (
    Surface,
    SurfaceStress,
    nodal_stress,
    outer_surface,
    surface_stress,
)
from cranktopo.tasks.fatigue.fillets import fillet_nodes
from cranktopo.tasks.fatigue.lsa import lsa, lsa_strength
from cranktopo.tasks.fatigue.safety_field import load_kinds, unit_loads
from cranktopo.tasks.fatigue.stress_model import images_of
from cranktopo.tasks.fatigue.superposition import signed_von_mises_range
from cranktopo.tasks.fea.condense import Superelement
from cranktopo.tasks.fea.node_gradients import centrifugal_slopes, mean_slopes, section_slopes, work_slopes
from cranktopo.tasks.fea.support_stiffness import bending_motion, torsion_motion
from cranktopo.tasks.fea.unit_fields import UnitField, loaded, support_spring, twisted
from cranktopo.tasks.shape.stress_adjoint import stress_adjoint

_POWER = 40.0
_NEGLIGIBLE = 1e-8
"""Weight of a node in the p-norm below which its derivative is left out."""
_STEP = 1e-6
"""Step of central differences of a node's used strength, of the largest stress."""


@dataclass(frozen=True)
class FilletSafety:
    """Fatigue safety of the fillets.

    Attributes:
        minimum: the least of all nodes.
        smooth: 1 over the p-norm of 1 / safety; below the least, by a factor that hardly changes.
        gradients: derivative of `smooth` by the nodes, (3, nodes).
    """

    minimum: float
    smooth: float
    gradients: Array


class FilletFatigue:
    """Safety by local stress analysis over the extreme load states of a scene."""

    def __init__(self, scene: Scene) -> None:
        """Find the load states.

        Raises:
            CranktopoError: the scene does not tell the loads.
        """
        enabled, kinds = load_kinds(scene, "extremes")
        self.scene, self.kinds = scene, kinds
        self.history: LoadHistory = load_history(scene, "extremes", enabled)

    @property
    def spins(self) -> bool:
        """True where the symmetric condensation needs the centrifugal load, as its only further load."""
        return "centrifugal" in self.kinds

    def safety(
        self, model: Elasticity, scene: Scene, bend: Superelement, twist: Superelement
    ) -> FilletSafety:
        """Return the safety of the fillets on a mesh.

        Args:
            scene: with the fillets of the mesh.
            bend, twist: symmetric and antisymmetric condensation.
        """
        fields = self._fields(bend, twist)
        moved = np.stack([field.displacement_mm for field in fields])
        found = nodal_stress(model, moved, *self._elastic)
        mirrored = bend.parts == 2
        planes = [(2, 0.0), (2, scene.pitch_mm / 2)] + ([(0, 0.0)] if mirrored else [])
        surface = outer_surface(model, found.elements, tuple(planes))
        stress = surface_stress(model, surface, found)
        signs = [image.signs for image in images_of(fields, mirrored)]
        minimum, smooth, adjoint = self._smooth(
            scene, surface, stress, [unit_loads(self.history, self.kinds) * s for s in signs]
        )
        forces, gradients = stress_adjoint(model, surface, found, moved, adjoint, self._elastic)
        pairs = list(zip(fields, forces, strict=True))

        def through(torsion: bool) -> Array:
            chosen = [pair for pair in pairs if (pair[0].kind == "torsion") == torsion]
            found = (self._through_field(model, bend, twist, *pair) for pair in chosen)
            return sum(found, np.zeros_like(gradients))

        one, other = side_by_side(lambda: through(True), lambda: through(False))
        return FilletSafety(minimum, smooth, gradients + one + other)

    @property
    def _elastic(self) -> tuple[float, float]:
        return self.scene.material.E_GPa * MPA_PER_GPA, self.scene.material.poisson

    def _fields(self, bend: Superelement, twist: Superelement) -> list[UnitField]:
        pushed = loaded(bend, self.scene, [kind for kind in self.kinds if kind != "torsion"])
        found = {**pushed, "torsion": twisted(twist, self.scene)}
        return [found[kind] for kind in self.kinds]

    def _smooth(
        self, scene: Scene, surface: Surface, stress: SurfaceStress, loads: list[Array]
    ) -> tuple[float, float, tuple[Array, Array]]:
        """Return minimum and smooth safety, and the latter's derivatives by stresses and depth slopes."""
        on = np.flatnonzero(sum(fillet_nodes(scene, name, surface.points_mm) for name in ("journal", "pin")))
        here = _at(stress, on)
        used = np.stack([self._used(here, load) for load in loads])
        worst = used.max()
        powers = (used / worst) ** _POWER
        norm = worst * powers.sum() ** (1 / _POWER)
        weights = -(powers / powers.sum()) * norm / used / norm**2  # d(1 / norm) / d(used)
        adjoint = np.zeros((2, *stress.stress_MPa.shape))
        for load, weight, power in zip(loads, weights, powers, strict=True):
            heavy = np.flatnonzero(power > _NEGLIGIBLE)
            gradients = _gradients_by_stress(partial(self._used, loads=load), _at(here, heavy))
            adjoint[:, :, on[heavy]] += gradients * weight[heavy, None]
        return float(1 / worst), float(1 / norm), (adjoint[0], adjoint[1])

    def _used(self, stress: SurfaceStress, loads: Array) -> Array:
        return 1 / lsa(signed_von_mises_range(stress, loads).local, lsa_strength(self.scene)).safety

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


def _at(stress: SurfaceStress, nodes: NDArray[np.intp]) -> SurfaceStress:
    """Return the stresses at some of the nodes."""
    return SurfaceStress(
        stress.stress_MPa[:, nodes], stress.depth_MPa_per_mm[:, nodes], stress.jump_MPa[:, nodes]
    )


def _gradients_by_stress(used: Callable[[SurfaceStress], Array], stress: SurfaceStress) -> Array:
    """Return derivatives of each node's used strength by its own stresses and slopes, (2, fields, n, 6)."""
    both = np.stack([stress.stress_MPa, stress.depth_MPa_per_mm])
    result = np.zeros_like(both)
    for place in np.ndindex(2, both.shape[1]):

        def shifted(component: Array, place: tuple[int, ...] = place) -> Array:
            moved = both.copy()
            moved[place] += component
            return used(SurfaceStress(moved[0], moved[1], stress.jump_MPa))

        result[place] = central_difference(shifted, np.zeros(6), _STEP * np.abs(both[place]).max())
    return result
