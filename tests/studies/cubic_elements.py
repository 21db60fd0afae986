"""Stiffnesses of a throw with cubic displacements: the truth that the evaluation's bounds are held to.

Own basis, own element matrices and own solver, so that nothing of the estimate checks itself.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import LinearOperator, cg
from skfem import Basis, ElementTetP2

from cranktopo.base.units import MPA_PER_GPA
from cranktopo.numerics.tetrahedra.elasticity import (
    Elasticity,
    assemble,
    basis_above_plane,
    mean_displacement,
)
from cranktopo.numerics.tetrahedra.hierarchical_error import straightened
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.tasks.throw_fea.condense import (
    bending_stiffness_N_per_mm,
    condense,
    torsional_stiffness_Nm_per_rad,
)
from cranktopo.tasks.throw_fea.error_bound import bending_shares, torsion_shares
from cranktopo.tasks.throw_fea.evaluation import mesh_target
from cranktopo.tasks.throw_fea.targets import Target

Array = NDArray[np.float64]

EDGES = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
FACES = ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3))
_QUADRATURE = 4
_RESIDUAL = 3e-3
"""Of the solve for what cubic displacements add; the energy is good to its square."""


@dataclass(frozen=True)
class Both:
    """A stiffness of one mesh with quadratic and with cubic displacements.

    Attributes:
        straight: share of the displacement under load that straightened elements miss, to first order.
    """

    quadratic: float
    cubic: float
    straight: float


def both_orders(target: Target, element_size_mm: float) -> dict[str, Both]:
    """Torsional (free, N m/rad) and bending stiffness (pinned, N/mm) of a target on one mesh."""
    scene, meshed = target.scene, mesh_target(target, element_size_mm)
    youngs, poisson = scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson
    model = assemble(meshed.mesh, youngs, poisson)
    lateral = ("odd", "even") if meshed.mesh.mirrored else ("none", "none")
    twist = condense(model, scene, "antisymmetric", lateral[0])
    bend = condense(model, scene, "symmetric", lateral[1])
    cubic = _Cubic(model, youngs, poisson)
    stiff_twist = cubic.condensed(twist, scene.web_z_mm[1])
    stiff_bend = cubic.condensed(bend, scene.web_z_mm[1])
    torsion = [torsional_stiffness_Nm_per_rad(block, "free") for block in (twist, stiff_twist)]
    bending = [bending_stiffness_N_per_mm(block, "pinned") for block in (bend, stiff_bend)]
    forms, _ = straightened(model, meshed.mesh, (twist, bend), youngs, poisson)
    shares = torsion_shares(twist, forms[:1], "free"), bending_shares(bend, forms[1:], "pinned")
    return {"torsion": Both(*torsion, *shares[0]), "bending": Both(*bending, *shares[1])}


class _Cubic:
    """Cubic displacements on a mesh: the nodes' quadratic ones and a function per edge and per face."""

    def __init__(self, model: Elasticity, youngs: float, poisson: float) -> None:
        mesh = model.mesh
        self.model, self.nodes = model, mesh.doflocs.shape[1]
        self.count = 3 * (self.nodes + mesh.nedges + mesh.nfacets)
        basis = Basis(mesh, ElementTetP2(), intorder=_QUADRATURE)
        numbers, slopes = self._functions(basis)
        elements, points = basis.dx.shape
        flat = np.ascontiguousarray(slopes.transpose(1, 2, 0, 3)).reshape(elements, points, 60)
        outer = np.matmul((flat * basis.dx[:, :, None]).transpose(0, 2, 1), flat)
        outer = outer.reshape(elements, 20, 3, 20, 3)
        shear = youngs / (2 * (1 + poisson))
        matrix = 2 * shear * poisson / (1 - 2 * poisson) * outer + shear * outer.transpose(0, 1, 4, 3, 2)
        matrix += shear * np.einsum("eaibi->eab", outer)[:, :, None, :, None] * np.eye(3)[:, None, :]
        self.matrices = matrix.reshape(elements, 60, 60)
        self.unknowns = (3 * numbers.T[:, :, None] + np.arange(3)).reshape(elements, 60)
        ones, order = np.ones(self.unknowns.size), np.arange(self.unknowns.size)
        self.gather = sp.csr_matrix((ones, (self.unknowns.ravel(), order)), (self.count, self.unknowns.size))
        self.diagonal = self.gather @ np.einsum("eii->ei", self.matrices).ravel()

    def times(self, field: Array) -> Array:
        """Forces of a displacement field."""
        forces = np.matmul(self.matrices, field[self.unknowns][:, :, None])
        return np.asarray(self.gather @ forces.ravel())

    def condensed(self, block: Superelement, pin_from_mm: float) -> Superelement:
        """The block with cubic displacements."""
        quadratic, motions = 3 * self.nodes, len(block.motions)
        fields = np.vstack(
            [block.displacement, np.zeros((self.count - quadratic, block.displacement.shape[1]))]
        )
        loads = np.zeros_like(fields)
        if fields.shape[1] > motions:
            loads[:, motions] = self._pin_load(pin_from_mm)
        forces = np.stack([self.times(field) for field in fields.T]).T
        gain = self._gain(block, loads - forces)
        energy = fields.T @ forces
        stiffness = block.parts * (energy - gain)[:motions, :motions]
        if fields.shape[1] == motions:
            return replace(block, stiffness=stiffness)
        added = (gain - energy)[:, motions]
        compliance = 2 * block.load_compliance + added[motions] / block.parts
        return replace(
            block, stiffness=stiffness, load=block.load + added[:motions], load_compliance=compliance
        )

    def _gain(self, block: Superelement, residual: Array) -> Array:
        """Residuals times the displacements that answer them, with what the block holds at zero."""
        free = np.setdiff1d(np.arange(self.count), self._held(block))
        nodal = free[free < 3 * self.nodes]
        matrix = self.model.stiffness
        cycle = self.model.equations.two_level_cycle(np.setdiff1d(np.arange(3 * self.nodes), nodal))

        def product(x: Array) -> Array:
            field = np.zeros(self.count)
            field[free] = x.ravel()
            return self.times(field)[free]

        def precondition(x: Array) -> Array:
            x = x.ravel()
            load, field = np.zeros((2, 3 * self.nodes, 1))
            load[nodal, 0] = x[: len(nodal)]
            field[matrix.unknowns] = cycle(load[matrix.unknowns] / matrix.root) / matrix.root
            return np.concatenate([field[nodal, 0], x[len(nodal) :] / self.diagonal[free[len(nodal) :]]])

        shape = (len(free), len(free))
        operator, inverse = (LinearOperator(shape, f, dtype=float) for f in (product, precondition))
        right = residual[free]
        answers = np.zeros_like(right)
        for column in np.flatnonzero(np.linalg.norm(right, axis=0) > 1e-9 * np.linalg.norm(right)):
            answers[:, column] = cg(operator, right[:, column], rtol=_RESIDUAL, M=inverse)[0]
        left = right - np.stack([product(answer) for answer in answers.T]).T
        gain = right.T @ answers + answers.T @ left
        return np.asarray((gain + gain.T) / 2)

    def _functions(self, basis: Any) -> tuple[NDArray[np.intp], Array]:
        """Numbers and gradients of the twenty functions of each element, (20, e) and (20, e, points, 3)."""
        mesh, elements = self.model.mesh, basis.tind
        elements = np.arange(mesh.nelements) if elements is None else elements
        numbers = np.vstack([mesh.t2e[:, elements], mesh.nedges + mesh.t2f[:, elements]])
        inverse = basis.mapping.invDF(basis.X, tind=elements)
        corner = np.vstack([1 - basis.X.sum(axis=0), basis.X])
        slope = np.vstack([-np.ones(3), np.eye(3)])
        slopes = [
            np.outer(slope[a] - slope[b], corner[a] * corner[b])
            + np.outer(slope[a], corner[b] * (corner[a] - corner[b]))
            + np.outer(slope[b], corner[a] * (corner[a] - corner[b]))
            for a, b in EDGES
        ]
        slopes += [
            np.outer(slope[a], corner[b] * corner[c])
            + np.outer(slope[b], corner[a] * corner[c])
            + np.outer(slope[c], corner[a] * corner[b])
            for a, b, c in FACES
        ]
        cubic = np.einsum("jieq,njq->neqi", inverse, np.stack(slopes), optimize=True)
        cubic *= self._signs(elements)[:, :, None, None]
        quadratic = np.stack([phi[0].grad for phi in basis.basis]).transpose(0, 2, 3, 1)
        return np.vstack([basis.element_dofs, self.nodes + numbers]), np.concatenate([quadratic, cubic])

    def _signs(self, elements: NDArray[np.intp]) -> Array:
        corners = self.model.mesh.t[:, elements]
        edges = [np.where(corners[a] < corners[b], 1.0, -1.0) for a, b in EDGES]
        return np.vstack([*edges, np.ones((len(FACES), len(elements)))])

    def _pin_load(self, pin_from_mm: float) -> Array:
        """Mean of -u_y over the pin's material."""
        model = self.model
        basis, inside = basis_above_plane(model, pin_from_mm)
        corner = np.vstack([1 - basis.X.sum(axis=0), basis.X])
        values = [corner[a] * corner[b] * (corner[a] - corner[b]) for a, b in EDGES]
        values += [corner[a] * corner[b] * corner[c] for a, b, c in FACES]
        numbers = self._functions(basis)[0][10:]
        load = np.zeros(self.count)
        load[: 3 * self.nodes] = -mean_displacement(model, axis=1, z_from_mm=pin_from_mm)
        weights = self._signs(basis.tind) * (np.stack(values) @ inside.T)
        np.add.at(load, 3 * numbers + 1, -weights / inside.sum())
        return load

    def _held(self, block: Superelement) -> NDArray[np.intp]:
        """Held unknowns: a function is held like all nodes of its edge or face."""
        mesh = self.model.mesh
        fixed = np.zeros(3 * self.nodes, dtype=bool)
        fixed[block.held] = True
        fixed = fixed.reshape(-1, 3)
        edges = fixed[mesh.edges].all(axis=0) & fixed[mesh.nvertices :]
        faces = fixed[mesh.facets].all(axis=0) & edges[mesh.f2e].all(axis=0)
        return np.flatnonzero(np.vstack([fixed, edges, faces]).ravel())
