"""Arrays by the type of their numbers; shapes stand where they are used."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Of 64-bit floating-point numbers."""
Complex = NDArray[np.complex128]
"""Of 128-bit complex numbers."""
Index = NDArray[np.intp]
"""Of positions in other arrays."""
