"""Quadratic tetrahedra on a quarter of the rod: x >= 0 in the plane of motion, z >= 0 along the pins."""

from __future__ import annotations

from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.memory import check_mesh_memory
from cranktopo.bodies.mesh.solid_mesh import NoMeshError, generate, positive_x
from cranktopo.bodies.solid.rod import add_rod
from cranktopo.design.checks.rod import check_square_split, rod_of
from cranktopo.design.rod_body import rod_mass
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
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
    """Return the mesh of a quarter of a design's rod with its cap, in the frame of its solid.

    Raises:
        CranktopoError: no rod, an oblique split, impossible geometry, elements too fine for the memory, or no
            valid mesh.
    """
    check_square_split(scene)
    check_mesh_memory(rod_volume_mm3(scene) / 4, element_size_mm)
    try:
        return _made(scene, element_size_mm, adapt=False)
    except NoMeshError:
        return _made(scene, element_size_mm, adapt=True)


def _made(scene: Scene, size: float, *, adapt: bool) -> TetMesh:
    with cad_session(f"rod of {scene.name}") as gmsh:
        occ = gmsh.model.occ
        positive_x(occ, add_rod(occ, scene), rod_of(scene)[1], quarter=True)
        occ.synchronize()
        for option, value in (
            ("MeshSizeMax", size),
            ("MeshSizeMin", _SMALLEST * size),
            ("MeshSizeFromPoints", 0),
            ("MeshSizeFromCurvature", _AROUND),
        ):
            gmsh.option.setNumber(f"Mesh.{option}", value)
        return generate(gmsh, size, mirrored=True, stresses=True, regular=True, adapt=adapt)
