"""The body-fitted system of an evaluation on the CPU and on a GPU.

    python -m tests.benchmarks.gpu_tetrahedra --write FOLDER [ENGINE]     # meshes, where gmsh is
    python -m tests.benchmarks.gpu_tetrahedra FOLDER [--cudss libcudss.so.0]

The half throw held at one end, three loads at once. Per mesh: seconds and relative residual of the CPU's own
solver; of the same conjugate gradients and cycle on a GPU (CuPy), whose linear level cuDSS solves; and of
cuDSS alone. Factorisation and copies count. Needs CuPy, and NVIDIA's cuDSS 0.7 as a shared library.
"""

from __future__ import annotations

import argparse
import ctypes
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import scipy.sparse as sp
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble, mean_displacement
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.numerics.tetrahedra.solver import Equations, largest_eigenvalue

SHARES = (1.5, 1.0, 0.5, 0.3)
"""Element sizes over the default one."""
STEEL = (210_000.0, 0.3)
# Of cudss.h 0.7 and library_types.h.
ANALYSIS, FACTORISATION, SOLVE = 3, 4, 1008
POSITIVE, FULL, ZERO_BASED, COLUMNS, FLOAT64, INT32 = 3, 0, 0, 0, 1, 10
RELATIVE_RESIDUAL = 1e-8
Solver = Callable[[Array], Array]


def main() -> None:
    """Write meshes, or measure and print the table as Markdown."""
    options = _options()
    if options.write:
        write_meshes(options.write, options.folder)
        return
    print("| unknowns | solver | first solve s | second solve s | residual |\n|---|---|---|---|---|")
    for file in sorted(Path(options.folder).glob("*.npz")):
        body = system(file)
        for name, build in methods(body, options.cudss).items():
            print(f"| {body.matrix.shape[0]:,} | {name} | {timed(build, body)} |", flush=True)


@dataclass(frozen=True)
class Body:
    """A body held at its lower end, and three loads.

    Attributes:
        free: unknowns that are not held; matrix, prolongation and loads are over these.
    """

    equations: Equations
    free: NDArray[np.intp]
    matrix: sp.csr_matrix
    prolongation: sp.csr_matrix
    loads: Array


def methods(body: Body, library: str | None) -> dict[str, Callable[[], Solver]]:
    """Return what builds each solver, by name; those of the GPU where its library is given."""
    found: dict[str, Callable[[], Solver]] = {"CPU, own": lambda: on_cpu(body)}
    if library:
        found["GPU, same cycle"] = lambda: on_gpu_by_cycle(library, body.matrix, body.prolongation)
        found["GPU, cuDSS"] = lambda: Factor(library, body.matrix).on_host
    return found


def on_cpu(body: Body) -> Solver:
    """Return the evaluation's own solver."""
    unknowns = body.equations.stiffness.shape[0]
    solver = body.equations.solver(np.setdiff1d(np.arange(unknowns), body.free), 100 * RELATIVE_RESIDUAL)

    def solve(loads: Array) -> Array:
        forces = np.zeros((unknowns, loads.shape[1]))
        forces[body.free] = loads
        return solver(forces)[body.free]

    return solve


def timed(build: Callable[[], Solver], body: Body) -> str:
    """Return seconds with and without what is made once, and the largest relative residual."""
    matrix, loads = body.matrix, body.loads
    began = time.perf_counter()
    try:
        solve = build()
        solution = solve(loads)
        first = time.perf_counter() - began
        began = time.perf_counter()
        solve(loads)
        again = time.perf_counter() - began
    except Exception as error:  # a row says why it is empty
        return f"{type(error).__name__}: {str(error)[:60]} | - | -"
    residual = np.linalg.norm(matrix @ solution - loads, axis=0) / np.linalg.norm(loads, axis=0)
    return f"{first:.3g} | {again:.3g} | {residual.max():.1e}"


def write_meshes(folder: str, engine: str) -> None:
    """Mesh the half throw of a design at all sizes, an .npz each."""
    from cranktopo.bodies.mesh.solid_mesh import mesh_throw
    from cranktopo.design.halves import default_element_size_mm
    from cranktopo.design.loading import load_scene
    from cranktopo.engine.plan.planning import planned_scene

    scene = planned_scene(load_scene(engine), ("fillets",))
    Path(folder).mkdir(parents=True, exist_ok=True)
    for number, share in enumerate(SHARES):
        mesh = mesh_throw(scene, share * default_element_size_mm(scene)).mesh
        np.savez_compressed(Path(folder) / f"mesh-{number}.npz", points_mm=mesh.points_mm, cells=mesh.cells)
        print(f"{folder}/mesh-{number}.npz: {3 * mesh.points_mm.shape[1]:,} unknowns", flush=True)


def system(file: Path) -> Body:
    """Return the body of a mesh with its loads."""
    stored = np.load(file)
    model = assemble(TetMesh(stored["points_mm"], stored["cells"], mirrored=False), *STEEL)
    heights = np.repeat(model.nodes_mm[2], 3)
    free = np.flatnonzero(heights > heights.min() + 1e-6)
    loads = np.stack([_end_load(model, axis) for axis in range(3)], axis=1)
    prolongation = sp.kron(model.equations.prolongation, sp.eye(3)).tocsr()
    coarse = free[free < prolongation.shape[1]]
    matrix = model.stiffness.tocsr()[free][:, free]
    return Body(model.equations, free, matrix, prolongation[free][:, coarse], loads[free])


def _end_load(model: Elasticity, axis: int) -> Array:
    low, high = model.nodes_mm[2].min(), model.nodes_mm[2].max()
    return 1000.0 * mean_displacement(model, axis, high - 0.1 * (high - low))


def on_gpu_by_cycle(library: str, matrix: Any, prolongation: Any) -> Solver:
    """Return the evaluation's own conjugate gradients with all its products on the GPU."""
    import cupy as cp
    import cupyx.scipy.sparse as gpu_sparse

    fine, up = (gpu_sparse.csr_matrix(m) for m in (matrix, prolongation))
    down = up.T.tocsr()
    coarse = Factor(library, (prolongation.T @ matrix @ prolongation).tocsr())
    inverse = 1.0 / matrix.diagonal()[:, None]
    upper = 1.1 * largest_eigenvalue(matrix, inverse)
    scale = cp.asarray(inverse)

    def smooth(residual: Any) -> Any:
        centre, half = (upper + upper / 10) / 2, (upper - upper / 10) / 2
        rho = half / centre
        step = scale * residual / centre
        x = step
        for _ in range(2):
            residual = residual - fine @ step
            following = 1.0 / (2 * centre / half - rho)
            step = following * rho * step + 2 * following / half * (scale * residual)
            rho, x = following, x + step
        return x

    def cycle(residual: Any) -> Any:
        x = smooth(residual)
        x = x + up @ coarse(down @ (residual - fine @ x))
        return x + smooth(residual - fine @ x)

    def solve(loads: Array) -> Array:
        residual = cp.asarray(loads)
        x, direction, energy = cp.zeros_like(residual), cp.zeros_like(residual), None
        goal = RELATIVE_RESIDUAL * cp.linalg.norm(residual, axis=0)
        for _ in range(400):
            z = cycle(residual)
            following = (residual * z).sum(axis=0)
            direction = z if energy is None else z + following / energy * direction
            image, energy = fine @ direction, following
            step = energy / (direction * image).sum(axis=0)
            x, residual = x + step * direction, residual - step * image
            if bool((cp.linalg.norm(residual, axis=0) <= goal).all()):
                break
        return np.asarray(cp.asnumpy(x))

    return solve


class Factor:
    """Cholesky factor of a symmetric positive definite matrix on the GPU, by cuDSS."""

    def __init__(self, library: str, matrix: sp.csr_matrix) -> None:
        import cupy as cp

        self._library, self._cp, self._size = ctypes.CDLL(library), cp, matrix.shape[0]
        self._kept = (
            cp.asarray(matrix.indptr, dtype=cp.int32),
            cp.asarray(matrix.indices, dtype=cp.int32),
            cp.asarray(matrix.data),
        )
        self._handle, self._config, self._data, self._matrix = (ctypes.c_void_p() for _ in range(4))
        self._call("cudssCreate", ctypes.byref(self._handle))
        self._call("cudssConfigCreate", ctypes.byref(self._config))
        self._call("cudssDataCreate", self._handle, ctypes.byref(self._data))
        rows, columns, values = (ctypes.c_void_p(a.data.ptr) for a in self._kept)
        size, count = ctypes.c_int64(self._size), ctypes.c_int64(matrix.nnz)
        kinds = (INT32, FLOAT64, POSITIVE, FULL, ZERO_BASED)
        self._call(
            "cudssMatrixCreateCsr",
            ctypes.byref(self._matrix),
            size,
            size,
            count,
            rows,
            None,
            columns,
            values,
            *kinds,
        )
        empty = cp.zeros((self._size, 1), order="F")
        for phase in (ANALYSIS, FACTORISATION):
            self._execute(phase, empty, empty)

    def __call__(self, loads: Any) -> Any:
        """Solve for loads (n, k) on the GPU."""
        right = self._cp.asfortranarray(loads)
        solution = self._cp.zeros_like(right)
        self._execute(SOLVE, solution, right)
        return solution

    def on_host(self, loads: Array) -> Array:
        """Solve for loads of the CPU's memory."""
        return np.asarray(self._cp.asnumpy(self(self._cp.asarray(loads))))

    def _execute(self, phase: int, solution: Any, right: Any) -> None:
        x, b = (self._dense(array) for array in (solution, right))
        self._call("cudssExecute", self._handle, phase, self._config, self._data, self._matrix, x, b)
        self._cp.cuda.Device().synchronize()
        for matrix in (x, b):
            self._call("cudssMatrixDestroy", matrix)

    def _dense(self, array: Any) -> ctypes.c_void_p:
        found = ctypes.c_void_p()
        rows, columns = (ctypes.c_int64(n) for n in array.shape)
        pointer = ctypes.c_void_p(array.data.ptr)
        self._call("cudssMatrixCreateDn", ctypes.byref(found), rows, columns, rows, pointer, FLOAT64, COLUMNS)
        return found

    def _call(self, name: str, *arguments: Any) -> None:
        status = getattr(self._library, name)(*arguments)
        if status:
            raise RuntimeError(f"{name} returned {status}")


def _options() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folder", help="of the meshes; with --write the engine")
    parser.add_argument("--write", metavar="FOLDER", help="mesh an engine's half throw into this folder")
    parser.add_argument("--cudss", metavar="FILE", help="NVIDIA's libcudss.so.0")
    return parser.parse_args()


if __name__ == "__main__":
    main()
