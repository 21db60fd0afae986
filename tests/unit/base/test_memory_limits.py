"""What a process may take is known: of the container, and by `ulimit -v`; what does not fit is one line."""

from __future__ import annotations

import math
import re
import resource
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path

import pytest
import scipy.sparse

from cranktopo.app import main
from cranktopo.base import machine
from cranktopo.base.errors import CranktopoError
from cranktopo.bodies import memory
from cranktopo.numerics import precision
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.tetrahedra import solver
from cranktopo.tasks.doctor import stage as doctor
from cranktopo.tasks.throw_fatigue import stress_mesh
from cranktopo.tasks.throw_fea.targets import resolve_targets

PROGRAM = f"{sys.executable} -c 'from cranktopo.app.launch import main; main()'"
MIB = 2**20


def test_address_space(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(resource, "getrlimit", lambda _: (resource.RLIM_INFINITY, resource.RLIM_INFINITY))
    assert math.isinf(machine.addresses_left_MiB())
    assert memory.available_memory_MiB() > 500
    monkeypatch.setattr(resource, "getrlimit", lambda _: (900 * MIB, resource.RLIM_INFINITY))
    assert 0 <= machine.addresses_left_MiB() < 900
    assert memory.available_memory_MiB() == 0


@pytest.mark.parametrize("version", [1, 2])
@pytest.mark.parametrize("limited", ["own", "parent", "none"])
def test_container(version: int, limited: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    own = tmp_path / "cgroup"
    own.write_text("0::/job/step\n" if version == 2 else "9:name=systemd:/\n4:memory:/job/step\n0::/\n")
    most, used, kept = (
        ("memory.max", "memory.current", "inactive_file")
        if version == 2
        else ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file")
    )
    root = tmp_path / "fs" if version == 2 else tmp_path / "fs" / "memory"
    for name, folder in {"parent": root / "job", "own": root / "job" / "step"}.items():
        folder.mkdir(parents=True)
        unlimited = "max" if version == 2 else str(2**63 - 4096)
        (folder / most).write_text(f"{512 * MIB}" if name == limited else unlimited)
        (folder / used).write_text(str(300 * MIB))
        (folder / "memory.stat").write_text(f"anon 5\n{kept} {100 * MIB}\n")
    monkeypatch.setattr(machine, "_OWN_CGROUPS", own)
    monkeypatch.setattr(machine, "_CGROUPS", tmp_path / "fs")
    left = machine.container_memory_left_MiB()
    assert left > 1e9 if limited == "none" else left == 312


def limited(kilobytes: int, line: str, folder: Path) -> subprocess.CompletedProcess[str]:
    """Run a command that may have so many addresses."""
    words = ["bash", "-c", f"ulimit -v {kilobytes}; {PROGRAM} {line}"]
    return subprocess.run(words, cwd=folder, capture_output=True, text=True, timeout=600, check=False)


@pytest.mark.parametrize(
    "line",
    [
        "evaluate mikron-iiic-plain",
        pytest.param("optimise mikron-iiic-plain --out run", marks=pytest.mark.slow),
    ],
)
def test_what_does_not_fit_is_refused_before_it_starts(line: str, tmp_path: Path) -> None:
    done = limited(1_000_000, line, tmp_path)
    assert (done.returncode, done.stdout) == (3, ""), done.stderr
    assert done.stderr.splitlines()[-1].startswith("error: memory: "), done.stderr
    assert not (tmp_path / "run").exists()


def fails(error: Exception) -> Callable[..., None]:
    def raising(*_: object, **__: object) -> None:
        raise error

    return raising


@pytest.mark.parametrize(
    "error",
    [
        MemoryError(),
        RuntimeError("can't start new thread"),
        ImportError("libgmsh.so.4.15: failed to map segment from shared object"),
        OSError(12, "Cannot allocate memory"),
        RuntimeError("RESOURCE_EXHAUSTED: Out of memory allocating 64 bytes."),
        RuntimeError("std::bad_alloc"),
    ],
    ids=repr,
)
def test_memory_that_is_not_there_is_one_line(
    error: Exception, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(main.cli, "main", fails(error))
    assert main.main(["plan"]) == 4
    hint = "Take larger cells or elements, or allow more memory."
    assert capsys.readouterr().err == f"error: not enough memory. {hint}\n"


@pytest.mark.parametrize(
    ("begins", "told"),
    [
        (precision.check_device.__wrapped__, "JAX needs 2.5 GiB"),
        (lambda: solver.cholesky(scipy.sparse.identity(3)), "the factorisation needs 1.4 GiB"),
    ],
    ids=["JAX", "OpenBLAS"],
)
def test_a_library_that_would_end_the_process_is_not_begun(
    begins: Callable[[], None], told: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    """What it takes grows with the cores: one thread each, with a stack and a heap."""
    monkeypatch.setattr(machine, "usable_cores", lambda: 16)
    monkeypatch.setattr(machine, "addresses_left_MiB", lambda: 800.0)
    with pytest.raises(CranktopoError, match=rf"memory: {told} of addresses, 0\.8 left"):
        begins()


def test_doctor_tells_of_too_few_addresses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine, "addresses_left_MiB", lambda: 800.0)
    told = doctor._jax_device()
    assert (told.state, told.remedy) == ("short", "Allow more (ulimit -v).")
    assert "JAX needs" in told.value


@pytest.mark.parametrize("error", [MemoryError(), ImportError("x.so: failed to map segment")], ids=repr)
def test_a_check_without_memory_leaves_the_others(
    error: Exception, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(doctor, "memory", fails(error))
    assert main.main(["doctor"]) == 3
    told = capsys.readouterr().out
    assert told.endswith("needed, and too little memory for it: memory\n")
    assert "CalculiX" in told


@pytest.mark.slow
@pytest.mark.parametrize("megabytes", [60, 180, 300, 700, 770, 1556])
def test_doctor_with_little_memory(megabytes: int, tmp_path: Path) -> None:
    """By 100 to 300 MB, libraries end in many ways: an abort by Rust or OpenBLAS, a lock for ever."""
    done = limited(1000 * megabytes, "doctor", tmp_path)
    assert done.returncode == 3, done.stderr
    assert "memory" in (done.stdout + done.stderr).splitlines()[-1]


def test_a_mesh_is_not_begun_without_addresses(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(machine, "addresses_left_MiB", lambda: 100.0)
    with pytest.raises(CranktopoError, match=r"memory: a box needs 0\.3 GiB"), cad_session("a box"):
        pass


@pytest.fixture
def gibibyte(monkeypatch: pytest.MonkeyPatch) -> None:
    """One GiB is all that is free."""
    monkeypatch.setattr(memory, "available_memory_MiB", lambda: 1024.0)


@pytest.mark.usefixtures("gibibyte")
def test_fillets_finer_than_the_memory_are_refused_before_they_are_meshed(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The fraction that is named is let through, by the same estimate."""
    (target,) = resolve_targets(["mikron-iiic"], fillets=True, whole=True)
    monkeypatch.setattr(stress_mesh, "mesh_throw", fails(AssertionError("a mesh was begun")))
    with pytest.raises(CranktopoError, match=r"^fillet fraction = 0\.02: too fine: at least") as refused:
        stress_mesh.mesh_for_stress(target, 0.02)
    named = re.search(r"finest that may fit is about ([\d.]+) \(--fillet-fraction\)", str(refused.value.hint))
    assert named is not None
    assert 0.02 < float(named[1]) < 0.17
    with pytest.raises(AssertionError, match="a mesh was begun"):
        stress_mesh.mesh_for_stress(target, float(named[1]))


@pytest.mark.usefixtures("gibibyte")
def test_stresses_on_too_many_nodes_are_refused_when_these_are_counted() -> None:
    memory.check_stress_memory(100_000, 0.1)
    with pytest.raises(CranktopoError, match="too fine") as refused:
        memory.check_stress_memory(300_000, 0.05)
    assert "about 0.075 (" in str(refused.value.hint)
    with pytest.raises(CranktopoError, match="too fine") as refused:
        memory.check_stress_memory(300_000, 0.4)
    assert "finest" not in str(refused.value.hint)
