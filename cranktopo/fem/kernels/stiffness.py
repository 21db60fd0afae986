"""Code of the product with the stiffness on the finest grid: sums, blocks and sums back in registers.

Cells of a plane are taken in columns of `width` along z, each from the first row of cells along y to the
last: sums over a row's nodes serve the rows of cells on both of its sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from cranktopo.fem.element import COUPLED
from cranktopo.fem.kernels.code import INT64, Value, VectorCode
from cranktopo.fem.kernels.planes import Grid, Layer, Pair

# What a row of nodes is known by: its plane (near or far along x), the component, the wave along z.
_ROWS = list(product(range(2), range(3), range(2)))


class Stiffness:
    """Layers of cells: reflection blocks (8, 3, 3, cells along z) and moduli (cells...)."""

    arrays = 2
    together = False

    def couple(self, code: VectorCode, grid: Grid, arrays: Sequence[Value], layer: Layer) -> None:
        """Forces of a layer of cells on the planes on both sides of it, where there is one."""
        blocks, moduli = arrays
        cells = _Cells(code.plus(grid.ny, -1), code.plus(grid.nz, -1), grid.nz, grid.plane)
        stiffness = code.at(moduli, code.times(layer.number, cells.ny, cells.nz))
        with (
            code.builder.if_then(layer.inside),
            code.loop(INT64(0), layer.cases, INT64(1)) as case,
            code.loop(INT64(0), cells.nz, INT64(code.width)) as column,
        ):
            _Column(code, cells, column.index, layer.pair(case.index)).write(blocks, stiffness)


@dataclass(frozen=True)
class _Cells:
    """Cells along y and z; numbers from a row and from a plane of nodes to the next."""

    ny: Value
    nz: Value
    row: Value
    plane: Value


class _Column:
    """A column of cells between two planes of nodes, `width` along z from k."""

    def __init__(self, code: VectorCode, grid: _Cells, k: Value, pair: Pair):
        self._code, self._grid, self._k, self._pair = code, grid, k, pair
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
        for field in self._pair.field[1]:
            code.prefetch(code.at(field, code.times(row, grid.row), self._k, grid.plane))

    def _sums(self, row: Value) -> list[Value]:
        """Sums and differences along z of a row of nodes, in the order of `_ROWS`."""
        code = self._code
        result: list[Value] = []
        for plane, c in product(self._pair.field, range(3)):
            address = code.at(plane[c], code.times(row, self._grid.row), self._k)
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
        for index, (plane, c) in enumerate(product(self._pair.forces, range(3))):
            near, far = _corners(code, sums[2 * index], sums[2 * index + 1], c == 2)
            address = code.at(plane[c], code.times(row, self._grid.row), self._k)
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
