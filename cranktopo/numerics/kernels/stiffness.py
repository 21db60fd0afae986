"""Code of the stiffness on the finest grid: its product with a field, and the strain energy of cells.

Sums and differences over the corners of cells stay in registers. Cells of a plane are taken in columns of
`width` along z, each from the first row of cells along y to the last: sums over a row's nodes serve the rows
of cells on both of its sides.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from cranktopo.numerics.grid.lattice import COUPLED
from cranktopo.numerics.kernels.ir_builder import INT64, Value, VectorCode
from cranktopo.numerics.kernels.plane_sweep import Grid, Layer, Pair, Planes

# What a row of nodes is known by: its plane (near or far along x), the component, the wave along z.
_ROWS = list(product(range(2), range(3), range(2)))
_Classes = dict[tuple[int, int], Value]
"""Waves of a row of cells by parity class and component, in the order of `parity_sums`."""


@dataclass(frozen=True)
class Cells:
    """Cells along y and z; numbers from a row and from a plane of nodes to the next."""

    ny: Value
    nz: Value
    row: Value
    plane: Value


class _Waves:
    """Sums and differences of displacements in a column of cells between two planes of nodes.

    Of `width` cells along z from `k` on those in the mask `inside` exist.
    """

    def __init__(self, code: VectorCode, cells: Cells, k: Value, field: tuple[Planes, Planes]):
        self._code, self.cells, self._field, self.k = code, cells, field, k
        self.inside = code.first_lanes(code.plus(cells.nz, code.builder.neg(k)))

    def along_z(self, row: Value) -> list[Value]:
        """Return those of a row of nodes, in the order of `_ROWS`."""
        code = self._code
        result: list[Value] = []
        for plane, c in product(self._field, range(3)):
            address = code.at(plane[c], code.times(row, self.cells.row), self.k)
            near, far = (code.load(code.at(address, step), self.inside) for step in (0, 1))
            result += _waves(code, near, far, c == 2)
        return result

    def classes(self, near: list[Value], far: list[Value]) -> _Classes:
        """Return those of the cells between two rows of nodes."""
        code, along_y, classes = self._code, {}, {}
        for (x, c, z), a, b in zip(_ROWS, near, far, strict=True):
            for y, wave in enumerate(_waves(code, a, b, c == 1)):
                along_y[x, y, z, c] = wave
        for c, y, z in product(range(3), range(2), range(2)):
            for x, wave in enumerate(_waves(code, along_y[0, y, z, c], along_y[1, y, z, c], c == 0)):
                classes[4 * x + 2 * y + z, c] = wave
        return classes


def _block_product(
    code: VectorCode, waves: _Waves, blocks: Value, classes: _Classes, entry: tuple[int, int]
) -> Value | None:
    """Return an entry (class, component) of the products of all parity classes; None where it is always 0."""
    (p, c), total = entry, None
    for d in np.flatnonzero(COUPLED[p, c]):
        place = code.times(INT64(int((3 * p + c) * 3 + d)), waves.cells.nz)
        term = code.multiply(code.load(code.at(blocks, place, waves.k), waves.inside), classes[p, int(d)])
        total = term if total is None else code.add(total, term)
    return total


def _waves(code: VectorCode, near: Value, far: Value, own: bool) -> tuple[Value, Value]:
    """Return both waves along an axis; along its own axis a component has them in the other order."""
    waves = code.add(far, near), code.subtract(far, near)
    return waves[::-1] if own else waves


class StiffnessOperator:
    """Layers of cells: reflection blocks (8, 3, 3, cells along z) and moduli (cells...)."""

    arrays = 2
    all_cases_at_once = False

    def couple(self, code: VectorCode, grid: Grid, arrays: Sequence[Value], layer: Layer) -> None:
        """Add the forces of a layer of cells to the planes on both sides of it, where there is one."""
        blocks, moduli = arrays
        cells = Cells(code.plus(grid.ny, -1), code.plus(grid.nz, -1), grid.nz, grid.plane)
        stiffness = code.at(moduli, code.times(layer.number, cells.ny, cells.nz))
        with (
            code.builder.if_then(layer.inside),
            code.loop(layer.cases) as case,
            code.loop(cells.nz, step=code.width) as column,
        ):
            _StiffnessColumn(code, cells, column.index, layer.pair(case.index)).write(blocks, stiffness)


class _StiffnessColumn:
    def __init__(self, code: VectorCode, grid: Cells, k: Value, pair: Pair):
        self._code, self._grid, self._k, self._pair = code, grid, k, pair
        self._waves = _Waves(code, grid, k, pair.field)
        left, width = code.plus(grid.nz, code.builder.neg(k)), code.width
        self._nodes = code.first_lanes(code.plus(left, 1))
        # The last node of a full column lies in the vector after it.
        full = code.builder.icmp_signed(">=", left, INT64(width))
        self._beyond = code.first_lanes(code.builder.zext(full, INT64))

    def write(self, blocks: Value, moduli: Value) -> None:
        """Write all rows of cells, one after the other, adding to the forces on the nodes."""
        code, grid = self._code, self._grid
        waiting = [code.zero] * len(_ROWS)
        with code.loop(grid.ny, carried=(*self._waves.along_z(INT64(0)), *waiting)) as row:
            near, waiting = row.values[: len(_ROWS)], row.values[len(_ROWS) :]
            far = self._waves.along_z(code.plus(row.index, 1))
            place = code.times(row.index, grid.nz), self._k
            modulus = code.load(code.at(moduli, *place), self._waves.inside)
            self._ask_for_next(moduli, row.index)
            here, later = self._row_forces(near, far, blocks, modulus)
            self._add([code.add(a, b) for a, b in zip(here, waiting, strict=True)], row.index)
            row.following = (*far, *later)
        self._add(row.values[len(_ROWS) :], grid.ny)

    def _ask_for_next(self, moduli: Value, row: Value) -> None:
        """Ask for what the next plane of cells reads: rows are too far apart for the processor to foresee."""
        code, grid = self._code, self._grid
        code.prefetch(code.at(moduli, code.times(row, grid.nz), self._k, code.times(grid.ny, grid.nz)))
        for field in self._pair.field[1]:
            code.prefetch(code.at(field, code.times(row, grid.row), self._k, grid.plane))

    def _row_forces(
        self, near: list[Value], far: list[Value], blocks: Value, modulus: Value
    ) -> tuple[list[Value], list[Value]]:
        code, along_y = self._code, {}
        classes = self._waves.classes(near, far)
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
        total = _block_product(self._code, self._waves, blocks, classes, (p, c))
        return self._code.zero if total is None else self._code.multiply(total, modulus)

    def _add(self, sums: list[Value], row: Value) -> None:
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


def write_energies(code: VectorCode) -> None:
    """Write v^T K_e u of the cells for unit modulus, from plane of cells `first` to before `last`.

    Inputs of the function: reflection blocks (8, 3, 3, cells along z); fields v and u (cases, 3, nodes...);
    energies (cases, 1, cells...); cases, cells along x, y, z, part, first, last.
    """
    blocks, left, right, target, cases, nx, ny, nz, _, first, last = code.function.args
    row = code.plus(nz, 1)
    cells = Cells(ny, nz, row, code.times(code.plus(ny, 1), row))
    with (
        code.loop(cases) as case,
        code.loop(last, start=first) as plane,
        code.loop(nz, step=code.width) as column,
    ):
        number = code.plus(code.times(case.index, nx), plane.index)
        energies = code.at(target, code.times(number, ny, nz), column.index)
        fields = [_layer(code, cells, start, nx, (case.index, plane.index)) for start in (left, right)]
        waves = [_Waves(code, cells, column.index, field) for field in fields]
        _write_column(code, blocks, waves, energies)
    code.builder.ret_void()


def _layer(
    code: VectorCode, cells: Cells, start: Value, nx: Value, place: tuple[Value, Value]
) -> tuple[Planes, Planes]:
    case, plane = place
    component = code.times(code.plus(nx, 1), cells.plane)
    planes = []
    for step in (0, 1):
        within = code.times(code.plus(plane, step), cells.plane)
        firsts = (code.times(code.plus(code.times(case, INT64(3)), c), component) for c in range(3))
        planes.append(tuple(code.at(start, offset, within) for offset in firsts))
    return planes[0], planes[1]


def _write_column(code: VectorCode, blocks: Value, waves: list[_Waves], energies: Value) -> None:
    cells, count = waves[0].cells, len(_ROWS)
    before = [wave for side in waves for wave in side.along_z(INT64(0))]
    with code.loop(cells.ny, carried=before) as row:
        after = [side.along_z(code.plus(row.index, 1)) for side in waves]
        known = row.values[:count], row.values[count:]
        left, right = (side.classes(near, far) for side, near, far in zip(waves, known, after, strict=True))
        energy = _energy(code, waves[1], blocks, left, right)
        code.store(energy, code.at(energies, code.times(row.index, cells.nz)), waves[0].inside)
        row.following = (*after[0], *after[1])


def _energy(code: VectorCode, waves: _Waves, blocks: Value, left: _Classes, right: _Classes) -> Value:
    energy = code.zero
    for entry in product(range(8), range(3)):
        force = _block_product(code, waves, blocks, right, entry)
        if force is not None:
            energy = code.add(energy, code.multiply(left[entry], force))
    return energy
