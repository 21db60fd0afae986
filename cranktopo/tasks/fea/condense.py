"""The half throw condensed to the rigid motions of its mid-journal section, the whole one to those of both.

Motions (ux, uy, uz, rx, ry, rz) of the section z = 0: translations of its centre and rotations about its
axes, mm and rad. The mid-pin plane carries u_z = 0 for symmetric and u_x = u_y = 0 for antisymmetric motion.
With the mirror x = 0 each of the two splits again into motions even and odd in x.
A throw whose halves differ has no such plane: it is condensed whole, to six more motions of its far section.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Set
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.frames import Span
from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, mean_displacement
from cranktopo.numerics.tetrahedra.solver import RESIDUAL_LIMIT

Lateral = Literal["even", "odd", "none"]

UX, UY, UZ, RX, RY, RZ = range(6)
_EVEN, _ODD = (UY, UZ, RX), (UX, RY, RZ)
_PLANE_MM = 1e-6
_STRESS_FREE = 1e-9
"""Relative displacement of a held plane below which a motion of the whole body leaves it where it is."""


@dataclass(frozen=True)
class Superelement:
    """Stiffness of the half throw over some motions of its section, or of the whole throw over those of both.

    With a force F on the full pin the mean pin displacement is load.q + F load_compliance / copies, where
    stiffness q = F load / copies + section forces. A radial force is symmetric in z and even in x: in the
    other blocks `load` and `load_compliance` are zero.

    Attributes:
        motions: which of the six motions, in order; 6 to 11 are those of the far section of a whole throw.
        parts: 2 where the model is the half x >= 0 of the half or whole throw, else 1.
        stiffness: shape (m, m), N/mm, N, N mm, of the half or whole throw (both signs of x).
        load: mean of -u_y over the pin material per unit motion, shape (m,).
        load_compliance: mean of -u_y under unit force on the (half) pin, sections fixed, mm/N.
        displacement: unit-motion fields, then the load field where there is one, then the fields of further
            loads with the section fixed, shape (unknowns, m [+ 1] + k).
        extra_loads: section forces of the half throw that answer the further loads, shape (m, k).
        held: unknowns at zero, or moved with the section.
        solve: from nodal forces on the model, shape (unknowns, k), to fields with the section fixed.
        copies: how many of what is modelled make the throw: 2 half throws, or 1 whole one.
    """

    motions: tuple[int, ...]
    parts: int
    stiffness: Array
    load: Array
    load_compliance: float
    displacement: Array
    extra_loads: Array
    held: NDArray[np.intp]
    solve: Callable[[Array], Array]
    copies: int = 2

    @property
    def fields(self) -> Array:
        """Unit-motion fields and the load field where there is one, (unknowns, m [+ 1])."""
        return self.displacement[:, : self.displacement.shape[1] - self.extra_loads.shape[1]]

    def index(self, *motions: int) -> list[int]:
        """Return the positions of motions in this block."""
        return [self.motions.index(m) for m in motions]


def condense(
    model: Elasticity,
    scene: Scene,
    span: Span,
    lateral: Lateral,
    extra_loads: Array | None = None,
    residual: float = RESIDUAL_LIMIT,
) -> Superelement:
    """Condense the half or whole throw to the motions of its rigid sections.

    Args:
        extra_loads: nodal forces of loads on the model besides the pin's, of the same symmetry, shape
            (unknowns, k).

    Raises:
        CranktopoError: the solve failed, or a plane of the model is missing.
    """
    motions = {"even": _EVEN, "odd": _ODD, "none": tuple(range(6))}[lateral]
    sections, held = _constraints(model, scene, span, lateral)
    rigid = np.hstack([section_motions(model.nodes_mm, section)[:, motions] for section in sections])
    loaded = span != "antisymmetric" and lateral != "odd"
    mean = np.zeros(model.nodes_mm.size)
    if loaded:
        mean = -mean_displacement(model, 1, *loaded_mm(scene, span == "whole"))
    others = np.zeros((model.nodes_mm.size, 0)) if extra_loads is None else extra_loads
    solve = model.equations.solver(held, residual)
    if span == "whole":
        whole, turned = _whole_body(model.nodes_mm, motions, scene.pitch_mm)
        motions = (*motions, *(6 + motion for motion in motions))
    else:
        whole, turned = _stress_free(model.nodes_mm, motions, sections[0], held)
    bent = rigid @ turned
    forces = np.column_stack([-(model.stiffness @ bent), *([mean] if loaded else []), others])
    fields = solve(forces)
    bending = turned.shape[1]
    units = whole + (fields[:, :bending] + bent) @ turned.T
    fields = np.column_stack([units, fields[:, bending:]])
    parts = 1 if lateral == "none" else 2
    pin = len(motions)
    return Superelement(
        motions,
        parts,
        parts * _symmetric(units.T @ (model.stiffness @ units)),
        units.T @ mean,
        float(mean @ fields[:, pin]) / parts if loaded else 0.0,
        fields,
        parts * units.T @ others,
        held,
        solve,
        1 if span == "whole" else 2,
    )


def loaded_mm(scene: Scene, whole: bool) -> tuple[float, float]:
    """Return the heights between which the crankpin carries its load in the half or the whole throw."""
    start = scene.web_z_mm[1]
    return (start, scene.pitch_mm - halves(scene)[1].web_z_mm[1]) if whole else (start, math.inf)


def section_motions(nodes_mm: Array, section: NDArray[np.intp]) -> Array:
    """Return the six rigid motions of a section across z about its own centre, (unknowns, 6)."""
    x, y = nodes_mm[0, section], nodes_mm[1, section]
    motions = np.zeros((nodes_mm.size, 6))
    for axis in range(3):
        motions[3 * section + axis, axis] = 1.0
    motions[3 * section + 2, RX] = y
    motions[3 * section + 2, RY] = -x
    motions[3 * section, RZ] = -y
    motions[3 * section + 1, RZ] = x
    return motions


def _stress_free(
    nodes_mm: Array, motions: tuple[int, ...], section: NDArray[np.intp], held: NDArray[np.intp]
) -> tuple[Array, Array]:
    """Split unit motions into those of the whole body, (unknowns, m), and axes of the rest, (m, rest)."""
    body = body_motions(nodes_mm)[:, motions]
    own = (3 * section[:, None] + np.arange(3)).ravel()
    _, sizes, axes = np.linalg.svd(body[np.setdiff1d(held, own)], full_matrices=False)
    bends = sizes > _STRESS_FREE * sizes.max()
    return body @ axes[~bends].T @ axes[~bends], axes[bends].T


def body_motions(nodes_mm: Array) -> Array:
    """Return the six rigid motions of the whole body about the origin, (unknowns, 6)."""
    body = section_motions(nodes_mm, np.arange(nodes_mm.shape[1]))
    body[1::3, RX], body[::3, RY] = -nodes_mm[2], nodes_mm[2]
    return body


def _whole_body(nodes_mm: Array, motions: tuple[int, ...], pitch_mm: float) -> tuple[Array, Array]:
    """As `_stress_free` for the sections of a whole throw, which as one body moves in every way."""
    far = np.eye(6)
    far[UY, RX], far[UX, RY] = -pitch_mm, pitch_mm
    both_faces = np.vstack([np.eye(len(motions)), far[np.ix_(motions, motions)]])
    axes = np.linalg.svd(both_faces)[0]
    whole = body_motions(nodes_mm)[:, motions] @ np.linalg.pinv(both_faces)
    return whole, axes[:, len(motions) :]


def plane_nodes(nodes_mm: Array, axis: int, position_mm: float) -> NDArray[np.intp]:
    """Return the nodes, of (3, n), on the plane across an axis; CranktopoError where there are none."""
    found = np.nonzero(np.abs(nodes_mm[axis] - position_mm) < _PLANE_MM)[0]
    if found.size == 0:
        raise CranktopoError(
            f"mesh: no nodes on the plane {'xyz'[axis]} = {position_mm:g} mm.",
            hint="The body must reach from z = 0 to half the pitch.",
            code=ExitCode.SOLVER,
        )
    return found


def section_slopes(model: Elasticity, forces: Array, field: Array, z_mm: float = 0.0) -> Array:
    """Return the derivative of forces' field by the nodes of a rigid section, (3, nodes), forces held."""
    section = plane_nodes(model.nodes_mm, 2, z_mm)
    unknowns = (3 * section[:, None] + np.arange(3)).ravel()
    rigid = section_motions(model.nodes_mm, section)[unknowns]
    turn = np.linalg.lstsq(rigid, field[unknowns], rcond=None)[0][[RX, RY, RZ]]
    total = np.zeros(model.nodes_mm.shape)
    total[:, section] = np.cross(forces[unknowns].reshape(-1, 3), turn).T
    return total


def _constraints(
    model: Elasticity, scene: Scene, span: Span, lateral: Lateral
) -> tuple[list[NDArray[np.intp]], NDArray[np.intp]]:
    ends = (0.0, scene.pitch_mm) if span == "whole" else (0.0,)
    sections = [plane_nodes(model.nodes_mm, 2, z) for z in ends]
    held = [(3 * section[:, None] + np.arange(3)).ravel() for section in sections]
    if span != "whole":
        middle = plane_nodes(model.nodes_mm, 2, scene.pitch_mm / 2)
        held += [3 * middle + axis for axis in ((2,) if span == "symmetric" else (0, 1))]
    if lateral != "none":
        mirror = plane_nodes(model.nodes_mm, 0, 0.0)
        held += [3 * mirror + axis for axis in ((0,) if lateral == "even" else (1, 2))]
    return sections, np.unique(np.concatenate(held))


def _symmetric(matrix: Array) -> Array:
    return (matrix + matrix.T) / 2


TorsionSupport = Literal["free", "held", "spring"]
BendingSupport = Literal["pinned", "clamped", "spring"]


_ALL = frozenset({UX, UY, UZ, RX, RY, RZ})
_TORSION: dict[TorsionSupport, frozenset[int]] = {"free": _ALL, "held": frozenset({RZ, UZ}), "spring": _ALL}
_BENDING: dict[BendingSupport, frozenset[int]] = {
    "pinned": frozenset({UZ, RX, RY, RZ}),
    "clamped": frozenset({UZ}),
    "spring": _ALL,
}
"""Motions that each support leaves to each section."""


def torsional_stiffness_Nm_per_rad(
    block: Superelement, support: TorsionSupport, spring_N_per_mm: float = 0.0
) -> float:
    """Return the torsional stiffness of the full throw: torque over relative rotation, T / (2 phi).

    Args:
        block: antisymmetric or whole block holding ux, ry, rz (and more).
    """
    twist = torque_ends(block) @ torsion_motion(block, support, spring_N_per_mm)
    return 1.0 / (block.copies * float(twist)) / NMM_PER_NM


def torque_ends(block: Superelement) -> Array:
    """Return a torque of 1 N mm on the section of the half throw, opposite ones on both of the whole, (m,).

    Times a motion it is the rotation of the section, or that of the far section relative to the near one.
    """
    near = 1.0 if block.copies == 2 else -1.0
    return np.array([{RZ: near, 6 + RZ: 1.0}.get(m, 0.0) for m in block.motions])


def bending_stiffness_N_per_mm(
    block: Superelement, support: BendingSupport, spring_N_per_mm: float = 0.0
) -> float:
    """Return the bending stiffness of the full throw: pin force over mean radial pin displacement.

    Args:
        block: symmetric or whole block holding uy, uz, rx (and more).
    """
    motion = bending_motion(block, block.load, support, spring_N_per_mm)
    return block.copies / (block.load_compliance + float(block.load @ motion))


def torsion_motion(
    block: Superelement, support: TorsionSupport, spring_N_per_mm: float = 0.0, force: Array | None = None
) -> Array:
    """Return the section motion under section forces, shape (m,), mm and rad."""
    force = torque_ends(block) if force is None else force
    return _response(block, _TORSION[support], _springs(support, spring_N_per_mm), force)


def bending_motion(
    block: Superelement,
    force: Array,
    support: BendingSupport,
    spring_N_per_mm: float = 0.0,
    *,
    turning: bool = True,
) -> Array:
    """Return the section motion under section forces, shape (m,), mm and rad.

    Args:
        turning: whether the section may turn about the crank axis; a tangential force needs a torque there.
    """
    released = _BENDING[support] - (frozenset() if turning else {RZ})
    return _response(block, released, _springs(support, spring_N_per_mm), force)


def _springs(support: str, spring_N_per_mm: float) -> dict[int, float]:
    return {UX: spring_N_per_mm, UY: spring_N_per_mm} if support == "spring" else {}


def _response(block: Superelement, released: Set[int], springs: dict[int, float], force: Array) -> Array:
    """Section motion under a section force, held motions at zero; rigid motions of the whole stay at zero."""
    kinds = [m % 6 for m in block.motions]
    index = [i for i, m in enumerate(kinds) if m in released]
    stiffness = block.stiffness + np.diag([springs.get(m, 0.0) for m in kinds])
    length = np.array([1.0 if m < RX else 1.0 / 50.0 for m in kinds])[index]
    scaled = stiffness[np.ix_(index, index)] * np.outer(length, length)
    motion = np.zeros(len(block.motions))
    motion[index] = length * (np.linalg.pinv(scaled, rcond=1e-7, hermitian=True) @ (length * force[index]))
    return motion
