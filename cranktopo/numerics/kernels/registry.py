"""Calling the kernels from JAX."""

from __future__ import annotations

import ctypes
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import cache, partial
from typing import TypeVar

import jax
import llvmlite.ir as ir

from cranktopo.base.machine import usable_cores
from cranktopo.numerics.kernels.energy import write_energies
from cranktopo.numerics.kernels.epilogues import FreeForces, Smooth, Store
from cranktopo.numerics.kernels.ir_builder import POINTER, VectorCode
from cranktopo.numerics.kernels.jit_cache import address_of, vector_width
from cranktopo.numerics.kernels.plane_sweep import (
    NUMBERS,
    Finish,
    Operator,
    spare_planes,
    write_copies,
    write_planes,
)
from cranktopo.numerics.kernels.stencil import Stencil
from cranktopo.numerics.kernels.stiffness import Stiffness
from cranktopo.numerics.kernels.transfer import write_prolongation, write_restriction
from cranktopo.numerics.kernels.xla_ffi import interface, write_handler

_Result = TypeVar("_Result")
_Writer = Callable[[VectorCode], None]


@dataclass(frozen=True)
class _Kernel:
    """A kernel that XLA calls.

    Attributes:
        writers: who write its functions, called one after the other; all but the last take no time.
        buffers: numbers of arguments and of results.
        replaced: by the number of an argument, that of the result that takes its memory.
    """

    writers: tuple[_Writer, ...]
    buffers: tuple[int, int]
    replaced: Mapping[int, int]


def _coupling(operator: Operator, finish: Finish) -> _Kernel:
    """Kernel of an operator and a finish; its last result is spare memory: XLA gives none in another way."""
    written = len(finish.results((1,) * 5))
    return _Kernel(
        tuple(partial(write, operator=operator, finish=finish) for write in (write_copies, write_planes)),
        (operator.arrays + finish.arrays, written + 1),
        {operator.arrays + number: number for number in range(finish.replaced)},
    )


# The call frame that `foreign` reads belongs to this major version of XLA's interface.
_KNOWN_MAJOR = 0
_MOST_THREADS = 16
_CHOSEN_DEVICE = "jax_default_device"
_OPERATORS: Mapping[str, Operator] = {"stiffness": Stiffness(), "stencil": Stencil()}
_FINISHES: Mapping[str, Finish] = {"product": Store(), "free_forces": FreeForces(), "smoothing": Smooth()}
_KERNELS: Mapping[str, _Kernel] = {
    **{f"{o}_{f}": _coupling(_OPERATORS[o], _FINISHES[f]) for o in _OPERATORS for f in _FINISHES},
    "restriction": _Kernel((write_restriction,), (1, 1), {}),
    "prolongation": _Kernel((write_prolongation,), (2, 2), {1: 1}),
    "energy": _Kernel((write_energies,), (3, 1), {}),
}
# What solves, optimisations and bounds take as long as the first method does.
_FAST = (
    ("stencil_product", "float32"),
    ("stiffness_smoothing", "float32"),
    ("restriction", "float32"),
    ("stencil_smoothing", "float32"),
    ("prolongation", "float32"),
    ("stiffness_free_forces", "float64"),
    ("energy", "float64"),
)
_one_at_a_time = threading.Lock()


@cache
def kernels_usable() -> bool:
    """Whether kernels can be had here: functions of POSIX, 64 bits, and a known interface of XLA."""
    return sys.platform != "win32" and sys.maxsize > 2**32 and interface().version[0] == _KNOWN_MAJOR


def by_kernel(
    kernel: Callable[..., _Result], elsewhere: Callable[..., _Result], *arguments: object
) -> _Result:
    """What a kernel computes on a processor, and JAX code elsewhere.

    Chosen when a program is traced, so that only one of them is.
    """
    return (kernel if _on_processor() and kernels_usable() else elsewhere)(*arguments)


def _on_processor() -> bool:
    """Whether JAX computes on a processor now."""
    chosen = getattr(jax.config, _CHOSEN_DEVICE)
    return (jax.default_backend() if chosen is None else getattr(chosen, "platform", chosen)) == "cpu"


def compile_kernels() -> None:
    """Make the machine code that the fast method takes, ahead of its first solve.

    LLVM leaves the interpreter meanwhile: a thread that calls this has it while scenes are read.
    """
    if kernels_usable() and _on_processor():
        for name, precision in _FAST:
            _registered(name, precision)


def coupled(operator: str, finish: str, arrays: Sequence[jax.Array]) -> Sequence[jax.Array]:
    """What the kernel of an operator and a finish computes, in the precision of the field.

    Args:
        arrays: of the operator and of the finish, the field the first of these.
    """
    field = arrays[_OPERATORS[operator].arrays]
    cases, _, _, *plane = field.shape
    each, besides = spare_planes(_OPERATORS[operator], _FINISHES[finish])
    spare = _threads(), each * cases + besides, 3, *plane
    shapes = _FINISHES[finish].results(field.shape)
    return called(f"{operator}_{finish}", arrays, [*shapes, spare], field.dtype)[:-1]


def called(
    name: str, arrays: Sequence[jax.Array], shapes: Sequence[tuple[int, ...]], precision: jax.typing.DTypeLike
) -> Sequence[jax.Array]:
    """Results of a kernel, of the given shapes; what goes in and out has one precision."""
    results = [jax.ShapeDtypeStruct(shape, precision) for shape in shapes]
    target = _registered(name, results[0].dtype.name)
    call = jax.ffi.ffi_call(target, results, input_output_aliases=dict(_KERNELS[name].replaced))
    found: Sequence[jax.Array] = call(*(array.astype(precision) for array in arrays))
    return found


def _threads() -> int:
    """Threads that share a kernel: further ones would wait for memory."""
    return min(usable_cores(), _MOST_THREADS)


def _registered(kernel: str, precision: str) -> str:
    """Name under which XLA finds a kernel for a precision; compiled once, whichever thread asks."""
    with _one_at_a_time:
        return _register(kernel, precision, vector_width(precision), _threads())


@cache
def _register(kernel: str, precision: str, width: int, threads: int) -> str:
    name = f"cranktopo_{kernel}_{precision}_{width}_{threads}"
    address = address_of("handler", str(_module(_KERNELS[kernel], precision, width, threads)))
    handler = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)(address)
    jax.ffi.register_ffi_target(name, jax.ffi.pycapsule(handler), platform="cpu")
    return name


def _module(kernel: _Kernel, precision: str, width: int, threads: int) -> ir.Module:
    """Code of a kernel and of what calls it."""
    module = ir.Module()
    inputs = [POINTER] * sum(kernel.buffers) + NUMBERS
    functions = []
    for number, write in enumerate(kernel.writers):
        code = VectorCode(module, f"planes{number}", inputs, precision, width)
        write(code)
        functions.append(code.function)
    write_handler(module, functions, kernel.buffers, threads)
    return module
