from __future__ import annotations

import atexit
import fcntl
import gc
import os
import signal
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any

import pytest

# As in the program, before NumPy loads: threads of OpenBLAS wait busily, three of four seconds of a solve.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

from cranktopo.app import process
from cranktopo.app.main import main
from cranktopo.bodies.solid import step
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.plan import planning
from cranktopo.engine.vibration import vibrating_shaft
from cranktopo.engine.vibration.steady import speeds_to_solve
from cranktopo.numerics.precision import compile_quickly, double_precision

if "PYTEST_XDIST_WORKER" in os.environ:
    # The last act of a process of tests: else nanobind lists what lives in caches as leaked, in many lines.
    atexit.register(os._exit, 0)

# Collecting tests makes many objects that stay, as loading the program does.
gc.set_threshold(*process._COLLECTING)

# A suite that was started in the background ignores Ctrl-C, and so would the commands that it interrupts.
signal.signal(signal.SIGINT, signal.default_int_handler)

_TRIANGLES_OF_USERS = dict(step._TRIANGULATION)
_STEPS_OF_USERS: Any = speeds_to_solve.__defaults__


def pytest_configure(config: pytest.Config) -> None:
    """Compile as the command does; quicker in the quick suite, where most programs run once.

    Slow tests run what users run, as do quick ones with JAX_DISABLE_MOST_OPTIMIZATIONS=0.
    """
    compile_quickly()
    if config.getoption("markexpr") == "not slow":
        os.environ.setdefault("JAX_DISABLE_MOST_OPTIMIZATIONS", "1")
    if os.environ.get("PYTEST_XDIST_WORKER") == "gw1" and config.args == config.getini("testpaths"):
        config.args = _folders_from_the_last()


def _folders_from_the_last() -> list[str]:
    """Folders of tests: a second process compiles those that the first one has not come to, and not all."""
    here = Path(__file__).parent
    tops = {file.relative_to(here).parts[0] for file in here.rglob("test_*.py")}
    return [str(here / top) for top in sorted(tops, reverse=True)]


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put a file first that makes the default run; those that need it come after `cli`.

    The short files of `unit` come last, so that both processes end at the same time.
    """

    @cache
    def place(file: Path) -> tuple[bool, bool, str]:
        folder = file.relative_to(Path(__file__).parent).parts[0]
        first = file.name == "test_cells.py"
        return not first, folder == "unit", "cli, browser" if folder == "browser" else folder

    items.sort(key=lambda item: place(item.path))


@pytest.fixture(scope="session")
def mikron() -> Scene:
    """The built-in design with a free topology: what a process leaves is tested where one is asked for."""
    return load_scene("mikron-iiic-plain").with_optimise(process="free", draft_deg=0.0)


@pytest.fixture(scope="session")
def shared(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of all test processes."""
    folder = tmp_path_factory.getbasetemp()
    return folder.parent if "PYTEST_XDIST_WORKER" in os.environ else folder


@pytest.fixture(scope="session", autouse=True)
def compilations(shared: Path) -> Iterator[None]:
    """Compiled programs, apart from the user's: all test processes and the commands they start share them.

    Modules too, whose compiling takes a third of the time that a command needs to begin, where Python is
    not to keep them beside their sources.
    """
    with pytest.MonkeyPatch.context() as patched:
        patched.setenv("XDG_CACHE_HOME", str(shared / "cache"))
        if os.environ.get("PYTHONDONTWRITEBYTECODE"):
            patched.setenv("PYTHONPYCACHEPREFIX", str(shared / "modules"))
            patched.delenv("PYTHONDONTWRITEBYTECODE")
        yield


@pytest.fixture(scope="session", autouse=True)
def collecting() -> None:
    """Unused objects are not looked for among those that stay."""
    gc.collect()
    gc.freeze()


@pytest.fixture(scope="session", autouse=True)
def patient() -> Iterator[None]:
    """No lines about waits, which depend on what else the machine does."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("cranktopo.cli.verbosity._QUIET_S", 3600.0)
        yield


@pytest.fixture(scope="module")
def throws_made_once() -> Iterator[None]:
    """A mesh for each body of a shaft: how it is made is not the subject."""
    from tests.throws_once import throws_once  # loads solvers

    with throws_once():
        yield


@pytest.fixture(scope="session", autouse=True)
def coarse_pictures(request: pytest.FixtureRequest) -> Iterator[None]:
    """Pictures of Markdown pages and PDF files with a third of the points; slow tests have all of them."""
    with pytest.MonkeyPatch.context() as patched:
        if request.config.getoption("markexpr") == "not slow":
            patched.setattr("cranktopo.report.report_file._DPI", 50)
            patched.setattr("cranktopo.report.pdf_file._DPI", 100.0)
        yield


@pytest.fixture(scope="session", autouse=True)
def coarse_triangles(request: pytest.FixtureRequest) -> Iterator[None]:
    """A third of the CAD kernel's triangles, 1e-4 of a volume off; slow tests have all of them."""
    with pytest.MonkeyPatch.context() as patched:
        if request.config.getoption("markexpr") == "not slow":
            patched.setitem(step._TRIANGULATION, "StlLinearDeflection", 0.03)
            patched.setitem(step._TRIANGULATION, "StlAngularDeflection", 0.2)
        yield


@pytest.fixture(scope="session", autouse=True)
def coarse_ranges(request: pytest.FixtureRequest) -> Iterator[None]:
    """A third of the even steps over a range of speeds, beside all critical ones; slow tests have all."""
    with pytest.MonkeyPatch.context() as patched:
        if request.config.getoption("markexpr") == "not slow":
            _, rise = _STEPS_OF_USERS
            patched.setattr(speeds_to_solve, "__defaults__", (60, rise))
        yield


@pytest.fixture
def every_step(monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    """All even steps over a range of speeds, for a test of what they give; none that was solved before."""
    monkeypatch.setattr(speeds_to_solve, "__defaults__", _STEPS_OF_USERS)
    solved = vibrating_shaft._solved_range, planning._plan
    for one in solved:
        one.cache_clear()
    yield
    for one in solved:
        one.cache_clear()


@pytest.fixture(scope="module")
def fine_triangles() -> Iterator[None]:
    """All of the CAD kernel's triangles, for tests of what they give."""
    with pytest.MonkeyPatch.context() as patched:
        for name, value in _TRIANGLES_OF_USERS.items():
            patched.setitem(step._TRIANGULATION, name, value)
        yield


@pytest.fixture(scope="session", autouse=True)
def unflushed() -> Iterator[None]:
    """Files that this process writes are not waited for until the disk has them: no test cuts the power."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("cranktopo.base.files._flush", lambda _: None)
        yield


@pytest.fixture(scope="session", autouse=True)
def whole_sentences() -> Iterator[None]:
    """Sentences on one line each, as tests look for them; `test_terminal_width.py` has them folded."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("cranktopo.cli.output._folded", str)
        yield


@pytest.fixture(scope="session")
def default_run(shared: Path) -> Path:
    """The default run on coarse cells to its end, one for all test processes, not to be changed."""
    out = shared / "default-run"
    with (shared / "default-run.lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        if not out.exists():
            assert (
                main(["optimise", "--volume-fraction", "0.3", "--resolution-mm", "4.5", "--out", str(out)])
                == 0
            )
    return out


@pytest.fixture
def kernel_here(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bodies that a test has written are read in its own process: to start another takes longer."""
    for room in ("bodies.solid.step", "tasks.importing.imported_body", "tasks.crank_import.stage"):
        monkeypatch.setattr(f"cranktopo.{room}.in_child", lambda _, work, *arguments, by="": work(*arguments))


@pytest.fixture
def float64() -> Iterator[None]:
    with double_precision():
        yield
