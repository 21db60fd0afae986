"""Solves in two Python threads, as beside a run that still iterates, do not wait for each other for ever."""

from __future__ import annotations

import subprocess
import sys

import pytest

_PROGRAM = """
import os, threading
import jax

from cranktopo.numerics.grid.multigrid import build_hierarchy
from cranktopo.numerics.precision import double_precision
from tests.studies.parts import lopsided

def work(cells):
    with double_precision():
        tables, system = lopsided(cells)
        for _ in range(100):
            built = build_hierarchy(tables, system.supports, system.moduli, precision="float32")
            jax.block_until_ready(built)

threads = [threading.Thread(target=work, args=(cells,), daemon=True) for cells in ((8, 20, 10), (8, 20, 12))]
for thread in threads:
    thread.start()
for thread in threads:
    thread.join(60)
os._exit(sum(thread.is_alive() for thread in threads))
"""


@pytest.mark.slow
def test_hierarchies_of_two_threads() -> None:
    """jaxlib 0.10.2 hangs here where the coarsest matrices of both load cases are factorised side by side."""
    done = subprocess.run([sys.executable, "-c", _PROGRAM], check=False)
    assert done.returncode == 0
