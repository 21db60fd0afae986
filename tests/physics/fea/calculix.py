"""A half or whole throw as a CalculiX deck: mesh of the evaluation, rigid sections by its rigid bodies."""

from __future__ import annotations

import subprocess
from collections.abc import Iterable, Sequence
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.frames import Span
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.rigid_motions import plane_nodes

Array = NDArray[np.float64]
Entry = tuple[int, int, float]
"""Node (from 0; REFERENCE and ROTATION follow the mesh's), axis 0 to 2, value."""


def handles(mesh: TetMesh, end: int = 0) -> tuple[int, int]:
    """The nodes that move (translations) and turn (rotations) a rigid section: 0 the near, 1 the far one."""
    count = mesh.points_mm.shape[1] + 2 * end
    return count, count + 1


def displacements(
    folder: Path,
    mesh: TetMesh,
    scene: Scene,
    span: Span,
    *,
    fixed: Sequence[Entry],
    forces: Sequence[Entry] = (),
    spring_N_per_mm: float = 0.0,
) -> Array:
    """Displacements of all nodes and the handles by `ccx`, mm and rad, shape (nodes + 2 or 4, 3).

    Args:
        folder: where the deck is run.
        mesh: half throw, or whole one.
        scene: material and pitch.
        span: held motions of the mid-pin plane; a whole throw has a second rigid section instead.
        fixed: prescribed motions.
        forces: nodal forces, N, and torques on the rotation handle, N mm.
        spring_N_per_mm: radial spring at the reference node, if any.
    """
    ends = (0.0, scene.pitch_mm) if span == "whole" else (0.0,)
    held: list[Entry] = []
    if span != "whole":
        middle = plane_nodes(mesh.points_mm, 2, scene.pitch_mm / 2)
        axes = (2,) if span == "symmetric" else (0, 1)
        held = [(int(node), axis, 0.0) for node in middle for axis in axes]
    lines = [*_body(mesh, scene, ends), *(_springs(mesh, spring_N_per_mm) if spring_N_per_mm else [])]
    lines += ["*BOUNDARY", *(f"{n + 1}, {a + 1}, {a + 1}, {v:.10e}" for n, a, v in [*held, *fixed])]
    lines += ["*STEP", "*STATIC"]
    if forces:
        lines += ["*CLOAD", *(f"{n + 1}, {a + 1}, {v:.10e}" for n, a, v in forces)]
    lines += ["*NODE PRINT, NSET=ALL", "U", "*END STEP"]
    return read(_solved(folder, lines), mesh.points_mm.shape[1] + 2 * len(ends))


def of_free_body(
    folder: Path, mesh: TetMesh, scene: Scene, fixed: Sequence[tuple[int, int]], loads: Sequence[str]
) -> Array:
    """Displacements of all nodes of a body without rigid sections, mm, shape (nodes, 3).

    Args:
        fixed: nodes (from 0) and the axis along which each stays.
        loads: lines of the deck.
    """
    return read(_solved(folder, free_body(mesh, scene, fixed, loads)), mesh.points_mm.shape[1])


def free_body(
    mesh: TetMesh,
    scene: Scene,
    fixed: Sequence[tuple[int, int]],
    loads: Sequence[str],
    static: str = "*STATIC",
) -> list[str]:
    """Lines of the deck of a body without rigid sections, arguments as in `of_free_body`.

    Args:
        static: the line that names the step, and with it the solver.
    """
    lines = [*_body(mesh, scene, ()), "*BOUNDARY", *(f"{n + 1}, {a + 1}, {a + 1}" for n, a in fixed)]
    return [*lines, "*STEP", static, *loads, "*NODE PRINT, NSET=ALL", "U", "*END STEP"]


def free_frequencies_Hz(folder: Path, mesh: TetMesh, scene: Scene, count: int) -> Array:
    """First frequencies of a free body above its six rigid motions, by `ccx`."""
    density = f"*DENSITY\n{scene.material.density_kg_m3 * 1e-12:.10e}\n*SOLID SECTION"
    lines = "\n".join(_body(mesh, scene, ())).replace("*SOLID SECTION", density).splitlines()
    lines += ["*STEP", f"*FREQUENCY\n{count + 6}", "*END STEP"]
    rows = [line.split() for line in _solved(folder, lines).read_text().splitlines()]
    found = {int(row[0]): float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()}
    return np.array([found[number] for number in range(7, count + 7)])


def _solved(folder: Path, lines: list[str]) -> Path:
    (folder / "throw.inp").write_text("\n".join(lines) + "\n")
    done = subprocess.run(["ccx", "throw"], cwd=folder, capture_output=True, text=True, check=False)
    assert "Job finished" in done.stdout, done.stdout[-2000:]
    return folder / "throw.dat"


def _body(mesh: TetMesh, scene: Scene, ends: Sequence[float]) -> list[str]:
    points = [*mesh.points_mm.T, *(np.array([0.0, 0.0, z]) for z in ends for _ in "mt")]
    return [
        "*NODE, NSET=ALL",
        *(f"{i}, {x:.12e}, {y:.12e}, {z:.12e}" for i, (x, y, z) in enumerate(points, 1)),
        "*ELEMENT, TYPE=C3D10, ELSET=BODY",
        *(", ".join(map(str, [i, *(cell + 1)])) for i, cell in enumerate(mesh.cells.T, 1)),
        "*MATERIAL, NAME=STEEL",
        "*ELASTIC",
        f"{scene.material.E_GPa * 1e3}, {scene.material.poisson}",
        "*SOLID SECTION, ELSET=BODY, MATERIAL=STEEL",
        *(line for end, z in enumerate(ends) for line in _section(mesh, end, z)),
    ]


def _section(mesh: TetMesh, end: int, z_mm: float) -> list[str]:
    reference, rotation = handles(mesh, end)
    return [
        f"*NSET, NSET=SECTION{end}",
        *(str(node + 1) for node in plane_nodes(mesh.points_mm, 2, z_mm)),
        f"*RIGID BODY, NSET=SECTION{end}, REF NODE={reference + 1}, ROT NODE={rotation + 1}",
    ]


def _springs(mesh: TetMesh, stiffness: float) -> Iterable[str]:
    reference, count = handles(mesh)[0] + 1, mesh.cells.shape[1]
    for axis in (1, 2):
        yield f"*ELEMENT, TYPE=SPRING1, ELSET=SPRING{axis}"
        yield f"{count + axis}, {reference}"
        yield f"*SPRING, ELSET=SPRING{axis}"
        yield f"{axis}"
        yield f"{stiffness}"


def read(path: Path, nodes: int) -> Array:
    """Printed displacements of all nodes, (nodes, 3)."""
    rows = [line.split() for line in path.read_text().splitlines()]
    values = {int(row[0]): [float(v) for v in row[1:]] for row in rows if len(row) == 4 and row[0].isdigit()}
    assert len(values) == nodes
    return np.array([values[i] for i in range(1, nodes + 1)])
