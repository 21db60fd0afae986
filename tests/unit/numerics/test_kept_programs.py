"""Programs that the next process loads: same digits, nothing traced; what is not ours is compiled anew."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.numerics import kept_programs
from cranktopo.numerics.kept_programs import KeptProgram, kept_program
from cranktopo.numerics.precision import cache_folder, double_precision
from cranktopo.numerics.source_files import digest_of_sources

traced: list[tuple[int, ...]] = []
MATRIX = np.array([[4.0, 1.0, 0.5], [1.0, 3.0, 0.25], [0.5, 0.25, 5.0]])
SOLVE = """
import jax, jax.numpy as jnp, numpy as np
from cranktopo.numerics.grid.conjugate_gradients import System
from cranktopo.numerics.grid.equilibrium import solve_system
from cranktopo.numerics.grid.multigrid import build_tables
from cranktopo.numerics.precision import double_precision
from tests.studies.cantilever import cantilever

names = []
jax.monitoring.register_event_duration_secs_listener(
    lambda event, _, **more: names.append(more.get("fun_name", "")) if "trace" in event else None
)
with double_precision():
    model, _ = cantilever((8, 4, 6))
    tables = build_tables(model.lattice, model.levels)
    moduli = jnp.asarray(np.random.default_rng(0).uniform(0.1, 1, model.lattice.cells))
    system = System(jnp.asarray(tables.blocks), model.supports, moduli, model.forces)
    found = solve_system(tables, system, jnp.zeros_like(model.forces), 1e-8, ("bending",) * len(model.forces))
    print(np.asarray(found.displacements).tobytes().hex())
print(any(name.startswith(("build_hierarchy", "multigrid_cg")) for name in names))
"""


def inverse_times(matrix: jax.Array, vector: jax.Array) -> tuple[jax.Array, jax.Array]:
    """Return what calls LAPACK, and the vector; tell that it is traced."""
    traced.append(matrix.shape)
    return jnp.linalg.inv(matrix) @ vector, vector + 1


@pytest.fixture(autouse=True)
def empty_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    traced.clear()
    with double_precision():
        yield


def fresh() -> KeptProgram[tuple[jax.Array, jax.Array]]:
    """Return the function as a new process has it."""
    return kept_program()(inverse_times)


def kept_files() -> list[Path]:
    folder = cache_folder()
    assert folder is not None
    return sorted(folder.glob("inverse_times_*"))


def answer(program: KeptProgram[tuple[jax.Array, jax.Array]]) -> bytes:
    return np.asarray(program(MATRIX, jnp.arange(3.0))[0]).tobytes()


def test_the_next_process_loads_it() -> None:
    first = answer(fresh())
    assert np.allclose(np.frombuffer(first), np.linalg.solve(MATRIX, np.arange(3.0)), rtol=1e-14)
    assert (len(traced), len(kept_files())) == (1, 1)
    again = fresh()
    assert answer(again) == answer(again) == first
    assert len(traced) == 1
    begun = fresh().begin(MATRIX, jax.ShapeDtypeStruct((3,), np.float64))
    assert [out.shape for out in begun.out_info] == [(3,), (3,)]
    assert len(traced) == 1
    assert jax.jit(lambda vector: fresh()(MATRIX, vector)[0])(jnp.arange(3.0)).shape == (3,)  # JAX's own


def test_one_that_is_not_kept_has_the_same_digits(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both are compiled at one level of optimisation."""
    levels: list[object] = []
    compile_program = jax.stages.Lowered.compile

    def noted(lowered: jax.stages.Lowered, compiler_options: dict[str, str | bool]) -> jax.stages.Compiled:
        levels.append(compiler_options)
        return compile_program(lowered, compiler_options)

    monkeypatch.setattr(jax.stages.Lowered, "compile", noted)
    first = answer(fresh())
    monkeypatch.setattr(kept_programs, "folder_of_programs", lambda: None)
    assert answer(fresh()) == first
    assert levels == [kept_programs._LEVEL] * 2
    assert len(traced) == 2


def test_numbers_of_32_bits_have_a_program_of_their_own() -> None:
    program, vector = fresh(), np.arange(3.0)
    assert program(MATRIX, vector)[1].dtype == np.float64
    with jax.enable_x64(False):
        assert program(MATRIX, vector)[1].dtype == np.float32
    assert program(MATRIX, vector)[1].dtype == np.float64


@pytest.mark.parametrize("damage", [lambda found: found[:-9], lambda found: found[:40] + b"x" + found[41:]])
def test_a_damaged_one_is_compiled_again(damage: object) -> None:
    assert callable(damage)
    first = answer(fresh())
    (file,) = kept_files()
    file.write_bytes(damage(file.read_bytes()))
    assert answer(fresh()) == first
    assert len(traced) == 2


def test_what_cannot_be_loaded_here_is_compiled_again(monkeypatch: pytest.MonkeyPatch) -> None:
    first = answer(fresh())
    monkeypatch.setattr(kept_programs, "make_known", lambda _: 1 / 0)
    assert answer(fresh()) == first
    assert len(traced) == 2


def test_a_program_of_other_origin_is_another_one(monkeypatch: pytest.MonkeyPatch) -> None:
    """Other files, settings or shapes; one from XLA's cache lacks code and is not kept once more."""
    answer(fresh())
    for number, (name, found) in enumerate({"digest_of_sources": "x", "_settings": "x"}.items()):
        with monkeypatch.context() as changed:
            changed.setattr(kept_programs, name, lambda *_, found=found: found)
            answer(fresh())
        assert (len(traced), len(kept_files())) == (number + 2, number + 2)
    fresh()(np.eye(2), jnp.arange(2.0))
    assert len(kept_files()) == 4
    for file in kept_files():
        file.unlink()
    answer(fresh())
    assert kept_files() == []


def test_a_digest_follows_the_files(tmp_path: Path) -> None:
    file = tmp_path / "part.py"
    file.write_text("a = 1")
    before = digest_of_sources.__wrapped__(tmp_path)
    file.write_text("a = 2")
    assert digest_of_sources.__wrapped__(tmp_path) != before


def test_plain_numbers_are_arguments_as_they_are() -> None:
    program = kept_program()(lambda factor, count, vector: vector * factor + count)
    program._function.__name__ = "scaled"
    for number in (2, 3):
        assert np.asarray(program(0.5, number, np.arange(2.0))).tolist() == [number, 0.5 + number]
    assert len(program._programs) == 1


def test_other_versions_of_jaxlib_are_left_to_jax(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(kept_programs, "_jaxlib", lambda: "0.9.2")
    answer(fresh())
    fresh().begin(MATRIX, np.arange(3.0)).compile()
    assert kept_files() == []


def test_nothing_is_kept_where_that_is_not_wanted() -> None:
    jax.config.update("jax_enable_compilation_cache", False)
    try:
        answer(fresh())
    finally:
        jax.config.update("jax_enable_compilation_cache", True)
    assert kept_files() == []


@pytest.mark.slow
def test_a_whole_solve_in_the_next_process(tmp_path: Path) -> None:
    """Displacements to the last bit, with kernels and LAPACK within, and neither program traced."""
    environment = {**os.environ, "XDG_CACHE_HOME": str(tmp_path / "of-two")}
    runs = [
        subprocess.run(
            [sys.executable, "-c", SOLVE], env=environment, capture_output=True, text=True, check=True
        )
        for _ in range(2)
    ]
    (first, cold), (second, warm) = (run.stdout.split() for run in runs)
    assert first == second
    assert (cold, warm) == ("True", "False")
