"""The kernels by name: what they compute, their machine code, and which a solve takes. Without JAX."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Hashable, Mapping
from dataclasses import dataclass
from functools import cache, partial

import llvmlite
import llvmlite.ir as ir

from cranktopo.base.machine import usable_cores
from cranktopo.numerics.kernels.coarse_grids import Stencil, write_prolongation, write_restriction
from cranktopo.numerics.kernels.ir_builder import POINTER, VectorCode
from cranktopo.numerics.kernels.plane_sweep import (
    NUMBERS,
    Finish,
    FreeForces,
    Operator,
    Smooth,
    Store,
    write_copies,
    write_planes,
)
from cranktopo.numerics.kernels.stiffness import StiffnessOperator, write_energies
from cranktopo.numerics.kernels.xla_ffi import write_handler
from cranktopo.numerics.machine_code import address_of, can_be_kept, code_of, vector_width
from cranktopo.numerics.source_files import NUMERICS, digest_of_sources

_Writer = Callable[[VectorCode], None]


@dataclass(frozen=True)
class Kernel:
    """A kernel that XLA calls.

    Attributes:
        writers: who write its functions, called one after the other; all but the last take no time.
        buffers: numbers of arguments and of results.
        replaced: by the number of an argument, that of the result that takes its memory.
    """

    writers: tuple[_Writer, ...]
    buffers: tuple[int, int]
    replaced: Mapping[int, int]


def _coupling(operator: Operator, finish: Finish) -> Kernel:
    """Kernel of an operator and a finish; its last result is spare memory: XLA gives none in another way."""
    written = len(finish.results((1,) * 5))
    return Kernel(
        tuple(partial(write, operator=operator, finish=finish) for write in (write_copies, write_planes)),
        (operator.arrays + finish.arrays, written + 1),
        {operator.arrays + number: number for number in range(finish.replaced)},
    )


SWITCH, OFF = "CRANKTOPO_KERNELS", "off"
"""Variable of the environment, and what it is where no kernel is wanted."""
MOST_THREADS = 16
TRIED = "stiffness_product", "float32"
"""The kernel whose first call shows whether any can be used."""
OPERATORS: Mapping[str, Operator] = {"stiffness": StiffnessOperator(), "stencil": Stencil()}
FINISHES: Mapping[str, Finish] = {"product": Store(), "free_forces": FreeForces(), "smoothing": Smooth()}
KERNELS: Mapping[str, Kernel] = {
    **{f"{o}_{f}": _coupling(OPERATORS[o], FINISHES[f]) for o in OPERATORS for f in FINISHES},
    "restriction": Kernel((write_restriction,), (1, 1), {}),
    "prolongation": Kernel((write_prolongation,), (2, 2), {1: 1}),
    "energy": Kernel((write_energies,), (3, 1), {}),
}
# What solves, optimisations and bounds take as long as the first method does.
FAST = (
    ("stencil_product", "float32"),
    ("stiffness_smoothing", "float32"),
    ("restriction", "float32"),
    ("stencil_smoothing", "float32"),
    ("prolongation", "float32"),
    ("stiffness_free_forces", "float64"),
    ("energy", "float64"),
)


def why_unwanted() -> str:
    """Return why no kernel is wanted here in a few words, empty where they are."""
    if os.environ.get(SWITCH, "").lower() == OFF:
        return f"switched off by {SWITCH}={OFF}"
    if sys.platform == "win32" or sys.maxsize <= 2**32:
        return "they need POSIX and 64 bits"
    return ""


def keep_machine_code() -> None:
    """Make what the fast method takes and keep it, for another process, which needs it soon."""
    if why_unwanted() or not can_be_kept():
        return
    for kernel, precision in (TRIED, *FAST):
        code_of(*_written(kernel, precision, vector_width(precision), threads()))


def threads() -> int:
    """Return how many threads share a kernel: further ones would wait for memory."""
    return min(usable_cores(), MOST_THREADS)


@cache
def address(kernel: str, precision: str, width: int, threads: int) -> int:
    """Return the address of a kernel's handler in this process; made once."""
    return address_of("handler", *_written(kernel, precision, width, threads))


def _written(kernel: str, precision: str, width: int, threads: int) -> tuple[Hashable, Callable[[], str]]:
    """Return what a kernel's text is made from, and what writes it."""
    settings = kernel, precision, width, threads
    origin = settings, llvmlite.__version__, digest_of_sources(NUMERICS)
    return origin, lambda: text_of(KERNELS[kernel], precision, width, threads)


def text_of(kernel: Kernel, precision: str, width: int, threads: int) -> str:
    """Return a kernel and the handler that XLA calls, written for LLVM."""
    module = ir.Module()
    inputs = [POINTER] * sum(kernel.buffers) + NUMBERS
    functions = []
    for number, write in enumerate(kernel.writers):
        code = VectorCode(module, f"planes{number}", inputs, precision, width)
        write(code)
        functions.append(code.function)
    write_handler(module, functions, kernel.buffers, threads)
    return str(module)
