"""A stepped shaft in tension by CalculiX: six-node triangles of its meridian (CAX6), its own stresses."""

from __future__ import annotations

import subprocess
from pathlib import Path

import numpy as np

from cranktopo.numerics.gmsh_session import cad_session
from tests.physics.fatigue.stepped_shaft import POISSON, YOUNGS_MPA, Array, Shaft, graded, meridian


def tension_factor(shaft: Shaft, folder: Path, size_mm: float = 4.0, fillet_fraction: float = 0.06) -> float:
    """Largest principal stress on the fillet over that of the thinner part, by `ccx`.

    Args:
        folder: where the deck is run.
    """
    points, cells = _mesh(shaft, size_mm, fillet_fraction)
    ends = [np.flatnonzero(np.abs(points[:, 1] - z) < 1e-6) + 1 for z in (-shaft.length, shaft.length)]
    lines = [
        "*NODE, NSET=ALL",
        *(f"{i}, {x:.12e}, {z:.12e}, 0." for i, (x, z) in enumerate(points, 1)),
        "*ELEMENT, TYPE=CAX6, ELSET=BODY",
        *(", ".join(map(str, [i, *(cell + 1)])) for i, cell in enumerate(cells, 1)),
        "*MATERIAL, NAME=STEEL",
        "*ELASTIC",
        f"{YOUNGS_MPA}, {POISSON}",
        "*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL",
        "*BOUNDARY",
        *(f"{node}, 2, 2, {moved}" for end, moved in zip(ends, (0.0, 0.1), strict=True) for node in end),
        *("*STEP", "*STATIC", "*EL FILE, OUTPUT=2D", "S", "*END STEP"),
    ]
    (folder / "shaft.inp").write_text("\n".join(lines) + "\n")
    done = subprocess.run(["ccx", "shaft"], cwd=folder, capture_output=True, text=True, check=False)
    assert "Job finished" in done.stdout, done.stdout[-2000:]
    stress = _nodal(folder / "shaft.frd")
    assert len(stress) == len(points)
    principal = np.linalg.eigvalsh(stress)[:, -1]
    fillet = shaft.section
    across, height = points[:, 0] - shaft.small / 2 - fillet.radial_mm, fillet.axial_mm - points[:, 1]
    on = (np.abs(fillet.off_mm(across, height)) < 1e-4) & (across <= 0) & (height >= 0)
    far = (np.abs(points[:, 1] - 0.6 * shaft.length) < size_mm) & (points[:, 0] < size_mm)
    return float(principal[on].max() / principal[far].mean())


def _mesh(shaft: Shaft, size_mm: float, fillet_fraction: float) -> tuple[Array, Array]:
    """Nodes (n, 2) in radius and height, and six nodes of each triangle."""
    with cad_session("meridian") as gmsh:
        meridian(gmsh, shaft)
        gmsh.model.occ.synchronize()
        graded(gmsh, shaft, size_mm, fillet_fraction, 0.15)
        gmsh.model.mesh.generate(2)
        gmsh.model.mesh.setOrder(2)
        tags, coordinates, _ = gmsh.model.mesh.getNodes()
        _, numbers = gmsh.model.mesh.getElementsByType(9)
    place = {int(tag): i for i, tag in enumerate(tags)}
    cells = np.array([place[int(tag)] for tag in numbers]).reshape(-1, 6)
    used, compact = np.unique(cells, return_inverse=True)
    points = coordinates.reshape(-1, 3)[used][:, [0, 2]]
    cells = compact.reshape(cells.shape)
    a, b, c = (points[cells[:, k]] for k in range(3))
    turned = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) < (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    cells[turned] = cells[turned][:, [0, 2, 1, 5, 4, 3]]
    return points, cells


def _nodal(path: Path) -> Array:
    """Stress tensors of the nodes, (n, 3, 3), in the order of their numbers."""
    lines = path.read_text().splitlines()
    first = next(i for i, line in enumerate(lines) if line.startswith(" -4  STRESS"))
    last = next(i for i, line in enumerate(lines) if i > first and line.startswith(" -3"))
    rows = [line for line in lines[first:last] if line.startswith(" -1")]
    values = np.array([[float(row[13 + 12 * k : 25 + 12 * k]) for k in range(6)] for row in rows])
    xx, yy, zz, xy, yz, zx = values.T
    return np.array([[xx, xy, zx], [xy, yy, yz], [zx, yz, zz]]).transpose(2, 0, 1)
