"""What the tests of the house ask of the package's source: each file is parsed and walked once for all."""

from __future__ import annotations

import ast
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import cranktopo
from tests.studies.house import array_aliases, question

PACKAGE = Path(cranktopo.__file__).resolve().parent
FILES = tuple(sorted(PACKAGE.rglob("*.py")))
OF_EXTRAS = {"cryptography", "dask", "distributed", "h5py", "pandas", "pyarrow", "pylife", "tornado"}
"""Packages that the core does without."""


@dataclass(frozen=True)
class Facts:
    """Facts of one file.

    Attributes:
        imports: dotted names that it imports, anywhere in it; `relative` tells whether one of them is.
        questions: lines of docstrings that ask.
        aliases: names for arrays of one type of numbers.
        calls: functions that it calls, as spelt, where that is a name or an attribute of one.
        classes: names of its classes, inner ones too.
    """

    imports: frozenset[str]
    relative: bool
    questions: tuple[int, ...]
    aliases: tuple[str, ...]
    calls: frozenset[str]
    classes: tuple[str, ...]


@cache
def facts(file: Path) -> Facts:
    """Return the facts of a file of the package."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    nodes = list(ast.walk(tree))
    return Facts(
        imports=frozenset(name for node in nodes for name in _imported(node)),
        relative=any(isinstance(node, ast.ImportFrom) and node.level for node in nodes),
        questions=tuple(node.lineno for node in nodes if isinstance(node, ast.Expr) and question(node)),
        aliases=tuple(array_aliases(tree)),
        calls=frozenset(_spelt(node.func) for node in nodes if isinstance(node, ast.Call)),
        classes=tuple(node.name for node in nodes if isinstance(node, ast.ClassDef)),
    )


def _imported(node: ast.AST) -> Iterator[str]:
    if isinstance(node, ast.ImportFrom):
        yield from (f"{node.module}.{alias.name}" for alias in node.names)
    elif isinstance(node, ast.Import):
        yield from (alias.name for alias in node.names)


def _spelt(function: ast.expr) -> str:
    if isinstance(function, ast.Attribute) and isinstance(function.value, ast.Name):
        return f"{function.value.id}.{function.attr}"
    return function.id if isinstance(function, ast.Name) else ""
