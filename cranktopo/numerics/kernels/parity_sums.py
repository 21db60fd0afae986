"""Code for the sums and differences over the corners of cells, which their stiffness is made of.

Cells of a plane are taken in columns of `width` along z, each from the first row of cells along y to the
last: sums over a row's nodes serve the rows of cells on both of its sides.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import product

import numpy as np

from cranktopo.numerics.grid.element import COUPLED
from cranktopo.numerics.kernels.ir_builder import INT64, Value, VectorCode
from cranktopo.numerics.kernels.plane_sweep import Planes

# What a row of nodes is known by: its plane (near or far along x), the component, the wave along z.
ROWS = list(product(range(2), range(3), range(2)))
Classes = dict[tuple[int, int], Value]
"""Waves of a row of cells by parity class and component, as `operator.py` has them."""


@dataclass(frozen=True)
class Cells:
    """Cells along y and z; numbers from a row and from a plane of nodes to the next."""

    ny: Value
    nz: Value
    row: Value
    plane: Value


class Waves:
    """Sums and differences of displacements in a column of cells between two planes of nodes.

    Attributes:
        k: first of the `width` cells along z.
        inside: mask of those that exist.
    """

    def __init__(self, code: VectorCode, cells: Cells, k: Value, field: tuple[Planes, Planes]):
        self._code, self.cells, self._field, self.k = code, cells, field, k
        self.inside = code.first_lanes(code.plus(cells.nz, code.builder.neg(k)))

    def along_z(self, row: Value) -> list[Value]:
        """Return those of a row of nodes, in the order of `ROWS`."""
        code = self._code
        result: list[Value] = []
        for plane, c in product(self._field, range(3)):
            address = code.at(plane[c], code.times(row, self.cells.row), self.k)
            near, far = (code.load(code.at(address, step), self.inside) for step in (0, 1))
            result += _waves(code, near, far, c == 2)
        return result

    def classes(self, near: list[Value], far: list[Value]) -> Classes:
        """Return those of the cells between two rows of nodes."""
        code, along_y, classes = self._code, {}, {}
        for (x, c, z), a, b in zip(ROWS, near, far, strict=True):
            for y, wave in enumerate(_waves(code, a, b, c == 1)):
                along_y[x, y, z, c] = wave
        for c, y, z in product(range(3), range(2), range(2)):
            for x, wave in enumerate(_waves(code, along_y[0, y, z, c], along_y[1, y, z, c], c == 0)):
                classes[4 * x + 2 * y + z, c] = wave
        return classes


def block_product(
    code: VectorCode, waves: Waves, blocks: Value, classes: Classes, entry: tuple[int, int]
) -> Value | None:
    """Entry (class, component) of the 3 x 3 products of all parity classes; None where it is always 0."""
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
