"""Calling the kernels from JAX, whose programs find them by name."""

from __future__ import annotations

import logging
import threading
from collections import defaultdict
from collections.abc import Callable, Hashable, Sequence
from functools import cache
from typing import TypeVar

import jax

from cranktopo.numerics.kernels.catalogue import (
    FAST,
    FINISHES,
    KERNELS,
    OPERATORS,
    TRIED,
    address,
    threads,
    why_unwanted,
)
from cranktopo.numerics.kernels.first_call import Product, find_fault, first_line, register
from cranktopo.numerics.kernels.plane_sweep import spare_planes
from cranktopo.numerics.machine_code import vector_width

_known: list[tuple[str, str]] = []
_Result = TypeVar("_Result")
_CHOSEN_DEVICE = "jax_default_device"
_one_at_a_time: defaultdict[tuple[str, str], threading.Lock] = defaultdict(threading.Lock)
_one_trial = threading.Lock()
_log = logging.getLogger(__name__)


def kernels_usable() -> bool:
    """Tell whether kernels can be had here, and are wanted."""
    return not why_no_kernels()


def why_no_kernels() -> str:
    """Return why there are no kernels here in a few words, empty where there are; a first call tries one."""
    if why := why_unwanted():
        return why
    with _one_trial:
        return _fault()


@cache
def _fault() -> str:
    from cranktopo.numerics.grid.slab_product import apply_by_slabs

    try:
        name, precision = TRIED
        tried = address(name, precision, vector_width(precision), threads())
        fault = find_fault(tried, _stiffness_product, apply_by_slabs)
    except Exception as error:  # of LLVM
        fault = f"they cannot be compiled: {first_line(error)}"
    if fault:
        _log.info("note: kernels are not used, JAX code computes the same in more time: %s.", fault)
    return fault


def _stiffness_product(target: str) -> Product:
    def product(*arrays: jax.Array) -> jax.Array:
        return _ffi_results(target, TRIED[0], arrays, _shapes("stiffness", "product", arrays))[0]

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
        for name, precision in FAST:
            _registered(name, precision)


def apply_operator(operator: str, finish: str, arrays: Sequence[jax.Array]) -> Sequence[jax.Array]:
    """Return what the kernel of an operator and a finish computes, in the precision of the field."""
    field = arrays[OPERATORS[operator].arrays]
    return ffi_call(f"{operator}_{finish}", arrays, _shapes(operator, finish, arrays), field.dtype)[:-1]


def _shapes(operator: str, finish: str, arrays: Sequence[jax.Array]) -> list[tuple[int, ...]]:
    field = arrays[OPERATORS[operator].arrays]
    cases, _, _, *plane = field.shape
    each, besides = spare_planes(OPERATORS[operator], FINISHES[finish])
    spare = threads(), each * cases + besides, 3, *plane
    return [*FINISHES[finish].results(field.shape), spare]


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
    call = jax.ffi.ffi_call(target, results, input_output_aliases=dict(KERNELS[name].replaced))
    found: Sequence[jax.Array] = call(*arrays)
    return found


def _registered(kernel: str, precision: str) -> str:
    """Name under which XLA finds a kernel for a precision; compiled once, whichever thread asks."""
    with _one_at_a_time[kernel, precision]:
        return _register(kernel, precision, vector_width(precision), threads())


@cache
def _register(kernel: str, precision: str, width: int, threads: int) -> str:
    name = f"cranktopo_{kernel}_{precision}_{width}_{threads}"
    register(name, address(kernel, precision, width, threads))
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
    return (on_processor() and kernels_usable()) and (widths, threads())
