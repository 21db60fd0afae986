"""The whole shaft that vibrates as one body over named coordinates, for other programs to solve."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.frames import about_z_deg
from cranktopo.bodies.crank_ends import SIDES, main_journal_places_mm
from cranktopo.design.schema import Scene
from cranktopo.numerics.harmonic_balance import DampedBody
from cranktopo.numerics.turning_body import TurningBody
from cranktopo.tasks.dynamics.moving_shaft import MovingShaft
from cranktopo.tasks.dynamics.moving_throw import MovingThrow
from cranktopo.tasks.modes.shaft_model import MOTIONS, end_coordinates
from cranktopo.tasks.shaft.assembly import SECTIONS, own_unknowns, turned
from cranktopo.tasks.shaft.cycle import warps_of
from cranktopo.tasks.shaft.loaded_throw import LOADS

_SQUARE_SPEED = "rad2/s2"
"""Unit of the amplitude of the load "centrifugal", whose unit load is that of 1 rad/s; of others it is N."""
_INERTIAL = "mm t0.5"
"""Unit of a field that is orthonormal in the mass."""
_WARPS = ("oval", "oval", "saddle", "saddle", "shear", "shear")
"""Names of the deformations of a section, in their order."""


@dataclass(frozen=True)
class Coordinate:
    """An unknown of the shaft.

    Attributes:
        name: of the section, field or part that moves.
        motion: one of `MOTIONS`; "oval", "saddle" or "shear" of the deformation of a section (`WarpShapes`);
            or "field" of the inner deformation of a throw with its sections held.
        unit: of the unknown.
        z_mm: its place along the shaft, the middle of the first main journal at 0; of a field, of its throw.
    """

    name: str
    motion: str
    unit: str
    z_mm: float


@dataclass(frozen=True)
class AssembledShaft:
    """A free shaft, without bearings; mm, tonne, N, s, rad.

    Attributes:
        damped: all throws and ends with what damps them, in the frame that turns with the shaft.
        own: unknowns of each throw in its own axes, as of `MovingThrow`, by those of the shaft,
            (unknowns, n) each.
    """

    damped: DampedBody
    coordinates: tuple[Coordinate, ...]
    own: tuple[Array, ...]


def assembled(shaft: MovingShaft, scene: Scene) -> AssembledShaft:
    """Join the bodies of a shaft over one set of unknowns: motions of all sections, warps, fields, ends."""
    sections, count = len(shaft.viscous), len(shaft.throws)
    coordinates = _sections(main_journal_places_mm(scene))
    parts = list[tuple[DampedBody, Array, list[int]]]()
    for index, (throw, angle) in enumerate(zip(shaft.throws, shaft.angles_deg, strict=True)):
        new = _fields(throw, index + 1, coordinates[6 * index].z_mm, coordinates[6 * index + 6].z_mm)
        at = [*own_unknowns(index, count, SECTIONS), *_behind(coordinates, new)]
        back = np.eye(len(at))
        back[:SECTIONS, :SECTIONS] = turned(about_z_deg(angle), SECTIONS).T
        parts.append((throw.damped, back, at))
    for side, end, first in zip(SIDES, shaft.ends, (0, 6 * count), strict=True):
        new = [Coordinate(name, motion, _unit(motion), z) for name, motion, z in end_coordinates(scene, side)]
        at = [*range(first, first + 6), *_behind(coordinates, new)]
        parts.append((end, np.eye(len(end.loss)), at))
    rows = np.eye(len(coordinates))
    motions = [motion @ rows[at] for _, motion, at in parts]
    total = TurningBody.of_nothing(len(rows))
    viscous = rows[:sections].T @ shaft.viscous @ rows[:sections]
    loss = np.zeros_like(viscous)
    for (part, _, _), motion in zip(parts, motions, strict=True):
        total += part.body.over(motion)
        loss += motion.T @ part.loss @ motion
        viscous += motion.T @ part.viscous @ motion
    kept = np.delete(np.arange(len(rows)), warps_of(shaft.rigid_at, count + 1, sections))
    chosen = np.ix_(kept, kept)
    return AssembledShaft(
        DampedBody(total.over(rows[:, kept]), loss[chosen], viscous[chosen]),
        tuple(coordinates[one] for one in kept),
        tuple(motion[:, kept] for motion in motions[:count]),
    )


def _behind(coordinates: list[Coordinate], new: Sequence[Coordinate]) -> range:
    """Add coordinates behind others and return their numbers."""
    start = len(coordinates)
    coordinates.extend(new)
    return range(start, len(coordinates))


def _sections(places_mm: Sequence[float]) -> list[Coordinate]:
    return [
        Coordinate(f"section {number}", motion, _unit(motion), z)
        for motions in (MOTIONS, _WARPS)
        for number, z in enumerate(places_mm, start=1)
        for motion in motions
    ]


def _fields(throw: MovingThrow, number: int, near_mm: float, far_mm: float) -> list[Coordinate]:
    z, inertial = (near_mm + far_mm) / 2, len(throw.loads) - SECTIONS - len(LOADS)
    units = {name: _SQUARE_SPEED if name == "centrifugal" else "N" for name in LOADS}
    units |= {f"inertia {field}": _INERTIAL for field in range(1, inertial + 1)}
    return [Coordinate(f"throw {number} {name}", "field", unit, z) for name, unit in units.items()]


def _unit(motion: str) -> str:
    return "rad" if motion.startswith("r") else "mm"
