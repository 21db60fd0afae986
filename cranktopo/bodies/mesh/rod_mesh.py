"""Quadratic tetrahedra on a quarter of the rod: x >= 0 in the plane of motion, z >= 0 along the pins.

An oblique split leaves one of both mirrors: its rod is a half, z >= 0.
"""

from __future__ import annotations

from functools import partial
from typing import Any

from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.memory import check_mesh_memory
from cranktopo.bodies.solid.checked import check_parts, volume_mm3
from cranktopo.bodies.solid.rod import add_rod
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.rod_body import rod_mass
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags, cad_session
from cranktopo.numerics.tetrahedra.cad_mesh import by_smaller_elements, generate, positive_x
from cranktopo.numerics.tetrahedra.mesh import TetMesh

_ELEMENTS = 40_000
"""Elements of the default size that a quarter would hold if all were regular."""
_REGULAR = 2**0.5 / 12
"""Volume of a regular tetrahedron over the cube of its edge."""
_AROUND = 16
"""Elements around a full circle, where the general size would give fewer."""
_SMALLEST = 0.2
"""Least element size over the general one."""


def rod_volume_mm3(scene: Scene) -> float:
    """Return the volume of rod and cap without what is fitted."""
    rod, length = rod_of(scene)
    density = (rod.material or scene.material).density_kg_m3
    return rod_mass(rod, length, scene.material).body_kg / density_kg_per_mm3(density)


def default_rod_element_mm(scene: Scene) -> float:
    """Return the element size that gives rods of any size the same number of elements."""
    return float((rod_volume_mm3(scene) / 4 / (_ELEMENTS * _REGULAR)) ** (1 / 3))


def mesh_rod(scene: Scene, element_size_mm: float) -> TetMesh:
    """Return the mesh of a quarter or half of a design's rod with its cap, in the frame of its solid.

    Raises:
        CranktopoError: no rod, impossible geometry, elements too fine for the memory, or no valid mesh.
    """
    check_mesh_memory(rod_volume_mm3(scene) / (4 if _is_square(scene) else 2), element_size_mm)
    return by_smaller_elements(f"rod of {scene.name}", element_size_mm, partial(_meshed, scene))


def _meshed(scene: Scene, size: float, adapt: bool) -> TetMesh:
    square = _is_square(scene)
    with cad_session(f"rod of {scene.name}") as gmsh:
        occ = gmsh.model.occ
        _cut(occ, add_rod(occ, scene), rod_of(scene)[1], square=square)
        occ.synchronize()
        for option, value in (
            ("MeshSizeMax", size),
            ("MeshSizeMin", _SMALLEST * size),
            ("MeshSizeFromPoints", 0),
            ("MeshSizeFromCurvature", _AROUND),
        ):
            gmsh.option.setNumber(f"Mesh.{option}", value)
        return generate(gmsh, mirrored=square, stresses=True, regular=True, adapt=adapt)


def _is_square(scene: Scene) -> bool:
    return not rod_of(scene)[0].split_angle_deg


def _cut(occ: Any, body: DimTags, reach: float, *, square: bool) -> None:
    """Leave the quarter of a rod, or its half in two parts that meet in x = 0: bores of both have no seam."""
    if square:
        whole = volume_mm3(occ, body)
        check_parts(4 * volume_mm3(occ, positive_x(occ, body, reach, quarter=True)), whole)
        return
    size = 20 * reach
    left = [(3, occ.addBox(-size, -size, 0, size, 2 * size, size))]
    others, _ = occ.intersect(body, left, removeObject=False)
    occ.fragment(positive_x(occ, body, reach, quarter=True), others)
