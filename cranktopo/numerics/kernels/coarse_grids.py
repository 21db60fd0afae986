"""Code of what is done on coarser grids: products with their stencils, and transfers between two grids.

Stencils have 27 blocks 3 x 3, of which 14 are stored, row by row of nodes along z. A row's blocks lie in one
piece of memory. They are read once, for what the row's nodes get from their later neighbours and for what
these get from them, and the next row is asked for meanwhile. Of two grids the coarser one has every second
node along each axis.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import product

import llvmlite.ir as ir

from cranktopo.numerics.kernels.ir_builder import INT64, Value, VectorCode
from cranktopo.numerics.kernels.plane_sweep import Grid, Layer, Pair

_TWO = INT64(2)


@dataclass(frozen=True)
class _Field:
    code: VectorCode
    start: Value
    nodes: Sequence[Value]

    def row(self, component: Value, i: Value, j: Value) -> Value:
        """Return the address of a row along z; components are counted through all cases."""
        code, (nx, ny, nz) = self.code, self.nodes
        plane = code.plus(code.times(component, nx), i)
        return code.at(self.start, code.times(code.plus(code.times(plane, ny), j), nz))

    def load(self, row: Value, k: Value, exists: Value | None = None) -> Value:
        """Return numbers from k on along z; 0 outside the field, and where the row does not exist."""
        code = self.code
        mask = code.first_lanes(code.plus(self.nodes[2], code.builder.neg(k)))
        return code.load(code.at(row, k), mask if exists is None else code.both(mask, exists))

    def store(self, vector: Value, row: Value, k: Value) -> None:
        """Write numbers from k on along z."""
        mask = self.code.first_lanes(self.code.plus(self.nodes[2], self.code.builder.neg(k)))
        self.code.store(vector, self.code.at(row, k), mask)


def write_restriction(code: VectorCode) -> None:
    """Write the transpose of the interpolation, on the coarse planes of nodes from `first` to before `last`.

    Inputs of the function: fine field; coarse field; cases, coarse nodes along x, y, z, part, first, last.
    """
    source, target, cases, *nodes, _, first, last = code.function.args
    fine = _Field(code, source, [code.plus(code.times(_TWO, n), -1) for n in nodes])
    coarse = _Field(code, target, nodes)
    with _rows(code, cases, (first, last), nodes) as (component, i, j, k):
        # From 2 k on, from a vector later, and the same from 2 k - 1 on.
        sums = [code.zero] * 4
        for di, dj in product((-1, 0, 1), repeat=2):
            sums = _added_row(code, sums, fine, component, (i, di), (j, dj), k)
        even, odd = (code.pick(sums[0], sums[1], list(range(n, 2 * code.width, 2))) for n in (0, 1))
        before = code.pick(sums[2], sums[3], list(range(0, 2 * code.width, 2)))
        sides = code.multiply(_all(code, 0.5), code.add(odd, before))
        coarse.store(code.add(even, sides), coarse.row(component, i, j), k)
    code.builder.ret_void()


def _added_row(
    code: VectorCode,
    sums: Sequence[Value],
    fine: _Field,
    component: Value,
    along_x: tuple[Value, int],
    along_y: tuple[Value, int],
    k: Value,
) -> list[Value]:
    """Sums with a row of fine nodes about a row of coarse ones, which it is so many steps away from."""
    builder = code.builder
    places = [code.plus(code.times(_TWO, n), step) for n, step in (along_x, along_y)]
    sides = [
        builder.and_(code.below(INT64(-1), n), code.below(n, size))
        for n, size in zip(places, fine.nodes[:2], strict=True)
    ]
    exists = builder.and_(*sides)
    row = fine.row(component, *places)
    weight = _all(code, 0.5 ** (abs(along_x[1]) + abs(along_y[1])))
    result = []
    for number, offset in enumerate((0, code.width, -1, code.width - 1)):
        start = code.plus(code.times(_TWO, k), offset)
        vector = fine.load(row, start, exists)
        if offset < 0:  # the first row has nothing before it
            at_start = builder.icmp_signed("==", k, INT64(0))
            vector = builder.select(
                builder.select(at_start, code.later_lanes(), code.all_lanes()), vector, code.zero
            )
        result.append(code.add(sums[number], code.multiply(weight, vector)))
    return result


def write_prolongation(code: VectorCode) -> None:
    """Write the interpolation, also added to a field, on the fine planes from `first` to before `last`.

    Inputs of the function: coarse field, fine field; the interpolation and, in the place of the fine field,
    the sum; cases, fine nodes along x, y, z, part, first, last.
    """
    source, field, target, total, cases, *nodes, _, first, last = code.function.args
    coarse = _Field(code, source, [code.builder.sdiv(code.plus(n, 1), _TWO) for n in nodes])
    found, before, after = (_Field(code, start, nodes) for start in (target, field, total))
    rows = [nodes[0], nodes[1], coarse.nodes[2]]
    with _rows(code, cases, (first, last), rows) as (component, i, j, k):
        near = [[code.builder.sdiv(code.plus(n, up), _TWO) for up in (0, 1)] for n in (i, j)]
        parents = [coarse.row(component, *place) for place in product(*near)]
        here, following = (_mean(code, coarse, parents, code.plus(k, step)) for step in (0, 1))
        between = code.multiply(_all(code, 0.5), code.add(here, following))
        row = before.row(component, i, j)
        row_found, row_after = found.row(component, i, j), after.row(component, i, j)
        for half in range(2):
            lanes = [lane for n in range(code.width // 2) for lane in (n, code.width + n)]
            vector = code.pick(here, between, [lane + half * code.width // 2 for lane in lanes])
            start = code.plus(code.times(_TWO, k), half * code.width)
            found.store(vector, row_found, start)
            after.store(code.add(before.load(row, start), vector), row_after, start)
    code.builder.ret_void()


def _mean(code: VectorCode, coarse: _Field, rows: Sequence[Value], k: Value) -> Value:
    total = code.zero
    for row in rows:
        total = code.add(total, coarse.load(row, k))
    return code.multiply(_all(code, 0.25), total)


@contextmanager
def _rows(
    code: VectorCode, cases: Value, planes: tuple[Value, Value], nodes: Sequence[Value]
) -> Iterator[tuple[Value, Value, Value, Value]]:
    with (
        code.loop(code.times(cases, INT64(3))) as component,
        code.loop(planes[1], start=planes[0]) as plane,
        code.loop(nodes[1]) as row,
        code.loop(nodes[2], step=code.width) as column,
    ):
        yield component.index, plane.index, row.index, column.index


def _all(code: VectorCode, number: float) -> ir.Constant:
    return ir.Constant(code.vector, [number] * code.width)


# A node itself and the half of its neighbours that come later; the rest of a symmetric operator follows.
OFFSETS = [offset for offset in product((-1, 0, 1), repeat=3) if offset >= (0, 0, 0)]
_LATER_ROWS = sorted({(i, j) for i, j, _ in OFFSETS} - {(0, 0)})


class Stencil:
    """Stencils of the nodes (nodes along x, along y, 14, 3, 3, nodes along z)."""

    arrays = 1
    all_cases_at_once = True  # for all cases a block is read once

    def couple(self, code: VectorCode, grid: Grid, arrays: Sequence[Value], layer: Layer) -> None:
        """Add forces of a plane and of the one after it that are due to the blocks of the plane."""
        length = code.times(INT64(9 * len(OFFSETS)), grid.nz)
        with code.loop(grid.ny) as row, code.loop(grid.nz, step=code.width) as nodes:
            number = code.plus(code.times(layer.number, grid.ny), row.index)
            blocks = code.at(arrays[0], code.times(number, length), nodes.index)
            vector = _Nodes(code, grid, blocks, row.index, nodes.index, layer.inside)
            vector.prefetch(length)
            with code.loop(layer.cases) as case:
                vector.write(layer.pair(case.index))


@dataclass(frozen=True)
class _Nodes:
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
        """Add what the nodes get from themselves and later neighbours, and these from them."""
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
        code = self.code
        mask = code.first_lanes(code.plus(self.grid.nz, code.builder.neg(self.k), -step))
        if step >= 0:
            return mask
        at_start = code.builder.icmp_signed("==", self.k, INT64(0))
        return code.builder.and_(mask, code.builder.select(at_start, code.later_lanes(), mask))

    def _exists(self, to: tuple[int, int]) -> Value:
        code, row = self.code, self.code.plus(self.row, to[1])
        exists = code.builder.and_(code.below(INT64(-1), row), code.below(row, self.grid.ny))
        return code.builder.and_(exists, self.inside) if to[0] else exists
