"""The shape of the house: imports run one way, help stays light."""

from __future__ import annotations

import ast
import re
import subprocess
import sys
from functools import cache
from pathlib import Path

import pytest

from tests.source_facts import FILES, OF_EXTRAS, PACKAGE, facts
from tests.studies.house import several

FLOORS = (
    {"base"},
    {"numerics", "runs", "throw"},
    {"design"},
    {"bodies"},
    {"engine", "report", "cli"},
    {"tasks"},
    {"app"},
)
"""Each room may import those of the floors before it, and itself."""
TASKS = (
    "plan",
    "loads",
    "balance",
    "film",
    "drawing",
    "crank_drawing",
    "designs",
    "importing",
    "crank_import",
    "throw_fea",
    "shaft",
    "vibration",
    "modes",
    "fatigue",
    "throw_fatigue",
    "dynamics",
    "shaft_safety",
    "export",
    "bolts",
    "rod",
    "balancer",
    "density",
    "extraction",
    "refit",
    "bound",
    "accuracy",
    "web_shape",
    "optimise",
    "iterate",
    "evaluate",
    "sweep",
    "compare",
    "report",
    "run_list",
    "doctor",
    "completion",
    "bench",
)
"""Each task may import those before it, and itself."""
HEAVY = ("jax", "gmsh", "skfem", "trimesh", "matplotlib", "scipy", "numpy", "pydantic", "manifold3d", "tqdm")


def imported_names(file: Path) -> set[str]:
    """Dotted names of the package that a file imports, anywhere in it."""
    return {name for name in facts(file).imports if name.startswith("cranktopo.")}


def room_of(file: Path) -> tuple[str, ...]:
    """The room that a file stands in, and in `tasks` the task."""
    folders = file.relative_to(PACKAGE).parts[:-1]
    return folders[:2] if folders[:1] == ("tasks",) else folders[:1]


def imported_rooms(file: Path) -> set[tuple[str, ...]]:
    return {room_of(found) for name in imported_names(file) for found in files_of(name)} - {()}


def allowed_rooms(room: tuple[str, ...]) -> set[tuple[str, ...]]:
    """Rooms that a room may import, itself included."""
    floor = next(number for number, rooms in enumerate(FLOORS) if room[0] in rooms)
    below = {(other,) for rooms in FLOORS[:floor] for other in rooms}
    if room[0] == "app":
        return below | {("tasks", task) for task in TASKS} | {room}
    tasks = TASKS[: TASKS.index(room[1]) + 1] if room[1:] else ()
    return below | {("tasks", task) for task in tasks} | {room, room[:1]}


def test_imports_run_one_way() -> None:
    assert not [file for file in FILES if facts(file).relative]
    upward = {
        file: rooms
        for file in FILES
        if (room := room_of(file)) and (rooms := imported_rooms(file) - allowed_rooms(room))
    }
    assert upward == {}


def test_the_picture_names_every_room() -> None:
    folders = {folder.name for folder in PACKAGE.iterdir() if (folder / "__init__.py").is_file()}
    assert folders == set().union(*FLOORS)
    assert {file.parent.name for file in PACKAGE.glob("tasks/*/__init__.py")} == set(TASKS)


@cache
def files_of(name: str) -> set[Path]:
    """Files that importing a dotted name of the package runs; the last part may be no module."""
    parts = name.split(".")[1:]
    folders = [PACKAGE.joinpath(*parts[:n]) for n in range(len(parts) + 1)]
    return {
        f for folder in folders for f in (folder / "__init__.py", folder.with_suffix(".py")) if f.is_file()
    }


@pytest.mark.parametrize("task", ["throw_fea", "throw_fatigue"])
def test_the_check_never_reaches_what_it_checks(task: str) -> None:
    """Neither by itself nor through any module it uses, late imports included."""
    found, waiting = set(), set((PACKAGE / "tasks" / task).glob("*.py"))
    while waiting:
        file = waiting.pop()
        found.add(file)
        if file != PACKAGE / "__init__.py":
            waiting |= {f for name in imported_names(file) for f in files_of(name)} - found
    assert PACKAGE / "numerics" / "surfaces" / "mesh.py" in found
    folders = {file.relative_to(PACKAGE).parent.as_posix() for file in found}
    assert not folders & {"numerics/grid", "numerics/kernels", "tasks/density"}


def imported_files(file: Path) -> set[Path]:
    """Files that a file names in any import, late ones and those for types alone included."""
    own = {folder / "__init__.py" for folder in file.parents}
    return {f for name in imported_names(file) for f in files_of(name)} - own - {file}


def test_no_circle_of_imports() -> None:
    """Whichever module is read first, what it builds on does not build on it."""
    waits = {file: imported_files(file) for file in FILES if file != PACKAGE / "__init__.py"}
    while free := {file for file, others in waits.items() if not others & waits.keys()}:
        waits = {file: others for file, others in waits.items() if file not in free}
    assert not sorted(str(file.relative_to(PACKAGE)) for file in waits)


SHOWING = ("page", "section", "text", "plot", "picture", "table", "tables")
"""Last words of the names of modules that show finished results."""


def test_pages_only_show() -> None:
    """Pages, figures and tables are functions of finished results: nothing is solved, meshed or extracted."""
    solving = {"numerics/grid", "numerics/kernels", "bodies/solid", "bodies/mesh", "tasks/density"}
    showing = [file for file in PACKAGE.glob("tasks/*/*.py") if file.stem.split("_")[-1] in SHOWING]
    assert showing
    for file in showing:
        used = {f.relative_to(PACKAGE).parent.as_posix() for n in imported_names(file) for f in files_of(n)}
        assert not used & solving, file


PARTS_OF_AN_ENGINE = re.compile(r"(?<![a-z])(crank|crankpin|crankshaft|throw|web|piston)s?(?![a-z])", re.I)


def test_numerics_names_no_part_of_an_engine() -> None:
    """Neither code nor comments nor messages: who calls it says what a hint means for a crank.

    A journal has no place outside the theory of bearings.
    """
    for file in (PACKAGE / "numerics").rglob("*.py"):
        text = file.read_text(encoding="utf-8")
        assert not PARTS_OF_AN_ENGINE.findall(text), file
        theirs = file.parent.name == "bearing_film"
        assert theirs or not re.search(r"(?<![a-z])journal", text, re.I), file


METHODS_OF_FATIGUE = sorted(
    file.stem for file in PACKAGE.glob("tasks/fatigue/*.py") if file.name != "__init__.py"
)
"""All modules of `tasks/fatigue`: they judge the surface of any part."""
BESIDE_THE_CRANK = sorted(
    [
        *(file for part in ("rod", "bolts", "balancer") for file in PACKAGE.glob(f"tasks/{part}/*.py")),
        PACKAGE / "bodies" / "mesh" / "rod_mesh.py",
        PACKAGE / "bodies" / "solid" / "rod.py",
    ]
)


OF_THE_THROW = ("throw_fea", "throw_fatigue", "web_shape")
"""Tasks that are done to a throw or its web alone, and are named so."""
SHARED = {
    "numerics/tetrahedra/rigid_motions.py": {"throw_fea", "web_shape", "rod"},
    "numerics/tetrahedra/unit_stress.py": {"throw_fatigue", "web_shape", "rod"},
    "numerics/optimisers/gradient_search.py": {"web_shape", "rod", "balancer"},
    "numerics/optimisers/model_management.py": {"web_shape", "rod"},
    "tasks/fatigue/smooth_extremes.py": {"web_shape", "rod"},
    "tasks/fatigue/lsa.py": {"throw_fatigue", "balancer"},
}
"""Code for any part, and tasks of several parts that use it."""


def known(file: Path) -> set[str]:
    """What a file imports of the package, by path; reading a scene is no knowledge of its parts."""
    files = (found for found in imported_files(file) if found.name != "__init__.py")
    return {found.relative_to(PACKAGE).as_posix() for found in files}


@pytest.mark.parametrize("name", METHODS_OF_FATIGUE)
def test_methods_of_fatigue_know_no_part(name: str) -> None:
    """Of a scene they take material and settings; who calls says which points of what are judged."""
    file = PACKAGE / "tasks" / "fatigue" / f"{name}.py"
    tree = ast.parse(file.read_text(encoding="utf-8"))
    spelt = {getattr(node, key, None) for node in ast.walk(tree) for key in ("id", "attr", "arg", "name")}
    assert not [one for one in spelt if isinstance(one, str) and PARTS_OF_AN_ENGINE.search(one)]
    allowed = {f"tasks/fatigue/{one}.py" for one in METHODS_OF_FATIGUE}
    below = ("base/", "numerics/", "design/schema.py", "design/material.py", "design/assumed.py")
    assert not [one for one in known(file) - allowed if not one.startswith(below)]


def test_parts_beside_the_crank_take_nothing_of_the_throw() -> None:
    """All the same they mesh, solve, recover stresses, judge and move meshes as the web does."""
    rooms = ("throw/", *(f"tasks/{task}/" for task in (*OF_THE_THROW, "shaft")))
    forbidden = (*rooms, "bodies/mesh/solid_mesh.py", "bodies/solid/throw.py")
    taken = {file: known(file) for file in BESIDE_THE_CRANK}
    assert not [(file, one) for file, names in taken.items() for one in names if one.startswith(forbidden)]


@pytest.mark.parametrize("task", ["throw_fatigue", "web_shape", "rod"])
def test_web_and_rod_take_one_path_through_stresses(task: str) -> None:
    """None of them takes the way back from stresses by itself."""
    taken = {name for file in (PACKAGE / "tasks" / task).glob("*.py") for name in known(file)}
    assert "numerics/tetrahedra/unit_stress.py" in taken
    assert "numerics/tetrahedra/stress_adjoint.py" not in taken


@pytest.mark.parametrize("module", sorted(SHARED))
def test_parts_share_what_is_of_no_part(module: str) -> None:
    """Beside a web the rod or the balancer shaft uses it: neither has another of its own."""
    assert len(SHARED[module] - set(OF_THE_THROW)) > 0
    for task in SHARED[module]:
        taken = {name for file in (PACKAGE / "tasks" / task).rglob("*.py") for name in known(file)}
        assert module in taken, task


def test_rooms_without_the_name_of_a_part_know_none() -> None:
    """Methods of finite elements and of searches are in `numerics`, those of fatigue in `tasks/fatigue`.

    No room of their bare names is left that could know a part, and no optimiser outside `numerics`.
    """
    assert not {"fea", "shape"} & set(TASKS)
    optimising = {
        file for file in FILES if any(name.split(".")[0] == "nlopt" for name in facts(file).imports)
    }
    assert optimising
    assert all(room_of(file) == ("numerics",) for file in optimising)


def test_docstrings_are_statements() -> None:
    """Of modules, classes, functions and attributes; Args and messages may ask."""
    assert {file: lines for file in FILES if (lines := facts(file).questions)} == {}


def test_names_of_array_types_stand_in_one_file() -> None:
    found = [file.relative_to(PACKAGE).as_posix() for file in FILES if facts(file).aliases]
    assert found == ["base/arrays.py"]


def test_no_class_name_has_two_meanings() -> None:
    assert several(facts(file).classes for file in FILES) == 0


def test_all_that_is_said_leaves_at_one_place() -> None:
    """A line that is printed past it would be as long as it was written."""
    printing = {"print", "click.echo", "click.secho"}
    past = [file.relative_to(PACKAGE).as_posix() for file in FILES if facts(file).calls & printing]
    assert past == ["cli/output.py"]


def test_packages_of_extras_are_imported_where_they_are_needed_alone() -> None:
    """`tests/cli/test_extras.py` runs the core without them."""
    importing = {
        file.relative_to(PACKAGE / "tasks").as_posix()
        for file in FILES
        if {name.partition(".")[0] for name in facts(file).imports} & OF_EXTRAS
    }
    others = {name for name in importing if not name.startswith(("bench/", "sweep/"))}
    assert others == {"fatigue/fkm.py", "throw_fatigue/spectrum.py"}


def test_help_loads_nothing_heavy() -> None:
    code = (
        "import sys; from cranktopo.app.main import main; main(['--help']); "
        f"print([m for m in {HEAVY!r} if m in sys.modules], file=sys.stderr)"
    )
    result = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert "optimise" in result.stdout
    assert result.stderr.strip() == "[]"


def test_reading_a_design_loads_no_optimiser() -> None:
    """Every command reads one; optimisers and interpolators of SciPy take a quarter of the time of that."""
    code = (
        "import sys; from cranktopo.design.loading import load_scene; load_scene('car-diesel'); "
        "print([m for m in ('scipy.optimize', 'scipy.spatial', 'scipy.interpolate') if m in sys.modules])"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert told.strip() == "[]"


def test_evaluate_loads_its_solver_beside_the_mesh() -> None:
    """What the main thread loads before gmsh begins, it waits for: SciPy is a tenth of it."""
    code = (
        "import sys, cranktopo.tasks.throw_fea.stage, cranktopo.tasks.evaluate.command; "
        "print([m for m in ('scipy.sparse', 'scipy.linalg', 'skfem') if m in sys.modules])"
    )
    told = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout
    assert told.strip() == "[]"
