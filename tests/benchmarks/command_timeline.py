"""When the parts of a command run, in which thread: `python -m tests.benchmarks.command_timeline COMMAND...`.

One process, with its cache of compiled programs as it is. For each part the wall time at which it begins and
ends, the processor seconds of the process meanwhile (all threads), and those of its own thread: what the main
thread computes itself is the way that no second core shortens. Processor seconds hold on a busy machine, too.
"""

from __future__ import annotations

import functools
import importlib.util
import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec
from types import ModuleType
from typing import Any, NoReturn

_OPTIMISE, _FEA = "cranktopo.tasks.optimise", "cranktopo.tasks.throw_fea"
PARTS: dict[str, tuple[str, ...]] = {
    f"{_OPTIMISE}.stage": (
        "optimise_design",
        "prepare",
        "build_problem",
        "iterate",
        "_compiled",
        "_ready_for_the_end",
    ),
    f"{_OPTIMISE}.finalise": (
        "_write_design",
        "checked_surface",
        "run_surface",
        "_judged",
        "assess",
        "assess_original",
        "_bound",
        "model_for_result",
        "run_page",
        "write_report",
    ),
    f"{_FEA}.stage": ("resolve_targets", "evaluate_targets"),
    f"{_FEA}.evaluation": ("mesh_target", "_get_ready"),
    f"{_FEA}.throw_stiffness": ("assemble", "_blocks", "discretisation_errors"),
    "cranktopo.numerics.tetrahedra.solver": ("_load",),
    "cranktopo.tasks.density.loop": ("step",),
    "jax": (),
    "scipy.sparse": (),
    "trimesh": (),
}
"""Modules, whose import is a part, and those of their functions that are parts."""
_HEAD = (
    "\n| part | thread | begins s | ends s | CPU s, process | CPU s, own thread |\n|---|---|---|---|---|---|"
)


class _Rows:
    """Rows of the table, in the order of their begin."""

    def __init__(self) -> None:
        self._began = time.perf_counter() - time.process_time()  # about when the interpreter started
        self._rows: list[tuple[float, str]] = []

    def timed(self, name: str, function: Callable[..., Any]) -> Callable[..., Any]:
        """Return the function with a row for each of its calls."""

        @functools.wraps(function)
        def call(*arguments: Any, **named: Any) -> Any:
            began = self._now()
            try:
                return function(*arguments, **named)
            finally:
                self._add(name, began, self._now())

        return call

    def _now(self) -> tuple[float, float, float]:
        return time.perf_counter() - self._began, time.process_time(), time.thread_time()

    def _add(self, name: str, began: Sequence[float], ended: Sequence[float]) -> None:
        thread = "main" if threading.current_thread() is threading.main_thread() else "other"
        _, process, own = (b - a for a, b in zip(began, ended, strict=True))
        times = " | ".join(f"{seconds:.2f}" for seconds in (began[0], ended[0], process, own))
        self._rows.append((began[0], f"| {name} | {thread} | {times} |"))

    def print(self) -> None:
        """Print the table, and what the whole process took."""
        print(_HEAD)
        print("\n".join(text for _, text in sorted(self._rows)))
        wall, process, own = self._now()
        print(f"\n{wall:.2f} s; CPU s: {process:.2f}, of the main thread {own:.2f}; no second process in it")
        sys.stdout.flush()


class _Watching(MetaPathFinder):
    """Finds the modules of `PARTS` once, to time their import and their functions."""

    def __init__(self, rows: _Rows) -> None:
        self._rows, self._left = rows, dict(PARTS)

    def find_spec(self, name: str, path: Any, target: Any = None) -> ModuleSpec | None:
        """Return the usual place of a module, to be loaded with a clock beside it."""
        functions = self._left.pop(name, None)
        spec = None if functions is None else importlib.util.find_spec(name)
        if spec is None or spec.loader is None or functions is None:
            return None
        load = self._rows.timed(f"import {name}", spec.loader.exec_module)

        def loaded(module: ModuleType) -> None:
            load(module)
            for function in functions:
                setattr(module, function, self._rows.timed(function, getattr(module, function)))

        spec.loader.exec_module = loaded  # type: ignore[method-assign]
        return spec


def main() -> None:
    """Run a command in this process and print its timeline at its end."""
    rows = _Rows()
    sys.meta_path.insert(0, _Watching(rows))
    end = os._exit

    def tell(code: int) -> NoReturn:
        rows.print()
        end(code)

    os._exit = tell
    from cranktopo.app.launch import main as command

    command()


if __name__ == "__main__":
    main()
