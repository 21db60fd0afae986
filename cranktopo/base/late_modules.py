"""Modules that libraries import whole and hardly anybody uses: loaded when somebody does."""

from __future__ import annotations

import sys
from collections.abc import Sequence
from importlib.abc import MetaPathFinder
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import LazyLoader
from types import ModuleType

_LATE = frozenset({"numpy.f2py"})
"""SciPy copies all names of NumPy; behind this one is a parser of Fortran, a twentieth of `evaluate`."""


class _Late(MetaPathFinder):
    def find_spec(
        self, name: str, path: Sequence[str] | None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        spec = PathFinder.find_spec(name, path) if name in _LATE else None
        if spec is not None and spec.loader is not None:
            spec.loader = LazyLoader(spec.loader)
        return spec


def load_late() -> None:
    """Have them loaded when they are used, from now on; for processes of our own, before NumPy begins."""
    sys.meta_path.insert(0, _Late())
