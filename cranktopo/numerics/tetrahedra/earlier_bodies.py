"""Fields and linear levels of bodies solved before on the same elements, with which the next solve begins."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.connections import Connections
from cranktopo.numerics.tetrahedra.symmetric_blocks import SymmetricBlocks

_DEPENDENT = 1e-10
"""Share of the largest energy below which a combination of the fields counts as zero."""
_BODIES = 2
"""Bodies whose fields are kept: two tell a straight drag, more cost as much as they save."""


class EarlierBodies:
    """Connections, fields and linear levels of a body while its mesh moves, these by what was held.

    Its equations are always over the same unknowns; a mesh with other elements asks for another of these.

    Attributes:
        connections: of these elements, once a body was assembled.
    """

    def __init__(self) -> None:
        self.connections: Connections | None = None
        self._fields: dict[bytes, list[Array]] = {}
        self._coarse: dict[bytes, Callable[[Array], Array]] = {}
        self._cycles: dict[bytes, int] = {}

    def start(self, matrix: SymmetricBlocks, held: NDArray[np.intp], loads: Array) -> Array | None:
        """Return the sum of the fields with the least error in energy for scaled loads (unknowns, k), if any.

        Loads and the answer are in the order of the rows of the scaled matrix.
        """
        known = self._fields.get(held.tobytes())
        if known is None:
            return None
        basis = matrix.root * np.hstack(known)[matrix.unknowns]
        basis /= np.linalg.norm(basis, axis=0)  # of unit loads and of moments, 1e11 apart
        image = np.zeros_like(basis)
        matrix.add_product(basis, image)
        energy = basis.T @ image
        values, ways = np.linalg.eigh((energy + energy.T) / 2)
        kept = values > _DEPENDENT * values[-1]
        shares = ways[:, kept] / values[kept] @ (ways[:, kept].T @ (basis.T @ loads))
        return np.asarray(basis @ shares)

    def keep(self, held: NDArray[np.intp], fields: Array) -> None:
        """Keep fields (unknowns, k), with what was held at zero."""
        self._fields[held.tobytes()] = [fields, *self._fields.get(held.tobytes(), [])[: _BODIES - 1]]

    def coarse_level(
        self, held: NDArray[np.intp], made: Callable[[], Callable[[Array], Array]]
    ) -> Callable[[Array], Array]:
        """Return the solver of the linear level that a body before had with the same held, else make it."""
        key = held.tobytes()
        if key not in self._coarse:
            self._coarse[key] = made()
        return self._coarse[key]

    def judge_coarse_level(self, held: NDArray[np.intp], cycles: int) -> None:
        """Have the next body make its own linear level where one took more cycles than the first body did."""
        if cycles > self._cycles.setdefault(held.tobytes(), cycles):
            self._coarse.pop(held.tobytes(), None)  # another solve of the same body may have said so
