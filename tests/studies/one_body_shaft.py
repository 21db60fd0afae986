"""A crank on its bearings as one meshed body beside `shaft`, which joins throws condensed one by one.

`python -m tests.studies.one_body_shaft [DESIGN [SIZE [FRACTION]]]` prints a table of docs/pages/evaluating.md
of motions, forces and stresses in the fillets over the cycle. Both have the same elements, and stresses of
both are found at the same nodes by the same polynomials: the difference is that of the condensation alone.
"""

from __future__ import annotations

import sys
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cranktopo.design.crank_throws import carried
from cranktopo.design.halves import halves
from cranktopo.design.loading import load_scene
from cranktopo.numerics.tetrahedra.fitted_stress import fitted_stress
from cranktopo.numerics.tetrahedra.rigid_motions import RX, RY, RZ, UX, UY, UZ
from cranktopo.numerics.tetrahedra.stress import Surface, outer_surface, von_mises
from cranktopo.tasks.shaft.cycle import CycleForces, ShaftCycle, cycle_forces, shaft_cycle, throw_states
from cranktopo.tasks.shaft.loaded_throw import ACTING, LoadedBlock, LoadedThrow, loaded_blocks, loaded_throw
from cranktopo.tasks.throw_fatigue.fillets import fillet_nodes
from cranktopo.tasks.throw_fea.condense import Lateral
from tests.studies.one_body import LATERALS, MOTIONS, FreeHalf, OneBody, free_half, one_body

Array = NDArray[np.float64]
STRIDE = 30
"""Every so many degrees of the cycle is a state."""
_OF_MOTION = {
    "along the axis": [UZ],
    "tilt of journals": [RX, RY],
    "twist": [RZ],
    "offset of journals": [UX, UY],
}
_OF_FORCE = {"shear": [UX, UY], "bending moment": [RX, RY], "torque": [RZ]}


@dataclass(frozen=True)
class Solved:
    """A crank over the cycle, by either way.

    Attributes:
        motion: of all sections, (sections, 6, states).
        pins: mean displacement of each pin along -y and x of its throw, (throws, 2, states).
        throw_N: forces on both sections of each throw in its axes, (throws, 12, states).
        bearing_N: x and y of the forces of the bearings, (sections, 2, states).
        fields: displacements of the half x >= 0 in either lateral symmetry, (unknowns, states).
    """

    motion: Array
    pins: Array
    throw_N: Array
    bearing_N: Array
    fields: Mapping[Lateral, Array]


@dataclass(frozen=True)
class Throws:
    """The throws of a body condensed one by one."""

    blocks: tuple[list[LoadedBlock], ...]
    loaded: tuple[LoadedThrow, ...]


def few_states(forces: CycleForces, stride: int = STRIDE) -> CycleForces:
    """Every so many-th state of a cycle."""
    names = ("radial_N", "tangential_N", "radial_aside_N_mm", "tangential_aside_N_mm")
    some = {name: getattr(forces, name)[:, ::stride] for name in names}
    return replace(forces, angle_deg=forces.angle_deg[::stride], **some)


def condensed(body: OneBody) -> Throws:
    """Condense the elements of each throw, as `shaft` does those of its own meshes."""
    blocks = tuple(loaded_blocks(one.model, one.scene, mirrored=True, whole=True) for one in body.parts)
    loaded = tuple(loaded_throw(own, one.scene) for own, one in zip(blocks, body.parts, strict=True))
    return Throws(blocks, loaded)


def nodal_loads(body: OneBody, forces: CycleForces) -> dict[Lateral, list[Array]]:
    """Forces on the nodes of each throw, in its axes, in either symmetry, (unknowns, states) each."""
    assert not forces.radial_aside_N_mm.any()
    speed = forces.angular_speed_rad_s**2 * np.ones(forces.angle_deg.size)
    found: dict[Lateral, list[Array]] = {lateral: [] for lateral in LATERALS}
    for index, part in enumerate(body.parts):
        acts = {"radial": forces.radial_N, "tangential": forces.tangential_N}
        for lateral in LATERALS:
            found[lateral].append(
                np.sum(
                    [
                        np.outer(unit, acts[name][index] if name in acts else speed)
                        for name, unit in part.loads(lateral).items()
                    ],
                    axis=0,
                )
            )
    return found


@dataclass(frozen=True)
class AllUnknowns:
    """A crank under unit loads by all its unknowns: radial or tangential by throw, then the rotation."""

    body: OneBody
    halves: Mapping[Lateral, FreeHalf]

    def on_bearings(self, forces: CycleForces, spring_N_per_mm: float | None) -> Solved:
        """Return the crank over a cycle; None: rigid bearings."""
        turning = np.full((1, forces.angle_deg.size), forces.angular_speed_rad_s**2)
        acts: dict[Lateral, Array] = {
            "even": np.vstack([forces.radial_N, turning]),
            "odd": forces.tangential_N,
        }
        fields = {
            lateral: self.halves[lateral].displacements(own, carried(self.body.scene), spring_N_per_mm)
            for lateral, own in acts.items()
        }
        return told(self.body, fields, nodal_loads(self.body, forces))


def all_unknowns(body: OneBody) -> AllUnknowns:
    """Solve all unit loads of a crank."""
    return AllUnknowns(
        body, {lateral: free_half(body, lateral, unit_forces(body, lateral)) for lateral in LATERALS}
    )


def unit_forces(body: OneBody, lateral: Lateral) -> Array:
    """Return the nodal forces of unit loads: on each pin, then of the rotation, (unknowns, k)."""
    pins, turning = [], np.zeros(body.model.nodes_mm.size)
    for part in body.parts:
        for name, own in part.loads(lateral).items():
            placed = np.zeros(body.model.nodes_mm.size)
            placed[part.unknowns] = part.turned(lateral)[:, 0] * own
            if name == "centrifugal":
                turning += placed
            else:
                pins.append(placed)
    return np.column_stack([*pins, turning] if lateral == "even" else pins)


def told(body: OneBody, fields: Mapping[Lateral, Array], loads: Mapping[Lateral, list[Array]]) -> Solved:
    """Return what displacements and loads of the crank mean; `loads` as of `nodal_loads`."""
    states, count = next(iter(fields.values())).shape[1], len(body.parts)
    motion = np.zeros((count + 1, 6, states))
    throw_N, pins = np.zeros((count, 12, states)), np.zeros((count, 2, states))
    for lateral in LATERALS:
        for number in range(count + 1):
            motion[number, MOTIONS[lateral]] = body.section(number, lateral) @ fields[lateral]
        for index, part in enumerate(body.parts):
            own = part.turned(lateral) * fields[lateral][part.unknowns]
            throw_N[index] += part.section_forces(lateral, own, loads[lateral][index])
            row, name = (0, "radial") if lateral == "even" else (1, "tangential")
            pins[index, row] = 2 * part.loads(lateral)[name] @ own
    bearing = np.zeros((count + 1, 2, states))
    for index, part in enumerate(body.parts):
        side = -1.0 if part.half_turn else 1.0
        bearing[index] += side * throw_N[index, :2]
        bearing[index + 1] += side * throw_N[index, 6:8]
    return Solved(motion, pins, throw_N, bearing, fields)


def by_throws(
    body: OneBody, throws: Throws, forces: CycleForces, spring_N_per_mm: float | None, *, warps: bool = True
) -> Solved:
    """Solve the crank by its condensed throws, sections round or not."""
    angles, count = body.scene.shaft_angles_deg, len(body.parts)
    rigid_at = () if warps else range(count + 1)
    cycle = shaft_cycle(
        throws.loaded, angles, forces, spring_N_per_mm, carried(body.scene), rigid_at=rigid_at
    )
    fields = expanded(body, throws, forces, cycle)
    found = told(body, fields, nodal_loads(body, forces))
    motion = cycle.motion.reshape(count + 1, 6, -1)
    return replace(found, motion=motion, throw_N=cycle.throw_N, bearing_N=cycle.bearing_N)


def expanded(body: OneBody, throws: Throws, forces: CycleForces, cycle: ShaftCycle) -> dict[Lateral, Array]:
    """Return the displacements of all nodes of the crank by those of its condensed throws."""
    states = throw_states(throws.loaded, body.scene.shaft_angles_deg, forces, cycle)
    fields = {lateral: np.zeros((body.model.nodes_mm.size, forces.angle_deg.size)) for lateral in LATERALS}
    for part, blocks, own in zip(body.parts, throws.blocks, states, strict=True):
        for one in blocks:
            fields[one.lateral][part.unknowns] = part.turned(one.lateral) * moved(one, own)
    return fields


def moved(one: LoadedBlock, states: Array) -> Array:
    """Return the displacements of a condensed throw in states of it, (unknowns, states)."""
    motions, sections = len(one.block.motions), one.sections.shape[1]
    acting = states[sections:][[ACTING.index(name) for name in one.names]]
    first = np.hstack([one.block.displacement[:, :motions], one.warp_fields])
    loaded = one.block.displacement[:, one.block.displacement.shape[1] - len(one.names) :]
    return np.asarray(first @ (one.sections @ states[:sections]) + loaded @ (one.on_model[:, None] * acting))


@dataclass(frozen=True)
class Fillets:
    """The fillets of all webs: nodes of the surface, and stresses of both halves there."""

    body: OneBody
    surface: Surface
    on: Mapping[tuple[int, str], NDArray[np.intp]]
    chosen: NDArray[np.bool_]

    def stress_MPa(self, fields: Mapping[Lateral, Array]) -> Array:
        """Return the stresses at all chosen nodes for x >= 0 and their images, (2, states, nodes, 6)."""
        parts = [
            fitted_stress(self.body.model, self.surface, self.chosen, fields[lateral].T, self.body.elastic)[0]
            for lateral in LATERALS
        ]
        even, odd = parts
        return np.stack([even + odd, even - odd])


def fillets(body: OneBody) -> Fillets:
    """Find the nodes on the fillets of a body."""
    planes = ((0, 0.0), (2, body.places_mm[0]), (2, body.places_mm[-1]))
    surface = outer_surface(body.model, body.model.mesh.dofs.element_dofs, planes)
    on: dict[tuple[int, str], NDArray[np.intp]] = {}
    chosen = np.zeros(len(surface.nodes), dtype=bool)
    for index, part in enumerate(body.parts):
        x, y, z = surface.points_mm - [[0.0], [0.0], [body.places_mm[index]]]
        inside = (z > 0) & (z < part.scene.pitch_mm)
        y = -y if part.half_turn else y
        for far, half in enumerate(halves(part.scene)):
            near = inside & ((z > part.scene.pitch_mm / 2) == bool(far))
            own = np.stack([x, y, part.scene.pitch_mm - z if far else z])
            for name in ("journal", "pin"):
                mask = near & fillet_nodes(half, name, own)
                on[2 * index + far + 1, name] = np.flatnonzero(mask)
                chosen |= mask
    place = np.cumsum(chosen) - 1
    return Fillets(body, surface, {key: place[nodes] for key, nodes in on.items()}, chosen)


def differences(one: Solved, other: Solved) -> dict[str, float]:
    """Largest difference of each kind of motion and force over its largest value in the first, %."""
    found = {}
    pairs = {
        **{name: (one.motion[:, rows], other.motion[:, rows]) for name, rows in _OF_MOTION.items()},
        "pin along the throw": (one.pins[:, 0], other.pins[:, 0]),
        "pin across it": (one.pins[:, 1], other.pins[:, 1]),
        "bearing force": (one.bearing_N, other.bearing_N),
        **{name: (_ends(one, rows), _ends(other, rows)) for name, rows in _OF_FORCE.items()},
    }
    for name, (first, second) in pairs.items():
        scale = np.abs(first).max()
        if scale > 1e-9:
            found[name] = 100 * float(np.abs(first - second).max() / scale)
    return found


def _ends(solved: Solved, rows: list[int]) -> Array:
    return solved.throw_N.reshape(-1, 2, 6, solved.throw_N.shape[2])[:, :, rows]


def stress_differences(on: Fillets, one: Array, other: Array) -> dict[tuple[int, str], tuple[float, float]]:
    """Return the change of the largest stress of each fillet, and the largest of the difference, %."""
    found = {}
    for key, nodes in on.on.items():
        first, second = one[:, :, nodes], other[:, :, nodes]
        peak = float(von_mises(first).max())
        change = float(von_mises(second).max()) / peak - 1
        found[key] = (100 * change, 100 * float(von_mises(second - first).max()) / peak)
    return found


def main(design: str, size_mm: float, fraction: float) -> None:
    """Print the table as Markdown."""
    body = one_body(load_scene(design, whole=True), size_mm, fraction)
    whole, throws, on = all_unknowns(body), condensed(body), fillets(body)
    forces = few_states(cycle_forces(body.scene))
    print(f"{design}: {body.model.nodes_mm.shape[1]:,} nodes of the half, {forces.angle_deg.size} states\n")
    columns: dict[str, dict[str, float]] = {}
    for bearings, spring in (("rigid", None), ("springs", 1e6)):
        full = whole.on_bearings(forces, spring)
        stress = on.stress_MPa(full.fields)
        for kind, warps in (("rigid", False), ("warping", True)):
            found = by_throws(body, throws, forces, spring, warps=warps)
            column = differences(full, found)
            by_fillet = stress_differences(on, stress, on.stress_MPa(found.fields))
            for name in ("journal", "pin"):
                own = {web: value for (web, where), value in by_fillet.items() if where == name}
                column |= {
                    f"{name} fillet of web {web}, largest stress": change for web, (change, _) in own.items()
                }
                column[f"{name} fillets, stress of the difference"] = max(local for _, local in own.values())
            columns[f"{bearings}, {kind} sections"] = column
    print(f"| % of the largest | {' | '.join(columns)} |", "|---|" + "---:|" * len(columns), sep="\n")
    names = dict.fromkeys(name for column in columns.values() for name in column)
    for name in names:
        cells = (f"{column[name]:+.2f}" if name in column else "" for column in columns.values())
        print(f"| {name} | {' | '.join(cells)} |")


if __name__ == "__main__":
    told_of = sys.argv[1:]
    main(
        (told_of or ["mikron-iiic"])[0],
        float((told_of[1:] or ["8"])[0]),
        float((told_of[2:] or ["0.5"])[0]),
    )
