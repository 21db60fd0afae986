"""A round bar with a cross hole under tension, bending and torsion: stresses at and in the hole's outlet."""

from __future__ import annotations

import math

import numpy as np

from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.tetrahedra.cad_mesh import extract_mesh
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.stress import (
    nodal_stress,
    outer_surface,
    principal_stresses,
    surface_stress,
)
from tests.physics.fatigue.stepped_shaft import (
    AXIAL,
    BENDING,
    POISSON,
    TORSION,
    YOUNGS_MPA,
    Shaft,
    shaft_fields,
)

LOADS = (AXIAL, BENDING, TORSION)
DIAMETER_MM = 20.0
BAR = Shaft(DIAMETER_MM, DIAMETER_MM, 1.0)
"""A shaft without a step; its fillet is not built."""


def bar_mesh(hole_mm: float, elements: int) -> TetMesh:
    """Half the bar, y >= 0, with a hole along x; `elements` to its diameter at the outlets."""
    radius, length = DIAMETER_MM / 2, BAR.length
    with cad_session("bar with a cross hole") as gmsh:
        occ, mesh = gmsh.model.occ, gmsh.model.mesh
        bar = occ.addCylinder(0, 0, -length, 0, 0, 2 * length, radius)
        hole = occ.addCylinder(-2 * radius, 0, 0, 4 * radius, 0, 0, hole_mm / 2)
        body, _ = occ.cut([(3, bar)], [(3, hole)])
        half = occ.addBox(-2 * radius, 0, -2 * length, 4 * radius, 2 * radius, 4 * length)
        occ.intersect(body, [(3, half)])
        occ.synchronize()
        outlet = f"Max(0,Sqrt((Fabs(x)-{radius})^2+y*y+z*z)-{0.75 * hole_mm})"
        along = f"Max(0,Sqrt(y*y+z*z)-{hole_mm / 2})"
        sizes = f"{hole_mm / elements}+0.4*{outlet}", f"{hole_mm / 5}+0.5*{along}"
        field = mesh.field.add("MathEval")
        mesh.field.setString(field, "F", f"Min({DIAMETER_MM / 6},Min({sizes[0]},{sizes[1]}))")
        mesh.field.setAsBackgroundMesh(field)
        for option in ("MeshSizeFromPoints", "MeshSizeExtendFromBoundary", "MeshSizeFromCurvature"):
            gmsh.option.setNumber(f"Mesh.{option}", 0)
        gmsh.option.setNumber("Mesh.Algorithm3D", 1)
        mesh.generate(3)
        mesh.optimize("Netgen")
        mesh.setOrder(2)
        return extract_mesh(gmsh, mirrored=True)


def outlet_peaks(hole_mm: float, elements: int = 8) -> dict[int, tuple[float, float]]:
    """Largest principal stress over the nominal one, by load: on the edge of the outlet, and near it."""
    model = assemble(bar_mesh(hole_mm, elements), YOUNGS_MPA, POISSON)
    found = nodal_stress(model, shaft_fields(BAR, model, LOADS), YOUNGS_MPA, POISSON)
    surface = outer_surface(model, found.elements, ((2, -BAR.length), (2, BAR.length), (1, 0.0)))
    x, y, z = surface.points_mm
    near = np.hypot(y, z) < 1.2 * hole_mm
    edge = near & (np.abs(np.hypot(x, y) - DIAMETER_MM / 2) < 0.02 * hole_mm)
    peaks = {}
    for load, stress in zip(LOADS, surface_stress(model, surface, found).stress_MPa, strict=True):
        size = np.abs(principal_stresses(stress)).max(axis=1) / BAR.nominal_MPa(load)
        peaks[load] = float(size[edge].max()), float(size[near].max())
    return peaks


def peterson_bending(ratio: float) -> float:
    """Peterson's curve of a bar with a cross hole in bending, as fitted by Norton, on the plain section.

    Args:
        ratio: diameter of the hole over that of the bar, 0 to 0.3.
    """
    return (1.58990 - 0.63550 * math.log10(ratio)) / (1 - 16 / (3 * math.pi) * ratio)


def peterson_torsion(ratio: float) -> float:
    """Peterson's curve in torsion, as fitted by Norton, on the plain section; `ratio` as in bending."""
    fit = np.polynomial.Polynomial([3.92150, -24.435, 234.06, -1200.5, 3059.5, -3042.4])
    return float(fit(ratio)) / (1 - 8 / (3 * math.pi) * ratio)
