"""The whole shaft with its mass: throws, ends and what they carry joined over one set of unknowns."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.frames import about_z_deg
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.crank_ends import SIDES, crank_end, end_length_mm, main_journal_places_mm
from cranktopo.design.crank import Side
from cranktopo.design.crank_throws import carried
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import ShaftTable
from cranktopo.engine.bearings import bearing_tilt_spring_Nmm_per_rad
from cranktopo.numerics.harmonic_balance import DampedBody
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, RZ, UX, UY
from cranktopo.numerics.turning_body import TurningBody
from cranktopo.numerics.turning_parts import RoundSection, beam, rigid_disk
from cranktopo.tasks.modes.carried import Part, parts_on, section_of
from cranktopo.tasks.modes.reduced_throw import ReducedThrow
from cranktopo.tasks.modes.station import Station, added
from cranktopo.tasks.shaft.assembly import Bearings, turned

MOTIONS = ("ux", "uy", "uz", "rx", "ry", "rz")
"""Of a section in their order."""
_ELEMENTS = 2
"""Beams of a step of an end."""


@dataclass(frozen=True)
class ShaftModel:
    """A shaft on its bearings.

    Attributes:
        body: over the unknowns that the bearings leave.
        step_of: as of `ReducedThrow`, of each unknown.
        sections: every mid-journal section, without mass.
        stations: pieces of the shaft; motions are in the axes of throw 1.
    """

    body: TurningBody
    step_of: NDArray[np.intp]
    sections: tuple[Station, ...]
    stations: tuple[Station, ...]

    def without_step(self, step: int) -> ShaftModel:
        """Return the model without the fields of a step and of those after it."""
        return self._with(np.flatnonzero(self.step_of < step))

    def held(self, unknowns: Sequence[int]) -> ShaftModel:
        """Return the model with some unknowns at zero."""
        return self._with(np.setdiff1d(np.arange(len(self.step_of)), unknowns))

    def _with(self, kept: NDArray[np.intp]) -> ShaftModel:
        chosen = np.eye(len(self.step_of))[:, kept]
        return ShaftModel(
            self.body.over(chosen),
            self.step_of[kept],
            *(
                tuple(replace(one, motion=one.motion[:, kept]) for one in places)
                for places in (self.sections, self.stations)
            ),
        )


class _Assembly:
    """Bodies over unknowns that are added one after the other."""

    def __init__(self) -> None:
        self._steps: list[int] = []
        self._bodies: list[tuple[TurningBody, Array, list[int]]] = []
        self._stations: list[tuple[Station, list[int]]] = []
        self._losses: list[tuple[Array, list[int]]] = []
        self._dashpots: list[tuple[Array, list[int]]] = []

    def new(self, steps: Sequence[int]) -> list[int]:
        """Add unknowns."""
        start = len(self._steps)
        self._steps += steps
        return list(range(start, len(self._steps)))

    def add(self, body: TurningBody, unknowns: list[int], motion: Array | None = None) -> None:
        """Add a body whose own unknowns are `motion` times some of the shaft's."""
        self._bodies.append((body, np.eye(len(unknowns)) if motion is None else motion, unknowns))

    def station(self, station: Station, unknowns: list[int]) -> None:
        """Add a piece, with its motion by some unknowns."""
        self._stations.append((station, unknowns))

    def lose(self, loss: Array, unknowns: list[int]) -> None:
        """Add the imaginary part of a stiffness over some unknowns."""
        self._losses.append((loss, unknowns))

    def attach(self, one: int, other: int, part: Part) -> None:
        """Join the rotation of a part to that of what it sits on."""
        joined = np.array([[1.0, -1.0], [-1.0, 1.0]])
        spring = (part.spring_Nmm_per_rad or 0.0) * joined
        self.add(added(2, stiffness=spring), [one, other])
        self.lose(part.loss_factor * spring, [one, other])
        self._dashpots.append((part.fluid_Nmms_per_rad * joined, [one, other]))

    def resist(self, one: int, damping: float) -> None:
        """Resist the velocity of an unknown."""
        self._dashpots.append((np.array([[damping]]), [one]))

    def damped(self) -> DampedBody:
        """Return all bodies with what damps them."""
        return DampedBody(self._body(), self._sum(self._losses), self._sum(self._dashpots))

    def _body(self) -> TurningBody:
        count = len(self._steps)
        rows, total = np.eye(count), TurningBody.of_nothing(count)
        for body, motion, unknowns in self._bodies:
            total += body.over(motion @ rows[unknowns])
        return total

    def _sum(self, parts: list[tuple[Array, list[int]]]) -> Array:
        total = np.zeros((len(self._steps),) * 2)
        for matrix, unknowns in parts:
            total[np.ix_(unknowns, unknowns)] += matrix
        return total

    def model(self, sections: list[list[int]], places: tuple[float, ...]) -> ShaftModel:
        """Return all of it."""
        rows = np.eye(len(self._steps))
        stations = (replace(s, motion=s.motion @ rows[unknowns]) for s, unknowns in self._stations)
        return ShaftModel(
            self._body(),
            np.array(self._steps, dtype=np.intp),
            tuple(
                Station(z, rows[motions], np.zeros((6, 6)))
                for motions, z in zip(sections, places, strict=True)
            ),
            tuple(stations),
        )


def shaft_model(
    throws: Sequence[ReducedThrow], scene: Scene, bearings: Bearings, spring_N_per_mm: float
) -> ShaftModel:
    """Join the throws of a shaft, its ends and what they carry.

    A section deforms unless a beam, whose sections do not, goes on behind it.

    Args:
        bearings: as of `shaft_stiffness`.
    """
    join, places = _Assembly(), main_journal_places_mm(scene)
    sections = [join.new([0] * 6) for _ in places]
    shapes = [join.new([0] * throws[0].shapes.count) for _ in places]
    for index, (throw, angle) in enumerate(zip(throws, scene.shaft_angles_deg, strict=True)):
        own = join.new([step for step in throw.step_of.tolist() if step])
        near, far = index, index + 1
        unknowns = [*sections[near], *sections[far], *shapes[near], *shapes[far], *own]
        _add_throw(join, throw, unknowns, about_z_deg(angle), places[index], f"throw {index + 1}")
    held = []
    for side, place in zip(SIDES, (0, -1), strict=True):
        held += shapes[place] if crank_end(scene, side) else []
        _add_end(join, scene, side, sections[place])
    radial = [sections[s][m] for s in carried(scene) for m in (UX, UY)]
    tilt = bearing_tilt_spring_Nmm_per_rad(scene)
    if tilt and bearings != "free":
        tilting = [sections[s][m] for s in carried(scene) for m in (RX, RY)]
        join.add(added(len(tilting), stiffness=tilt * np.eye(len(tilting))), tilting)
    if bearings == "spring":
        join.add(added(len(radial), stiffness=spring_N_per_mm * np.eye(len(radial))), radial)
    model = join.model(sections, places)
    return model.held(held + radial if bearings == "rigid" else held)


def _add_throw(
    join: _Assembly, throw: ReducedThrow, unknowns: list[int], angle_deg: float, z_mm: float, name: str
) -> None:
    back, count = np.eye(len(unknowns)), throw.shapes.count
    back[:12, :12] = turned(angle_deg).T
    deformed = throw.shapes.turned(math.radians(angle_deg)).T
    back[12 : 12 + 2 * count, 12 : 12 + 2 * count] = np.kron(np.eye(2), deformed)
    join.add(throw.body, unknowns, back)
    turn = turned(angle_deg)[:6, :6]
    for station in throw.stations:
        motion, inertia = turn @ station.motion @ back, turn @ station.inertia @ turn.T
        join.station(Station(z_mm + station.z_mm, motion, inertia, name), unknowns)


def damped_end(scene: Scene, side: Side) -> DampedBody:
    """Return an end of the crank with what it carries; the outer mid-journal section is its first unknowns.

    The crank's own material has the loss factor of the shaft's throws, whichever way it is strained.
    """
    join = _Assembly()
    _add_end(join, scene, side, join.new([0] * 6))
    return join.damped()


def end_coordinates(scene: Scene, side: Side) -> list[tuple[str, str, float]]:
    """Return name, motion and place along the shaft, mm, of the unknowns of `damped_end` behind the section.

    These are the joints of its beams from inside outwards, then the rotation of every part on a spring.
    """
    pieces = crank_end(scene, side)
    joints = [z for piece in pieces for z in np.linspace(*piece.z_mm, _ELEMENTS + 1)[1:].tolist()]
    found = [(f"{side} end {number}", motion, z) for number, z in enumerate(joints, 1) for motion in MOTIONS]
    sprung = (part for part in _parts_at_tip(scene, side) if part.spring_Nmm_per_rad is not None)
    return [*found, *((part.name, MOTIONS[RZ], _tip_mm(scene, side)) for part in sprung)]


def _add_end(join: _Assembly, scene: Scene, side: Side, section: list[int]) -> None:
    """Add an end of the crank as beams, and what it carries at its tip."""
    outward = -1 if side == "free" else 1
    table = scene.shaft or ShaftTable()
    pieces, parts = crank_end(scene, side), parts_on(table, side)
    spring = parts[0].spring_Nmm_per_rad if parts else None
    twisted = table.throw_loss_factor if spring is None else parts[0].loss_factor
    material = scene.material
    shear_MPa = material.E_GPa * MPA_PER_GPA / (2 * (1 + material.poisson))
    own = shear_MPa / sum(piece.twist_per_mm3 for piece in pieces) if pieces else 0.0
    tip = section
    for piece in pieces:
        along = section_of(piece, scene, spring / own if spring is not None else 1.0)
        length = piece.step.length_mm / _ELEMENTS
        for number in range(_ELEMENTS):
            outer, z = join.new([0] * 6), piece.z_mm[0] + outward * (number + 0.5) * length
            ends = [*tip, *outer] if outward > 0 else [*outer, *tip]
            elastic = beam(along, length)
            join.add(elastic, ends)
            join.lose(_lost(elastic.stiffness, table.throw_loss_factor, twisted), ends)
            join.station(replace(_of_beam(z, along, length), part=f"{side} end"), [*tip, *outer])
            tip = outer
    _add_parts(join, _parts_at_tip(scene, side), tip, _tip_mm(scene, side), outward)


def _parts_at_tip(scene: Scene, side: Side) -> tuple[Part, ...]:
    """Return what an end carries; the spring of the first part is the end itself, where that is drawn."""
    parts = parts_on(scene.shaft or ShaftTable(), side)
    if not parts or not crank_end(scene, side):
        return parts
    return (replace(parts[0], spring_Nmm_per_rad=None), *parts[1:])


def _tip_mm(scene: Scene, side: Side) -> float:
    """Return the place along the shaft of the outer face of an end."""
    length = end_length_mm(scene, side)
    return -length if side == "free" else main_journal_places_mm(scene)[-1] + length


def _lost(stiffness: Array, bent: float, twisted: float) -> Array:
    """Return the imaginary part of a beam's stiffness, whose torsion may have a loss factor of its own."""
    turns = np.isin(np.arange(len(stiffness)) % 6, [RZ])
    return stiffness * np.where(turns[:, None] & turns, twisted, bent)


def _of_beam(z_mm: float, section: RoundSection, length: float) -> Station:
    """Return a beam as a rigid piece over the motions of both its sections."""
    mass, polar = (section.density * moment * length for moment in (section.area, section.polar))
    diametral = polar / 2 + mass * length**2 / 12
    mean = np.hstack([np.eye(6), np.eye(6)]) / 2
    return Station(z_mm, mean, rigid_disk(mass, diametral, polar).mass)


def _add_parts(join: _Assembly, parts: Sequence[Part], tip: list[int], z_mm: float, outward: int) -> None:
    """Add parts to the tip of an end; those on springs have a rotation of their own."""
    turn = tip[RZ]
    for part in parts:
        if part.spring_Nmm_per_rad is not None:
            (own,) = join.new([0])
            join.attach(turn, own, part)
            turn = own
        join.resist(turn, part.resisted_Nmms_per_rad)
        unknowns = [*tip[:RZ], turn]
        body = part.body(outward)
        join.add(body, unknowns)
        centre = np.eye(6)
        centre[UX, RY], centre[UY, RX] = outward * part.outwards_mm, -outward * part.outwards_mm
        inertia = replace(part, outwards_mm=0.0).body(outward).mass
        join.station(Station(z_mm + outward * part.outwards_mm, centre, inertia, part.name), unknowns)
