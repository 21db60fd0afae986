"""A direct solve that shares nothing with the solver but the 24 x 24 element matrices.

Element by element into a sparse matrix, supports by elimination in the plain motions of a section, sparse
LU. Its own residual and its sensitivity to rounding are part of the answer: at extreme contrast a
direct solve loses digits too.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray
from scipy.sparse.linalg import SuperLU, splu

from cranktopo.numerics.grid.boundary_conditions import CaseSupports
from cranktopo.numerics.grid.lattice import CORNERS, Lattice, layer_stiffness

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Direct:
    """Reduced equations of one load case and their direct solution.

    Attributes:
        matrix: stiffness of the displacements that the supports leave free, with springs.
        space: (3 nodes, free) displacements of all nodes per free amplitude.
        loads: forces on the free amplitudes.
        amplitudes: the solution.
        residual: relative residual of the direct solve itself.
    """

    matrix: sp.csr_matrix
    space: sp.csr_matrix
    loads: Array
    amplitudes: Array
    residual: float

    def energy_error(self, displacements: Array) -> float:
        """Energy norm of the difference of displacements (3, nodes...) to the solution, relative to it."""
        difference = self._amplitudes_of(displacements) - self.amplitudes
        energy = self.amplitudes @ (self.matrix @ self.amplitudes)
        return float(np.sqrt(max(difference @ (self.matrix @ difference), 0.0) / energy))

    @property
    def compliance(self) -> float:
        """Work of the loads on the solution."""
        return float(self.loads @ self.amplitudes)

    def work(self, displacements: Array) -> float:
        """Work of the loads on displacements (3, nodes...)."""
        return float(self.loads @ self._amplitudes_of(displacements))

    @property
    def rounding(self) -> float:
        """Largest relative change of the compliance when every entry of the matrix is rounded once."""
        size = np.abs(self.amplitudes)
        return float(np.finfo(float).eps * (size @ (abs(self.matrix) @ size)) / self.compliance)

    def relative_residual(self, displacements: Array) -> float:
        """Norm of the forces out of balance, as far as the supports let them act, over that of the load."""
        left_over = self.loads - self.matrix @ self._amplitudes_of(displacements)
        return float(np.sqrt(left_over @ self._share(left_over) / (self.loads @ self._share(self.loads))))

    def inadmissible(self, displacements: Array) -> float:
        """Largest displacement that the supports forbid, relative to the largest one."""
        kept = self.space @ self._amplitudes_of(displacements)
        return float(np.abs(kept - displacements.ravel()).max() / np.abs(displacements).max())

    def _amplitudes_of(self, displacements: Array) -> Array:
        return self._share(self.space.T @ displacements.ravel())

    def _share(self, forces: Array) -> Array:
        return np.asarray(self._products.solve(forces))

    @cached_property
    def _products(self) -> SuperLU:
        """Factors of the scalar products of the displacements per free amplitude."""
        return splu((self.space.T @ self.space).tocsc())


def solve_directly(
    lattice: Lattice, origin_mm: tuple[float, float], supports: CaseSupports, moduli: Array, forces: Array
) -> Direct:
    """Assemble, eliminate and solve; amplitudes without any stiffness stay zero.

    Args:
        lattice: the grid.
        origin_mm: x and y of the first node relative to the crank axis, mm.
        supports: of the load case; spring stiffness in the unit of `moduli` times mm.
        moduli: modulus per cell (nx, ny, nz).
        forces: nodal forces (3, nodes...).
    """
    space, springs = admissible_space(lattice, origin_mm, supports)
    full = assemble(lattice, moduli)
    matrix = (space.T @ full @ space + sp.diags(springs)).tocsr()
    loads = space.T @ forces.ravel()
    stiff = np.flatnonzero(matrix.diagonal() > 0)
    amplitudes = np.zeros(len(loads))
    amplitudes[stiff] = _factorised(matrix[stiff][:, stiff], loads[stiff])
    residual = np.linalg.norm(loads - matrix @ amplitudes) / np.linalg.norm(loads)
    return Direct(matrix, space, loads, amplitudes, float(residual))


def _factorised(matrix: sp.csr_matrix, loads: Array) -> Array:
    """Sparse LU of the diagonally scaled matrix, and one refinement."""
    scale = 1 / np.sqrt(matrix.diagonal())
    scaled = (sp.diags(scale) @ matrix @ sp.diags(scale)).tocsc()
    options = {"SymmetricMode": True}
    factors = splu(scaled, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=0.0, options=options)
    solved = factors.solve(scale * loads)
    solved = solved + factors.solve(scale * loads - scaled @ solved)
    return np.asarray(scale * solved)


def assemble(lattice: Lattice, moduli: Array) -> sp.csr_matrix:
    """Stiffness of all nodes; degrees of freedom in the order of a field (3, nodes...)."""
    numbers = np.arange(np.prod(lattice.nodes)).reshape(lattice.nodes)
    nx, ny, nz = lattice.cells
    corners = np.stack([numbers[i : i + nx, j : j + ny, k : k + nz] for i, j, k in CORNERS], axis=-1)
    freedoms = (corners[..., None] + numbers.size * np.arange(3)).reshape(-1, 24)
    elements = np.stack([layer_stiffness(lattice, k) for k in range(nz)])
    values = moduli[..., None, None] * elements[None, None]
    rows, columns = np.repeat(freedoms, 24, axis=1), np.tile(freedoms, (1, 24))
    shape = (3 * numbers.size, 3 * numbers.size)
    return sp.coo_matrix((values.ravel(), (rows.ravel(), columns.ravel())), shape).tocsr()


def admissible_space(
    lattice: Lattice, origin_mm: tuple[float, float], supports: CaseSupports
) -> tuple[sp.csr_matrix, Array]:
    """Displacements (3 nodes, free) that the supports allow, and a spring to ground per amplitude."""
    free = np.ones(lattice.field_shape, bool)
    free[list(supports.fixed_at_x0), 0] = False
    sections = {0, *(motion.plane for motion in supports.motions)}
    free[list(supports.fixed_at_z_end), :, :, -1] = False
    for plane in sections:
        free[..., plane] = False
    number = free.size
    single = sp.eye(number, format="csc")[:, np.flatnonzero(free)]
    moved = [rigid_motion(lattice, origin_mm, motion.plane, motion.motion) for motion in supports.motions]
    columns = [sp.csc_matrix(field.reshape(number, 1)) for field in moved]
    springs = [0.0] * single.shape[1] + [motion.stiffness for motion in supports.motions]
    return sp.hstack([single, *columns]).tocsr(), np.array(springs)


def rigid_motion(lattice: Lattice, origin_mm: tuple[float, float], plane: int, motion: str) -> Array:
    """Displacements of the nodes of an end plane that turns or moves about its point on the crank axis."""
    axis = np.eye(3)["xyz".index(motion[1])]
    x = origin_mm[0] + lattice.dx_mm * np.arange(lattice.nodes[0])
    y = origin_mm[1] + lattice.dy_mm * np.arange(lattice.nodes[1])
    arms = np.stack([*np.meshgrid(x, y, indexing="ij"), np.zeros((len(x), len(y)))], axis=-1)
    field = np.zeros(lattice.field_shape)
    moved = np.cross(axis, arms) if motion[0] == "r" else np.broadcast_to(axis, arms.shape)
    field[..., plane] = np.moveaxis(moved, -1, 0)
    return field
