"""Calling the kernels from JAX; their machine code is kept in the user's cache like XLA's programs."""

from __future__ import annotations

import hashlib
import logging
import os
import sys
import threading
from collections.abc import Callable, Hashable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from functools import cache, partial
from pathlib import Path
from typing import TYPE_CHECKING, TypeVar

import jax
import llvmlite
import llvmlite.ir as ir
import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.base.machine import private_cache, usable_cores
from cranktopo.base.seals import read_sealed_bytes, write_sealed_bytes
from cranktopo.numerics.kernels.coarse_grids import Stencil, write_prolongation, write_restriction
from cranktopo.numerics.kernels.frames import Product, find_fault, first_line, register
from cranktopo.numerics.kernels.ir_builder import POINTER, VectorCode
from cranktopo.numerics.kernels.plane_sweep import (
    NUMBERS,
    Finish,
    FreeForces,
    Operator,
    Smooth,
    Store,
    spare_planes,
    write_copies,
    write_planes,
)
from cranktopo.numerics.kernels.stiffness import StiffnessOperator, write_energies
from cranktopo.numerics.kernels.xla_ffi import write_handler
from cranktopo.numerics.source_files import NUMERICS, digest_of_sources

if TYPE_CHECKING:
    import llvmlite.binding as llvm


_FOLDER = "machine-code"  # versions before had one that others could read, "kernels"
_KEEPING = "jax_enable_compilation_cache"
_engines: list[llvm.ExecutionEngine] = []  # machine code lives as long as its engine
_known: list[tuple[str, str]] = []


def address_of(function: str, origin: Hashable, text: Callable[[], str]) -> int:
    """Return the address of a function of a module, written for LLVM, as machine code for this processor.

    LLVM takes a tenth of a second for a kernel, its text as long: its object files are kept.

    Args:
        origin: what the text is made from, the same for two processes that would write the same one.
    """
    import llvmlite.binding as llvm  # loads all of LLVM: only who solves needs it

    machine = _machine()
    kept = _kept(f"{llvm.llvm_version_info} {machine.triple} {_processor()} {origin!r}")
    code = None if kept is None else read_sealed_bytes(kept)
    if code is None:
        code = _compiled(text())
        if kept is not None:
            _keep(code, kept)
    engine = llvm.create_mcjit_compiler(llvm.parse_assembly(""), machine)
    engine.add_object_file(llvm.ObjectFileRef.from_data(code))
    engine.finalize_object()
    _engines.append(engine)
    return int(engine.get_function_address(function))


def vector_width(precision: str) -> int:
    """Return the numbers in a vector register of this processor; of 256 bits where it has no longer ones."""
    import llvmlite.binding as llvm

    wide = llvm.get_host_cpu_features().get("avx512f", False)
    return (64 if wide else 32) // np.dtype(precision).itemsize


def _compiled(text: str) -> bytes:
    import llvmlite.binding as llvm

    machine, module = _machine(), llvm.parse_assembly(text)
    builder = llvm.create_pass_builder(machine, llvm.create_pipeline_tuning_options(speed_level=2))
    builder.getModulePassManager().run(module, builder)
    return bytes(machine.emit_object(module))


def _machine() -> llvm.TargetMachine:
    import llvmlite.binding as llvm

    llvm.initialize_native_target()
    llvm.initialize_native_asmprinter()
    name, features = _processor()
    target = llvm.Target.from_default_triple()
    return target.create_target_machine(cpu=name, features=features, opt=3, jit=True)


@cache
def _processor() -> tuple[str, str]:
    import llvmlite.binding as llvm

    return llvm.get_host_cpu_name(), llvm.get_host_cpu_features().flatten()


def _kept(source: str) -> Path | None:
    """File for the code of a source; None where it is not wanted, or has no place that is the user's."""
    folder = private_cache(_FOLDER) if getattr(jax.config, _KEEPING) else None
    return None if folder is None else folder / f"{hashlib.sha256(source.encode()).hexdigest()[:32]}.o"


def _keep(code: bytes, file: Path) -> None:
    """Keep code where that is possible; a reader finds all of it or what was there before."""
    with suppress(CranktopoError):
        write_sealed_bytes(file, code)


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


SWITCH, OFF = "CRANKTOPO_KERNELS", "off"
"""Variable of the environment, and what it is where no kernel is wanted."""
_MOST_THREADS = 16
_CHOSEN_DEVICE = "jax_default_device"
_OPERATORS: Mapping[str, Operator] = {"stiffness": StiffnessOperator(), "stencil": Stencil()}
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
_one_trial = threading.Lock()
_log = logging.getLogger(__name__)


def kernels_usable() -> bool:
    """Tell whether kernels can be had here, and are wanted."""
    return not why_no_kernels()


def why_no_kernels() -> str:
    """Return why there are no kernels here in a few words, empty where there are; a first call tries one."""
    if os.environ.get(SWITCH, "").lower() == OFF:
        return f"switched off by {SWITCH}={OFF}"
    if sys.platform == "win32" or sys.maxsize <= 2**32:
        return "they need POSIX and 64 bits"
    with _one_trial:
        return _fault()


@cache
def _fault() -> str:
    from cranktopo.numerics.grid.slab_product import apply_by_slabs

    try:
        address = _address("stiffness_product", "float32", vector_width("float32"), _threads())
        fault = find_fault(address, _stiffness_product, apply_by_slabs)
    except Exception as error:  # of LLVM
        fault = f"they cannot be compiled: {first_line(error)}"
    if fault:
        _log.info("note: kernels are not used, JAX code computes the same in more time: %s.", fault)
    return fault


def _stiffness_product(target: str) -> Product:
    def product(*arrays: jax.Array) -> jax.Array:
        return _ffi_results(target, "stiffness_product", arrays, _shapes("stiffness", "product", arrays))[0]

    return product


def kernel_or_jax(
    kernel: Callable[..., _Result], elsewhere: Callable[..., _Result], *arguments: object
) -> _Result:
    """Return what a kernel computes on a processor, and JAX code elsewhere.

    Chosen when a program is traced, so that only one of them is.
    """
    return (kernel if on_processor() and kernels_usable() else elsewhere)(*arguments)


def on_processor() -> bool:
    """Tell whether JAX computes on a processor here."""
    chosen = getattr(jax.config, _CHOSEN_DEVICE)
    return (jax.default_backend() if chosen is None else getattr(chosen, "platform", chosen)) == "cpu"


def compile_kernels() -> None:
    """Make the machine code that the fast method takes, ahead of its first solve.

    LLVM leaves the interpreter meanwhile: a thread that calls this has it while scenes are read.
    """
    if on_processor() and kernels_usable():
        for name, precision in _FAST:
            _registered(name, precision)


def apply_operator(operator: str, finish: str, arrays: Sequence[jax.Array]) -> Sequence[jax.Array]:
    """Return what the kernel of an operator and a finish computes, in the precision of the field."""
    field = arrays[_OPERATORS[operator].arrays]
    return ffi_call(f"{operator}_{finish}", arrays, _shapes(operator, finish, arrays), field.dtype)[:-1]


def _shapes(operator: str, finish: str, arrays: Sequence[jax.Array]) -> list[tuple[int, ...]]:
    field = arrays[_OPERATORS[operator].arrays]
    cases, _, _, *plane = field.shape
    each, besides = spare_planes(_OPERATORS[operator], _FINISHES[finish])
    spare = _threads(), each * cases + besides, 3, *plane
    return [*_FINISHES[finish].results(field.shape), spare]


def ffi_call(
    name: str, arrays: Sequence[jax.Array], shapes: Sequence[tuple[int, ...]], precision: jax.typing.DTypeLike
) -> Sequence[jax.Array]:
    """Return results of a kernel, of the given shapes; what goes in and out has one precision."""
    target = _registered(name, jax.numpy.dtype(precision).name)
    return _ffi_results(target, name, [array.astype(precision) for array in arrays], shapes)


def _ffi_results(
    target: str, name: str, arrays: Sequence[jax.Array], shapes: Sequence[tuple[int, ...]]
) -> Sequence[jax.Array]:
    results = [jax.ShapeDtypeStruct(shape, arrays[0].dtype) for shape in shapes]
    call = jax.ffi.ffi_call(target, results, input_output_aliases=dict(_KERNELS[name].replaced))
    found: Sequence[jax.Array] = call(*arrays)
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
    register(name, _address(kernel, precision, width, threads))
    _known.append((kernel, precision))
    return name


def known_kernels() -> list[tuple[str, str]]:
    """Return the kernels that XLA knows in this process, each with its precision."""
    return list(_known)


def make_known(kernels: Sequence[tuple[str, str]]) -> None:
    """Have XLA know kernels: a program that is loaded calls them by their names."""
    for kernel, precision in kernels:
        _registered(kernel, precision)


def kernel_settings() -> Hashable:
    """Return what of this process decides which kernels a program calls, and with how much memory."""
    widths = tuple(vector_width(precision) for precision in ("float32", "float64"))
    return (on_processor() and kernels_usable()) and (widths, _threads())


@cache
def _address(kernel: str, precision: str, width: int, threads: int) -> int:
    settings = kernel, precision, width, threads
    origin = settings, llvmlite.__version__, digest_of_sources(NUMERICS)
    return address_of("handler", origin, lambda: str(_module(_KERNELS[kernel], *settings[1:])))


def _module(kernel: _Kernel, precision: str, width: int, threads: int) -> ir.Module:
    module = ir.Module()
    inputs = [POINTER] * sum(kernel.buffers) + NUMBERS
    functions = []
    for number, write in enumerate(kernel.writers):
        code = VectorCode(module, f"planes{number}", inputs, precision, width)
        write(code)
        functions.append(code.function)
    write_handler(module, functions, kernel.buffers, threads)
    return module
