"""A stepped shaft under tension, bending and torsion: elements against published concentration factors."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.tetrahedra.cad_mesh import extract_mesh
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.rigid_motions import section_motions
from cranktopo.numerics.tetrahedra.stress import (
    nodal_stress,
    outer_surface,
    principal_stresses,
    surface_stress,
)
from cranktopo.throw.journal import FilletSection

Array = NDArray[np.float64]
YOUNGS_MPA, POISSON = 2.1e5, 0.3
AXIAL, BENDING, TORSION = 2, 4, 5
"""Section motion that makes each load; bending about y."""
EVEN, ODD = (0, 2, 4), (1, 3, 5)
"""Motions even and odd in y."""


@dataclass(frozen=True)
class Shaft:
    """Diameters and fillet, mm; each part is as long as 1.2 larger diameters.

    The fillet has its axial semi-axis besides where it is an ellipse.
    """

    large: float
    small: float
    fillet: float
    axial: float | None = None

    @property
    def section(self) -> FilletSection:
        """Section of the fillet."""
        return FilletSection(self.fillet, self.axial or self.fillet)

    @property
    def length(self) -> float:
        """Length of each part."""
        return 1.2 * self.large

    def nominal_MPa(self, load: int) -> float:
        """Nominal stress of the thinner part per unit force or moment."""
        d = self.small
        return {AXIAL: 4 / d**2, BENDING: 32 / d**3, TORSION: 16 / d**3}[load] / math.pi


def shaft_mesh(shaft: Shaft, size_mm: float, fillet_fraction: float, growth: float = 0.5) -> TetMesh:
    """The shaft along z, step at z = 0, thinner part above; graded to its fillet."""
    with cad_session("stepped shaft") as gmsh:
        occ, section = gmsh.model.occ, meridian(gmsh, shaft)
        occ.revolve([(2, section)], 0, 0, 0, 0, 0, 1, math.pi)
        occ.remove([(2, section)], recursive=True)
        occ.synchronize()
        graded(gmsh, shaft, size_mm, fillet_fraction, growth)
        gmsh.option.setNumber("Mesh.Algorithm3D", 1)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.optimize("Netgen")
        gmsh.model.mesh.setOrder(2)
        return extract_mesh(gmsh, mirrored=True)


def meridian(gmsh: Any, shaft: Shaft) -> int:
    """The right half of the section through the axis, in x and z."""
    a, b, fillet, occ = shaft.large / 2, shaft.small / 2, shaft.section, gmsh.model.occ
    foot, top = (b + fillet.radial_mm, 0.0), (b, fillet.axial_mm)
    points = [(0, -shaft.length), (a, -shaft.length), (a, 0), foot, top, (b, shaft.length)]
    tags = [occ.addPoint(x, 0, z) for x, z in [*points, (0, shaft.length)]]
    centre = occ.addPoint(foot[0], 0, top[1])
    curves = [occ.addLine(tags[i], tags[i + 1]) for i in range(3)]
    longer = tags[3] if fillet.axial_mm > fillet.radial_mm else tags[4]
    curves += [occ.addEllipseArc(tags[3], centre, longer, tags[4])]
    curves += [occ.addLine(tags[i], tags[(i + 1) % 7]) for i in (4, 5, 6)]
    return int(occ.addPlaneSurface([occ.addCurveLoop(curves)]))


def graded(gmsh: Any, shaft: Shaft, size_mm: float, fillet_fraction: float, growth: float) -> None:
    """Sizes that grow from the fillet, there a fraction of its least radius."""
    fillet = shaft.section
    across = f"Sqrt(x*x+y*y)-{shaft.small / 2 + fillet.radial_mm!r}"
    height = f"{fillet.flattening!r}*(z-{fillet.axial_mm!r})"
    ring = f"Fabs(Sqrt(({across})^2+({height})^2)-{fillet.radial_mm!r})"
    field, finest = gmsh.model.mesh.field.add("MathEval"), fillet_fraction * fillet.least_radius_mm
    gmsh.model.mesh.field.setString(field, "F", f"Min({size_mm!r}, {finest!r}+{growth!r}*{ring})")
    gmsh.model.mesh.field.setAsBackgroundMesh(field)
    for option in ("MeshSizeFromPoints", "MeshSizeExtendFromBoundary", "MeshSizeFromCurvature"):
        gmsh.option.setNumber(f"Mesh.{option}", 0)


def shaft_fields(shaft: Shaft, model: Elasticity, loads: tuple[int, ...]) -> Array:
    """Displacements per unit load (N, N mm), shape (loads, unknowns); the mirror plane is y = 0.

    The thick end is held, the thin one is a rigid section whose other motions are free.
    """
    nodes = model.nodes_mm
    low, high = (np.nonzero(np.abs(nodes[2] - z) < 1e-6)[0] for z in (-shaft.length, shaft.length))
    mirror = np.nonzero(np.abs(nodes[1]) < 1e-6)[0]
    motions = section_motions(nodes, high)
    fields = []
    for load in loads:
        kept, plane = (ODD, [0, 2]) if load == TORSION else (EVEN, [1])
        held = [(3 * end[:, None] + np.arange(3)).ravel() for end in (low, high)]
        held += [3 * mirror + axis for axis in plane]
        units = motions[:, kept].copy()
        units += model.equations.solver(np.concatenate(held))(-(model.stiffness @ units))
        stiffness = 2 * units.T @ (model.stiffness @ units)
        unit = np.array([1.0 if motion == load else 0.0 for motion in kept])
        fields.append(units @ np.linalg.solve(stiffness, unit))
    return np.stack(fields)


def concentration(
    shaft: Shaft, size_mm: float, fillet_fraction: float, loads: tuple[int, ...]
) -> tuple[dict[int, float], dict[int, float], int]:
    """Concentration factors by load from the mean around the shaft and from the worst node, and nodes.

    Stresses of a round shaft are constant around it in tension and torsion and follow the cosine in bending:
    the mean is taken over a quadratic in the fillet's angle, fitted to the nodes near the peak.
    """
    mesh = shaft_mesh(shaft, size_mm, fillet_fraction)
    model = assemble(mesh, YOUNGS_MPA, POISSON)
    found = nodal_stress(model, shaft_fields(shaft, model, loads), YOUNGS_MPA, POISSON)
    surface = outer_surface(model, found.elements, ((2, -shaft.length), (2, shaft.length), (1, 0.0)))
    stress = surface_stress(model, surface, found).stress_MPa
    x, y, z = surface.points_mm
    rho = np.hypot(x, y)
    fillet = shaft.section
    across, height = rho - shaft.small / 2 - fillet.radial_mm, fillet.axial_mm - z
    along = np.degrees(np.arctan2(fillet.flattening * height, -across))
    off = fillet.off_mm(across, height)
    on = (np.abs(off) < 1e-3) & (along > 2) & (along < 60)
    means, peaks = {}, {}
    for load, field in zip(loads, stress, strict=True):
        principal = principal_stresses(field)
        value = (principal[:, 0] - principal[:, 2]) / 2 if load == TORSION else principal[:, 0]
        value = value / shaft.nominal_MPa(load)
        peaks[load] = float(value[on].max())
        cosine = -x / rho if load == BENDING else np.ones_like(x)
        used = on & (cosine > 0.7)
        means[load] = _peak_of_curve(along[used], (value / cosine)[used])
    return means, peaks, mesh.points_mm.shape[1]


def _peak_of_curve(angle: Array, value: Array) -> float:
    """Peak of a sixth-degree polynomial through the values over the fillet's angle."""
    curve = np.polynomial.Polynomial.fit(angle, value, 6)
    return float(curve(np.linspace(angle.min(), angle.max(), 500)).max())


def tipton(load: int, shaft: Shaft) -> float:
    """Concentration factor of a shoulder fillet in closed form, from finite elements of its authors.

    Source: S. M. Tipton, J. R. Sorem, R. D. Rolovic, Updated stress concentration factors for filleted shafts
    in bending and tension, J. Mech. Des. 118 (1996), fits that Peterson's Stress Concentration Factors quotes
    since its third edition; torsion by the same authors. Each fit tends to 1 as the step vanishes.
    """
    x, r = shaft.large / shaft.small, shaft.fillet / shaft.small
    if load == BENDING:
        root = (-0.14 - 0.363 * x**2 + 0.503 * x**4) / (1 - 2.39 * x**2 + 3.368 * x**4)
        return 0.632 + 0.377 * x**-4.4 + r**-0.5 * math.sqrt(root)
    if load == AXIAL:
        root = (3.43 - 3.41 * x**2 - 0.0232 * x**4) / (1 - 8.85 * x**2 - 0.078 * x**4)
        return 0.493 + 0.48 * x**-2.43 + r**-0.48 * math.sqrt(root)
    root = (0.002 - 0.125 * x**2 + 0.123 * x**4) / (1 - 2.75 * x**2 + 2.55 * x**4)
    return 0.78 + 0.2 * x**-10 + r**-0.46 * math.sqrt(root)


def peterson(load: int, shaft: Shaft) -> float:
    """The same in bending and torsion from the older, photoelastic curves.

    Source: W. D. Pilkey, Peterson's Stress Concentration Factors, second edition, charts 3.10 and 3.12. Its
    chart of tension is left out: flat bars stood for round ones, and it lies 10 % below the fits of 1996.
    """
    step = (shaft.large - shaft.small) / 2
    ratio, depth = step / shaft.fillet, 2 * step / shaft.large
    basis = np.array([1.0, math.sqrt(ratio), ratio])
    bending = _BENDING_SHALLOW if ratio <= 2.0 else _BENDING_DEEP
    rows = _TORSION if load == TORSION else bending
    return float((np.array(rows) @ basis) @ depth ** np.arange(4))


_BENDING_SHALLOW = (
    (0.947, 1.206, -0.131),
    (0.022, -3.405, 0.915),
    (0.869, 1.777, -0.555),
    (-0.810, 0.422, -0.260),
)
_BENDING_DEEP = (
    (1.232, 0.832, -0.008),
    (-3.813, 0.968, -0.260),
    (7.423, -4.868, 0.869),
    (-3.839, 3.070, -0.600),
)
_TORSION = (
    (0.905, 0.783, -0.075),
    (-0.437, -1.969, 0.553),
    (1.557, 1.073, -0.578),
    (-1.061, 0.171, 0.086),
)
"""Coefficients of 1, sqrt(t/r), t/r in each power of 2 t / D."""
