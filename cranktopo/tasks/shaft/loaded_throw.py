"""A throw condensed to its two mid-journal sections with the forces on its crankpin and of its rotation."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.frames import Span
from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.section_shapes import WARPS, WarpShapes
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble, mean_displacement, swing_force
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RZ, UY, plane_nodes
from cranktopo.numerics.tetrahedra.solver import RESIDUAL_LIMIT
from cranktopo.numerics.tetrahedra.superelement import Superelement
from cranktopo.tasks.shaft.assembly import SECTIONS, SPLITS, WARP_SPLITS, symmetries
from cranktopo.tasks.throw_fea.condense import Lateral, condense, loaded_mm
from cranktopo.tasks.throw_fea.turning_load import turning_load

_PIN = ("radial", "tangential")
LOADS = (*_PIN, "radial aside", "tangential aside", "centrifugal")
"""Unit loads of a throw: `LoadedThrow.loads` says what they are."""
SWING = "swing"
"""The further load of a shaft whose disks vibrate: its own mass, which an angular acceleration lets push."""
ACTING = (*LOADS, SWING)
"""All that acts on a throw beside the motions of its sections."""
_LENGTH_MM = 50.0
"""Scales rotations to displacements where a rank is decided."""
_RIGID = 1e-8
"""Share of the largest stiffness below which a motion is one of the whole body."""


@dataclass(frozen=True)
class LoadedThrow:
    """Stiffness of a full throw over the unknowns of its sections, and its loads.

    Attributes:
        stiffness: (`SECTIONS`, `SECTIONS`), mm, rad, N, N mm, each section in axes parallel to those of the
            throw; over the 12 motions alone of one whose sections stay rigid.
        loads: section forces that do the same work as a unit load, (`SECTIONS`,): "radial" 1 N on the pin
            along -y, "tangential" 1 N along +x, "radial aside" and "tangential aside" half of it on the near
            half of the pin and its opposite on the far one, "centrifugal" of 1 rad/s; of a shaft that may
            vibrate also "swing", 1 N mm about -z by the mass of the throw, which resists being accelerated.
        aside_moment_mm: moment of the loads "aside" about the middle of the pin, N mm per N: half the
            distance between the middles of the halves of the pin, as the mesh has them.
        pin_tilt: rotation of the crankpin about x and y by the unknowns of both sections and then by one of
            each of `ACTING`: that on which the moments of the loads "aside" do their work.
    """

    stiffness: Array
    loads: dict[str, Array]
    aside_moment_mm: float
    pin_tilt: Array


@dataclass(frozen=True)
class LoadedBlock:
    """The throw condensed in one symmetry of the model, with the unit loads that have it.

    Attributes:
        names: of the further loads of the block, in their order.
        warps: which of the warps of both sections the block has, of a half throw those of its own.
        warp_fields: displacements of each with the sections else held, (unknowns, warps).
        warp_stiffness: work on motions and warps of what moves each warp, of the model, (motions and warps,
            warps).
        warp_loads: work of each further load on these, (warps, loads).
    """

    span: Span
    lateral: Lateral
    block: Superelement
    names: tuple[str, ...]
    warps: NDArray[np.intp]
    warp_fields: Array
    warp_stiffness: Array
    warp_loads: Array

    @property
    def on_model(self) -> Array:
        """Shares of the loads of the full throw that act on the model, (loads,)."""
        models = self.block.copies * self.block.parts
        return np.array([1.0 if name == "centrifugal" else 1 / models for name in self.names])

    def section_forces(self) -> dict[str, Array]:
        """Return what the unit loads of the full throw do on both its sections, (`SECTIONS`,) each."""
        on_both = np.vstack([self.block.extra_loads / self.block.parts, self.warp_loads])
        per_model = self.sections.T @ on_both
        models = self.block.copies * self.block.parts
        return dict(zip(self.names, (per_model * (models * self.on_model)).T, strict=True))

    @property
    def sections(self) -> Array:
        """Its motions and warps by the unknowns of both sections, (motions and warps, `SECTIONS`)."""
        motions = SPLITS[self.span][list(self.block.motions)]
        found = np.zeros((len(motions) + len(self.warps), SECTIONS))
        found[: len(motions), :12] = motions
        found[len(motions) :, 12:] = WARP_SPLITS[self.span][self.warps]
        return found

    def stiffness(self) -> Array:
        """Return its part in the stiffness of the full throw, (`SECTIONS`, `SECTIONS`)."""
        block, motions = self.block, len(self.block.motions)
        across, own = np.split(block.parts * self.warp_stiffness, [motions])
        both = np.block([[block.stiffness, across], [across.T, (own + own.T) / 2]])
        return np.asarray(block.copies * self.sections.T @ both @ self.sections)

    def aside_motion(self, name: str) -> Array:
        """Return the work of a load "aside" of 1 N on what each of `ACTING` moves, sections held, (6,)."""
        found = np.zeros(len(ACTING))
        if name in self.names:
            work = self.block.extra_compliance[self.names.index(name)] * self.on_model
            found[[ACTING.index(acting) for acting in self.names]] = work
        return found

    def load_fields(self) -> Array:
        """Return what each load of `of_still` on the full throw does, sections held, (unknowns, k)."""
        loaded = self.block.displacement[:, self.block.displacement.shape[1] - len(self.names) :]
        still = len(self.of_still)
        return loaded[:, :still] * self.on_model[:still]

    @property
    def of_still(self) -> tuple[str, ...]:
        """Its loads in a shaft whose inertia is no load: all but the last, "swing"."""
        return tuple(name for name in self.names if name != SWING)

    def straining_fields(self) -> tuple[Array, Array]:
        """Return the displacement fields that strain the throw, and how much of them what acts on it makes.

        The fields, (unknowns, k), are those section motions that move no whole body, the warps, and the loads
        with the sections held; the shares are (k, `SECTIONS` and then `ACTING`).
        """
        block, motions = self.block, len(self.block.motions)
        length = np.array([1.0 if motion % 6 < RX else 1 / _LENGTH_MM for motion in block.motions])
        sizes, axes = np.linalg.eigh(block.stiffness * np.outer(length, length))
        axes = axes[:, sizes > _RIGID * sizes.max()]
        sections = self.sections
        strained = np.vstack([(axes.T / length) @ sections[:motions], sections[motions:]])
        shares = np.zeros((len(strained) + len(self.names), SECTIONS + len(ACTING)))
        shares[: len(strained), :SECTIONS] = strained
        for row, (name, share) in enumerate(zip(self.names, self.on_model, strict=True), len(strained)):
            shares[row, SECTIONS + ACTING.index(name)] = share
        loaded = block.displacement[:, block.displacement.shape[1] - len(self.names) :]
        bent = block.displacement[:, :motions] @ (length[:, None] * axes)
        return np.hstack([bent, self.warp_fields, loaded]), shares


@dataclass(frozen=True)
class ThrowBody:
    """A meshed throw condensed with its loads in every symmetry."""

    meshed: MeshedThrow
    model: Elasticity
    blocks: tuple[LoadedBlock, ...]


def throw_body(meshed: MeshedThrow, scene: Scene, residual: float = RESIDUAL_LIMIT) -> ThrowBody:
    """Condense a meshed throw with its loads, to a relative residual.

    Raises:
        CranktopoError: a failed solve.
    """
    model = assemble(meshed.mesh, scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson)
    blocks = loaded_blocks(model, scene, meshed.mesh.mirrored, whole=meshed.whole, residual=residual)
    return ThrowBody(meshed, model, tuple(blocks))


def loaded_blocks(
    model: Elasticity,
    scene: Scene,
    mirrored: bool,
    *,
    whole: bool = False,
    residual: float = RESIDUAL_LIMIT,
) -> list[LoadedBlock]:
    """Return the throw condensed as by `throw_blocks`, with the unit loads of each symmetry.

    Raises:
        CranktopoError: a failed solve.
    """
    found = symmetries(mirrored, whole)
    middle = (len(found) + 1) // 2

    def condensed(some: Sequence[tuple[Span, Lateral]]) -> list[LoadedBlock]:
        return [_condensed(model, scene, span, lateral, residual) for span, lateral in some]

    first, second = side_by_side(lambda: condensed(found[:middle]), lambda: condensed(found[middle:]))
    return first + second


def _condensed(model: Elasticity, scene: Scene, span: Span, lateral: Lateral, residual: float) -> LoadedBlock:
    forces = _unit_loads(model, scene, span, lateral)
    nodal = np.column_stack(list(forces.values()))
    warps, bent = _warps(model, scene, span, lateral)
    # Solved with the loads: a product with the matrix takes hardly longer for eight columns than for four.
    others = np.hstack([nodal, -(model.stiffness @ bent)])
    found = condense(model, scene, span, lateral, others, residual)
    fields = bent + found.displacement[:, -len(warps) :]
    block = found.without_last(len(warps))
    every = np.hstack([block.displacement[:, : len(block.motions)], fields])
    stiffness = every.T @ (model.stiffness @ fields)
    return LoadedBlock(span, lateral, block, tuple(forces), warps, fields, stiffness, fields.T @ nodal)


def _warps(model: Elasticity, scene: Scene, span: Span, lateral: Lateral) -> tuple[NDArray[np.intp], Array]:
    """Return the warps that a block has, and displacements of the sections alone by each."""
    ends = zip((0.0, scene.pitch_mm) if span == "whole" else (0.0,), halves(scene), strict=False)
    numbers, bent = [], []
    for end, (z, half) in enumerate(ends):
        shapes, section = section_warps(half), plane_nodes(model.nodes_mm, 2, z)
        chosen = shapes.having(lateral)
        moved = np.zeros((model.nodes_mm.shape[1], 3, len(chosen)))
        moved[section] = shapes.at(*model.nodes_mm[:2, section])[:, :, chosen].transpose(1, 0, 2)
        bent.append(moved.reshape(-1, len(chosen)))
        numbers.append(chosen + WARPS * end)
    return np.concatenate(numbers), np.hstack(bent)


def section_warps(half: Scene) -> WarpShapes:
    """Return the ways in which the mid-journal section of a half throw deforms."""
    journal = half.throw.main_journal
    return WarpShapes(journal.radius_mm, journal.bore_radius_mm)


def loaded_throw(blocks: Sequence[LoadedBlock], scene: Scene) -> LoadedThrow:
    """Return stiffness and loads of the full throw from its condensed symmetries."""
    loads: dict[str, Array] = {}
    for part in blocks:
        for name, forces in part.section_forces().items():
            loads[name] = loads.get(name, np.zeros(SECTIONS)) + forces
    for name, moment in (("radial", 0.0), ("tangential", -scene.throw.radius_mm)):
        loads[name] = _with_torque(loads[name], moment)
    aside = loads["radial aside"]
    moment = -float(aside[RX] + aside[6 + RX] - scene.pitch_mm * aside[6 + UY])
    stiffness = np.sum([part.stiffness() for part in blocks], axis=0)
    moved = [
        np.concatenate([loads[name], sum(part.aside_motion(name) for part in blocks)])
        for name in ("radial aside", "tangential aside")
    ]
    return LoadedThrow(stiffness, loads, moment, -np.array(moved) / moment)


def _with_torque(forces: Array, moment_Nmm: float) -> Array:
    """Return section forces of a pin force with the torque of one on the pin's axis; each takes half of it.

    Spread over material that a drilling lacks, the force acts beside the axis, its lever up to 0.6 % short.
    """
    missing = moment_Nmm - forces[RZ] - forces[6 + RZ]
    found = forces.copy()
    found[[RZ, 6 + RZ]] += missing / 2
    return found


def _unit_loads(model: Elasticity, scene: Scene, span: Span, lateral: Lateral) -> dict[str, Array]:
    """Nodal forces on the model of the unit loads that have its symmetry."""
    directions = {"even": ("radial",), "odd": ("tangential",), "none": _PIN}[lateral]
    low, high = loaded_mm(scene, whole=True)
    found: dict[str, Array] = {}
    for name in directions:
        axis, sign = (1, -1.0) if name == "radial" else (0, 1.0)
        near = sign * mean_displacement(model, axis, low, (low + high) / 2)
        far = sign * mean_displacement(model, axis, (low + high) / 2, high) if span == "whole" else near
        if span != "antisymmetric":
            found[name] = (near + far) / 2
        if span != "symmetric":
            found[f"{name} aside"] = (near - far) / 2 if span == "whole" else near
    if span != "antisymmetric" and lateral != "odd":
        found["centrifugal"] = turning_load(model, scene, span, lateral)
    if span != "antisymmetric" and lateral != "even" and _may_vibrate(scene):
        found[SWING] = swing_force(model)
    return found


def _may_vibrate(scene: Scene) -> bool:
    """Tell whether the torque of a vibrating shaft may load it, whatever the plan decides."""
    takeoff = scene.shaft is not None and scene.shaft.has_takeoff
    return takeoff and scene.effects.torsional_vibration != "off"
