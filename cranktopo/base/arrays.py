"""Arrays by the type of their numbers; shapes stand where they are used."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
"""Of 64-bit floating-point numbers."""
