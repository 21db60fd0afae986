"""Compiling of programs that a test runs once or twice."""

from __future__ import annotations

QUICKLY = {"xla_backend_optimization_level": 0}
"""Options for `jax.jit`: without passes of LLVM that take longer here than what they make faster."""
