"""A throw with its mass, reduced to the motions of its two mid-journal sections and a few fields between.

The fields are those of the static condensation and what the inertia of these adds with the sections held
(`numerics/tetrahedra/component_modes.py`). A half throw stands for both, in each symmetry that it has.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Span
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import KG_PER_TONNE, density_tonne_per_mm3
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.section_shapes import SectionShapes, WarpShapes
from cranktopo.numerics.tetrahedra.component_modes import inertial_fields, reduced
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, mass_matrix, mean_displacement
from cranktopo.numerics.tetrahedra.rigid_motions import body_motions, plane_nodes
from cranktopo.numerics.turning_body import TurningBody
from cranktopo.tasks.modes.station import (
    MassPiece,
    PointMass,
    Station,
    added,
    piece_of,
    point_mass,
    rigid_share,
    stiffened,
)
from cranktopo.tasks.shaft.assembly import MIRROR, SPLITS
from cranktopo.tasks.shaft.loaded_throw import LoadedBlock, ThrowBody
from cranktopo.tasks.throw_fea.condense import Lateral, loaded_mm

DEGREE = 3
"""Of the polynomials by which mid-journal sections deform."""
Shapes = SectionShapes | WarpShapes


@dataclass(frozen=True)
class ReducedThrow:
    """A throw over the motions of its near and then its far section, and amplitudes of more fields.

    First come the six rigid motions of both sections, then the deformations of both.

    Attributes:
        shapes: by which either section deforms; warps have the radius of each.
        step_of: 0 of the motions of sections, else the step that found the field, (unknowns,); 1 of loads.
        stations: its halves, placed from the near section.
        held: fields with both sections held, where its loads have some of their own.
    """

    body: TurningBody
    shapes: Shapes
    step_of: NDArray[np.intp]
    stations: tuple[Station, ...]
    held: tuple[HeldFields, ...] = ()


@dataclass(frozen=True)
class HeldFields:
    """Fields of one symmetry with the sections held, (unknowns of the model, k), and their unknowns, (k,).

    Attributes:
        loads: unit loads of the full throw whose fields are the last of these.
    """

    span: Span
    lateral: Lateral
    fields: Array
    unknowns: NDArray[np.intp]
    loads: tuple[str, ...]


@dataclass(frozen=True)
class _Block:
    """Fields of one symmetry, (unknowns of the model, k); the first of them move the sections.

    Attributes:
        motions: which of the twelve rigid ones, or of the six of a half throw.
        shapes: which deformations of the sections follow these, of both for a whole throw.
        step_of: of the fields beyond these.
        loads: whose fields are the last of those, if any are asked for.
    """

    span: Span
    lateral: Lateral
    motions: tuple[int, ...]
    shapes: NDArray[np.intp]
    fields: Array
    step_of: tuple[int, ...]
    loads: tuple[str, ...]


def section_shapes(scene: Scene, degree: int = DEGREE) -> SectionShapes:
    """Return how the mid-journal sections of a shaft deform: one for all, so that neighbours share it.

    Args:
        degree: of the polynomials; 0: they stay rigid.
    """
    journal = scene.throw.main_journal
    return SectionShapes(journal.radius_mm, journal.bore_radius_mm, degree)


def reduced_throw(
    body: ThrowBody,
    scene: Scene,
    shapes: Shapes,
    steps: int,
    moving_kg: float,
    *,
    with_loads: bool = False,
) -> ReducedThrow:
    """Reduce a condensed throw.

    Args:
        shapes: of its sections, as of `section_shapes` of the shaft, or the warps that it has already.
        steps: how often the inertia of the fields adds to them; 0: static fields alone.
        moving_kg: mass of rods and pistons on the crankpin.
        with_loads: also what its unit loads do with the sections held, so that it gives way to them as the
            condensed throw does.

    Raises:
        CranktopoError: a failed solve.
    """
    mass = mass_matrix(body.model, density_tonne_per_mm3(scene.material.density_kg_m3))
    middle = (len(body.blocks) + 1) // 2

    def blocks_of(some: Sequence[LoadedBlock]) -> list[_Block]:
        return [_block(body.model, part, mass, shapes, steps, with_loads) for part in some]

    first, second = side_by_side(
        lambda: blocks_of(body.blocks[:middle]), lambda: blocks_of(body.blocks[middle:])
    )
    throw = _Throw(body.model, scene, mass, shapes, first + second, moving_kg / KG_PER_TONNE)
    return throw.reduced()


def _block(
    model: Elasticity,
    part: LoadedBlock,
    mass: sp.csr_matrix,
    shapes: Shapes,
    steps: int,
    with_loads: bool,
) -> _Block:
    block = part.block
    static = block.displacement[:, : len(block.motions)]
    more = inertial_fields(block.solve, mass, static, steps)
    step_of = [number for number, fields in enumerate(more, start=1) for _ in range(fields.shape[1])]
    loads = part.of_still if with_loads else ()
    if loads:
        more.append(part.load_fields())
        step_of += [1] * len(loads)
    if isinstance(shapes, WarpShapes):
        which, deformed = part.warps, [part.warp_fields]
    else:
        chosen = shapes.having(part.lateral)
        ends = (0.0, float(model.nodes_mm[2].max())) if part.span == "whole" else (0.0,)
        deformed = [_deformed(model, block.solve, shapes, chosen, z) for z in ends]
        which = np.concatenate([chosen + shapes.count * number for number in range(len(ends))])
    fields = np.hstack([static, *deformed, *more])
    return _Block(part.span, part.lateral, block.motions, which, fields, tuple(step_of), loads)


def _deformed(
    model: Elasticity,
    solve: Callable[[Array], Array],
    shapes: SectionShapes,
    chosen: NDArray[np.intp],
    z_mm: float,
) -> Array:
    """Return the static fields of deformations of a section, (unknowns, chosen)."""
    section = plane_nodes(model.nodes_mm, 2, z_mm)
    moved = shapes.at(*model.nodes_mm[:2, section])[:, :, chosen]
    bent = np.zeros((model.nodes_mm.size, len(chosen)))
    for axis in range(3):
        bent[3 * section + axis] = moved[axis]
    return np.asarray(bent - solve(model.stiffness @ bent)) if len(chosen) else bent


class _Throw:
    """The blocks of a throw on their way to one set of unknowns."""

    def __init__(
        self,
        model: Elasticity,
        scene: Scene,
        mass: sp.csr_matrix,
        shapes: Shapes,
        blocks: list[_Block],
        moving: float,
    ) -> None:
        self._model, self._scene, self._mass, self._blocks = model, scene, mass, blocks
        self._whole = blocks[0].span == "whole"
        self._copies = 1 if self._whole else 2
        self._parts = 1 if blocks[0].lateral == "none" else 2
        self._moving = moving / 2
        self._shapes = shapes
        self._step_of = np.concatenate(
            [np.zeros(12 + 2 * shapes.count, int), *(np.array(b.step_of, int) for b in blocks)]
        )
        self._ways = self._expansions()

    def _expansions(self) -> list[Array]:
        """Return the fields of each block by the unknowns of the throw, (fields, unknowns)."""
        count = self._shapes.count
        ways, at = [], 12 + 2 * count
        image = np.diag(np.where(self._shapes.axial, -1.0, 1.0))
        splits = {
            "symmetric": np.hstack([np.eye(count), image]) / 2,
            "antisymmetric": np.hstack([np.eye(count), -image]) / 2,
            "whole": np.eye(2 * count),
        }
        for block in self._blocks:
            own, rigid = len(block.step_of), len(block.motions)
            moved = rigid + len(block.shapes)
            way = np.zeros((block.fields.shape[1], len(self._step_of)))
            way[:rigid, :12] = SPLITS[block.span][list(block.motions)]
            way[rigid:moved, 12 : 12 + 2 * count] = splits[block.span][block.shapes]
            way[moved:, at : at + own] = np.eye(own)
            ways.append(way)
            at += own
        return ways

    def reduced(self) -> ReducedThrow:
        """Return the matrices and stations."""
        body = TurningBody.of_nothing(len(self._step_of))
        for span in dict.fromkeys(block.span for block in self._blocks):
            body += self._of_span([i for i, block in enumerate(self._blocks) if block.span == span])
        stations = []
        for side in (0, 1):
            piece, motion = self._half(side)
            body += stiffened(motion, piece.second_moments)
            for point in self._bolted(side):
                at = body_motions(np.array(point.place_mm)[:, None] - [[0.0], [0.0], [piece.z_mm]]) @ motion
                turning = point.polar * np.outer(motion[5], motion[5])
                body += point_mass(point.mass, at) + added(len(turning), mass=turning, lateral=turning)
            stations.append(Station(piece.z_mm, motion, piece.inertia))
        return ReducedThrow(body, self._shapes, self._step_of, tuple(stations), self._held())

    def _held(self) -> tuple[HeldFields, ...]:
        """Return the fields with the sections held, where loads have some."""
        found, at = [], 12 + 2 * self._shapes.count
        for block in self._blocks:
            own = len(block.step_of)
            fields = block.fields[:, block.fields.shape[1] - own :]
            unknowns = np.arange(at, at + own)
            found.append(HeldFields(block.span, block.lateral, fields, unknowns, block.loads))
            at += own
        return tuple(found) if any(block.loads for block in self._blocks) else ()

    def _of_span(self, which: list[int]) -> TurningBody:
        """Return the matrices of the blocks of one span, which the Coriolis force alone couples."""
        blocks = [self._blocks[i] for i in which]
        own = reduced(self._model, self._mass, np.hstack([block.fields for block in blocks]))
        own = own.times(self._parts)
        for motion in self._pins(blocks):
            own += point_mass(self._moving, motion)
        of = np.repeat(np.arange(len(blocks)), [block.fields.shape[1] for block in blocks])
        same = (of[:, None] == of).astype(float)
        other = same if self._parts == 1 else 1 - same
        masked = TurningBody(
            own.stiffness * same, own.mass * same, own.coriolis * other, own.lateral * same, own.stiffening
        )
        return masked.over(np.vstack([self._ways[i] for i in which])).times(self._copies)

    def _pins(self, blocks: list[_Block]) -> list[Array]:
        """Return the mean x and y of each half of the crankpin that the model has, (2, fields) each."""
        low, high = loaded_mm(self._scene, whole=True)
        ends = ((low, (low + high) / 2), ((low + high) / 2, high))[: 3 - self._copies]
        found = []
        for start, end in ends:
            means = [mean_displacement(self._model, axis, start, end) for axis in (0, 1)]
            rows = [[mean @ block.fields for block in blocks] for mean in means]
            for axis, hidden in ((0, "even"), (1, "odd")):
                for place, block in enumerate(blocks):
                    if block.lateral == hidden:
                        rows[axis][place] = np.zeros(block.fields.shape[1])
            found.append(np.array([np.concatenate(row) for row in rows]))
        return found

    def _half(self, side: int) -> tuple[MassPiece, Array]:
        """Return a half of the throw as a piece, placed from the near section, and its motion."""
        pitch, far = self._scene.pitch_mm, bool(side) and not self._whole
        fastened = [*self._bolted(side), self._moved(side)]
        if far:  # the model is the near half: its mirror image
            fastened = [replace(p, place_mm=(*p.place_mm[:2], pitch - p.place_mm[2])) for p in fastened]
        piece = piece_of(self._model.nodes_mm, self._mass_of(side), self._parts, fastened)
        count = len(self._step_of)
        motion = np.zeros((6, count))
        for block, way in zip(self._blocks, self._ways, strict=True):
            image = -1.0 if far and block.span == "antisymmetric" else 1.0
            motion += image * rigid_share(piece, block.fields, block.lateral) @ way
        if far:
            turn = np.diag([1.0, 1.0, -1.0])
            piece = replace(
                piece,
                z_mm=pitch - piece.z_mm,
                inertia=MIRROR @ piece.inertia @ MIRROR,
                second_moments=turn @ piece.second_moments @ turn,
            )
            motion = MIRROR @ motion
        return piece, motion

    def _mass_of(self, side: int) -> sp.csr_matrix:
        if not self._whole:
            return self._mass
        heights = self._model.mesh.p[2][self._model.mesh.t].mean(axis=0)
        beyond = heights > halves(self._scene)[0].pitch_mm / 2
        density = density_tonne_per_mm3(self._scene.material.density_kg_m3)
        return mass_matrix(self._model, density, np.flatnonzero(beyond == bool(side)))

    def _bolted(self, side: int) -> list[PointMass]:
        """Return what is fastened to the web of a half, from the near section."""
        half = halves(self._scene)[side]
        moments = bolted_mass(half)
        if not moments.volume:
            return []
        x, y = moments.first_x / moments.volume, moments.first_y / moments.volume
        height = sum(half.web_z_mm) / 2
        z = self._scene.pitch_mm - height if side else height
        rest = moments.polar - moments.volume * (x**2 + y**2)
        return [PointMass(moments.volume / KG_PER_TONNE, (x, y, z), rest / KG_PER_TONNE)]

    def _moved(self, side: int) -> PointMass:
        """Return the mass of rods and pistons on half of the crankpin."""
        low, high = loaded_mm(self._scene, whole=True)
        z = low + (high - low) * (0.75 if side else 0.25)
        return PointMass(self._moving, (0.0, self._scene.throw.radius_mm, z), slides=True)
