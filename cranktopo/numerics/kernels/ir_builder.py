"""Writing vector code: a thin layer over llvmlite's builder."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from types import SimpleNamespace
from typing import TypeAlias

import llvmlite.ir as ir

BYTE, INT32, INT64, BIT, POINTER = (
    ir.IntType(8),
    ir.IntType(32),
    ir.IntType(64),
    ir.IntType(1),
    ir.PointerType(),
)
Value: TypeAlias = ir.Value
_ZERO = INT64(0)

# Products and sums may become one instruction, as in XLA's programs; nothing else is reordered.
_FUSED = ("contract",)


class VectorCode:
    """Code of one function, with vectors of `width`; the builder stands where the next instruction goes."""

    def __init__(self, module: ir.Module, name: str, inputs: Sequence[ir.Type], precision: str, width: int):
        self.number = ir.FloatType() if precision == "float32" else ir.DoubleType()
        self.item_bytes = 4 if precision == "float32" else 8
        self.width = width
        self.vector = ir.VectorType(self.number, width)
        self.mask = ir.VectorType(BIT, width)
        self.zero = ir.Constant(self.vector, [0.0] * width)
        suffix = f"v{width}f{8 * self.item_bytes}.p0"
        memory = POINTER, INT32, self.mask
        self._load = declare(module, f"llvm.masked.load.{suffix}", self.vector, (*memory, self.vector))
        self._store = declare(module, f"llvm.masked.store.{suffix}", ir.VoidType(), (self.vector, *memory))
        self._fill = declare(module, "llvm.memset.p0.i64", ir.VoidType(), (POINTER, BYTE, INT64, BIT))
        self._copy = declare(module, "llvm.memcpy.p0.p0.i64", ir.VoidType(), (POINTER, POINTER, INT64, BIT))
        self._total = declare(
            module,
            f"llvm.vector.reduce.fadd.v{width}f{8 * self.item_bytes}",
            self.number,
            (self.number, self.vector),
        )
        self._fetch = declare(module, "llvm.prefetch.p0", ir.VoidType(), (POINTER, INT32, INT32, INT32))
        self.function = ir.Function(module, ir.FunctionType(ir.VoidType(), inputs), name)
        self.builder = ir.IRBuilder(self.function.append_basic_block())

    def add(self, a: Value, b: Value) -> Value:
        """Sum of two vectors."""
        return self.builder.fadd(a, b, flags=_FUSED)

    def subtract(self, a: Value, b: Value) -> Value:
        """Return the difference of two vectors."""
        return self.builder.fsub(a, b, flags=_FUSED)

    def multiply(self, a: Value, b: Value) -> Value:
        """Return the product of two vectors, number by number."""
        return self.builder.fmul(a, b, flags=_FUSED)

    def times(self, *factors: Value) -> Value:
        """Return the product of integers."""
        first, *others = factors
        for factor in others:
            first = self.builder.mul(first, factor)
        return first

    def plus(self, first: Value, *terms: Value | int) -> Value:
        """Sum of integers."""
        for term in terms:
            first = self.builder.add(first, INT64(term) if isinstance(term, int) else term)
        return first

    def at(self, start: Value, *numbers: Value | int) -> Value:
        """Return the address so many numbers after another."""
        offset = self.plus(INT64(0), *numbers)
        return self.builder.gep(start, [offset], source_etype=self.number)

    def load(self, address: Value, mask: Value) -> Value:
        """Return the vector at an address; 0 outside the mask, where nothing is read."""
        return self.builder.call(self._load, [address, INT32(self.item_bytes), mask, self.zero])

    def store(self, vector: Value, address: Value, mask: Value) -> None:
        """Write a vector; nothing outside the mask."""
        self.builder.call(self._store, [vector, address, INT32(self.item_bytes), mask])

    def spread(self, address: Value) -> Value:
        """Return the vector of one number at an address."""
        undefined = ir.Constant(self.vector, ir.Undefined)
        one = self.builder.insert_element(undefined, self.builder.load(address, typ=self.number), INT32(0))
        return self.pick(one, one, [0] * self.width)

    def both(self, mask: Value, condition: Value) -> Value:
        """Return a mask where a condition holds, else none of it."""
        return self.builder.select(condition, mask, ir.Constant(self.mask, [0] * self.width))

    def total(self, vector: Value) -> Value:
        """Sum of a vector's numbers, from the first on."""
        return self.builder.call(self._total, [ir.Constant(self.number, 0.0), vector])

    def below(self, a: Value, b: Value) -> Value:
        """Tell whether an integer is less than another."""
        return self.builder.icmp_signed("<", a, b)

    def prefetch(self, address: Value) -> None:
        """Ask for what is at an address, soon to be read once."""
        self.builder.call(self._fetch, [address, INT32(0), INT32(2), INT32(1)])

    def accumulate(self, vector: Value, address: Value, mask: Value) -> None:
        """Add a vector to what is there."""
        self.store(self.add(self.load(address, mask), vector), address, mask)

    def clear(self, address: Value, numbers: Value) -> None:
        """Set so many numbers to 0."""
        length = self.times(numbers, INT64(self.item_bytes))
        self.builder.call(self._fill, [address, BYTE(0), length, BIT(0)])

    def copy(self, source: Value, target: Value, numbers: Value) -> None:
        """Copy so many numbers."""
        length = self.times(numbers, INT64(self.item_bytes))
        self.builder.call(self._copy, [target, source, length, BIT(0)])

    def first_lanes(self, count: Value) -> Value:
        """Return the mask of so many numbers from the first; of all where there are not as many."""
        integers = ir.VectorType(INT64, self.width)
        undefined = ir.Constant(integers, ir.Undefined)
        one = self.builder.insert_element(undefined, count, INT32(0))
        everywhere = self.pick(one, one, [0] * self.width)
        return self.builder.icmp_signed("<", ir.Constant(integers, list(range(self.width))), everywhere)

    def later_lanes(self) -> Value:
        """Return the mask of all numbers but the first."""
        return ir.Constant(self.mask, [0] + [1] * (self.width - 1))

    def all_lanes(self) -> Value:
        """Return the mask of all numbers."""
        return ir.Constant(self.mask, [1] * self.width)

    def pick(self, a: Value, b: Value, lanes: list[int]) -> Value:
        """Return numbers of two vectors: lanes of `a` count from 0, those of `b` from `width`."""
        return self.builder.shuffle_vector(a, b, ir.Constant(ir.VectorType(INT32, len(lanes)), lanes))

    @contextmanager
    def loop(
        self, stop: Value, *, start: Value = _ZERO, step: int = 1, carried: Sequence[Value] = ()
    ) -> Iterator[SimpleNamespace]:
        """Run what is written inside for `index` from start to below stop.

        `values` are those carried from turn to turn, and after the loop the last ones; inside it, `following`
        is to be set to what the next turn gets.
        """
        builder, before = self.builder, self.builder.block
        head, body, after = (builder.append_basic_block() for _ in range(3))
        builder.branch(head)
        builder.position_at_end(head)
        phis = [builder.phi(value.type) for value in (start, *carried)]
        turn = SimpleNamespace(index=phis[0], values=phis[1:], following=phis[1:])
        builder.cbranch(builder.icmp_signed("<", turn.index, stop), body, after)
        builder.position_at_end(body)
        yield turn
        following = [builder.add(turn.index, INT64(step)), *turn.following]
        for phi, first, later in zip(phis, (start, *carried), following, strict=True):
            phi.add_incoming(first, before)
            phi.add_incoming(later, builder.block)
        builder.branch(head)
        builder.position_at_end(after)


def declare(module: ir.Module, name: str, result: ir.Type, inputs: Sequence[ir.Type]) -> ir.Function:
    """Return a function of LLVM or of the C library."""
    return module.globals.get(name) or ir.Function(module, ir.FunctionType(result, inputs), name)
