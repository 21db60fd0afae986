"""The shape of the house: imports run one way, help stays light."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGE = Path(__file__).resolve().parents[2] / "cranktopo"
# Each room may import the rooms to its left. `store` knows only errors and inputs.
ORDER = [
    "errors",
    "inputs",
    "cores",
    "units",
    "frames",
    "formats",
    "scene",
    "loads",
    "triangles",
    "cad",
    "domain",
    "effects",
    "fem",
    "optimise",
    "bound",
    "surface",
    "meshing",
    "remodel",
    "evaluate",
    "shape",
    "accuracy",
    "report",
    "pipeline",
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
        assert imports <= {"errors", "inputs", "store"}
        return
    assert imports <= {*ORDER[: ORDER.index(room) + 1], "store"}


def files_of(name: str) -> set[Path]:
    """Files that importing a dotted name of the package runs; the last part may be no module."""
    parts = name.split(".")[1:]
    folders = [PACKAGE.joinpath(*parts[:n]) for n in range(len(parts) + 1)]
    return {
        f for folder in folders for f in (folder / "__init__.py", folder.with_suffix(".py")) if f.is_file()
    }


def test_the_evaluation_never_imports_the_optimiser() -> None:
    """Neither by itself nor through any module it uses, late imports included."""
    found, waiting = set(), set((PACKAGE / "evaluate").glob("*.py"))
    while waiting:
        file = waiting.pop()
        found.add(file)
        if file != PACKAGE / "__init__.py":
            waiting |= {f for name in imported_names(file) for f in files_of(name)} - found
    assert PACKAGE / "triangles" / "surface_mesh.py" in found
    assert not {room_of(file) for file in found} & {"fem", "optimise"}


def imported_at_once(file: Path) -> set[Path]:
    """Files that run when a file is imported, its own packages apart."""
    tree = ast.parse(file.read_text(encoding="utf-8"))
    now = [node for node in tree.body if isinstance(node, ast.ImportFrom) and node.module]
    names = {f"{node.module}.{alias.name}" for node in now for alias in node.names}
    own = {folder / "__init__.py" for folder in file.parents}
    return {f for name in names if name.startswith("cranktopo.") for f in files_of(name)} - own - {file}


def test_no_module_waits_for_itself() -> None:
    """No circles of imports: whichever module is imported first, the others are complete."""
    waits = {file: imported_at_once(file) for file in PACKAGE.rglob("*.py")}
    while free := {file for file, others in waits.items() if not others & waits.keys()}:
        waits = {file: others for file, others in waits.items() if file not in free}
    assert not sorted(str(file.relative_to(PACKAGE)) for file in waits)


def test_reports_only_show() -> None:
    """Pages, figures and tables are functions of finished results: nothing is solved, meshed or extracted."""
    files = (PACKAGE / "report").rglob("*.py")
    assert not {"fem", "optimise", "cad", "meshing", "remodel"} & {
        room for file in files for room in imported_rooms(file)
    }


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys; from cranktopo.cli.main import main; main(['--help']); "
        f"print([m for m in {HEAVY!r} if m in sys.modules], file=sys.stderr)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "optimise" in result.stdout
    assert result.stderr.strip() == "[]"
