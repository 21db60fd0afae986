"""Where the processor time of commands goes: `python -m tests.benchmarks.command_parts [COMMAND...]`.

One process per command, on the default design: CPU seconds of each part in whatever thread it runs.
"""

from __future__ import annotations

import importlib
import os
import resource
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Sequence
from contextlib import redirect_stderr, redirect_stdout
from typing import Any

COMMANDS = ("evaluate mikron-iiic", "fatigue mikron-iiic")
_TETRAHEDRA, _FEA = "cranktopo.numerics.tetrahedra", "cranktopo.tasks.fea"
PARTS: dict[str, tuple[tuple[str, Sequence[str]], ...]] = {
    "mesh": (("cranktopo.bodies.mesh.solid_mesh", ("add_half_throw", "positive_x", "_generate")),),
    "assembly": (
        (f"{_TETRAHEDRA}.elasticity", ("_add_elements",)),
        (f"{_TETRAHEDRA}.symmetric_blocks:Pattern", ("__init__", "matrix")),
    ),
    "loads": ((f"{_TETRAHEDRA}.elasticity", ("_load_points", "_gathered")),),
    "factorisation": ((f"{_TETRAHEDRA}.solver", ("cholesky",)),),
    "largest eigenvalue": ((f"{_TETRAHEDRA}.solver", ("largest_eigenvalue",)),),
    "cycles": ((f"{_TETRAHEDRA}.solver", ("_conjugate_gradients",)),),
    "stress": ((f"{_TETRAHEDRA}.stress", ("nodal_stress", "_depth", "_jumps", "_normals")),),
    "error estimate": ((f"{_FEA}.discretisation_error", ("_part", "_answered", "_added", "_volume")),),
}
"""By part the functions whose time is its own: each runs in one thread, and none in another one."""
ELSE = "imports and all else"


def _timed(part: str, function: Callable[..., Any], spent: Counter[str]) -> Callable[..., Any]:
    def timed(*given: Any, **named: Any) -> Any:
        began = time.thread_time()
        try:
            return function(*given, **named)
        finally:
            spent[part] += time.thread_time() - began  # type: ignore[assignment]

    return timed


def row(command: str) -> str:
    """One row of the table, from this very process."""
    spent: Counter[str] = Counter()
    for part, places in PARTS.items():
        for place, names in places:
            module, _, inner = place.partition(":")
            owner: Any = importlib.import_module(module)
            owner = getattr(owner, inner) if inner else owner
            for name in names:
                setattr(owner, name, _timed(part, getattr(owner, name), spent))
    from cranktopo.app.main import main as run

    with (
        open(os.devnull, "w", encoding="utf-8") as nowhere,
        redirect_stdout(nowhere),
        redirect_stderr(nowhere),
    ):
        run(command.split())
    used = resource.getrusage(resource.RUSAGE_SELF)
    total = used.ru_utime + used.ru_stime
    parts = [*(spent[part] for part in PARTS), total - sum(spent.values()), total]
    return (
        f"| `{command}` | {' | '.join(f'{seconds:.1f}' for seconds in parts)} | {used.ru_maxrss / 1024:.0f} |"
    )


def main() -> None:
    """Print the table as Markdown."""
    if sys.argv[1:2] == ["--row"]:
        print(row(sys.argv[2]))
        return
    heads = ["command", *PARTS, ELSE, "CPU s", "peak MiB"]
    print(f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}", flush=True)
    here = os.environ | {"OPENBLAS_NUM_THREADS": "1"}
    for command in sys.argv[1:] or COMMANDS:
        own = [sys.executable, "-m", "tests.benchmarks.command_parts", "--row", command]
        print(
            subprocess.run(own, env=here, stdout=subprocess.PIPE, text=True, check=True).stdout,
            end="",
            flush=True,
        )


if __name__ == "__main__":
    main()
