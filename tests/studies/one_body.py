"""A crank whose throws lie in one plane, meshed as one body and solved with all its unknowns.

No condensation is in it: the stiffness is that of the elements, bearings hold or carry the mean displacement
of a mid-journal section, and forces are spread evenly over the material of a pin. The elements of each throw
are also told by themselves, so that the same elements can be condensed throw by throw.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.frames import about_z_deg
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.crank_ends import main_journal_places_mm
from cranktopo.bodies.mesh.solid_mesh import MeshedThrow, finest_mm, set_size_field
from cranktopo.bodies.solid.checked import SolidProperties
from cranktopo.bodies.solid.crankshaft import placed_throws
from cranktopo.bodies.solid.throw import add_full_throw
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.tetrahedra.cad_mesh import generate, positive_x
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble, mean_displacement
from cranktopo.numerics.tetrahedra.mesh import TetMesh, shape_gradients, shape_values
from cranktopo.numerics.tetrahedra.rigid_motions import (
    RX,
    RY,
    RZ,
    UX,
    UY,
    UZ,
    body_motions,
    held_by_mirror,
    plane_nodes,
    section_motions,
)
from cranktopo.numerics.tetrahedra.stress import boundary_faces
from cranktopo.tasks.throw_fea.condense import Lateral, loaded_mm
from cranktopo.tasks.throw_fea.turning_load import turning_load
from cranktopo.throw.element_size import tube_term

Array = NDArray[np.float64]
LATERALS: tuple[Lateral, ...] = ("even", "odd")
MOTIONS: dict[Lateral, list[int]] = {"even": [UY, UZ, RX], "odd": [UX, RY, RZ]}
"""Motions of a section that a lateral symmetry has."""
_RESIDUAL = 1e-5
"""Of the solutions: half of what it adds to a stiffness is its square."""
_MIRRORED = [1, 0, 2, 3, 4, 6, 5, 8, 7, 9]
"""Order of the nodes of an element that is mirrored."""
_FACE_EDGES = ((0, 1), (1, 2), (0, 2))
_PLANE_MM = 1e-6


@dataclass(frozen=True)
class PartOfBody:
    """The elements of one throw, those of its half x >= 0 in its own axes.

    A throw that is turned by half a turn is mirrored as well: its half is that of the crank then.

    Attributes:
        nodes: of the crank that they have, in their order.
        half_turn: whether it is turned so.
    """

    scene: Scene
    model: Elasticity
    nodes: NDArray[np.intp]
    half_turn: bool

    @property
    def meshed(self) -> MeshedThrow:
        """Its mesh, with the mass and volume of its elements."""
        volume = 2 * self.model.volume_mm3
        mesh = TetMesh(self.model.nodes_mm, self.model.mesh.dofs.element_dofs, mirrored=True)
        return MeshedThrow(mesh, SolidProperties(volume, (0.0, 0.0, 0.0), 0.0), volume, whole=True)

    @property
    def unknowns(self) -> NDArray[np.intp]:
        """Those of the crank that are its own."""
        return np.asarray((3 * self.nodes[:, None] + np.arange(3)).ravel())

    def turned(self, lateral: Lateral) -> Array:
        """Return by what displacements of the crank are multiplied in its axes, (unknowns, 1)."""
        one = np.array([1.0, -1.0, 1.0]) * (1.0 if lateral == "even" else -1.0)
        return np.tile(one if self.half_turn else np.ones(3), len(self.nodes))[:, None]

    def loads(self, lateral: Lateral) -> dict[str, Array]:
        """Return nodal forces on it, in its axes, of 1 N on its pin and of the rotation at 1 rad/s."""
        between = loaded_mm(self.scene, whole=True)
        if lateral == "odd":
            return {"tangential": mean_displacement(self.model, 0, *between) / 2}
        return {
            "radial": -mean_displacement(self.model, 1, *between) / 2,
            "centrifugal": turning_load(self.model, self.scene, "whole", lateral),
        }

    def section_forces(self, lateral: Lateral, fields: Array, loads: Array) -> Array:
        """Return what neighbours and bearings do to both sections of the whole throw, in its axes, (12, k).

        Args:
            fields: displacements in its axes, (unknowns, k).
            loads: nodal forces on it.
        """
        left, found = self.model.stiffness @ fields - loads, []
        for z in (0.0, self.scene.pitch_mm):
            moved = section_motions(self.model.nodes_mm, plane_nodes(self.model.nodes_mm, 2, z))
            both = np.zeros((6, fields.shape[1]))
            both[MOTIONS[lateral]] = 2 * moved[:, MOTIONS[lateral]].T @ left
            found.append(both)
        return np.vstack(found)


@dataclass(frozen=True)
class OneBody:
    """The half x >= 0 of a crank without ends.

    Attributes:
        throw_of: number of the throw of each element.
        places_mm: of the mid-journal sections.
    """

    scene: Scene
    mesh: TetMesh
    throw_of: NDArray[np.intp]
    places_mm: tuple[float, ...]

    @cached_property
    def model(self) -> Elasticity:
        """Its elements."""
        return assemble(self.mesh, *self.elastic)

    @property
    def elastic(self) -> tuple[float, float]:
        """Young's modulus in MPa and Poisson's ratio."""
        return self.scene.material.E_GPa * MPA_PER_GPA, self.scene.material.poisson

    @cached_property
    def parts(self) -> tuple[PartOfBody, ...]:
        """Its throws from the free end."""
        return tuple(self._part(index, throw) for index, throw in enumerate(throw_scenes(self.scene)))

    def _part(self, index: int, scene: Scene) -> PartOfBody:
        cells = self.mesh.cells[:, self.throw_of == index]
        nodes, own = np.unique(cells, return_inverse=True)
        own, points = own.reshape(cells.shape), self.mesh.points_mm[:, nodes]
        points = points - [[0.0], [0.0], [self.places_mm[index]]]
        angle = math.radians(about_z_deg(self.scene.shaft_angles_deg[index]))
        assert abs(math.sin(angle)) < 1e-9
        if half_turn := math.cos(angle) < 0:
            points, own = points * [[1.0], [-1.0], [1.0]], own[_MIRRORED]
        mesh = TetMesh(np.ascontiguousarray(points), np.ascontiguousarray(own), mirrored=True)
        model = assemble(mesh, *self.elastic)
        order = _same_places(model.nodes_mm, points)
        return PartOfBody(scene, model, self._nodes(nodes)[order], half_turn)

    def _nodes(self, nodes: NDArray[np.intp]) -> NDArray[np.intp]:
        """Return the numbers in the model of nodes of the mesh."""
        return _same_places(self.mesh.points_mm[:, nodes], self.model.nodes_mm)

    def section(self, number: int, lateral: Lateral) -> Array:
        """Return v with v.u = the rigid motion nearest to the displacements u of a section by its area.

        Shape (motions of `MOTIONS`, unknowns).
        """
        triangles, (points, weights) = self._faces(number), _triangle_points()
        values, slopes = shape_values(points, _FACE_EDGES), shape_gradients(points, _FACE_EDGES)
        corners = self.model.nodes_mm[:2, triangles]  # (2, 6, faces)
        (a, c), (b, d) = np.einsum("inf,pnj->ijpf", corners, slopes)
        area = 2 * np.abs(a * d - b * c) * weights[:, None]
        x, y = np.einsum("pn,inf->ipf", values, corners)
        moved = np.zeros((6, 3, *x.shape))
        moved[[UX, UY, UZ], [0, 1, 2]] = 1.0
        moved[RX, 2], moved[RY, 2], moved[RZ, 0], moved[RZ, 1] = y, -x, -y, x
        moved = moved[MOTIONS[lateral]]
        alike = np.einsum("aipf,bipf,pf->ab", moved, moved, area)
        found = np.zeros((3, self.model.nodes_mm.size))
        for row, own in zip(found, moved, strict=True):
            for axis in range(3):
                np.add.at(row, 3 * triangles + axis, np.einsum("pn,pf->nf", values, area * own[axis]))
        return np.asarray(np.linalg.solve(alike, found))

    def _faces(self, number: int) -> NDArray[np.intp]:
        """Return the triangles of a section, (6, faces)."""
        elements, z = self.model.mesh.dofs.element_dofs, self.places_mm[number]
        heights = self.model.nodes_mm[2]
        middle = heights[elements].mean(axis=0)
        local, owners = boundary_faces(elements := elements[:, middle < z if number else middle > z])
        triangles = elements[local, owners]
        return np.asarray(triangles[:, (np.abs(heights[triangles] - z) < _PLANE_MM).all(axis=0)])


def _same_places(one: Array, other: Array) -> NDArray[np.intp]:
    """Return for each point (3, n) the number of the same point among others."""
    from scipy.spatial import cKDTree

    distance, number = cKDTree(other.T).query(one.T)
    assert distance.max() < 1e-9
    return np.asarray(number)


def _triangle_points() -> tuple[Array, Array]:
    """Return barycentric points of a triangle, (points, 3), and their weights."""
    from skfem.quadrature import get_quadrature
    from skfem.refdom import RefTri

    points, weights = get_quadrature(RefTri, 8)
    return np.vstack([1 - points.sum(axis=0), points]).T, weights


def one_body(scene: Scene, size_mm: float, fillet_fraction: float | None = None) -> OneBody:
    """Mesh a crank without ends, its throws in one plane; mid-journal sections are faces of elements.

    Args:
        fillet_fraction: element size in the fillets over their radius.
    """
    places = main_journal_places_mm(scene)
    with cad_session("crank in one piece") as gmsh:
        occ = gmsh.model.occ
        throws = placed_throws(occ, scene, add_full_throw)
        first, *others = (positive_x(occ, throw, 4 * scene.pitch_mm) for throw in throws)
        occ.fragment(first, [entity for other in others for entity in other])
        occ.synchronize()
        set_size_field(gmsh, [repr(size_mm), *_at_fillets(scene, size_mm, fillet_fraction)])
        mesh = generate(gmsh, mirrored=True, stresses=fillet_fraction is not None, regular=True)
    middles = mesh.points_mm[2][mesh.cells[:4]].mean(axis=0)
    return OneBody(scene, mesh, np.searchsorted(places[1:-1], middles), tuple(places))


def _at_fillets(scene: Scene, size_mm: float, fraction: float | None) -> list[str]:
    """Return formulae of the element size at all fillets, mm, as a throw's own mesh has it."""
    found = []
    places = zip(throw_scenes(scene), scene.shaft_angles_deg, main_journal_places_mm(scene), strict=False)
    for throw, angle, place in places:
        for far, half in enumerate(halves(throw)):
            own, (start, end) = half.throw, half.web_z_mm
            for axis, journal, z in (
                (0.0, own.main_journal, start - own.main_journal.fillet.reach_mm),
                (own.radius_mm, own.crankpin, end + own.crankpin.fillet.reach_mm),
            ):
                y = axis * math.cos(math.radians(angle))
                height = place + (throw.pitch_mm - z if far else z)
                across = f"(Sqrt(x*x+(y-({y!r}))*(y-({y!r})))-{journal.radius_mm + journal.fillet_mm!r})"
                along = f"({journal.fillet.flattening!r}*(z-({height!r})))"
                finest = finest_mm(throw, size_mm, journal.fillet, fraction)
                found.append(tube_term(finest, across, along, journal.fillet.radial_mm))
    return found


@dataclass(frozen=True)
class FreeHalf:
    """The half of a crank in one lateral symmetry under unit forces, held at three nodes.

    These hold it where it is, and take no force once those of the bearings balance the loads.

    Attributes:
        sections: of every mid-journal section, as `OneBody.section`.
        units: displacements under unit loads, then under those of `sections`, (unknowns, k).
        rigid: its rigid motions, (unknowns, 3).
        loads: number of the unit loads.
    """

    lateral: Lateral
    sections: Array
    units: Array
    rigid: Array
    unit_forces: Array
    loads: int

    def displacements(self, loads: Array, borne_by: Sequence[int], spring_N_per_mm: float | None) -> Array:
        """Return the displacements in bearings of that radial stiffness, rigid by default, (unknowns, k).

        The last section is held in rotation and along the axis.

        Args:
            loads: number of each unit load, (loads, k).
        """
        of = MOTIONS[self.lateral]
        radial, last = (
            (of.index(UY), of.index(UZ)) if self.lateral == "even" else (of.index(UX), of.index(RZ))
        )
        held = [3 * number + radial for number in borne_by] + [len(self.sections) - 3 + last]
        lead, pulled = self.sections[held], self.units[:, self.loads :][:, held]
        gives = lead @ pulled
        if spring_N_per_mm is not None:
            gives[:-1, :-1] += 2 / spring_N_per_mm * np.eye(len(held) - 1)
        moves, free = lead @ self.rigid, self.units[:, : self.loads] @ loads
        matrix = np.block([[gives, moves], [moves.T, np.zeros((3, 3))]])
        right = np.vstack([-lead @ free, -self.rigid.T @ (self.unit_forces @ loads)])
        forces, rigid = np.split(np.linalg.solve(matrix, right), [len(held)])
        return np.asarray(free + pulled @ forces + self.rigid @ rigid)


def free_half(body: OneBody, lateral: Lateral, unit_forces: Array) -> FreeHalf:
    """Solve a half under unit forces on its nodes, (unknowns, loads), and under those of its sections."""
    nodes = body.model.nodes_mm
    mirror = held_by_mirror(nodes, 0, 0.0, even=lateral == "even")
    count = len(body.places_mm)
    sections = np.vstack([body.section(number, lateral) for number in range(count)])
    rigid = body_motions(nodes)[:, MOTIONS[lateral]]
    held = _three(nodes, lateral)
    solve = body.model.equations.solver(np.unique(np.concatenate([mirror, held])), _RESIDUAL)
    every = np.hstack([unit_forces, sections.T])
    return FreeHalf(lateral, sections, solve(every), rigid, unit_forces, unit_forces.shape[1])


def _three(nodes_mm: Array, lateral: Lateral) -> NDArray[np.intp]:
    """Return three unknowns that hold a half: near both ends of its mirror plane, and off it."""
    x, y, z = nodes_mm
    length = z.max()

    def nearest(*place: float) -> int:
        return int(np.linalg.norm(nodes_mm - np.array(place)[:, None], axis=0).argmin())

    middle = np.abs(x) < _PLANE_MM
    top, far = y[middle & (z < _PLANE_MM)].max(), y[middle & (z > length - _PLANE_MM)].max()
    ends = nearest(0.0, top, 0.0), nearest(0.0, far, length)
    if lateral == "even":
        return np.array([3 * ends[0] + 1, 3 * ends[1] + 1, 3 * ends[0] + 2])
    return np.array([3 * ends[0], 3 * ends[1], 3 * nearest(0.0, -top, 0.0)])
