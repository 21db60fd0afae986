"""A body condensed to the rigid motions of its plane sections, and fields of further loads on it.

Static condensation: R. J. Guyan, Reduction of stiffness and mass matrices, AIAA J. 3, 1965. Motions of
the whole body are split off first, as they have no stress: they would cost the others their last digits.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.numerics.tetrahedra.elasticity import Elasticity
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, UX, UY, body_motions, section_motions

_STRESS_FREE = 1e-9
"""Relative displacement of a held plane below which a motion of the whole body leaves it where it is."""


@dataclass(frozen=True)
class Superelement:
    """Stiffness of half a body over some motions of its section, or of a whole one over those of both.

    With a force F on all of the loaded material its mean displacement along F is
    load.q + F load_compliance / copies, where stiffness q = F load / copies + section forces. In blocks that
    this load does not move `load` and `load_compliance` are zero.

    Attributes:
        motions: which of the six motions, in order; 6 to 11 are those of the far section of a whole body.
        parts: 2 where the model is the half x >= 0 of the half or whole body, else 1.
        stiffness: shape (m, m), N/mm, N, N mm, of the half or whole body (both signs of x).
        load: mean displacement of the loaded material per unit motion, shape (m,).
        load_compliance: the same under unit force on it, sections fixed, mm/N.
        displacement: unit-motion fields, then the load field where there is one, then the fields of further
            loads with the section fixed, shape (unknowns, m [+ 1] + k).
        extra_loads: section forces of the half body that answer the further loads, shape (m, k).
        extra_compliance: work of each further load on the field of each with the section fixed, in what is
            modelled, shape (k, k).
        held: unknowns at zero, or moved with the section.
        solve: from nodal forces on the model, shape (unknowns, k), to fields with the section fixed.
        copies: how many of what is modelled make the body: 2 halves, or 1 whole one.
    """

    motions: tuple[int, ...]
    parts: int
    stiffness: Array
    load: Array
    load_compliance: float
    displacement: Array
    extra_loads: Array
    extra_compliance: Array
    held: NDArray[np.intp]
    solve: Callable[[Array], Array]
    copies: int = 2

    @property
    def fields(self) -> Array:
        """Unit-motion fields and the load field where there is one, (unknowns, m [+ 1])."""
        return self.displacement[:, : self.displacement.shape[1] - self.extra_loads.shape[1]]

    def without_last(self, loads: int) -> Superelement:
        """Return it without the last ones of the further loads."""
        kept = self.extra_loads.shape[1] - loads
        return replace(
            self,
            displacement=self.displacement[:, : self.displacement.shape[1] - loads],
            extra_loads=self.extra_loads[:, :kept],
            extra_compliance=self.extra_compliance[:kept, :kept],
        )

    def index(self, *motions: int) -> list[int]:
        """Return the positions of motions in this block."""
        return [self.motions.index(m) for m in motions]


@dataclass(frozen=True)
class HeldBody:
    """Sections and held unknowns of a body that is condensed.

    Attributes:
        sections: nodes of the near section, and of the far one of a whole body.
        held: unknowns of the sections, and those that mirror planes hold.
        distance_mm: of the far section from the near one, where there is one.
        parts: bodies that the mirror x = 0 makes of what is modelled: 2, or 1 without it.
    """

    sections: Sequence[NDArray[np.intp]]
    held: Index
    distance_mm: float
    parts: int

    @property
    def whole(self) -> bool:
        """Tell whether the body has both of its sections."""
        return len(self.sections) == 2


def superelement(
    model: Elasticity,
    body: HeldBody,
    motions: tuple[int, ...],
    load: Array | None,
    extra_loads: Array | None,
    residual: float,
) -> Superelement:
    """Condense a body to motions of its rigid sections.

    Args:
        load: mean displacement of the loaded material by nodal displacements, (unknowns,); None where the
            motions leave it.
        extra_loads: nodal forces of further loads, shape (unknowns, k).

    Raises:
        CranktopoError: the solve failed.
    """
    rigid = np.hstack([section_motions(model.nodes_mm, section)[:, motions] for section in body.sections])
    mean = np.zeros(model.nodes_mm.size) if load is None else load
    others = np.zeros((model.nodes_mm.size, 0)) if extra_loads is None else extra_loads
    solve = model.equations.solver(body.held, residual)
    if body.whole:
        unbent, turned = _whole_body(model.nodes_mm, motions, body.distance_mm)
        motions = (*motions, *(6 + motion for motion in motions))
    else:
        unbent, turned = _stress_free(model.nodes_mm, motions, body.sections[0], body.held)
    bent = rigid @ turned
    loads = [] if load is None else [mean]
    fields = _solved_once(solve, np.column_stack([-(model.stiffness @ bent), *loads, others]))
    bending = turned.shape[1]
    units = unbent + (fields[:, :bending] + bent) @ turned.T
    fields = np.column_stack([units, fields[:, bending:]])
    return Superelement(
        motions,
        body.parts,
        body.parts * _symmetric(units.T @ (model.stiffness @ units)),
        units.T @ mean,
        0.0 if load is None else float(mean @ fields[:, len(motions)]) / body.parts,
        fields,
        body.parts * units.T @ others,
        _symmetric(others.T @ fields[:, fields.shape[1] - others.shape[1] :]),
        body.held,
        solve,
        1 if body.whole else 2,
    )


def _solved_once(solve: Callable[[Array], Array], loads: Array) -> Array:
    """Return the fields of loads (unknowns, k), of equal ones solved once: a further load may be it."""
    columns = range(loads.shape[1])
    same = [next(i for i in columns if np.array_equal(loads[:, i], loads[:, own])) for own in columns]
    first, place = np.unique(same, return_inverse=True)
    return solve(loads[:, first])[:, place]


def _stress_free(
    nodes_mm: Array, motions: tuple[int, ...], section: NDArray[np.intp], held: NDArray[np.intp]
) -> tuple[Array, Array]:
    """Split unit motions into those of the whole body, (unknowns, m), and axes of the rest, (m, rest)."""
    body = body_motions(nodes_mm)[:, motions]
    own = (3 * section[:, None] + np.arange(3)).ravel()
    _, sizes, axes = np.linalg.svd(body[np.setdiff1d(held, own)], full_matrices=False)
    bends = sizes > _STRESS_FREE * sizes.max()
    return body @ axes[~bends].T @ axes[~bends], axes[bends].T


def _whole_body(nodes_mm: Array, motions: tuple[int, ...], distance_mm: float) -> tuple[Array, Array]:
    """As `_stress_free` for the sections of a whole body, which as one moves in every way."""
    far = np.eye(6)
    far[UY, RX], far[UX, RY] = -distance_mm, distance_mm
    both_faces = np.vstack([np.eye(len(motions)), far[np.ix_(motions, motions)]])
    axes = np.linalg.svd(both_faces)[0]
    whole = body_motions(nodes_mm)[:, motions] @ np.linalg.pinv(both_faces)
    return whole, axes[:, len(motions) :]


def _symmetric(matrix: Array) -> Array:
    return (matrix + matrix.T) / 2
