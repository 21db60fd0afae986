"""Lengths of transforms against SciPy's."""

from __future__ import annotations

from scipy.fft import next_fast_len

from cranktopo.numerics.filters.density_filter import fast_length


def test_as_scipy_has_them() -> None:
    for least in (*range(1, 2000), 10**6 + 1, 2**31 + 1):
        assert fast_length(least) == next_fast_len(least, real=True)
