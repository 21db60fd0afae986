"""Code of the product with stencils of 27 blocks 3 x 3, of which 14 are stored, row by row of nodes along z.

A row's blocks lie in one piece of memory. They are read once, for what the row's nodes get from their later
neighbours and for what these get from them, and the next row is asked for meanwhile.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

from cranktopo.numerics.kernels.ir_builder import INT64, Value, VectorCode
from cranktopo.numerics.kernels.plane_sweep import Grid, Layer, Pair

# A node itself and the half of its neighbours that come later; the rest of a symmetric operator follows.
OFFSETS = [offset for offset in product((-1, 0, 1), repeat=3) if offset >= (0, 0, 0)]
_LATER_ROWS = sorted({(i, j) for i, j, _ in OFFSETS} - {(0, 0)})


class Stencil:
    """Stencils of the nodes (nodes along x, along y, 14, 3, 3, nodes along z)."""

    arrays = 1
    together = True  # for all cases a block is read once

    def couple(self, code: VectorCode, grid: Grid, arrays: Sequence[Value], layer: Layer) -> None:
        """Forces of a plane and of the one after it that are due to the blocks of the plane."""
        length = code.times(INT64(9 * len(OFFSETS)), grid.nz)
        with (
            code.loop(INT64(0), grid.ny, INT64(1)) as row,
            code.loop(INT64(0), grid.nz, INT64(code.width)) as nodes,
        ):
            number = code.plus(code.times(layer.number, grid.ny), row.index)
            blocks = code.at(arrays[0], code.times(number, length), nodes.index)
            vector = _Nodes(code, grid, blocks, row.index, nodes.index, layer.inside)
            vector.prefetch(length)
            with code.loop(INT64(0), layer.cases, INT64(1)) as case:
                vector.write(layer.pair(case.index))


@dataclass(frozen=True)
class _Nodes:
    """A vector of nodes of a row, from k on, and where their blocks begin."""

    code: VectorCode
    grid: Grid
    blocks: Value
    row: Value
    k: Value
    inside: Value

    def prefetch(self, length: Value) -> None:
        """Ask for the same nodes of the next row."""
        for entry in range(9 * len(OFFSETS)):
            address = self.code.at(self.blocks, self.code.times(INT64(entry), self.grid.nz), length)
            self.code.prefetch(address)

    def write(self, pair: Pair) -> None:
        """What the nodes get from themselves and later neighbours, and these from them."""
        own = (0, 0)
        field = {step: self._vectors(pair.field, own, step) for step in (-1, 0, 1)}
        sums = self._vectors(pair.forces, own, 0)
        for i, j, k in OFFSETS:
            there = field[k] if (i, j) == own else self._vectors(pair.field, (i, j), k)
            sums = self._added(sums, (i, j, k), there, transposed=False)
        sums = self._added(sums, (0, 0, 1), field[-1], transposed=True)
        self._store(sums, pair.forces, own)
        for later in _LATER_ROWS:
            sums = self._vectors(pair.forces, later, 0)
            for step in (-1, 0, 1):
                sums = self._added(sums, (*later, step), field[-step], transposed=True)
            self._store(sums, pair.forces, later)

    def _added(
        self, sums: list[Value], offset: tuple[int, int, int], field: list[Value], transposed: bool
    ) -> list[Value]:
        """Sums plus blocks times displacements; transposed ones are those of the nodes before along z."""
        code, index = self.code, OFFSETS.index(offset)
        step = -offset[2] if transposed else 0
        mask = self._along(step)
        for c, d in product(range(3), repeat=2):
            row, column = (d, c) if transposed else (c, d)
            entry = code.times(INT64(9 * index + 3 * row + column), self.grid.nz)
            block = code.load(code.at(self.blocks, entry, step), mask)
            sums = [code.add(s, code.multiply(block, field[d])) if n == c else s for n, s in enumerate(sums)]
        return sums

    def _vectors(self, planes: tuple[Sequence[Value], ...], to: tuple[int, int], step: int) -> list[Value]:
        """Three components at nodes of a neighbouring row, so many on along z; 0 where there are none."""
        code = self.code
        mask = code.both(self._along(step), self._exists(to))
        return [code.load(code.at(address, step), mask) for address in self._addresses(planes, to)]

    def _store(self, sums: list[Value], planes: tuple[Sequence[Value], ...], to: tuple[int, int]) -> None:
        mask = self.code.both(self._along(0), self._exists(to))
        for value, address in zip(sums, self._addresses(planes, to), strict=True):
            self.code.store(value, address, mask)

    def _addresses(self, planes: tuple[Sequence[Value], ...], to: tuple[int, int]) -> list[Value]:
        row = self.code.times(self.code.plus(self.row, to[1]), self.grid.nz)
        return [self.code.at(address, row, self.k) for address in planes[to[0]]]

    def _along(self, step: int) -> Value:
        """Return which nodes have one so many on along z."""
        code = self.code
        mask = code.first_lanes(code.plus(self.grid.nz, code.builder.neg(self.k), -step))
        if step >= 0:
            return mask
        at_start = code.builder.icmp_signed("==", self.k, INT64(0))
        return code.builder.and_(mask, code.builder.select(at_start, code.later_lanes(), mask))

    def _exists(self, to: tuple[int, int]) -> Value:
        """Tell whether a neighbouring row does."""
        code, row = self.code, self.code.plus(self.row, to[1])
        exists = code.builder.and_(code.below(INT64(-1), row), code.below(row, self.grid.ny))
        return code.builder.and_(exists, self.inside) if to[0] else exists
