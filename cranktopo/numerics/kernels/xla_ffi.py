"""The function that a compiled JAX program calls: reads XLA's call frame, and has the parts computed.

Source: xla/ffi/api/c_api.h, which `jax.ffi.include_dir()` has; offsets are those of a 64-bit machine.
"""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache, reduce
from pathlib import Path

import jax
import llvmlite.ir as ir

from cranktopo.numerics.kernels.ir_builder import BYTE, INT32, INT64, POINTER, Value
from cranktopo.numerics.kernels.work_sharing import OFFERED, Pool, write_shared

# Offsets in bytes: of a call frame, a buffer, what XLA asks to know first, the list of its functions.
_EXTENSION, _INTERFACE, _CONTEXT, _ARGUMENTS, _RESULTS = 8, 16, 24, 72, 112
_DATA, _SIZES = 24, 40
_METADATA, _MAJOR, _MINOR = 24, 24, 28
_FUNCTIONS = 48
# Below so many numbers in the result sharing costs more than it saves.
_LEAST_SHARED = 20_000


@dataclass(frozen=True)
class Interface:
    """XLA's interface for foreign functions, as the header that comes with JAX describes it.

    Attributes:
        version: major and minor number.
        functions: names of what it offers, in order.
    """

    version: tuple[int, int]
    functions: tuple[str, ...]

    def offset(self, function: str) -> int:
        """Place of a function's address in the list, bytes."""
        return _FUNCTIONS + 8 * self.functions.index(function)


@cache
def interface() -> Interface:
    """The interface of the JAX at hand."""
    text = (Path(jax.ffi.include_dir()) / "xla/ffi/api/c_api.h").read_text(encoding="utf-8")
    found = dict(re.findall(r"#define XLA_FFI_API_(MAJOR|MINOR) (\d+)", text))
    functions = re.findall(r"^ *_XLA_FFI_API_STRUCT_FIELD\((\w+)\);", text, re.MULTILINE)
    return Interface((int(found["MAJOR"]), int(found["MINOR"])), tuple(functions))


def write_handler(
    module: ir.Module, functions: Sequence[ir.Function], buffers: tuple[int, int], threads: int
) -> ir.Function:
    """Handler that calls one function after the other once per part of the planes of nodes along x.

    A function gets the addresses of its buffers, the number of cases, of nodes along x, y and z, the number
    of the part, its first plane and the one after its last. The first result has shape (cases, 3, nodes...).

    Args:
        functions: all but the last take no time: the caller calls them itself.
        buffers: number of arguments and of results.
        threads: number of parts, where there is enough to share.
    """
    handler = ir.Function(module, ir.FunctionType(POINTER, [POINTER]), "handler")
    frame = handler.args[0]
    builder = ir.IRBuilder(handler.append_basic_block())
    none = ir.Constant(POINTER, None)
    extension = _read(builder, frame, _EXTENSION, POINTER)
    with builder.if_then(builder.icmp_unsigned("!=", extension, none)):
        metadata = _read(builder, extension, _METADATA, POINTER)
        for place, number in zip((_MAJOR, _MINOR), interface().version, strict=True):
            builder.store(INT32(number), _offset(builder, metadata, place))
        builder.ret(none)
    task = _task(builder, frame, buffers)
    _, planes, _, _ = shape = task[-4:]
    numbers = reduce(builder.mul, shape, INT64(3))
    shared = builder.and_(
        builder.icmp_signed(">=", numbers, INT64(_LEAST_SHARED)),
        builder.icmp_signed(">=", planes, INT64(threads)),
    )
    with builder.if_else(shared) as (together, alone):
        with together:
            write_shared(builder, functions, task, threads, _pool(builder, frame))
        with alone:
            for function in functions:
                builder.call(function, [*task, INT64(0), INT64(0), planes])
    builder.ret(none)
    return handler


def _task(builder: ir.IRBuilder, frame: Value, buffers: tuple[int, int]) -> list[Value]:
    """What every part of a call gets: addresses of all buffers, cases, nodes along x, y and z."""
    lists = [_read(builder, frame, place, POINTER) for place in (_ARGUMENTS, _RESULTS)]
    found = [_read(builder, lists[k], 8 * n, POINTER) for k in (0, 1) for n in range(buffers[k])]
    sizes = _read(builder, found[buffers[0]], _SIZES, POINTER)
    shape = [_read(builder, sizes, 8 * axis, INT64) for axis in (0, 2, 3, 4)]
    return [*(_read(builder, buffer, _DATA, POINTER) for buffer in found), *shape]


def _pool(builder: ir.IRBuilder, frame: Value) -> Pool:
    functions = _read(builder, frame, _INTERFACE, POINTER)
    offered = (_read(builder, functions, interface().offset(name), kind) for name, kind in OFFERED.items())
    return Pool(_read(builder, frame, _CONTEXT, POINTER), *offered)


def _offset(builder: ir.IRBuilder, start: Value, length: int) -> Value:
    return builder.gep(start, [INT64(length)], source_etype=BYTE)


def _read(builder: ir.IRBuilder, start: Value, offset: int, kind: ir.Type) -> Value:
    return builder.load(_offset(builder, start, offset), typ=kind)
