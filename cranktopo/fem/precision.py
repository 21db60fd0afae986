"""The one place that switches JAX to 64-bit numbers, for the length of a `with` block."""

from __future__ import annotations

from contextlib import AbstractContextManager


def double_precision() -> AbstractContextManager[object]:
    """Context in which JAX arrays may be float64.

    Reported numbers are computed inside it. Nothing is changed outside the block, so importing
    cranktopo never alters the precision of a user's own JAX program.
    """
    import jax

    context: AbstractContextManager[object] = jax.enable_x64(True)
    return context
