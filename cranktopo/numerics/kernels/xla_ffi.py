"""The function that a compiled JAX program calls: reads XLA's call frame, and has the parts computed."""

from __future__ import annotations

import ctypes
from collections.abc import Sequence
from functools import reduce

import llvmlite.ir as ir

from cranktopo.numerics.kernels.frames import (
    METADATA,
    VERSION,
    Api,
    Buffer,
    CallFrame,
    Extension,
    Metadata,
    MetadataExtension,
    offset,
)
from cranktopo.numerics.kernels.ir_builder import BYTE, INT32, INT64, POINTER, Value
from cranktopo.numerics.kernels.work_sharing import OFFERED, Pool, write_shared

# Below so many numbers in the result sharing costs more than it saves.
LEAST_SHARED = 20_000


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
    _write_answer(builder, _read(builder, frame, POINTER, CallFrame, "extension_start"))
    task = _task(builder, frame, buffers)
    _, planes, _, _ = shape = task[-4:]
    numbers = reduce(builder.mul, shape, INT64(3))
    shared = builder.and_(
        builder.icmp_signed(">=", numbers, INT64(LEAST_SHARED)),
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


def _write_answer(builder: ir.IRBuilder, first: Value) -> None:
    """Code that ends the call with the version where one of the extensions, from the first on, asks for it.

    A call may be extended by others, and is then computed as ever.
    """
    before, none = builder.block, ir.Constant(POINTER, None)
    check, look, answer, following, after = (builder.append_basic_block() for _ in range(5))
    builder.branch(check)
    builder.position_at_end(check)
    extension = builder.phi(POINTER)
    builder.cbranch(builder.icmp_unsigned("!=", extension, none), look, after)
    builder.position_at_end(look)
    kind = _read(builder, extension, INT32, Extension, "type")
    builder.cbranch(builder.icmp_signed("==", kind, INT32(METADATA)), answer, following)
    builder.position_at_end(answer)
    metadata = _read(builder, extension, POINTER, MetadataExtension, "metadata")
    for name, number in zip(("major_version", "minor_version"), VERSION, strict=True):
        builder.store(INT32(number), _place(builder, metadata, offset(Metadata, "api_version", name)))
    builder.ret(none)
    builder.position_at_end(following)
    extension.add_incoming(first, before)
    extension.add_incoming(_read(builder, extension, POINTER, Extension, "next"), following)
    builder.branch(check)
    builder.position_at_end(after)


def _task(builder: ir.IRBuilder, frame: Value, buffers: tuple[int, int]) -> list[Value]:
    """Return what every part of a call gets: addresses of all buffers, cases, nodes along x, y and z."""
    lists = [_read(builder, frame, POINTER, CallFrame, name, "buffers") for name in ("args", "rets")]
    found = [_load(builder, lists[k], 8 * n, POINTER) for k in (0, 1) for n in range(buffers[k])]
    sizes = _read(builder, found[buffers[0]], POINTER, Buffer, "dims")
    shape = [_load(builder, sizes, 8 * axis, INT64) for axis in (0, 2, 3, 4)]
    return [*(_read(builder, buffer, POINTER, Buffer, "data") for buffer in found), *shape]


def _pool(builder: ir.IRBuilder, frame: Value) -> Pool:
    functions = _read(builder, frame, POINTER, CallFrame, "api")
    offered = (_read(builder, functions, kind, Api, name) for name, kind in OFFERED.items())
    return Pool(_read(builder, frame, POINTER, CallFrame, "ctx"), *offered)


def _read(
    builder: ir.IRBuilder, start: Value, kind: ir.Type, struct: type[ctypes.Structure], *path: str
) -> Value:
    """Field of a struct that begins at an address."""
    return _load(builder, start, offset(struct, *path), kind)


def _load(builder: ir.IRBuilder, start: Value, length: int, kind: ir.Type) -> Value:
    return builder.load(_place(builder, start, length), typ=kind)


def _place(builder: ir.IRBuilder, start: Value, length: int) -> Value:
    return builder.gep(start, [INT64(length)], source_etype=BYTE)
