"""A crank that vibrates in its bearings as one meshed body beside `shaft --dynamic`, over a working cycle.

`python -m tests.studies.one_body_in_motion [DESIGN [SIZE [RPM]]]` prints a table of docs/pages/evaluating.md.
The body has all its unknowns: its vibration under every harmonic of the forces is the sum of its own natural
modes and, for all modes beyond, of its static displacement. How many modes are counted changes little, which
the table shows. Both have the same elements and bearings of springs. What the rotation adds to the equations
is left out of both, and so is the mean of the cycle, which is static: tests.studies.one_body_shaft.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as sla
from numpy.typing import NDArray

from cranktopo.base.units import KG_PER_TONNE, density_tonne_per_mm3
from cranktopo.design.crank_throws import carried
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import at_speed
from cranktopo.numerics.harmonic_balance import curves_of, harmonics_of
from cranktopo.numerics.tetrahedra.elasticity import mass_matrix, mean_displacement
from cranktopo.numerics.tetrahedra.rigid_motions import RZ, UX, UY, held_by_mirror
from cranktopo.numerics.tetrahedra.solver import cholesky
from cranktopo.tasks.dynamics.moving_shaft import MovingCycle, moving_cycle, moving_shaft
from cranktopo.tasks.dynamics.moving_throw import MovingThrow, moving_throw
from cranktopo.tasks.modes.stage import moving_kg
from cranktopo.tasks.shaft.cycle import CycleForces, cycle_forces
from cranktopo.tasks.shaft.loaded_throw import LOADS, LoadedBlock, ThrowBody
from cranktopo.tasks.throw_fea.condense import Lateral, loaded_mm
from tests.studies.one_body import LATERALS, MOTIONS, OneBody, one_body
from tests.studies.one_body_shaft import (
    Solved,
    Throws,
    condensed,
    differences,
    fillets,
    moved,
    stress_differences,
    told,
    unit_forces,
)

Array = NDArray[np.float64]
SPRING_N_PER_MM = 1e6
LOSS = 0.02
MODES = (10, 20, 40)
_SHIFT = -((2 * np.pi * 300.0) ** 2)
_EVEN_ROTATION_NMM_PER_RAD = 1e13
"""Holds the rotation of the last section, which drives something that turns evenly."""
STRIDE = 20
FRACTION = 3.0
"""Of the elements in the fillets over their radius: coarse, as the body is factorised."""


@dataclass(frozen=True)
class Vibrating:
    """A half of a crank by its natural modes.

    Attributes:
        squares: of their angular frequencies.
        shapes: orthonormal in the mass, (unknowns, modes).
        lossless: the part of the stiffness by bearings over the modes.
        shifted: displacements under unit loads with the mass taken off the stiffness `_SHIFT` times.
        forces: unit loads, (unknowns, loads).
    """

    squares: Array
    shapes: Array
    lossless: Array
    shifted: Array
    forces: Array

    def displacements(self, loads: Array, speed: float, cycle_rad: float, modes: int) -> Array:
        """Return the periodic displacements under loads without a mean, (unknowns, states), by some modes."""
        chosen = self.shapes[:, :modes]
        squares, parts = self.squares[:modes], harmonics_of(loads)
        push = chosen.T @ self.forces
        rest = self.shifted - chosen @ (push / (squares - _SHIFT)[:, None])
        found = np.zeros((modes, parts.shape[1]), dtype=complex)
        for number in range(1, parts.shape[1]):
            w = speed * 2 * np.pi / cycle_rad * number
            stiffness = np.diag(squares * (1 + 1j * LOSS) - w**2) - 1j * LOSS * self.lossless[:modes, :modes]
            found[:, number] = np.linalg.solve(stiffness, push @ parts[:, number])
        states = loads.shape[1]
        beyond = curves_of(parts / (1 + 1j * LOSS), states)
        return np.asarray(chosen @ curves_of(found, states) + rest @ beyond)


def vibrating(body: OneBody, lateral: Lateral, modes: int) -> Vibrating:
    """Find the natural modes of a half on springs, with the mass of rods and pistons on its pins."""
    scene, nodes = body.scene, body.model.nodes_mm
    free = np.setdiff1d(np.arange(nodes.size), held_by_mirror(nodes, 0, 0.0, even=lateral == "even"))
    sections = [body.section(number, lateral) for number in range(len(body.places_mm))]
    radial = MOTIONS[lateral].index(UY if lateral == "even" else UX)
    springs = [np.sqrt(SPRING_N_PER_MM / 2) * sections[one][radial] for one in carried(scene)]
    if lateral == "odd":
        springs.append(np.sqrt(_EVEN_ROTATION_NMM_PER_RAD / 2) * sections[-1][MOTIONS["odd"].index(RZ)])
    held = sp.csr_matrix(np.array(springs))
    pins = [np.sqrt(moving_kg(scene) / KG_PER_TONNE / 2) * one for one in _pins(body, lateral)]
    density = density_tonne_per_mm3(scene.material.density_kg_m3)
    riding = sp.csr_matrix(np.array(pins))
    mass = (sp.kron(mass_matrix(body.model, density), sp.eye(3)) + riding.T @ riding).tocsr()[free][:, free]
    stiffness = (body.model.stiffness.tocsr() + held.T @ held)[free][:, free]
    solve = cholesky(stiffness - _SHIFT * mass)
    inverse = sla.LinearOperator(
        stiffness.shape, lambda load: solve(np.ascontiguousarray(load.reshape(-1, 1))).ravel(), dtype=float
    )
    squares, vectors = sla.eigsh(stiffness, modes, mass, sigma=_SHIFT, OPinv=inverse)
    shapes, forces = np.zeros((nodes.size, modes)), unit_forces(body, lateral)
    shapes[free] = vectors
    by_springs = held @ shapes
    shifted = np.zeros_like(forces)
    shifted[free] = solve(np.ascontiguousarray(forces[free]))
    order = np.argsort(squares)
    lossless = (by_springs.T @ by_springs)[np.ix_(order, order)]
    return Vibrating(squares[order], shapes[:, order], lossless, shifted, forces)


def _pins(body: OneBody, lateral: Lateral) -> list[Array]:
    """Mean displacement of each pin along x and y, as far as the symmetry has it, (unknowns,) each."""
    found = []
    for part in body.parts:
        own = np.zeros(body.model.nodes_mm.size)
        axis = 1 if lateral == "even" else 0
        mean = mean_displacement(part.model, axis, *loaded_mm(part.scene, whole=True))
        own[part.unknowns] = part.turned(lateral)[:, 0] * mean
        found.append(own)
    return found


def by_modes(body: OneBody, halves: Mapping[Lateral, Vibrating], forces: CycleForces, modes: int) -> Solved:
    """Return the vibration of the body with all its unknowns, by some of its modes, each `STRIDE` degrees."""
    cycle_rad = float(np.radians(forces.angle_deg[1] - forces.angle_deg[0]) * forces.angle_deg.size)
    still = np.zeros((1, forces.angle_deg.size))
    acts: dict[Lateral, Array] = {"even": np.vstack([forces.radial_N, still]), "odd": forces.tangential_N}
    fields = {
        lateral: halves[lateral].displacements(own, forces.angular_speed_rad_s, cycle_rad, modes)[:, ::STRIDE]
        for lateral, own in acts.items()
    }
    return _told(body, fields, forces)


def without_mean(forces: CycleForces) -> CycleForces:
    """The forces of a cycle less their mean."""
    names = ("radial_N", "tangential_N")
    varying = {name: (own := getattr(forces, name)) - own.mean(axis=1, keepdims=True) for name in names}
    return replace(forces, **varying)


def by_reduced_throws(body: OneBody, throws: Throws, forces: CycleForces, *, warps: bool = True) -> Solved:
    """Return the vibration of the same elements reduced throw by throw, as `shaft --dynamic` has it."""
    moving = [
        _still_axes(moving_throw(ThrowBody(part.meshed, part.model, tuple(blocks)), part.scene, LOSS))
        for part, blocks in zip(body.parts, throws.blocks, strict=True)
    ]
    shaft = moving_shaft(moving, body.scene, SPRING_N_PER_MM)
    if not warps:
        shaft = replace(shaft, rigid_at=tuple(range(len(body.places_mm))))
    cycle = moving_cycle(shaft, forces)
    fields = {lateral: np.zeros((body.model.nodes_mm.size, forces.angle_deg.size)) for lateral in LATERALS}
    for index, throw in enumerate(moving):
        part, angle = body.parts[index], shaft.angles_deg[index]
        for lateral, own in _expanded(throws.blocks[index], throw, cycle, angle, index).items():
            fields[lateral][part.unknowns] = part.turned(lateral) * own
    varying = {
        lateral: (own - own.mean(axis=1, keepdims=True))[:, ::STRIDE] for lateral, own in fields.items()
    }
    return _told(body, varying, forces)


def _expanded(
    blocks: Sequence[LoadedBlock], throw: MovingThrow, cycle: MovingCycle, angle_deg: float, index: int
) -> dict[Lateral, Array]:
    """Return the displacements of a throw in either symmetry, (unknowns, states)."""
    within = cycle.within[index]
    acting = np.vstack([within[: len(LOADS)], np.zeros((1, within.shape[1]))])  # no load "swing"
    states = np.vstack([cycle.shaft.of_throw(index, angle_deg), acting])
    found = {one.lateral: moved(one, states) for one in blocks}
    for own, amplitude in zip(throw.inertial_fields(), within[len(LOADS) :], strict=True):
        found["even" if own.sign_x > 0 else "odd"] += np.outer(own.displacement_mm, amplitude)
    return dict(found)


def _still_axes(throw: MovingThrow) -> MovingThrow:
    """A throw without what the rotation adds to its equations."""
    body = throw.damped.body
    none = np.zeros_like(body.mass)
    slow = replace(body, coriolis=none, lateral=none, stiffening=none)
    return replace(throw, damped=replace(throw.damped, body=slow))


def _told(body: OneBody, fields: Mapping[Lateral, Array], forces: CycleForces) -> Solved:
    """Motions alone: forces on sections would need the inertia."""
    loads = {lateral: [np.zeros((part.unknowns.size, 1)) for part in body.parts] for lateral in LATERALS}
    found = told(body, fields, loads)
    return replace(found, throw_N=np.zeros_like(found.throw_N), bearing_N=np.zeros_like(found.bearing_N))


def columns(scene: Scene, size_mm: float) -> dict[str, dict[str, float]]:
    """Return how far each way is off the body by most modes, %: motions, and stresses in the fillets."""
    body = one_body(scene, size_mm, FRACTION)
    halves = {lateral: vibrating(body, lateral, max(MODES)) for lateral in LATERALS}
    throws, on = condensed(body), fillets(body)
    forces = without_mean(cycle_forces(scene))
    most = by_modes(body, halves, forces, max(MODES))
    ways = {f"body, {count} modes": by_modes(body, halves, forces, count) for count in MODES[:-1]}
    ways |= {
        f"shaft, {kind} sections": by_reduced_throws(body, throws, forces, warps=kind == "warping")
        for kind in ("rigid", "warping")
    }
    stress, found = on.stress_MPa(most.fields), {}
    for name, way in ways.items():
        column = differences(most, way)
        by_fillet = stress_differences(on, stress, on.stress_MPa(way.fields))
        for where in ("journal", "pin"):
            own = [value for (_, fillet), value in by_fillet.items() if fillet == where]
            column[f"{where} fillets, largest stress"] = max((one for one, _ in own), key=abs)
            column[f"{where} fillets, stress of the difference"] = max(one for _, one in own)
        found[name] = column
    return found


def main(design: str, size_mm: float, rpm: float) -> None:
    """Print the table as Markdown."""
    found = columns(at_speed(load_scene(design, whole=True), rpm), size_mm)
    print(f"| % of the largest | {' | '.join(found)} |", "|---|" + "---:|" * len(found), sep="\n")
    for name in next(iter(found.values())):
        print(f"| {name} | {' | '.join(f'{column[name]:+.2f}' for column in found.values())} |")


if __name__ == "__main__":
    told_of = sys.argv[1:]
    size, rpm = (float((told_of[place:] or [usual])[0]) for place, usual in ((1, "20"), (2, "2100")))
    main((told_of or ["mikron-iiic"])[0], size, rpm)
