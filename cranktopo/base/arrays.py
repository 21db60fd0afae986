"""Arrays by the type of their numbers; shapes stand where they are used."""

from __future__ import annotations

from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Of 64-bit floating-point numbers."""
Complex = NDArray[np.complex128]
"""Of 128-bit complex numbers."""
Index = NDArray[np.intp]
"""Of positions in other arrays."""
Mask = NDArray[np.bool_]
"""Of truth values, such as which cells or nodes are chosen."""
Int64 = NDArray[np.int64]
"""Of numbers of nodes, such as the corners of triangles and tetrahedra."""
Int32 = NDArray[np.int32]
"""Of labels, and of positions where a library takes no longer ones."""
Single = NDArray[np.float32]
"""Of 32-bit floating-point numbers."""


_Shared = TypeVar("_Shared", Array, Complex)


def shared(values: _Shared) -> _Shared:
    """Return values that nobody may change, as several have them."""
    values.setflags(write=False)
    return values


def mask_of(count: int, chosen: Index) -> Mask:
    """Return which positions in an array of so many are chosen."""
    mask = np.zeros(count, dtype=bool)
    mask[chosen] = True
    return mask


def all_but(count: int, left_out: Index) -> Index:
    """Return the positions in an array of so many that are not left out, rising."""
    return np.flatnonzero(~mask_of(count, left_out))
