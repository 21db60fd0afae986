"""Machine code is kept in a folder of the user's alone, and two processes do not make the same at once."""

from __future__ import annotations

import os
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import nullcontext, suppress
from pathlib import Path

import pytest

from cranktopo.base.machine import private_cache
from cranktopo.numerics import machine_code
from cranktopo.numerics.kernels import catalogue
from cranktopo.numerics.tetrahedra import block_code

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="no kernels there")


def _open_to_all(folder: Path) -> None:
    folder.chmod(0o777)


def _readable(folder: Path) -> None:
    folder.chmod(0o755)


def _link(folder: Path) -> None:
    folder.rename(folder.with_name("elsewhere"))
    folder.symlink_to(folder.with_name("elsewhere"))


def _file(folder: Path) -> None:
    folder.rename(folder.with_name("elsewhere"))
    folder.write_bytes(b"")


@pytest.mark.parametrize("change", [_open_to_all, _readable, _link, _file])
def test_a_folder_that_others_may_use(
    change: Callable[[Path], None], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    folder = private_cache("code")
    assert folder == private_cache("code") == tmp_path / "cranktopo" / "code"
    assert folder.stat().st_mode & 0o777 == 0o700
    change(folder)
    assert private_cache("code") is None


def test_a_folder_of_another_user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    assert private_cache("code")
    other = os.getuid() + 1
    monkeypatch.setattr(os, "getuid", lambda: other)
    assert private_cache("code") is None


def test_no_code_among_temporary_files(monkeypatch: pytest.MonkeyPatch) -> None:
    def nobody() -> Path:
        raise RuntimeError("Could not determine home directory.")

    monkeypatch.delenv("XDG_CACHE_HOME")
    monkeypatch.setattr(Path, "home", nobody)
    assert private_cache("code") is None


def test_code_is_loaded_from_the_own_folder_alone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    compiled: list[str] = []
    compile_text = machine_code._compiled
    monkeypatch.setattr(machine_code, "_compiled", lambda text: compiled.append(text) or compile_text(text))
    text = catalogue.text_of(catalogue.KERNELS["restriction"], "float32", 4, 1)
    for _ in range(2):
        machine_code.address_of("handler", text, lambda: text)
    assert len(compiled) == 1
    machine_code.address_of("handler", text, lambda: pytest.fail("text of kept code was written"))
    (file,) = (tmp_path / "cranktopo").rglob("*.o")
    file.parent.chmod(0o777)
    machine_code.address_of("handler", text, lambda: text)
    assert len(compiled) == 2


AHEAD = """
import sys
from cranktopo.numerics.kernels.catalogue import keep_machine_code
keep_machine_code()
assert "jax" not in sys.modules
"""


@pytest.mark.parametrize(
    "setting", [{}, {catalogue.SWITCH: catalogue.OFF}, {"JAX_ENABLE_COMPILATION_CACHE": "0"}]
)
def test_a_second_process_makes_what_a_solve_takes(
    setting: dict[str, str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """It has no JAX; where no code is wanted, or none is kept, it makes none."""
    here = os.environ | {"XDG_CACHE_HOME": str(tmp_path)} | setting
    subprocess.run([sys.executable, "-c", AHEAD], env=here, check=True)
    wanted = () if setting else (catalogue.TRIED, *catalogue.FAST)
    assert len(list(tmp_path.rglob("*.o"))) == len(wanted)
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    monkeypatch.setattr(machine_code, "_compiled", lambda _: pytest.fail("kept code was made again"))
    catalogue.address.cache_clear()
    for name, precision in wanted:
        width = machine_code.vector_width(precision)
        assert catalogue.address(name, precision, width, catalogue.threads())
    catalogue.address.cache_clear()


@pytest.fixture
def held(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[int]:
    """Another process, as it were, makes code: its lock on the folder."""
    fcntl = pytest.importorskip("fcntl")
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    folder = private_cache("machine-code")
    assert folder is not None
    place = os.open(folder, os.O_RDONLY)
    fcntl.flock(place, fcntl.LOCK_EX)
    yield place
    with suppress(OSError):
        os.close(place)


def test_code_that_another_process_makes_is_waited_for(held: int, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine_code, "_compiled", lambda text: text.encode())
    with ThreadPoolExecutor(1) as pool:
        waiting = pool.submit(machine_code.code_of, "origin", lambda: pytest.fail("it was made twice"))
        time.sleep(0.1)
        assert not waiting.done()
        monkeypatch.setattr(machine_code, "_one_process", lambda _: nullcontext())  # the other one's code
        assert machine_code.code_of("origin", lambda: "made") == b"made"
        os.close(held)
        assert waiting.result() == b"made"


def test_a_process_that_stands_still_is_not_waited_for(held: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """One that was stopped by Ctrl-Z keeps its lock."""
    monkeypatch.setattr(machine_code, "_PATIENCE_S", 0.05)
    monkeypatch.setattr(machine_code, "_compiled", lambda text: text.encode())
    assert machine_code.code_of("origin", lambda: "made") == b"made"


def test_products_of_blocks_are_kept_as_kernels_are(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """They were compiled by each process: a fifth of a second for those of an evaluation."""
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    for made in (1, 0):
        for program in (block_code.product, block_code.assembly):
            program.cache_clear()
        if not made:
            monkeypatch.setattr(machine_code, "_compiled", lambda _: pytest.fail("kept code was made again"))
        assert block_code.product(3)
        assert block_code.assembly()
    assert len(list(tmp_path.rglob("*.o"))) == 2
