"""Imports between the parts of a source tree: floors, circles and arrows that point up."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterator
from pathlib import Path

PACKAGE = "cranktopo"
Trees = dict[str, ast.Module]  # by dotted name, that of a folder's __init__ ending in it
Arrows = dict[str, set[str]]


def read(root: Path) -> dict[str, str]:
    """Return the source of all modules by dotted name."""
    files = sorted((root / PACKAGE).rglob("*.py"))
    if not files:
        raise SystemExit(f"{root}: no folder {PACKAGE} with Python files")
    names = [".".join(file.relative_to(root).with_suffix("").parts) for file in files]
    return {name: file.read_text(encoding="utf-8") for name, file in zip(names, files, strict=True)}


def room(module: str) -> str:
    """Return the top-level room of a module."""
    return module.split(".")[1]


def folder(module: str) -> str:
    """Return the folder of a module."""
    return module.rpartition(".")[0]


def imports(module: str, tree: ast.Module) -> Iterator[str]:
    """Yield the dotted names that a module imports, at any place."""
    for node in ast.walk(tree):
        if isinstance(node, ast.ImportFrom):
            above = module.split(".")[: -node.level] if node.level else []
            stem = ".".join([*above, *([node.module] if node.module else [])])
            yield from (f"{stem}.{alias.name}" for alias in node.names)
        elif isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names)


def home(name: str, trees: Trees) -> str | None:
    """Return the module that holds a dotted name."""
    parts = name.split(".")
    for n in range(len(parts), 0, -1):
        for module in (".".join(parts[:n]), ".".join([*parts[:n], "__init__"])):
            if module in trees:
                return module
    return None


def arrows(trees: Trees, part: Callable[[str], str]) -> Arrows:
    """Return which other parts each part imports; the package's own `__init__` is none."""
    inside = {module: tree for module, tree in trees.items() if module != f"{PACKAGE}.__init__"}
    found: Arrows = {part(module): set() for module in inside}
    for module, tree in inside.items():
        homes = {home(name, trees) for name in imports(module, tree)} & inside.keys()
        found[part(module)] |= {part(other) for other in homes if other} - {part(module)}
    return found


def reached(links: Arrows) -> Arrows:
    """Return all parts that each part needs, directly or through others."""
    found: Arrows = {}
    for one in links:
        seen, waiting = set[str](), set(links[one])
        while waiting:
            seen.add(next_one := waiting.pop())
            waiting |= links[next_one] - seen
        found[one] = seen
    return found


def circles(links: Arrows) -> set[frozenset[str]]:
    """Return the largest groups of parts that need each other."""
    needs = reached(links)
    return {frozenset(b for b in needs[a] if a in needs[b]) for a in links if a in needs[a]}


def floors(links: Arrows) -> int:
    """Return the number of parts in the longest chain of arrows, a circle counting as one part."""
    needs, height = reached(links), dict[str, int]()
    for one in sorted(links, key=lambda a: len(needs[a] | {a})):
        height[one] = 1 + max((height[b] for b in needs[one] if one not in needs[b]), default=0)
    return max(height.values())


def upward(links: Arrows) -> int:
    """Count arrows that point up if the part with the fewest arrows to those left is always laid next."""
    left, up = set(links), 0
    while left:
        lowest = min(sorted(left), key=lambda a: len(links[a] & left))
        left.remove(lowest)
        up += len(links[lowest] & left)
    return up
