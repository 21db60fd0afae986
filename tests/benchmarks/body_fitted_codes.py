"""Two load cases of the evaluation as systems that any code can take, and the codes that solve them.

Both are cases on a quarter of the throw, the half x >= 0 of its half: a unit rotation of the end section,
which is rigid and otherwise held (the torsion that `evaluate` calls "held"), and a force on the pin with that
section held. Every code gets the same nodes, elements, held unknowns and loads, and says when its matrix was
ready.
"""

from __future__ import annotations

import os
import re
import subprocess
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass, fields
from functools import cache, partial
from importlib import import_module
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.side_by_side import side_by_side
from cranktopo.base.units import MPA_PER_GPA
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble, mean_displacement
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.rigid_motions import RZ, held_by_mirror, plane_nodes, section_motions
from cranktopo.tasks.throw_fea.condense import loaded_mm
from tests.physics.fea import calculix

Array = NDArray[np.float64]
RESIDUAL = 1e-8
"""Asked of every iterative solver, relative; cranktopo aims at a hundredth of what it accepts, at this."""
_PIN_AXIS = 1
_QUARTERS = 4


@dataclass(frozen=True)
class QuarterCases:
    """Mesh and both load cases: twist, then bending.

    Attributes:
        points_mm, cells: shapes (3, nodes), corners first, and (10, elements), VTK order.
        elastic: Young's modulus in MPa and Poisson's ratio.
        held: whether each unknown 3 node + axis is prescribed, (2, unknowns).
        prescribed: displacements of these, mm, zero elsewhere.
        forces: on all unknowns, N.
    """

    points_mm: Array
    cells: NDArray[np.int64]
    elastic: Array
    held: NDArray[np.bool_]
    prescribed: Array
    forces: Array

    @property
    def mesh(self) -> TetMesh:
        """The mesh, which is the half x >= 0."""
        return TetMesh(self.points_mm, self.cells, True)

    def assembled(self) -> Elasticity:
        """The elastic body in cranktopo."""
        return assemble(self.mesh, *self.elastic)

    def save(self, file: Path) -> None:
        """Write all arrays to a file."""
        np.savez(file, **{one.name: getattr(self, one.name) for one in fields(self)})


def load_cases(file: Path) -> QuarterCases:
    """Read what `save` wrote."""
    with np.load(file) as arrays:
        return QuarterCases(**arrays)


def quarter_cases(mesh: TetMesh, scene: Scene) -> QuarterCases:
    """Both cases on the mesh of a quarter, in the numbering of nodes that cranktopo gives it."""
    if not mesh.mirrored:
        raise ValueError("the throw is not symmetric: its mesh is no quarter")
    elastic = scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson
    model = assemble(mesh, *elastic)
    nodes, middle = model.nodes_mm, scene.pitch_mm / 2
    section = plane_nodes(nodes, 2, 0.0)
    held = np.zeros((2, nodes.size), dtype=bool)
    for case, even in enumerate((False, True)):
        held[case, (3 * section[:, None] + np.arange(3)).ravel()] = True
        held[case, held_by_mirror(nodes, 2, middle, even=even)] = True
        held[case, held_by_mirror(nodes, 0, 0.0, even=even)] = True
    moved, forces = np.zeros(held.shape), np.zeros(held.shape)
    moved[0] = section_motions(nodes, section)[:, RZ]
    forces[1] = -mean_displacement(model, _PIN_AXIS, *loaded_mm(scene, False))
    cells = np.asarray(model.mesh.dofs.element_dofs, dtype=np.int64)
    return QuarterCases(nodes, cells, np.array(elastic), held, moved, forces)


@dataclass(frozen=True)
class CodeRun:
    """Displacements of both cases, (2, unknowns), mm, and what they took.

    Attributes:
        peak_MiB: of another program; 0 where it is that of this process.
        printed: they were read from six printed digits, which are too few for a residual.
    """

    displacements_mm: Array
    assembly_s: float
    solve_s: float
    peak_MiB: float = 0.0
    printed: bool = False


def with_cranktopo(cases: QuarterCases, _folder: Path) -> CodeRun:
    """Two-level conjugate gradients, both cases side by side, as `evaluate` does."""
    from cranktopo.numerics.tetrahedra.block_code import assembly, product

    import_module("cvxopt.cholmod")  # loaded and compiled before it counts, as scikit-fem is
    for make in (assembly, partial(product, 1), partial(product, 1, "float")):
        make()
    began = time.perf_counter()
    model = cases.assembled()
    ready = time.perf_counter()

    def solved(case: int) -> Array:
        moved = cases.prescribed[case]
        solve = model.equations.solver(np.flatnonzero(cases.held[case]))
        loads = cases.forces[case] - model.stiffness @ moved
        return moved + solve(loads[:, None])[:, 0]

    found = np.stack(side_by_side(lambda: solved(0), lambda: solved(1)))
    return CodeRun(found, ready - began, time.perf_counter() - ready)


def with_scikit_fem(cases: QuarterCases, _folder: Path, solver: str) -> CodeRun:
    """scikit-fem's elements and solvers, one case after the other."""
    from skfem import Basis, ElementTetP2, ElementVector, MeshTet2, condense, solve
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    began = time.perf_counter()
    basis = Basis(MeshTet2(cases.points_mm, cases.cells), ElementVector(ElementTetP2()), intorder=2)
    matrix = linear_elasticity(*lame_parameters(*cases.elastic)).assemble(basis)
    ready = time.perf_counter()
    _check_numbering(basis.doflocs, cases.points_mm)
    found = []
    for held, moved, forces in zip(cases.held, cases.prescribed, cases.forces, strict=True):
        system = condense(matrix, forces, x=moved.copy(), D=np.flatnonzero(held))
        found.append(solve(*system, solver=_scikit_fem_solver(solver, system[0])))
    return CodeRun(np.stack(found), ready - began, time.perf_counter() - ready)


def _check_numbering(unknowns_mm: Array, points_mm: Array) -> None:
    if not np.allclose(unknowns_mm, np.repeat(points_mm, 3, axis=1)):
        raise RuntimeError("scikit-fem numbers the unknowns otherwise")


def _scikit_fem_solver(name: str, matrix: Any) -> Any:
    from skfem.utils import build_pc_diag, build_pc_ilu, solver_direct_scipy, solver_iter_pcg

    if name == "direct":
        return solver_direct_scipy()
    conditioner = build_pc_ilu if name == "ilu" else build_pc_diag
    return solver_iter_pcg(M=conditioner(matrix), rtol=RESIDUAL)


def with_calculix(cases: QuarterCases, folder: Path, scene: Scene, solver: str) -> CodeRun:
    """One run of `ccx` for each case, its reading of the deck and its printing counted."""
    runs, found = list[CalculixRun](), list[Array]()
    for held, moved, forces in zip(cases.held, cases.prescribed, cases.forces, strict=True):
        fixed = [divmod(int(unknown), 3) for unknown in np.flatnonzero(held)]
        loads = [
            *_lines("*BOUNDARY", moved, "{0}, {1}, {1}, {2}"),
            *_lines("*CLOAD", forces, "{0}, {1}, {2}"),
        ]
        deck = calculix.free_body(cases.mesh, scene, fixed, loads, f"*STATIC, SOLVER={solver}")
        (folder / "throw.inp").write_text("\n".join(deck) + "\n")
        runs.append(run_calculix(["stdbuf", "-oL", "ccx", "throw"], folder))
        found.append(calculix.read(folder / "throw.dat", cases.points_mm.shape[1]).ravel())
    ready, ended = (sum(times) for times in zip(*((one.ready_s, one.end_s) for one in runs), strict=True))
    return CodeRun(np.stack(found), ready, ended - ready, max(one.peak_MiB for one in runs), printed=True)


def _lines(head: str, values: Array, form: str) -> list[str]:
    where = np.flatnonzero(values)
    own = [form.format(u // 3 + 1, u % 3 + 1, f"{values[u]:.12e}") for u in where]
    return [head, *own] if own else []


@dataclass(frozen=True)
class CalculixRun:
    """Seconds from the start until its solver begins and until its end, and peak memory."""

    ready_s: float
    end_s: float
    peak_MiB: float


_SOLVES = re.compile(r"(?i)factoring|iterative .*solver|conjugate gradient")
_LOOKS_S = 0.01


def run_calculix(words: Sequence[str], folder: Path) -> CalculixRun:
    """Run it with as many threads as there are cores; its matrix is ready when it tells of its solver.

    The peak is that of its own memory: what the system counts for a process begins with that of its parent.

    Raises:
        RuntimeError: it did not finish, with the last that it said.
    """
    here = os.environ | {"OMP_NUM_THREADS": str(os.cpu_count())}
    log, ready, peak_MiB = folder / "log.txt", None, 0.0
    began = time.perf_counter()
    with log.open("w") as out, subprocess.Popen(words, cwd=folder, env=here, stdout=out) as child:
        while child.poll() is None:
            peak_MiB = max(peak_MiB, _peak_MiB(child.pid))
            if ready is None and _SOLVES.search(log.read_text(errors="replace")):
                ready = time.perf_counter()
            time.sleep(_LOOKS_S)
    end, said = time.perf_counter() - began, log.read_text(errors="replace")
    if child.returncode or "Job finished" not in said:
        raise RuntimeError(f"ccx: exit {child.returncode}: {' '.join(said.split())[-100:]}")
    return CalculixRun(end if ready is None else ready - began, end, peak_MiB)


def _peak_MiB(process: int) -> float:
    try:
        found = re.search(r"VmHWM:\s*(\d+)", Path(f"/proc/{process}/status").read_text(encoding="utf-8"))
    except OSError:  # it has ended
        return 0.0
    return int(found[1]) / 1024 if found else 0.0


def free_residual(model: Elasticity, cases: QuarterCases, case: int, displacements_mm: Array) -> float:
    """Forces that are left on the unknowns that are not held, over the loads on them."""
    free, forces = ~cases.held[case], cases.forces[case]
    left = (forces - model.stiffness @ displacements_mm)[free]
    load = (forces - model.stiffness @ cases.prescribed[case])[free]
    return float(np.linalg.norm(left) / np.linalg.norm(load))


def stiffnesses(model: Elasticity, cases: QuarterCases, displacements_mm: Array) -> tuple[float, float]:
    """Torsional stiffness in kN m/rad and that of the pin with held sections in kN/mm, of the full throw."""
    twist, bend = displacements_mm
    torsion_Nmm = float(twist @ (model.stiffness @ twist))
    return torsion_Nmm / 1e6, _QUARTERS / float(cases.forces[1] @ bend) / 1e3


@cache
def codes() -> dict[str, Callable[..., CodeRun]]:
    """Codes with their solvers, by the name in the table; the first is what the others are compared with."""
    own: dict[str, Callable[..., CodeRun]] = {"cranktopo, two-level CG": with_cranktopo}
    of_scikit_fem = {"SuperLU": "direct", "CG, diagonal": "diagonal", "CG, incomplete LU": "ilu"}
    for words, name in of_scikit_fem.items():
        own[f"scikit-fem, {words}"] = partial(with_scikit_fem, solver=name)
    of_calculix = {
        "SPOOLES": "SPOOLES",
        "CG, diagonal": "ITERATIVE SCALING",
        "CG, incomplete Cholesky": "ITERATIVE CHOLESKY",
    }
    for words, name in of_calculix.items():
        own[f"CalculiX, {words}"] = partial(with_calculix, solver=name)
    return own


def needs_scene(name: str) -> bool:
    """Tell whether a code needs the scene of the design: decks of CalculiX take the material from it."""
    return name.startswith("CalculiX")


def chosen(names: Sequence[str]) -> list[str]:
    """Codes whose name holds one of some words, in the order of the table; the own one always."""
    own, *others = codes()
    return [own, *(name for name in others if not names or any(word in name for word in names))]
