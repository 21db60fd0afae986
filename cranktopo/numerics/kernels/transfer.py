"""Code of the transfers between a grid and a coarser one that has every second node along each axis."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import product

import llvmlite.ir as ir

from cranktopo.numerics.kernels.ir_builder import INT64, Value, VectorCode

_TWO = INT64(2)


@dataclass(frozen=True)
class _Field:
    """A field (cases, 3, nodes...): its address and the nodes per axis."""

    code: VectorCode
    start: Value
    nodes: Sequence[Value]

    def row(self, component: Value, i: Value, j: Value) -> Value:
        """Address of a row along z; components are counted through all cases."""
        code, (nx, ny, nz) = self.code, self.nodes
        plane = code.plus(code.times(component, nx), i)
        return code.at(self.start, code.times(code.plus(code.times(plane, ny), j), nz))

    def load(self, row: Value, k: Value, exists: Value | None = None) -> Value:
        """Numbers from k on along z; 0 outside the field, and where the row does not exist."""
        code = self.code
        mask = code.first_lanes(code.plus(self.nodes[2], code.builder.neg(k)))
        return code.load(code.at(row, k), mask if exists is None else code.both(mask, exists))

    def store(self, vector: Value, row: Value, k: Value) -> None:
        """Write numbers from k on along z."""
        mask = self.code.first_lanes(self.code.plus(self.nodes[2], self.code.builder.neg(k)))
        self.code.store(vector, self.code.at(row, k), mask)


def write_restriction(code: VectorCode) -> None:
    """Transpose of the interpolation, on the coarse planes of nodes from `first` to before `last`.

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
    """Trilinear interpolation, also added to a field, on the fine planes from `first` to before `last`.

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
    """Mean of four rows from k on."""
    total = code.zero
    for row in rows:
        total = code.add(total, coarse.load(row, k))
    return code.multiply(_all(code, 0.25), total)


@contextmanager
def _rows(
    code: VectorCode, cases: Value, planes: tuple[Value, Value], nodes: Sequence[Value]
) -> Iterator[tuple[Value, Value, Value, Value]]:
    """Component, plane, row and first node of every vector of some planes."""
    one, zero = INT64(1), INT64(0)
    with (
        code.loop(zero, code.times(cases, INT64(3)), one) as component,
        code.loop(planes[0], planes[1], one) as plane,
        code.loop(zero, nodes[1], one) as row,
        code.loop(zero, nodes[2], INT64(code.width)) as column,
    ):
        yield component.index, plane.index, row.index, column.index


def _all(code: VectorCode, number: float) -> ir.Constant:
    return ir.Constant(code.vector, [number] * code.width)
