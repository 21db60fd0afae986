"""The function that a compiled JAX program calls: reads XLA's call frame, shares the planes out to threads.

Source: xla/ffi/api/c_api.h, which `jax.ffi.include_dir()` has; offsets are those of a 64-bit machine.
"""

from __future__ import annotations

from functools import reduce

import llvmlite.ir as ir

from cranktopo.fem.kernels.code import BYTE, INT32, INT64, POINTER, Value

# Offsets in bytes: of a call frame, of a buffer, and of what XLA asks to know first.
_EXTENSION, _ARGUMENTS, _RESULTS = 8, 72, 112
_DATA, _SIZES = 24, 40
_METADATA, _MAJOR, _MINOR = 24, 24, 28
# Below so many numbers in the result starting threads costs more than they save.
_LEAST_SHARED = 20_000


def write_handler(
    module: ir.Module, kernel: ir.Function, buffers: tuple[int, int], threads: int, version: tuple[int, int]
) -> ir.Function:
    """Handler that calls a kernel once per part of the planes of nodes along x.

    A kernel gets the addresses of its buffers, the number of cases, of nodes along x, y and z, the number of
    the part, its first plane and the one after its last. The first result has shape (cases, 3, nodes...).

    Args:
        buffers: number of arguments and of results.
        version: major and minor number of the interface.
    """
    handler = ir.Function(module, ir.FunctionType(POINTER, [POINTER]), "handler")
    frame = handler.args[0]
    builder = ir.IRBuilder(handler.append_basic_block())
    none = ir.Constant(POINTER, None)
    extension = _read(builder, frame, _EXTENSION, POINTER)
    with builder.if_then(builder.icmp_unsigned("!=", extension, none)):
        metadata = _read(builder, extension, _METADATA, POINTER)
        for place, number in zip((_MAJOR, _MINOR), version, strict=True):
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
            _share(module, builder, kernel, task, threads)
        with alone:
            builder.call(kernel, [*task, INT64(0), INT64(0), planes])
    builder.ret(none)
    return handler


def _task(builder: ir.IRBuilder, frame: Value, buffers: tuple[int, int]) -> list[Value]:
    """What every part of a call gets: addresses of all buffers, cases, nodes along x, y and z."""
    lists = [_read(builder, frame, place, POINTER) for place in (_ARGUMENTS, _RESULTS)]
    found = [_read(builder, lists[k], 8 * n, POINTER) for k in (0, 1) for n in range(buffers[k])]
    sizes = _read(builder, found[buffers[0]], _SIZES, POINTER)
    shape = [_read(builder, sizes, 8 * axis, INT64) for axis in (0, 2, 3, 4)]
    return [*(_read(builder, buffer, _DATA, POINTER) for buffer in found), *shape]


def _share(
    module: ir.Module, builder: ir.IRBuilder, kernel: ir.Function, task: list[Value], threads: int
) -> None:
    """A thread for each part but the last; the caller computes that, and any that gets no thread."""
    planes = task[-3]
    kinds = [value.type for value in task] + [INT64] * 3
    packed = ir.LiteralStructType(kinds)
    begin = _thread(module, kernel, packed)
    create = ir.Function(module, ir.FunctionType(INT32, [POINTER] * 4), "pthread_create")
    join = ir.Function(module, ir.FunctionType(INT32, [INT64, POINTER]), "pthread_join")
    none = ir.Constant(POINTER, None)
    parts = [_memory(builder, packed) for _ in range(threads)]
    names = [_memory(builder, INT64) for _ in range(threads - 1)]
    edges = [builder.sdiv(builder.mul(planes, INT64(n)), INT64(threads)) for n in range(threads + 1)]
    failures = []
    for number, part in enumerate(parts):
        for place, value in enumerate((*task, INT64(number), edges[number], edges[number + 1])):
            builder.store(value, builder.gep(part, [INT32(0), INT32(place)], source_etype=packed))
        if number < threads - 1:
            failures.append(builder.call(create, [names[number], none, begin, part]))
    builder.call(begin, [parts[-1]])
    for failure, name, part in zip(failures, names, parts, strict=False):
        with builder.if_else(builder.icmp_signed("==", failure, INT32(0))) as (started, refused):
            with started:
                builder.call(join, [builder.load(name, typ=INT64), none])
            with refused:
                builder.call(begin, [part])


def _thread(module: ir.Module, kernel: ir.Function, packed: ir.Type) -> ir.Function:
    """What a thread starts with: the kernel, its inputs read from memory."""
    begin = ir.Function(module, ir.FunctionType(POINTER, [POINTER]), "part")
    builder = ir.IRBuilder(begin.append_basic_block())
    places = range(len(packed.elements))
    addresses = [builder.gep(begin.args[0], [INT32(0), INT32(n)], source_etype=packed) for n in places]
    inputs = [builder.load(a, typ=kind) for a, kind in zip(addresses, packed.elements, strict=True)]
    builder.call(kernel, inputs)
    builder.ret(ir.Constant(POINTER, None))
    return begin


def _memory(builder: ir.IRBuilder, kind: ir.Type) -> Value:
    address = builder.alloca(kind)
    address.type = POINTER  # llvmlite has one of the old kind
    return address


def _offset(builder: ir.IRBuilder, start: Value, length: int) -> Value:
    return builder.gep(start, [INT64(length)], source_etype=BYTE)


def _read(builder: ir.IRBuilder, start: Value, offset: int, kind: ir.Type) -> Value:
    return builder.load(_offset(builder, start, offset), typ=kind)
