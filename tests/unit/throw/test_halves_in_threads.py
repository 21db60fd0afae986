"""Two threads integrate to the same bits as one."""

from __future__ import annotations

import math
import threading

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.throw.moments import integrate


def test_two_threads_find_what_one_finds() -> None:
    used = set[int]()

    def half_disk(y: Array) -> Array:
        used.add(threading.get_ident())
        chord = np.sqrt(np.maximum(1 - y**2, 0.0))
        kink = np.abs(y - 0.3)
        return np.stack([chord, chord * y + kink, kink, chord * y**2], axis=-1)

    breaks = np.array([-1.0, 0.0, 1.0])
    one = integrate(half_disk, breaks)
    assert len(used) == 1
    two = integrate(half_disk, breaks, threads=2)
    assert len(used) > 1
    np.testing.assert_array_equal(two, one, strict=True)
    np.testing.assert_allclose(two, [math.pi / 2, 1.09, 1.09, math.pi / 8], rtol=1e-9)
