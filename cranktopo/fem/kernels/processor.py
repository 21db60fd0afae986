"""Compiling the kernels for this processor, and calling them from JAX."""

from __future__ import annotations

import ctypes
import re
import sys
import threading
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

import jax
import llvmlite.ir as ir
import numpy as np

from cranktopo.cores import usable_cores
from cranktopo.fem.kernels.code import INT64, POINTER, VectorCode
from cranktopo.fem.kernels.foreign import write_handler
from cranktopo.fem.kernels.stencil import LEAD, write_stencil
from cranktopo.fem.kernels.stiffness import write_product

if TYPE_CHECKING:
    import llvmlite.binding as llvm

# The call frame that `foreign` reads belongs to this major version of XLA's interface.
_KNOWN_MAJOR = 0
# Who writes a kernel, and its numbers of arguments and results.
_KERNELS = {"stiffness": (write_product, (3, 2)), "stencil": (write_stencil, (2, 1))}
_one_at_a_time = threading.Lock()
_engines: list[llvm.ExecutionEngine] = []  # machine code lives as long as its engine


@cache
def kernels_usable() -> bool:
    """Whether kernels can be had here: threads of POSIX, 64 bits, and the interface of XLA that is known."""
    return sys.platform != "win32" and sys.maxsize > 2**32 and _interface_version()[0] == _KNOWN_MAJOR


def by_kernel(
    kernel: Callable[..., jax.Array], elsewhere: Callable[..., jax.Array], *arguments: jax.Array
) -> jax.Array:
    """What a kernel computes on a processor, and JAX code elsewhere."""
    if not kernels_usable():
        return elsewhere(*arguments)
    return jax.lax.platform_dependent(*arguments, cpu=kernel, default=elsewhere)


def stiffness_kernel(blocks: jax.Array, moduli: jax.Array, field: jax.Array) -> jax.Array:
    """As `fem.operator.apply_stiffness`, on the processor."""
    blocks, moduli = blocks.astype(field.dtype), moduli.astype(field.dtype)
    spare = jax.ShapeDtypeStruct((usable_cores(), 3, *field.shape[3:]), field.dtype)
    forces = jax.ShapeDtypeStruct(field.shape, field.dtype)
    return jax.ffi.ffi_call(_registered("stiffness", field), (forces, spare))(blocks, moduli, field)[0]


def stencil_kernel(stencil: jax.Array, padded: jax.Array) -> jax.Array:
    """As `fem.galerkin.apply_stencil` on the processor, of fields with a node of zeros around them."""
    nodes = stencil.shape[0] - LEAD, stencil.shape[1], stencil.shape[5]
    result = jax.ShapeDtypeStruct((padded.shape[0], 3, *nodes), padded.dtype)
    return jax.ffi.ffi_call(_registered("stencil", padded), result)(stencil.astype(padded.dtype), padded)


def _registered(kernel: str, field: jax.Array) -> str:
    """Name under which XLA finds a kernel for a field's numbers; compiled once, whichever thread asks."""
    precision = field.dtype.name
    with _one_at_a_time:
        return _register(kernel, precision, _width(precision), usable_cores())


@cache
def _register(kernel: str, precision: str, width: int, threads: int) -> str:
    name = f"cranktopo_{kernel}_{precision}_{width}_{threads}"
    address = _compiled(str(_module(kernel, precision, width, threads)))
    handler = ctypes.CFUNCTYPE(ctypes.c_void_p, ctypes.c_void_p)(address)
    jax.ffi.register_ffi_target(name, jax.ffi.pycapsule(handler), platform="cpu")
    return name


def _module(kernel: str, precision: str, width: int, threads: int) -> ir.Module:
    """Code of a kernel and of what calls it."""
    module, write, buffers = ir.Module(), *_KERNELS[kernel]
    inputs = [POINTER] * sum(buffers) + [INT64] * 7
    code = VectorCode(module, "product", inputs, precision, width)
    write(code)
    write_handler(module, code.function, buffers, threads, _interface_version())
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


@cache
def _interface_version() -> tuple[int, int]:
    """Major and minor number of XLA's interface for foreign functions, from the header that comes with it."""
    text = (Path(jax.ffi.include_dir()) / "xla/ffi/api/c_api.h").read_text(encoding="utf-8")
    found = dict(re.findall(r"#define XLA_FFI_API_(MAJOR|MINOR) (\d+)", text))
    return int(found["MAJOR"]), int(found["MINOR"])
