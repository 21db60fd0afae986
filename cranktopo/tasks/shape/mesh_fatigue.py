"""Fatigue safety of a throw on one mesh as a smooth quantity, and its derivative by the nodes.

The least safety jumps from node to node, so the used strength, 1 / safety, is summed up by a p-norm over all
images of the throw and all nodes but those at sharp inner edges. One adjoint solve per unit field, with the
matrix that is factorised already, brings the derivative back to the nodes: every step of
`numerics.tetrahedra.stress` and of `stressed_surface` in reverse order.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import MPA_PER_GPA, density_tonne_per_mm3
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import HistoryKind, LoadHistory, load_history
from cranktopo.engine.load_case import LoadKind
from cranktopo.numerics.optimisers.gradient_search import central_difference
from cranktopo.numerics.tetrahedra.elasticity import STIFFNESS_ORDER, Elasticity, centrifugal_force
from cranktopo.numerics.tetrahedra.mesh import node_points, shape_gradients
from cranktopo.numerics.tetrahedra.node_gradients import (
    centrifugal_slopes,
    displacement_slopes,
    full_tensor,
    gather,
    mean_slopes,
    shape_slopes,
    work_slopes,
)
from cranktopo.numerics.tetrahedra.sharp_edges import near_sharp_edges
from cranktopo.numerics.tetrahedra.stress import (
    NodalStress,
    Surface,
    SurfaceStress,
    hooke,
    nodal_stress,
    nodes_from_points,
    outer_surface,
    surface_stress,
    triangle_gradients,
)
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.fillets import cut_outlet_nodes, fillet_nodes
from cranktopo.tasks.fatigue.hardened_layer import layers
from cranktopo.tasks.fatigue.hardening import Judge, TreatedFillet, harden, of_nodes, treated
from cranktopo.tasks.fatigue.lsa import LsaStrength, lsa, lsa_strength
from cranktopo.tasks.fatigue.needs import load_kinds
from cranktopo.tasks.fatigue.safety_field import unit_loads
from cranktopo.tasks.fatigue.stress_model import images_of
from cranktopo.tasks.fatigue.superposition import signed_von_mises_range
from cranktopo.tasks.fea.condense import Lateral, Superelement, bending_motion, section_slopes, torsion_motion
from cranktopo.tasks.fea.unit_fields import FieldKind, UnitField, loaded, support_spring, twisted

_PUSH: dict[FieldKind, tuple[int, float]] = {"bending": (1, -1.0), "tangential": (0, 1.0)}
"""Axis and sign of the unit forces on the pin."""
_BOTH_HALVES = np.array([1.0, 1.0, 1.0, 0.5, 0.5, 0.5])
"""A component off the diagonal stands at two places of the tensor."""


def stress_adjoint(
    model: Elasticity,
    surface: Surface,
    found: NodalStress,
    fields: Array,
    adjoint: tuple[Array, Array],
    elastic: tuple[float, float],
) -> tuple[Array, Array]:
    """Return the derivative of sum(adjoint * result of `surface_stress`) by displacements and nodes.

    Args:
        fields: displacements, shape (fields, unknowns).
        adjoint: of the stresses and of their derivatives into the depth, each (fields, surface nodes, 6).
        elastic: Young's modulus in MPa and Poisson's ratio.

    Returns:
        Shapes (fields, unknowns), displacements held for the second, (3, nodes).
    """
    of_stress, of_depth = adjoint
    nodal = np.zeros_like(found.nodal_MPa)
    nodal[:, surface.nodes] += of_stress
    by_nodes = np.zeros(model.nodes_mm.shape)
    _through_depth(model, surface, found, of_depth, nodal, by_nodes)
    return _through_nodes(model, found, fields, nodal, elastic, by_nodes), by_nodes


def _through_depth(
    model: Elasticity, surface: Surface, found: NodalStress, adjoint: Array, nodal: Array, by_nodes: Array
) -> None:
    """Add the adjoint of the derivatives into the depth to those of the nodal stresses and of the nodes."""
    number = np.bincount(surface.faces.ravel(), minlength=len(surface.nodes))
    active = (adjoint != 0).any(axis=(0, 2))
    chosen = active[surface.faces].any(axis=0)
    faces, local, owners = surface.faces[:, chosen], surface.local[:, chosen], surface.owners[chosen]
    cells = found.elements[:, owners]  # (10, f)
    reference = shape_gradients(node_points())[local]  # (6, f, 10, 3)
    jacobian = np.einsum("inf,pfnj->pfij", model.nodes_mm[:, cells], reference, optimize=True)
    direction = np.linalg.solve(jacobian, -surface.normals[faces][..., None])[..., 0]
    weights = np.einsum("pfnj,pfj->pfn", reference, direction, optimize=True)
    share = (adjoint / number[:, None])[:, faces]  # (fields, 6, f, 6)
    stress = found.nodal_MPa[:, cells]  # (fields, 10, f, 6)
    for total, part in zip(nodal, share, strict=True):
        np.add.at(total, cells, np.einsum("pfn,pfc->nfc", weights, part, optimize=True))
    of_weights = np.einsum("xpfc,xnfc->pfn", share, stress, optimize=True)
    of_direction = np.einsum("pfnj,pfn->pfj", reference, of_weights, optimize=True)
    inward = np.linalg.solve(jacobian.swapaxes(2, 3), of_direction[..., None])[..., 0]
    of_jacobian = -inward[..., :, None] * direction[..., None, :]
    _add(by_nodes, cells, np.einsum("pfij,pfnj->inf", of_jacobian, reference, optimize=True))
    of_normal = np.zeros((len(surface.nodes), 3))
    np.add.at(of_normal, faces, -inward)
    _through_normals(model, surface, (faces, cells, local), of_normal, by_nodes)


def _through_normals(
    model: Elasticity, surface: Surface, around: tuple[Index, Index, Index], adjoint: Array, by_nodes: Array
) -> None:
    """Add the adjoint of the unit normals of the surface nodes to that of the nodes."""
    faces, cells, _ = around
    numbers = surface.nodes[faces]
    at, gradients = model.nodes_mm[:, numbers], triangle_gradients()
    first, second = np.einsum("inf,pnk->kpfi", at, gradients)
    normal = np.cross(first, second)  # (6, f, 3)
    inside = model.nodes_mm[:, cells[:4]].mean(axis=1) - at[:, :3].mean(axis=1)
    sign = -np.sign(np.einsum("fi,if->f", normal.mean(axis=0), inside))[:, None]
    total = np.zeros_like(adjoint)
    np.add.at(total, faces, sign * normal)
    length = np.maximum(np.linalg.norm(total, axis=1, keepdims=True), np.finfo(float).tiny)
    unit = total / length
    of_total = (adjoint - unit * (unit * adjoint).sum(axis=1, keepdims=True)) / length
    of_normal = sign * of_total[faces]
    of_tangents = np.stack([np.cross(second, of_normal), np.cross(of_normal, first)])
    _add(by_nodes, numbers, np.einsum("kpfi,pnk->inf", of_tangents, gradients, optimize=True))


def _through_nodes(
    model: Elasticity,
    found: NodalStress,
    fields: Array,
    adjoint: Array,
    elastic: tuple[float, float],
    by_nodes: Array,
) -> Array:
    """Return the adjoint of the displacements, (fields, unknowns); that of the nodes is added to theirs."""
    from skfem import Basis, ElementTetP2

    active = (adjoint != 0).any(axis=(0, 2))
    elements = np.flatnonzero(active[found.elements].any(axis=0))
    basis = Basis(model.mesh, ElementTetP2(), intorder=STIFFNESS_ORDER, elements=elements)
    cells, volume = found.elements[:, elements], basis.dx.sum(axis=1)
    around = np.zeros(adjoint.shape[1])
    np.add.at(around, cells, np.broadcast_to(volume, cells.shape))
    around[~active] = 1.0
    share = (adjoint / around[:, None])[:, cells.T]  # (fields, e, 10, 6)
    shapes, result = shape_slopes(basis), np.zeros_like(fields)
    spread = nodes_from_points(basis.X)
    of_volume = np.zeros(len(elements))
    for field, u, part in zip(range(len(fields)), fields, share, strict=True):
        departure = found.element_MPa[field][elements] - found.nodal_MPa[field][cells.T]
        of_volume += np.einsum("enc,enc->e", part, departure)
        of_stress = np.einsum("nq,enc->eqc", spread, part * volume[:, None, None], optimize=True)
        of_slopes = full_tensor(hooke(of_stress, *elastic) * _BOTH_HALVES)
        mine = np.zeros(model.nodes_mm.shape)
        gather(mine, basis, np.einsum("eqij,njeq->nie", of_slopes, shapes, optimize=True))
        result[field] = mine.T.ravel()
        flow = -np.einsum("eqij,eqik->eqkj", of_slopes, displacement_slopes(basis, shapes, u), optimize=True)
        gather(by_nodes, basis, np.einsum("eqkj,njeq->nke", flow, shapes, optimize=True))
    gather(by_nodes, basis, np.einsum("e,eq,nkeq->nke", of_volume, basis.dx, shapes, optimize=True))
    return result


def _add(total: Array, nodes: Index, found: Array) -> None:
    """Add shares of nodes (n, f), (3, n, f), to (3, all nodes)."""
    for axis in range(3):
        np.add.at(total[axis], nodes, found[axis])


_POWER = 40.0
_NEGLIGIBLE = 1e-8
"""Weight of a node in the p-norm below which its derivative is left out."""
_STEP = 1e-6
"""Step of central differences of a node's used strength, of the largest stress."""


class FilletFatigue:
    """Safety by local stress analysis over the load states of a scene."""

    def __init__(self, scene: Scene, loads: HistoryKind = "extremes") -> None:
        """Find the load states, which the scene must tell: extremes joined, or every angle of the cycle."""
        enabled, kinds = load_kinds(scene, loads)
        self.scene, self.kinds = scene, kinds
        self.history: LoadHistory = load_history(scene, loads, enabled)

    def further(self, lateral: Lateral) -> tuple[LoadKind, ...]:
        """Return the further loads of a symmetric condensation with that symmetry in x, in their order."""
        held: dict[Lateral, tuple[LoadKind, ...]] = {"even": ("centrifugal",), "odd": ("tangential",)}
        return tuple(kind for kind in held.get(lateral, ("tangential", "centrifugal")) if kind in self.kinds)

    def safety(
        self,
        model: Elasticity,
        scene: Scene,
        bend: Superelement,
        twist: Superelement,
        side: Superelement | None = None,
    ) -> tuple[float, float, Array]:
        """Return the least safety on a mesh, by symmetric and antisymmetric condensation.

        Args:
            side: the symmetric condensation that is odd in x, where the tangential force acts on a model of
                one side of x = 0.

        Returns:
            The least; 1 over the p-norm of 1 / safety, which is below it by a factor that hardly changes; the
            derivative of the latter by the nodes, (3, nodes).
        """
        blocks: dict[FieldKind, Superelement] = dict.fromkeys(self.kinds, bend)
        blocks["torsion"], blocks["tangential"] = twist, side or bend
        pushed = [kind for kind in self.kinds if blocks[kind] is bend]
        by_kind = {**loaded(bend, self.scene, pushed), "torsion": twisted(twist, self.scene)}
        by_kind |= loaded(side, self.scene, ["tangential"]) if side else {}
        fields = [by_kind[kind] for kind in self.kinds]
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
            found = (self._through_field(model, blocks[field.kind], field, force) for field, force in chosen)
            return sum(found, np.zeros_like(gradients))

        one, other = side_by_side(lambda: through(True), lambda: through(False))
        return minimum, smooth, gradients + one + other

    @property
    def _elastic(self) -> tuple[float, float]:
        return self.scene.material.E_GPa * MPA_PER_GPA, self.scene.material.poisson

    def _smooth(
        self, scene: Scene, surface: Surface, stress: SurfaceStress, loads: list[Array]
    ) -> tuple[float, float, tuple[Array, Array]]:
        """Return minimum and smooth safety, and the latter's derivatives by stresses and depth slopes."""
        journal, pin = (fillet_nodes(scene, name, surface.points_mm) for name in ("journal", "pin"))
        fillets = journal | pin
        cut = cut_outlet_nodes(scene, surface.points_mm)
        on = np.flatnonzero(fillets | ~(near_sharp_edges(surface) | cut))
        masks = {"pin": pin, "journal": journal}
        hard = tuple(treated(scene, name, layer, masks[name]) for name, layer in layers(self.scene).items())
        here, judge = _at(stress, on), self._judge(fillets[on], of_nodes(hard, on))
        ranges = [signed_von_mises_range(here, load) for load in loads]
        used = np.stack([1 / judge(found.local) for found in ranges])
        worst = used.max()
        powers = (used / worst) ** _POWER
        norm = worst * powers.sum() ** (1 / _POWER)
        weights = -(powers / powers.sum()) * norm / used / norm**2  # d(1 / norm) / d(used)
        adjoint = np.zeros((2, *stress.stress_MPa.shape))
        for load, found, weight, power in zip(loads, ranges, weights, powers, strict=True):
            heavy = np.flatnonzero(power > _NEGLIGIBLE)
            own = self._judge(fillets[on[heavy]], of_nodes(hard, on[heavy]))
            decides = np.union1d(found.highest[heavy], found.lowest[heavy])  # few of the states of a cycle
            there = partial(_used, loads=load[decides], judge=own)
            gradients = _gradients_by_stress(there, _at(here, heavy))
            adjoint[:, :, on[heavy]] += gradients * weight[heavy, None]
        return float(1 / worst), float(1 / norm), (adjoint[0], adjoint[1])

    def _judge(self, on_fillet: NDArray[np.bool_], hard: tuple[TreatedFillet, ...]) -> Judge:
        """Return what tells the safety of nodes; on hardened fillets over all their depths."""
        strength, core = self._strength(on_fillet), lsa_strength(self.scene)

        def safety(local: LocalStress) -> Array:
            found = lsa(local, strength).safety
            return harden(found, lambda below: lsa(below, core).safety, hard, local) if hard else found

        return safety

    def _strength(self, on_fillet: NDArray[np.bool_]) -> LsaStrength:
        """Return the strength at nodes; a treatment of the fillets raises it nowhere else."""
        strength = lsa_strength(self.scene)
        factors = strength.treatment_factor, self.scene.fatigue.factor_off_fillets
        return replace(strength, treatment_factor=np.where(on_fillet, *factors))

    def _through_field(self, model: Elasticity, block: Superelement, field: UnitField, force: Array) -> Array:
        """Return the derivative by the nodes through a field, (3, nodes), whose adjoint is `force`."""
        scene, kind = self.scene, field.kind
        count = len(block.motions)
        units = block.displacement[:, :count]
        section = block.parts * units.T @ force
        if kind == "torsion":
            spring = support_spring(scene, scene.supports.torsion)
            motion = torsion_motion(block, scene.supports.torsion, spring, section)
        else:
            spring = support_spring(scene, scene.supports.bending)
            turning = kind != "tangential"
            motion = bending_motion(block, section, scene.supports.bending, spring, turning=turning)
        adjoint = block.solve(force[:, None])[:, 0] + units @ motion
        moved, load = field.displacement_mm, np.zeros(len(adjoint))
        gradients = -work_slopes(model, *self._elastic, moved, adjoint)
        if kind in _PUSH:
            axis, sign = _PUSH[kind]
            gradients += sign * mean_slopes(model, axis, scene.web_z_mm[1], adjoint) / (2 * block.parts)
        if kind == "centrifugal":
            density = density_tonne_per_mm3(scene.material.density_kg_m3)
            load = centrifugal_force(model, density)
            gradients += centrifugal_slopes(model, density, adjoint)
        gradients += section_slopes(model, load - model.stiffness @ moved, adjoint)
        gradients += section_slopes(model, force - model.stiffness @ adjoint, moved)
        return gradients


def _used(stress: SurfaceStress, loads: Array, judge: Judge) -> Array:
    return 1 / judge(signed_von_mises_range(stress, loads).local)


def _at(stress: SurfaceStress, nodes: NDArray[np.intp]) -> SurfaceStress:
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
