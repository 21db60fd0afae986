"""The one place that touches JAX's settings: 64-bit numbers for a `with` block, and compile times."""

from __future__ import annotations

import time
from contextlib import AbstractContextManager


def double_precision() -> AbstractContextManager[object]:
    """Context in which JAX arrays may be float64.

    Reported numbers are computed inside it. Nothing is changed outside the block, so importing
    cranktopo never alters the precision of a user's own JAX program.
    """
    import jax

    context: AbstractContextManager[object] = jax.enable_x64(True)
    return context


class CompileClock:
    """Adds up the time that JAX spends on tracing and compiling from now on, in this process."""

    def __init__(self) -> None:
        import jax

        self.began = time.perf_counter()
        self.compile_s = 0.0
        jax.monitoring.register_event_duration_secs_listener(self._add)

    def _add(self, event: str, seconds: float, **_: str | int) -> None:
        if event.startswith("/jax/core/compile/"):
            self.compile_s += seconds
