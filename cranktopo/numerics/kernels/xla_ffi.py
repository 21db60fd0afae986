"""The function that a compiled JAX program calls: reads XLA's call frame, and has the parts computed.

The parts are shared out to XLA's threads. Threads of its own a call would have to make each time, and the
system puts a new one as often as not on the core that the caller is on: a product then takes twice as long.
"""

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
from cranktopo.numerics.kernels.ir_builder import BYTE, INT32, INT64, POINTER, Value, declare

# What the interface offers for it, and of which kind that is.
_OFFERED = {
    "XLA_FFI_ThreadPool_Schedule": ir.PointerType(ir.FunctionType(POINTER, [POINTER])),
    "XLA_FFI_Error_Destroy": ir.PointerType(ir.FunctionType(ir.VoidType(), [POINTER])),
}
# Places in a job: next part to begin, parts that are done, and who may still look at it.
_NEXT, _DONE, _HOLDERS, _TASK = range(4)
_SPINS, _SLEEP_US = 100, 10


def _write_shared(
    builder: ir.IRBuilder, functions: Sequence[ir.Function], task: Sequence[Value], threads: int, frame: Value
) -> None:
    """Write a call of the functions once per part, the last by the caller and by as many threads as come.

    The caller takes part after part as the others do, and waits for none that has not begun: a pool that is
    busy, with programs that wait for theirs, holds nobody up. So a thread may find all done, and the job is
    kept until the last one has looked. A task lacks the part's number, its first plane and the one after its
    last.
    """
    module, (*before, kernel) = builder.module, functions
    for function in before:
        for number in range(threads):
            builder.call(function, [*task, INT64(number), *_planes(builder, task, INT64(number), threads)])
    job = ir.LiteralStructType([INT64] * _TASK + [value.type for value in task])
    work = _work(module, kernel, job, threads)
    release = _release(module, job)
    begin = _begin(module, work, release)
    begun = builder.call(declare(module, "malloc", POINTER, [INT64]), [INT64(8 * len(job.elements))])
    for place, value in enumerate((INT64(0), INT64(0), INT64(threads), *task)):
        builder.store(value, _at(builder, begun, job, place))
    offered = _read(builder, frame, POINTER, CallFrame, "api")
    schedule, destroy = (_read(builder, offered, kind, Api, name) for name, kind in _OFFERED.items())
    context = _read(builder, frame, POINTER, CallFrame, "ctx")
    for _ in range(threads - 1):
        error = _call_interface(builder, schedule, context, begin, begun)
        with builder.if_then(builder.icmp_unsigned("!=", error, ir.Constant(POINTER, None))):
            _call_interface(builder, destroy, error)
            builder.call(release, [begun])
    builder.call(work, [begun])
    _wait(builder, begun, job, threads)
    builder.call(release, [begun])


def _work(module: ir.Module, kernel: ir.Function, job: ir.Type, threads: int) -> ir.Function:
    function = ir.Function(module, ir.FunctionType(ir.VoidType(), [POINTER]), "work")
    start = function.args[0]
    entry, again, part, end = (function.append_basic_block() for _ in range(4))
    builder = ir.IRBuilder(entry)
    places = range(_TASK, len(job.elements))
    task = [builder.load(_at(builder, start, job, n), typ=job.elements[n]) for n in places]
    builder.branch(again)
    builder.position_at_end(again)
    number = _count(builder, start, job, _NEXT, 1)
    builder.cbranch(builder.icmp_signed("<", number, INT64(threads)), part, end)
    builder.position_at_end(part)
    builder.call(kernel, [*task, number, *_planes(builder, task, number, threads)])
    _count(builder, start, job, _DONE, 1)
    builder.branch(again)
    builder.position_at_end(end)
    builder.ret_void()
    return function


def _planes(builder: ir.IRBuilder, task: Sequence[Value], number: Value, threads: int) -> list[Value]:
    edges = number, builder.add(number, INT64(1))
    return [builder.sdiv(builder.mul(task[-3], edge), INT64(threads)) for edge in edges]


def _release(module: ir.Module, job: ir.Type) -> ir.Function:
    function = ir.Function(module, ir.FunctionType(ir.VoidType(), [POINTER]), "release")
    builder = ir.IRBuilder(function.append_basic_block())
    holders = _count(builder, function.args[0], job, _HOLDERS, -1)
    with builder.if_then(builder.icmp_signed("==", holders, INT64(1))):
        builder.call(declare(module, "free", ir.VoidType(), [POINTER]), [function.args[0]])
    builder.ret_void()
    return function


def _begin(module: ir.Module, work: ir.Function, release: ir.Function) -> ir.Function:
    function = ir.Function(module, ir.FunctionType(ir.VoidType(), [POINTER]), "begin")
    builder = ir.IRBuilder(function.append_basic_block())
    builder.call(work, function.args)
    builder.call(release, function.args)
    builder.ret_void()
    return function


def _wait(builder: ir.IRBuilder, start: Value, job: ir.Type, threads: int) -> None:
    """Until all parts are done: those that another thread has begun are about as long as the caller's.

    The system may have put that thread on the caller's core: the caller sleeps before long.
    """
    before = builder.block
    check, wait, spin, sleep, after = (builder.append_basic_block() for _ in range(5))
    builder.branch(check)
    builder.position_at_end(check)
    turns = builder.phi(INT64)
    done = builder.load_atomic(_at(builder, start, job, _DONE), "acquire", 8, typ=INT64)
    builder.cbranch(builder.icmp_signed("<", done, INT64(threads)), wait, after)
    builder.position_at_end(wait)
    more = builder.add(turns, INT64(1))
    builder.cbranch(builder.icmp_signed("<", turns, INT64(_SPINS)), spin, sleep)
    for block, function, arguments in ((spin, "sched_yield", []), (sleep, "usleep", [INT32(_SLEEP_US)])):
        builder.position_at_end(block)
        builder.call(declare(builder.module, function, INT32, [value.type for value in arguments]), arguments)
        builder.branch(check)
        turns.add_incoming(more, block)
    turns.add_incoming(INT64(0), before)
    builder.position_at_end(after)


def _call_interface(builder: ir.IRBuilder, function: Value, *arguments: Value) -> Value:
    """Result of a function of the interface: it takes its arguments in memory, behind size and extension."""
    kind = ir.LiteralStructType([INT64, POINTER, *(value.type for value in arguments)])
    none, packed = ir.Constant(POINTER, None), builder.alloca(kind)
    packed.type = POINTER  # llvmlite has one of the old kind
    for place, value in enumerate((INT64(8 * len(kind.elements)), none, *arguments)):
        builder.store(value, _at(builder, packed, kind, place))
    return builder.call(function, [packed])


def _count(builder: ir.IRBuilder, start: Value, job: ir.Type, place: int, step: int) -> Value:
    return builder.atomic_rmw("add", _at(builder, start, job, place), INT64(step), "acq_rel")


def _at(builder: ir.IRBuilder, start: Value, kind: ir.Type, place: int) -> Value:
    return builder.gep(start, [INT32(0), INT32(place)], source_etype=kind)


# Below so many numbers in the result sharing costs more than it saves.
LEAST_SHARED = 20_000


def write_handler(
    module: ir.Module, functions: Sequence[ir.Function], buffers: tuple[int, int], threads: int
) -> ir.Function:
    """Write the handler that calls one function after the other once per part of the planes of nodes along x.

    A function gets the addresses of its buffers, the number of cases, of nodes along x, y and z, the number
    of the part, its first plane and the one after its last. The first result has shape (cases, 3, nodes...).
    All but the last function take no time: the caller calls them itself. Buffers: of arguments and of
    results.
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
    with builder.if_else(shared) as (in_parts, alone):
        with in_parts:
            _write_shared(builder, functions, task, threads, frame)
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
    lists = [_read(builder, frame, POINTER, CallFrame, name, "buffers") for name in ("args", "rets")]
    found = [_load(builder, lists[k], 8 * n, POINTER) for k in (0, 1) for n in range(buffers[k])]
    sizes = _read(builder, found[buffers[0]], POINTER, Buffer, "dims")
    shape = [_load(builder, sizes, 8 * axis, INT64) for axis in (0, 2, 3, 4)]
    return [*(_read(builder, buffer, POINTER, Buffer, "data") for buffer in found), *shape]


def _read(
    builder: ir.IRBuilder, start: Value, kind: ir.Type, struct: type[ctypes.Structure], *path: str
) -> Value:
    return _load(builder, start, offset(struct, *path), kind)


def _load(builder: ir.IRBuilder, start: Value, length: int, kind: ir.Type) -> Value:
    return builder.load(_place(builder, start, length), typ=kind)


def _place(builder: ir.IRBuilder, start: Value, length: int) -> Value:
    return builder.gep(start, [INT64(length)], source_etype=BYTE)
