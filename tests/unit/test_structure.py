"""The shape of the house: imports run one way, help stays light, the code is clean."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "cranktopo"
# Each room may import the rooms to its left. `store` knows only errors.
ORDER = [
    "errors",
    "units",
    "frames",
    "formats",
    "scene",
    "loads",
    "domain",
    "effects",
    "fem",
    "optimise",
    "surface",
    "remodel",
    "evaluate",
    "report",
    "pipeline",
    "pipeline_remodel",
    "accuracy",
    "iterate",
    "cli",
]
HEAVY = ("jax", "gmsh", "skfem", "trimesh", "matplotlib", "scipy", "numpy", "pydantic", "manifold3d", "tqdm")


def imported_names(file: Path) -> set[str]:
    """Dotted names of the package that a file imports, anywhere in it."""
    found: set[str] = set()
    for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
        names: list[str] = []
        if isinstance(node, ast.ImportFrom):
            names = [f"{node.module}.{alias.name}" for alias in node.names]
            assert node.level == 0, f"{file}: relative import"
        elif isinstance(node, ast.Import):
            names = [alias.name for alias in node.names]
        found |= {name for name in names if name.startswith("cranktopo.")}
    return found


def imported_rooms(file: Path) -> set[str]:
    return {name.split(".")[1] for name in imported_names(file)}


def room_of(file: Path) -> str:
    return file.relative_to(PACKAGE).parts[0].removesuffix(".py")


@pytest.mark.parametrize("file", sorted(PACKAGE.rglob("*.py")), ids=lambda f: str(f.relative_to(PACKAGE)))
def test_imports_run_one_way(file: Path) -> None:
    room, imports = room_of(file), imported_rooms(file)
    if room == "__init__":
        return
    if room == "store":
        assert imports <= {"errors", "store"}
        return
    assert imports <= {*ORDER[: ORDER.index(room) + 1], "store"}


def files_of(name: str) -> set[Path]:
    """Files that importing a dotted name of the package runs; the last part may be no module."""
    parts = name.split(".")[1:]
    folders = [PACKAGE.joinpath(*parts[:n]) for n in range(len(parts) + 1)]
    return {
        f for folder in folders for f in (folder / "__init__.py", folder.with_suffix(".py")) if f.is_file()
    }


def test_the_judge_never_imports_the_optimiser() -> None:
    """Neither by itself nor through any module it uses, late imports included."""
    found, waiting = set(), set((PACKAGE / "evaluate").glob("*.py"))
    while waiting:
        file = waiting.pop()
        found.add(file)
        if file != PACKAGE / "__init__.py":
            waiting |= {f for name in imported_names(file) for f in files_of(name)} - found
    assert PACKAGE / "surface" / "mesh.py" in found
    assert not {room_of(file) for file in found} & {"fem", "optimise"}


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys; from cranktopo.cli.main import main; main(['--help']); "
        f"print([m for m in {HEAVY!r} if m in sys.modules], file=sys.stderr)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "optimise" in result.stdout
    assert result.stderr.strip() == "[]"


def public_functions(body: list[ast.stmt]) -> Iterator[ast.FunctionDef]:
    """Public functions and methods; not the commands, whose docstring is their help text."""
    for node in body:
        if isinstance(node, (ast.ClassDef, ast.FunctionDef)) and node.name.startswith("_"):
            continue
        if isinstance(node, ast.ClassDef):
            yield from public_functions(node.body)
        elif isinstance(node, ast.FunctionDef) and not any(map(makes_command, node.decorator_list)):
            yield node


def makes_command(decorator: ast.expr) -> bool:
    """Whether a decorator is `click.command(...)` or a group's `command(...)` or `group(...)`."""
    called = decorator.func if isinstance(decorator, ast.Call) else decorator
    return isinstance(called, ast.Attribute) and called.attr in ("command", "group")


def arguments_of(function: ast.FunctionDef) -> set[str]:
    given = function.args
    starred = [argument for argument in (given.vararg, given.kwarg) if argument is not None]
    every = [*given.posonlyargs, *given.args, *given.kwonlyargs, *starred]
    return {argument.arg for argument in every} - {"self", "cls"}


def described_arguments(docstring: str) -> set[str] | None:
    """Names that the section `Args:` explains, `a, b: ...` counting as two; None without the section."""
    section = re.search(r"^Args:\n((?: +.*\n?|\n)*)", docstring, re.MULTILINE)
    if section is None:
        return None
    entries = re.findall(r"^ {4}(\w+(?:, \w+)*): \S", section[1], re.MULTILINE)
    return {name for entry in entries for name in entry.split(", ")}


def missing_in_docstring(function: ast.FunctionDef) -> list[str]:
    """What the docstring of a public function owes its reader."""
    docstring = ast.get_docstring(function) or ""
    described, taken = described_arguments(docstring), arguments_of(function)
    raised = any(isinstance(node, ast.Raise) and node.exc is not None for node in ast.walk(function))
    owed = [] if docstring else ["docstring"]
    if described is None and len(taken) > 1:
        owed.append("Args")
    elif described is not None:
        owed += sorted(described ^ taken)
    if raised and not re.search(r"^Raises:$", docstring, re.MULTILINE):
        owed.append("Raises")
    return owed


def test_docstrings_name_every_argument_and_what_is_raised() -> None:
    """Two arguments or more need an `Args:` section; any such section names just the arguments there are."""
    owed = {
        f"{file.relative_to(PACKAGE)}: {function.name}": missing
        for file in sorted(PACKAGE.rglob("*.py"))
        for function in public_functions(ast.parse(file.read_text(encoding="utf-8")).body)
        if (missing := missing_in_docstring(function))
    }
    assert owed == {}


@pytest.mark.parametrize(
    "command", [["ruff", "check", "."], ["ruff", "format", "--check", "."], ["mypy"]], ids=" ".join
)
def test_clean(command: list[str]) -> None:
    result = subprocess.run(
        [sys.executable, "-m", *command], cwd=PACKAGE.parent, capture_output=True, text=True, check=False
    )
    assert result.returncode == 0, result.stdout + result.stderr
