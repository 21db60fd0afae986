"""Length of the way of a reader who follows one function of the package through the files that it calls.

Run with `python -m tests.studies.walk [ROOT ...]`, this repository by default. Functions are read from top
to bottom, depth first, each once; a call of a function or class of the package opens the file that has it,
down to DEPTH calls from the start. A return is a step back into a file that was left for another one; it
climbs where that other one stands in another room. Methods are not followed: their class is opened where an
object of it is made.
"""

from __future__ import annotations

import ast
import sys
from dataclasses import dataclass, field
from pathlib import Path

from tests.studies.house_arrows import PACKAGE, Trees, home, imports, read, room

START = "optimise_design"
DEPTH = 2
Definition = ast.FunctionDef | ast.ClassDef


@dataclass
class Walk:
    """The steps of a reader through the files of a source tree."""

    trees: Trees
    files: set[str] = field(default_factory=set)
    functions: set[tuple[str, str]] = field(default_factory=set)
    returns: int = 0
    climbs: int = 0

    def follow(self, module: str, name: str, depth: int) -> None:
        """Read a definition and whatever it calls that was not read before."""
        self.files.add(module)
        self.functions.add((module, name))
        found = definitions(self.trees[module])[name]
        if depth == 0 or isinstance(found, ast.ClassDef):
            return
        for other, called in self.calls(module, found):
            if (other, called) in self.functions:
                continue
            self.follow(other, called, depth - 1)
            if other != module:
                self.returns += 1
                self.climbs += room(other) != room(module)

    def calls(self, module: str, function: ast.FunctionDef) -> list[tuple[str, str]]:
        """Return modules and names of the package's definitions that a function calls, in reading order."""
        names = named(module, self.trees)
        found = [node.func for node in in_order(function) if isinstance(node, ast.Call)]
        targets = [
            names.get(ast.unparse(func)) for func in found if isinstance(func, ast.Name | ast.Attribute)
        ]
        return list(dict.fromkeys(target for target in targets if target))


def in_order(node: ast.AST) -> list[ast.AST]:
    """Return the parts of a syntax tree as a reader meets them."""
    return [part for child in ast.iter_child_nodes(node) for part in (child, *in_order(child))]


def definitions(tree: ast.Module) -> dict[str, Definition]:
    """Return the functions and classes of a module's own statements."""
    return {node.name: node for node in tree.body if isinstance(node, ast.FunctionDef | ast.ClassDef)}


def named(module: str, trees: Trees) -> dict[str, tuple[str, str]]:
    """Return module and name of what the words of a module mean, as `call` or `module.call`."""
    own = {name: (module, name) for name in definitions(trees[module])}
    for dotted in imports(module, trees[module]):
        if not dotted.startswith(f"{PACKAGE}.") or (found := home(dotted, trees)) is None:
            continue
        last = dotted.rpartition(".")[2]
        held = definitions(trees[found])
        own |= {last: (found, last)} if last in held else {f"{last}.{name}": (found, name) for name in held}
    return own


def counts(root: Path) -> dict[str, int]:
    """Return how many files, functions, returns and climbs the walk takes in a source tree."""
    trees = {name: ast.parse(source) for name, source in read(root).items()}
    starts = [name for name, tree in trees.items() if START in definitions(tree)]
    walk = Walk(trees)
    walk.follow(starts[0], START, DEPTH)
    return {
        "files": len(walk.files),
        "functions and classes": len(walk.functions),
        "returns to a file": walk.returns,
        "of these into another room": walk.climbs,
    }


def main(roots: list[Path]) -> None:
    """Print a line for each count, a column for each tree."""
    columns = [counts(root) for root in roots]
    for label in columns[0]:
        print(f"{label:<32}", *(f"{column[label]:>8}" for column in columns))


if __name__ == "__main__":
    main([Path(argument) for argument in sys.argv[1:]] or [Path(__file__).resolve().parents[2]])
