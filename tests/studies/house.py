"""Counts that describe a source tree of the package, whatever its layout: one column for each tree.

Run with `python -m tests.studies.house [ROOT ...]`, this repository by default. Rooms are the folders and
modules directly below the package. An arrow is an import of one part by another, at any place of a file.
Report code has one of the words of REPORT in its path. A file is about a topic if the topic is a word of its
path or of more than 3 different names in it, as TOPICS spells it: "balancer" counts, "unbalance" does not.
"""

from __future__ import annotations

import ast
import re
import sys
from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from statistics import median
from typing import TypeVar

from tests.studies import walk
from tests.studies.house_arrows import PACKAGE, Trees, arrows, circles, floors, folder, read, room, upward

REPORT = {"report", "page", "pages", "text", "table", "tables", "figures", "plot", "plots", "picture"}
TOPICS = {"vibration": r"vibrat\w*", "balance": r"balanc\w*", "bound": r"bounds?"}
QUESTIONS = {"What", "Whether", "How", "Which", "Where"}
ALIAS = re.compile(r"(np\.|numpy\.)?(NDArray|ndarray)\b|Array$")
LOOSE = "dict[str, Any]"
SHORT_MODULE, SHORT_FUNCTION, LONG_FUNCTION, NAMES_OF_A_TOPIC = 40, 15, 60, 3
Counts = dict[str, str]
Node = TypeVar("Node", bound=ast.AST)


def words(text: str) -> set[str]:
    """Return the words of a dotted path or a name, in small letters."""
    return {word.lower() for word in re.findall(r"[A-Z]?[a-z]+|[A-Z]+", text)}


def has_word(text: str, pattern: str) -> bool:
    """Tell whether a word of a dotted path or a name is spelt like this."""
    return any(re.fullmatch(pattern, word) for word in words(text))


def public_names(tree: ast.Module, kinds: tuple[type[ast.AST], ...]) -> Iterator[str]:
    """Yield names of a module's own statements of these kinds that do not start with an underscore."""
    for node in tree.body:
        if not isinstance(node, kinds):
            continue
        targets = node.targets if isinstance(node, ast.Assign) else [getattr(node, "target", node)]
        parts = [part for target in targets for part in (target, *getattr(target, "elts", ()))]
        names = [getattr(part, "id", getattr(part, "name", "_")) for part in parts]
        yield from (name for name in names if not name.startswith("_"))


def several(names: Iterable[Iterable[str]]) -> int:
    """Count names that more than one module has."""
    return sum(count > 1 for count in Counter(name for of_one in names for name in set(of_one)).values())


def of_kind(trees: Iterable[ast.AST], kind: type[Node]) -> list[Node]:
    """Return all statements and expressions of a kind."""
    return [node for tree in trees for node in ast.walk(tree) if isinstance(node, kind)]


def keys(trees: Iterable[ast.AST]) -> int:
    """Count subscripts with a constant string, such as `metrics["mass_kg"]`; `Literal["box"]` is a type."""
    found = [node for node in of_kind(trees, ast.Subscript) if ast.unparse(node.value) != "Literal"]
    return sum(isinstance(getattr(node.slice, "value", None), str) for node in found)


def loose_annotations(trees: Iterable[ast.AST]) -> tuple[int, int]:
    """Count `dict[str, Any]` in annotations, spelt out and by another name."""
    nodes = of_kind(trees, ast.AST)
    assigned = [node for node in nodes if isinstance(node, ast.Assign) and ast.unparse(node.value) == LOOSE]
    others = {ast.unparse(target) for node in assigned for target in node.targets}
    whole = [getattr(node, name, None) for node in nodes for name in ("annotation", "returns")]
    parts = [ast.unparse(part) for part in of_kind((one for one in whole if one), ast.expr)]
    return parts.count(LOOSE), sum(part in others for part in parts)


def array_aliases(tree: ast.Module) -> list[str]:
    """Return names of a module that stand for an array of one type of numbers and nothing more."""
    made = [node for node in tree.body if isinstance(node, ast.Assign | ast.AnnAssign) and node.value]
    return [ast.unparse(node) for node in made if ALIAS.match(ast.unparse(node.value or node))]


def question(node: ast.Expr) -> bool:
    """Tell whether a statement is a docstring that begins like a question."""
    text = getattr(node.value, "value", None)
    return isinstance(text, str) and bool(QUESTIONS & set(re.findall(r"\w+", text)[:1]))


def about(topic: str, module: str, tree: ast.Module) -> bool:
    """Tell whether a file is about a topic."""
    names = {getattr(node, key, None) for node in ast.walk(tree) for key in ("id", "attr", "arg", "name")}
    of_topic = [name for name in names if isinstance(name, str) and has_word(name, TOPICS[topic])]
    return has_word(module, TOPICS[topic]) or len(of_topic) > NAMES_OF_A_TOPIC


def sizes(sources: dict[str, str], trees: Trees) -> Counts:
    """Return numbers of files, lines and functions."""
    lines = {name: len(source.splitlines()) for name, source in sources.items()}
    functions = [
        (node.end_lineno or 0) - node.lineno + 1 for node in of_kind(trees.values(), ast.FunctionDef)
    ]
    short = [name for name in lines if lines[name] < SHORT_MODULE and not name.endswith(".__init__")]
    return {
        "files": f"{len(lines)}",
        "folders": f"{len({folder(name) for name in lines})}",
        "lines": f"{sum(lines.values())}",
        f"modules under {SHORT_MODULE} lines, __init__ apart": f"{len(short)}",
        "functions": f"{len(functions)}",
        "lines of a function, median": f"{median(functions):g}",
        f"functions over {SHORT_FUNCTION} lines": f"{sum(n > SHORT_FUNCTION for n in functions)}",
        f"functions over {LONG_FUNCTION} lines": f"{sum(n > LONG_FUNCTION for n in functions)}",
    }


def names(trees: Trees) -> Counts:
    """Return numbers of classes and public names, and of those with several meanings."""
    classes = [[node.name for node in of_kind([tree], ast.ClassDef)] for tree in trees.values()]
    functions = [set(public_names(tree, (ast.FunctionDef,))) for tree in trees.values()]
    kinds = (ast.FunctionDef, ast.ClassDef, ast.Assign, ast.AnnAssign)
    return {
        "classes": f"{sum(map(len, classes))}",
        "class names in several modules": f"{several(classes)}",
        "public names": f"{sum(len(set(public_names(tree, kinds))) for tree in trees.values())}",
        "public function names in several modules": f"{several(functions)}",
    }


def style(trees: Trees) -> Counts:
    """Return numbers of loose types, vague names and questions."""
    report = [tree for name, tree in trees.items() if words(name) & REPORT]
    loose, by_name = loose_annotations(trees.values())
    aliases = [array_aliases(tree) for name, tree in trees.items() if not name.endswith("base.arrays")]
    arguments = Counter(node.arg for node in of_kind(trees.values(), ast.arg))
    decorators = [ast.unparse(d) for c in of_kind(trees.values(), ast.ClassDef) for d in c.decorator_list]
    data = [text for text in decorators if text.split("(")[0].split(".")[-1] == "dataclass"]
    return {
        "string subscripts": f"{keys(trees.values())}",
        "string subscripts in report code": f"{keys(report)}",
        "files of report code": f"{len(report)}",
        f"{LOOSE} in annotations": f"{loose}",
        f"{LOOSE} in annotations by another name": f"{by_name}",
        "names of array types outside base/arrays.py": f"{sum(map(len, aliases))}",
        "parameters called info": f"{arguments['info']}",
        "parameters called progress": f"{arguments['progress']}",
        "docstrings that begin like a question": f"{sum(map(question, of_kind(trees.values(), ast.Expr)))}",
        "dataclasses, frozen of all": f"{sum('frozen=True' in text for text in data)} of {len(data)}",
    }


def imports(trees: Trees) -> Counts:
    """Return numbers of rooms, floors, circles and arrows that point up."""
    rooms, folders = arrows(trees, room), arrows(trees, folder)
    return {
        "rooms": f"{len(rooms)}",
        "floors": f"{floors(rooms)}",
        "arrows between rooms": f"{sum(map(len, rooms.values()))}",
        "arrows between rooms that point up": f"{upward(rooms)}",
        "circles between rooms": f"{len(circles(rooms))}",
        "circles between folders": f"{len(circles(folders))}",
    }


def topics(trees: Trees) -> Counts:
    """Return numbers of files and folders of each topic, and the folders by number of files."""
    found: Counts = {}
    for topic in TOPICS:
        places = Counter(folder(name) for name, tree in trees.items() if about(topic, name, tree))
        found[f"{topic}: files in folders"] = f"{places.total()} in {len(places)}"
        found[f"{topic}: where"] = ", ".join(
            f"{place.removeprefix(PACKAGE).lstrip('.') or '.'} {n}" for place, n in places.most_common()
        )
    return found


def counts(root: Path) -> Counts:
    """Return all counts of a source tree."""
    sources = read(root)
    trees = {name: ast.parse(source) for name, source in sources.items()}
    return sizes(sources, trees) | names(trees) | style(trees) | imports(trees) | topics(trees)


def walked(root: Path) -> Counts:
    """Return the length of a reader's way through `optimise_design`, two calls deep."""
    return {f"{walk.START}: {label}": f"{count}" for label, count in walk.counts(root).items()}


def main(roots: list[Path]) -> None:
    """Print a line for each count, and where the files of each topic are."""
    columns = {root: counts(root) | walked(root) for root in roots}
    for label in dict.fromkeys(label for column in columns.values() for label in column):
        values = [column.get(label, "-") for column in columns.values()]
        if label.endswith("where"):
            print(label, *values, sep="\n  ")
        else:
            print(f"{label:<52}", *(f"{value:>10}" for value in values))


if __name__ == "__main__":
    main([Path(argument) for argument in sys.argv[1:]] or [Path(__file__).resolve().parents[2]])
