"""Code of the product with the stiffness on the finest grid: sums, blocks and sums back in registers.

Cells of a plane are taken in columns of `width` along z, each from the first row of cells along y to the
last: sums over a row's nodes serve the rows of cells on both of its sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from cranktopo.fem.element import COUPLED
from cranktopo.fem.kernels.code import INT64, Value, VectorCode

# What a row of nodes is known by: its plane (near or far along x), the component, the wave along z.
_ROWS = list(product(range(2), range(3), range(2)))


@dataclass(frozen=True)
class _Grid:
    """Sizes that the code computes with, in numbers: `row`, `plane` and `component` are those of a field."""

    ny: Value
    nz: Value
    row: Value
    plane: Value
    component: Value


def _grid(code: VectorCode, nodes: tuple[Value, Value, Value]) -> _Grid:
    """Sizes of a grid of so many nodes along x, y and z."""
    plane = code.times(nodes[1], nodes[2])
    return _Grid(
        ny=code.plus(nodes[1], -1),
        nz=code.plus(nodes[2], -1),
        row=nodes[2],
        plane=plane,
        component=code.times(nodes[0], plane),
    )


def write_product(code: VectorCode) -> None:
    """Forces on the planes of nodes from `first` to before `last` of every case.

    Inputs of the function: blocks, moduli, field, forces, spare planes (parts, 3, nodes along y, along z),
    cases, nodes along x, along y, along z, part, first, last. A part computes the cells on both sides of its
    planes, and leaves what belongs to a neighbour's plane in its spare ones, so that the number of parts does
    not change the result.
    """
    blocks, moduli, field, forces, spare, cases, nx, ny, nz, part, first, last = code.function.args
    grid = _grid(code, (nx, ny, nz))
    one = INT64(1)
    spare = code.at(spare, code.times(part, INT64(3), grid.plane))
    least, most = code.plus(first, -1), code.plus(nx, -1)
    start = code.builder.select(code.builder.icmp_signed("<", least, INT64(0)), INT64(0), least)
    stop = code.builder.select(code.builder.icmp_signed("<", last, most), last, most)
    with code.loop(INT64(0), cases, one) as case:
        offset = code.times(case.index, INT64(3), grid.component)
        u, f = code.at(field, offset), code.at(forces, offset)
        for c in range(3):
            begin = code.times(INT64(c), grid.component), code.times(first, grid.plane)
            code.clear(code.at(f, *begin), grid.plane)
        with code.loop(start, stop, one) as layer:
            i, after = layer.index, code.plus(layer.index, 1)
            outside = code.builder.icmp_signed("<", i, first), code.builder.icmp_signed(">=", after, last)
            ends: list[list[tuple[Value, Value]]] = [[], []]
            for x, c in product(range(2), range(3)):
                there = code.times(INT64(c), grid.component), code.times((i, after)[x], grid.plane)
                own, other = code.at(f, *there), code.at(spare, code.times(INT64(c), grid.plane))
                ends[x].append((code.at(u, *there), code.builder.select(outside[x], other, own)))
            for _, target in ends[1]:
                code.clear(target, grid.plane)
            stiffness = code.at(moduli, code.times(i, grid.ny, grid.nz))
            with code.loop(INT64(0), grid.nz, INT64(code.width)) as column:
                _Column(code, grid, column.index, ends).write(blocks, stiffness)
    code.builder.ret_void()


class _Column:
    """A column of cells between two planes of nodes, `width` along z from k."""

    def __init__(self, code: VectorCode, grid: _Grid, k: Value, ends: list[list[tuple[Value, Value]]]):
        self._code, self._grid, self._k, self._ends = code, grid, k, ends
        left, width = code.plus(grid.nz, code.builder.neg(k)), code.width
        self._cells = code.first_lanes(left)
        self._nodes = code.first_lanes(code.plus(left, 1))
        # The last node of a full column lies in the vector after it.
        full = code.builder.icmp_signed(">=", left, INT64(width))
        self._beyond = code.first_lanes(code.builder.zext(full, INT64))

    def write(self, blocks: Value, moduli: Value) -> None:
        """All rows of cells, one after the other, adding to the forces on the nodes."""
        code, grid = self._code, self._grid
        waiting = [code.zero] * len(_ROWS)
        with code.loop(INT64(0), grid.ny, INT64(1), (*self._sums(INT64(0)), *waiting)) as row:
            near, waiting = row.values[: len(_ROWS)], row.values[len(_ROWS) :]
            far = self._sums(code.plus(row.index, 1))
            place = code.times(row.index, grid.nz), self._k
            modulus = code.load(code.at(moduli, *place), self._cells)
            self._ask_for_next(moduli, row.index)
            here, later = self._row_forces(near, far, blocks, modulus)
            self._add([code.add(a, b) for a, b in zip(here, waiting, strict=True)], row.index)
            row.following = (*far, *later)
        self._add(row.values[len(_ROWS) :], grid.ny)

    def _ask_for_next(self, moduli: Value, row: Value) -> None:
        """What the next plane of cells reads: rows are too far apart for the processor to foresee it."""
        code, grid = self._code, self._grid
        code.prefetch(code.at(moduli, code.times(row, grid.nz), self._k, code.times(grid.ny, grid.nz)))
        for field, _ in self._ends[1]:
            code.prefetch(code.at(field, code.times(row, grid.row), self._k, grid.plane))

    def _sums(self, row: Value) -> list[Value]:
        """Sums and differences along z of a row of nodes, in the order of `_ROWS`."""
        code = self._code
        result: list[Value] = []
        for plane, c in product(self._ends, range(3)):
            address = code.at(plane[c][0], code.times(row, self._grid.row), self._k)
            near, far = (code.load(code.at(address, step), self._cells) for step in (0, 1))
            result += _waves(code, near, far, c == 2)
        return result

    def _row_forces(
        self, near: list[Value], far: list[Value], blocks: Value, modulus: Value
    ) -> tuple[list[Value], list[Value]]:
        """What a row of cells gives to the nodes before and after it, as sums and differences along z."""
        code, along_y, classes = self._code, {}, {}
        for (x, c, z), a, b in zip(_ROWS, near, far, strict=True):
            for y, wave in enumerate(_waves(code, a, b, c == 1)):
                along_y[x, y, z, c] = wave
        for c, y, z in product(range(3), range(2), range(2)):
            for x, wave in enumerate(_waves(code, along_y[0, y, z, c], along_y[1, y, z, c], c == 0)):
                classes[4 * x + 2 * y + z, c] = wave
        products = {
            (p, c): self._block(p, c, blocks, classes, modulus) for p, c in product(range(8), range(3))
        }
        for c, y, z in product(range(3), range(2), range(2)):
            pair = products[2 * y + z, c], products[4 + 2 * y + z, c]
            along_y[0, y, z, c], along_y[1, y, z, c] = _corners(code, *pair, c == 0)
        pairs = [_corners(code, along_y[x, 0, z, c], along_y[x, 1, z, c], c == 1) for x, c, z in _ROWS]
        return [pair[0] for pair in pairs], [pair[1] for pair in pairs]

    def _block(
        self, p: int, c: int, blocks: Value, classes: dict[tuple[int, int], Value], modulus: Value
    ) -> Value:
        """Entry c of the 3 x 3 product of a parity class, times the modulus."""
        code, total = self._code, None
        for d in np.flatnonzero(COUPLED[p, c]):
            address = code.at(blocks, code.times(INT64(int((3 * p + c) * 3 + d)), self._grid.nz), self._k)
            term = code.multiply(code.load(address, self._cells), classes[p, int(d)])
            total = term if total is None else code.add(total, term)
        return code.zero if total is None else code.multiply(total, modulus)

    def _add(self, sums: list[Value], row: Value) -> None:
        """Add what a row of nodes has gathered to its forces."""
        code, width = self._code, self._code.width
        for index, (plane, c) in enumerate(product(self._ends, range(3))):
            near, far = _corners(code, sums[2 * index], sums[2 * index + 1], c == 2)
            address = code.at(plane[c][1], code.times(row, self._grid.row), self._k)
            shifted = code.pick(code.zero, far, list(range(width - 1, 2 * width - 1)))
            code.accumulate(code.add(near, shifted), address, self._nodes)
            end = code.pick(code.zero, far, [2 * width - 1, *range(width - 1)])
            code.accumulate(end, code.at(address, width), self._beyond)


def _waves(code: VectorCode, near: Value, far: Value, own: bool) -> tuple[Value, Value]:
    """Both waves along an axis; along its own axis a component has them in the other order."""
    waves = code.add(far, near), code.subtract(far, near)
    return waves[::-1] if own else waves


def _corners(code: VectorCode, first: Value, second: Value, own: bool) -> tuple[Value, Value]:
    """The transpose: what both waves give to the near and to the far corner."""
    near = code.subtract(second, first) if own else code.subtract(first, second)
    return near, code.add(first, second)
