"""Where processor time and memory of commands go: `python -m tests.benchmarks.command_parts [COMMAND...]`.

One process per command, on the default design: CPU seconds of each part in whatever thread it runs, without
those of parts inside it, and the memory that the process holds at its end, the most of all its calls.
"""

from __future__ import annotations

import importlib
import os
import resource
import subprocess
import sys
import tempfile
import threading
import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from typing import Any

import psutil

COMMANDS = ("evaluate mikron-iiic", "fatigue mikron-iiic", "shape mikron-iiic")
_TETRAHEDRA, _FEA, _SHAPE = (
    "cranktopo.numerics.tetrahedra",
    "cranktopo.tasks.throw_fea",
    "cranktopo.tasks.web_shape",
)
PARTS: dict[str, tuple[tuple[str, Sequence[str]], ...]] = {
    "mesh": (("cranktopo.bodies.mesh.solid_mesh", ("add_half_throw", "positive_x", "generate")),),
    "assembly": (
        (f"{_TETRAHEDRA}.elasticity", ("_add_elements",)),
        (f"{_TETRAHEDRA}.symmetric_blocks:Pattern", ("of",)),
        (f"{_TETRAHEDRA}.symmetric_blocks:BlockSum", ("matrix",)),
    ),
    "loads": ((f"{_TETRAHEDRA}.elasticity", ("load_points", "gathered")),),
    "factorisation": ((f"{_TETRAHEDRA}.solver", ("cholesky",)),),
    "largest eigenvalue": ((f"{_TETRAHEDRA}.solver", ("largest_eigenvalue",)),),
    "cycles": ((f"{_TETRAHEDRA}.solver", ("_conjugate_gradients",)),),
    "stress": (
        (f"{_TETRAHEDRA}.unit_stress", ("nodal_stress", "outer_surface", "surface_stress")),
        ("cranktopo.tasks.throw_fatigue.target_safety", ("safety_field",)),
    ),
    "error estimate": ((f"{_TETRAHEDRA}.hierarchical_error", ("_part", "_answered", "_added", "_volume")),),
    "moved mesh, gradients": (
        (f"{_TETRAHEDRA}.moved_mesh:MovedMesh", ("__init__", "velocities")),
        (f"{_SHAPE}.mesh_model:MeshModel", ("responses",)),
        (f"{_SHAPE}.mesh_stress:MeshStress", ("_through_field",)),
    ),
    "cells": (
        ("cranktopo.numerics.optimisers.dimension_search", ("minimise",)),
        (f"{_SHAPE}.stage", ("web_model",)),
    ),
    "bound": ((f"{_SHAPE}.run", ("bound_for_goal",)),),
    "writing": ((f"{_SHAPE}.run", ("_write", "_bodies", "shaped_undercuts", "shape_page", "write_report")),),
}
"""By part the functions whose time is its own. Threads of JAX count as all else."""
ELSE = "imports and all else"
_MIB = 2**20
_inner = threading.local()


def _timed(
    part: str, function: Callable[..., Any], spent: Counter[str], held: dict[str, float]
) -> Callable[..., Any]:
    process = psutil.Process()

    def timed(*given: Any, **named: Any) -> Any:
        outside, _inner.seconds = getattr(_inner, "seconds", 0.0), 0.0
        began = time.thread_time()
        try:
            return function(*given, **named)
        finally:
            whole = time.thread_time() - began
            spent[part] += whole - _inner.seconds
            _inner.seconds = outside + whole
            held[part] = max(held.get(part, 0.0), process.memory_info().rss / _MIB)

    return timed


def rows(command: str) -> str:
    """Two rows of the table, from this very process."""
    spent, held = Counter[str](), dict[str, float]()
    for part, places in PARTS.items():
        for place, names in places:
            module, _, inner = place.partition(":")
            if _SHAPE in module and not command.startswith("shape"):
                continue
            owner: Any = importlib.import_module(module)
            owner = getattr(owner, inner) if inner else owner
            for name in names:
                setattr(owner, name, _timed(part, getattr(owner, name), spent, held))
    from cranktopo.app.main import main as run

    with (
        open(os.devnull, "w", encoding="utf-8") as nowhere,
        redirect_stdout(nowhere),
        redirect_stderr(nowhere),
    ):
        run(command.split())
    used = resource.getrusage(resource.RUSAGE_SELF)
    total = used.ru_utime + used.ru_stime
    seconds = [*(spent[part] for part in PARTS), total - sum(spent.values()), total]
    memory = [f"{held[part]:.0f}" if part in held else "-" for part in PARTS]
    return (
        f"| `{command}`, CPU s | {' | '.join(f'{value:.1f}' for value in seconds)} |\n"
        f"| MiB | {' | '.join([*memory, '-', f'{used.ru_maxrss / 1024:.0f}'])} |"
    )


def main() -> None:
    """Print the table as Markdown."""
    if sys.argv[1:2] == ["--rows"]:
        print(rows(sys.argv[2]))
        return
    heads = ["command", *PARTS, ELSE, "all"]
    print(f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}", flush=True)
    here = os.environ | {"OPENBLAS_NUM_THREADS": "1", "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    for command in sys.argv[1:] or COMMANDS:
        own = [sys.executable, "-m", "tests.benchmarks.command_parts", "--rows", command]
        with tempfile.TemporaryDirectory() as folder:  # shape writes a run there
            told = subprocess.run(own, env=here, cwd=folder, stdout=subprocess.PIPE, text=True, check=True)
        print(told.stdout, end="", flush=True)


if __name__ == "__main__":
    main()
