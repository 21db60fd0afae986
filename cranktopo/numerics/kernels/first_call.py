"""A first call of a kernel in a process: structs as they are known, numbers as those of JAX code."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor

import jax
import numpy as np
from numpy.typing import NDArray

from cranktopo.numerics.grid.lattice import COUPLED
from cranktopo.numerics.kernels.frames import unknown_size

Product = Callable[[jax.Array, jax.Array, jax.Array], jax.Array]
"""Nodal forces from blocks, moduli and displacements."""

# Load cases and cells: at least as many planes of nodes as threads, rows that end within a vector, and
# enough numbers in all for the threads to share them.
TRIAL = 7, (15, 3, 18)
_TOLERANCE = 1e-5  # of the largest number; float32 takes a hundredth of it
_QUICKLY = {"xla_backend_optimization_level": 0}
_HANDLER = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)
_watched: list[_Watched] = []  # XLA may call a handler as long as the process lives


def register(name: str, address: int) -> None:
    """Let XLA find the handler at an address under a name."""
    jax.ffi.register_ffi_target(name, jax.ffi.pycapsule(_HANDLER(address)), platform="cpu")


def first_line(error: Exception) -> str:
    """Return what an error says first."""
    return str(error).partition("\n")[0][:200] or type(error).__name__


def find_fault(address: int, product: Callable[[str], Product], expected: Product) -> str:
    """Tell what is wrong with the product of the kernel at an address, empty if it is that of JAX code.

    In a thread of its own: the caller may be tracing a program, for another device or several.
    """
    with ThreadPoolExecutor(1) as pool:
        return pool.submit(_tried, address, product, expected).result()


class _Watched:
    """A handler that is called only as long as all structs have the sizes that are known."""

    def __init__(self, address: int) -> None:
        self.fault = ""
        self._handler = _HANDLER(address)
        self._own = _HANDLER(self._call)
        self.address = ctypes.cast(self._own, ctypes.c_void_p).value or 0

    def _call(self, frame: int) -> int | None:
        self.fault = self.fault or unknown_size(frame)
        return None if self.fault else self._handler(frame)


def _tried(address: int, product: Callable[[str], Product], expected: Product) -> str:
    watched, name = _Watched(address), f"cranktopo_trial_{len(_watched)}"
    _watched.append(watched)
    try:
        with jax.default_device(jax.local_devices(backend="cpu")[0]):
            register(name, watched.address)
            programs = (jax.jit(by, compiler_options=_QUICKLY) for by in (product(name), expected))
            numbers = [np.asarray(program(*_operands())) for program in programs]
    except Exception as error:  # of JAX or XLA, whatever they have against it
        return watched.fault or f"a first call failed: {first_line(error)}"
    with np.errstate(all="ignore"):  # what was not written may be any number
        miss = float(np.max(np.abs(numbers[0] - numbers[1])) / np.max(np.abs(numbers[1])))
    differs = "" if miss <= _TOLERANCE else f"a product differs from that of JAX by {100 * miss:.2g} %"
    return watched.fault or differs


def _operands() -> tuple[NDArray[np.float32], NDArray[np.float32], NDArray[np.float32]]:
    cases, cells = TRIAL
    shapes = (8, 3, 3, cells[2]), cells, (cases, 3, *(n + 1 for n in cells))
    random = np.random.default_rng(0)
    blocks, moduli, field = (random.random(shape, np.float32) - np.float32(0.5) for shape in shapes)
    return (blocks * COUPLED[..., None]).astype(np.float32), moduli, field
