"""Compiling the kernels for this processor, and calling them from JAX."""

from __future__ import annotations

import ctypes
import sys
import threading
from collections.abc import Callable, Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING, TypeVar

import jax
import llvmlite.ir as ir
import numpy as np

from cranktopo.cores import usable_cores
from cranktopo.fem.kernels.code import POINTER, VectorCode
from cranktopo.fem.kernels.finishes import Smooth, Store
from cranktopo.fem.kernels.foreign import interface, write_handler
from cranktopo.fem.kernels.planes import NUMBERS, SPARE, Finish, Operator, write_copies, write_planes
from cranktopo.fem.kernels.stencil import Stencil
from cranktopo.fem.kernels.stiffness import Stiffness

if TYPE_CHECKING:
    import llvmlite.binding as llvm

_Result = TypeVar("_Result")
Kernel = tuple[str, str]
"""Names of an operator and of a finish."""

# The call frame that `foreign` reads belongs to this major version of XLA's interface.
_KNOWN_MAJOR = 0
_OPERATORS: Mapping[str, Operator] = {"stiffness": Stiffness(), "stencil": Stencil()}
_FINISHES: Mapping[str, Finish] = {"product": Store(), "smoothing": Smooth()}
_one_at_a_time = threading.Lock()
_engines: list[llvm.ExecutionEngine] = []  # machine code lives as long as its engine


@cache
def kernels_usable() -> bool:
    """Whether kernels can be had here: functions of POSIX, 64 bits, and a known interface of XLA."""
    return sys.platform != "win32" and sys.maxsize > 2**32 and interface().version[0] == _KNOWN_MAJOR


def by_kernel(
    kernel: Callable[..., _Result], elsewhere: Callable[..., _Result], *arguments: object
) -> _Result:
    """What a kernel computes on a processor, and JAX code elsewhere."""
    if not kernels_usable():
        return elsewhere(*arguments)
    chosen: _Result = jax.lax.platform_dependent(*arguments, cpu=kernel, default=elsewhere)
    return chosen


def called(kernel: Kernel, arrays: Sequence[jax.Array]) -> list[jax.Array]:
    """Results of a kernel, shaped as its field and in its precision.

    Args:
        arrays: of the operator and of the finish, the field the first of these.
    """
    operator, finish = _OPERATORS[kernel[0]], _FINISHES[kernel[1]]
    field = arrays[operator.arrays]
    cases, _, _, *plane = field.shape
    result = jax.ShapeDtypeStruct(field.shape, field.dtype)
    # A result that nobody wants: it is how a kernel gets memory.
    spare = jax.ShapeDtypeStruct((usable_cores(), SPARE * cases, 3, *plane), field.dtype)
    replaced = {operator.arrays + number: number for number in range(finish.replaced)}
    call = jax.ffi.ffi_call(
        _registered(kernel, field), [*[result] * finish.arrays[1], spare], input_output_aliases=replaced
    )
    *results, _ = call(*(array.astype(field.dtype) for array in arrays))
    return results


def _registered(kernel: Kernel, field: jax.Array) -> str:
    """Name under which XLA finds a kernel for a field's numbers; compiled once, whichever thread asks."""
    precision = field.dtype.name
    with _one_at_a_time:
        return _register(kernel, precision, _width(precision), usable_cores())


@cache
def _register(kernel: Kernel, precision: str, width: int, threads: int) -> str:
    name = f"cranktopo_{'_'.join(kernel)}_{precision}_{width}_{threads}"
    address = _compiled(str(_module(kernel, precision, width, threads)))
    handler = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)(address)
    jax.ffi.register_ffi_target(name, jax.ffi.pycapsule(handler), platform="cpu")
    return name


def _module(kernel: Kernel, precision: str, width: int, threads: int) -> ir.Module:
    """Code of a kernel and of what calls it."""
    module, operator, finish = ir.Module(), _OPERATORS[kernel[0]], _FINISHES[kernel[1]]
    read, written = finish.arrays
    buffers = operator.arrays + read, written + 1
    inputs = [POINTER] * sum(buffers) + NUMBERS
    functions = []
    for name, write in (("copies", write_copies), ("planes", write_planes)):
        code = VectorCode(module, name, inputs, precision, width)
        write(code, operator, finish)
        functions.append(code.function)
    write_handler(module, functions, buffers, threads)
    return module


def _compiled(text: str) -> int:
    """Address of the handler of a module, as machine code for this processor."""
    import llvmlite.binding as llvm  # loads all of LLVM: only who solves needs it

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    module = llvm.parse_assembly(text)
    features = llvm.get_host_cpu_features().flatten()
    target = llvm.Target.from_default_triple()
    machine = target.create_target_machine(cpu=llvm.get_host_cpu_name(), features=features, opt=3)
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=2))
    builder.getModulePassManager().run(module, builder)
    engine = llvm.create_mcjit_compiler(module, machine)
    engine.finalize_object()
    _engines.append(engine)
    return engine.get_function_address("handler")


def _width(precision: str) -> int:
    """Numbers in a vector register of this processor; 256 bits where it has no longer ones."""
    import llvmlite.binding as llvm

    wide = llvm.get_host_cpu_features().get("avx512f", False)
    return (64 if wide else 32) // np.dtype(precision).itemsize
