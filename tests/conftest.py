from __future__ import annotations

import os
import signal
from collections.abc import Iterator

import pytest

from cranktopo.fem.precision import double_precision
from cranktopo.scene import Scene, load_scene

# A suite that was started in the background ignores Ctrl-C, and so would the commands that it interrupts.
signal.signal(signal.SIGINT, signal.default_int_handler)


@pytest.fixture(scope="session")
def mikron() -> Scene:
    """The built-in design with a free topology: what a process leaves is tested where one is asked for."""
    return load_scene("mikron-iiic").with_optimise(process="free", draft_deg=0.0)


@pytest.fixture(scope="session", autouse=True)
def compilations(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Compiled programs, apart from the user's: all test processes and the commands they start share them."""
    folder = tmp_path_factory.getbasetemp()
    if "PYTEST_XDIST_WORKER" in os.environ:
        folder = folder.parent
    before = os.environ.get("XDG_CACHE_HOME")
    os.environ["XDG_CACHE_HOME"] = str(folder / "cache")
    yield
    os.environ.pop("XDG_CACHE_HOME")
    if before is not None:
        os.environ["XDG_CACHE_HOME"] = before


@pytest.fixture
def float64() -> Iterator[None]:
    with double_precision():
        yield
