"""Code of the product with the stiffness on the finest grid: sums, blocks and sums back in registers."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

from cranktopo.numerics.kernels.ir_builder import INT64, Value, VectorCode
from cranktopo.numerics.kernels.parity_sums import ROWS, Cells, Waves, block_product
from cranktopo.numerics.kernels.plane_sweep import Grid, Layer, Pair


class StiffnessOperator:
    """Layers of cells: reflection blocks (8, 3, 3, cells along z) and moduli (cells...)."""

    arrays = 2
    together = False

    def couple(self, code: VectorCode, grid: Grid, arrays: Sequence[Value], layer: Layer) -> None:
        """Forces of a layer of cells on the planes on both sides of it, where there is one."""
        blocks, moduli = arrays
        cells = Cells(code.plus(grid.ny, -1), code.plus(grid.nz, -1), grid.nz, grid.plane)
        stiffness = code.at(moduli, code.times(layer.number, cells.ny, cells.nz))
        with (
            code.builder.if_then(layer.inside),
            code.loop(INT64(0), layer.cases, INT64(1)) as case,
            code.loop(INT64(0), cells.nz, INT64(code.width)) as column,
        ):
            _Column(code, cells, column.index, layer.pair(case.index)).write(blocks, stiffness)


class _Column:
    """A column of cells between two planes of nodes, `width` along z from k."""

    def __init__(self, code: VectorCode, grid: Cells, k: Value, pair: Pair):
        self._code, self._grid, self._k, self._pair = code, grid, k, pair
        self._waves = Waves(code, grid, k, pair.field)
        left, width = code.plus(grid.nz, code.builder.neg(k)), code.width
        self._nodes = code.first_lanes(code.plus(left, 1))
        # The last node of a full column lies in the vector after it.
        full = code.builder.icmp_signed(">=", left, INT64(width))
        self._beyond = code.first_lanes(code.builder.zext(full, INT64))

    def write(self, blocks: Value, moduli: Value) -> None:
        """All rows of cells, one after the other, adding to the forces on the nodes."""
        code, grid = self._code, self._grid
        waiting = [code.zero] * len(ROWS)
        with code.loop(INT64(0), grid.ny, INT64(1), (*self._waves.along_z(INT64(0)), *waiting)) as row:
            near, waiting = row.values[: len(ROWS)], row.values[len(ROWS) :]
            far = self._waves.along_z(code.plus(row.index, 1))
            place = code.times(row.index, grid.nz), self._k
            modulus = code.load(code.at(moduli, *place), self._waves.inside)
            self._ask_for_next(moduli, row.index)
            here, later = self._row_forces(near, far, blocks, modulus)
            self._add([code.add(a, b) for a, b in zip(here, waiting, strict=True)], row.index)
            row.following = (*far, *later)
        self._add(row.values[len(ROWS) :], grid.ny)

    def _ask_for_next(self, moduli: Value, row: Value) -> None:
        """What the next plane of cells reads: rows are too far apart for the processor to foresee it."""
        code, grid = self._code, self._grid
        code.prefetch(code.at(moduli, code.times(row, grid.nz), self._k, code.times(grid.ny, grid.nz)))
        for field in self._pair.field[1]:
            code.prefetch(code.at(field, code.times(row, grid.row), self._k, grid.plane))

    def _row_forces(
        self, near: list[Value], far: list[Value], blocks: Value, modulus: Value
    ) -> tuple[list[Value], list[Value]]:
        """What a row of cells gives to the nodes before and after it, as sums and differences along z."""
        code, along_y = self._code, {}
        classes = self._waves.classes(near, far)
        products = {
            (p, c): self._block(p, c, blocks, classes, modulus) for p, c in product(range(8), range(3))
        }
        for c, y, z in product(range(3), range(2), range(2)):
            pair = products[2 * y + z, c], products[4 + 2 * y + z, c]
            along_y[0, y, z, c], along_y[1, y, z, c] = _corners(code, *pair, c == 0)
        pairs = [_corners(code, along_y[x, 0, z, c], along_y[x, 1, z, c], c == 1) for x, c, z in ROWS]
        return [pair[0] for pair in pairs], [pair[1] for pair in pairs]

    def _block(
        self, p: int, c: int, blocks: Value, classes: dict[tuple[int, int], Value], modulus: Value
    ) -> Value:
        """Entry c of the 3 x 3 product of a parity class, times the modulus."""
        total = block_product(self._code, self._waves, blocks, classes, (p, c))
        return self._code.zero if total is None else self._code.multiply(total, modulus)

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


def _corners(code: VectorCode, first: Value, second: Value, own: bool) -> tuple[Value, Value]:
    """Return the transpose: what both waves give to the near and to the far corner."""
    near = code.subtract(second, first) if own else code.subtract(first, second)
    return near, code.add(first, second)
