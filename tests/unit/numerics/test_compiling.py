"""Programs compiled ahead are the ones that are run; the clock counts overlaps once."""

from __future__ import annotations

import json
import logging
import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import product
from pathlib import Path

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.design.schema import Scene
from cranktopo.numerics import precision
from cranktopo.numerics.grid.conjugate_gradients import System, multigrid_cg
from cranktopo.numerics.grid.equilibrium import compile_multigrid
from cranktopo.numerics.grid.multigrid import build_hierarchy, build_tables
from cranktopo.numerics.kernels import registry as processor
from cranktopo.numerics.precision import CompileClock
from cranktopo.tasks.density import loop
from cranktopo.tasks.density.build import build_problem
from cranktopo.tasks.density.proposals import compile_optimality_criteria
from cranktopo.tasks.density.response import compliance_gradients, solve
from cranktopo.tasks.density.stage import prepare
from tests.studies.cantilever import cantilever

EVENT = "/jax/core/compile/backend_compile_duration"
MEMORY = """
import json
import jax.numpy as jnp
from cranktopo.numerics.grid import equilibrium as compiling
from cranktopo.numerics.grid.conjugate_gradients import System
from cranktopo.numerics.grid.multigrid import build_tables
from cranktopo.numerics.precision import double_precision
from tests.studies.cantilever import cantilever

def resident_MiB():
    line = next(line for line in open("/proc/self/status") if line.startswith("RssAnon"))
    return int(line.split()[1]) / 1024

known = {}
give_back = compiling._give_back_memory
compiling._give_back_memory = lambda: (known.update(before=resident_MiB()), give_back())
with double_precision():
    model, _ = cantilever((32, 16, 16))
    tables = build_tables(model.lattice, model.levels)
    system = System(jnp.asarray(tables.blocks), model.supports, jnp.ones(model.lattice.cells), model.forces)
    compiling.compile_multigrid(tables, system, "float32")
print(json.dumps({**known, "after": resident_MiB()}))
"""

OF_NO_FUNCTION = {
    f"jit({name})"
    for name in (
        *("stage", "convert_element_type", "broadcast_in_dim", "dynamic_slice", "unstack", "dot", "_einsum"),
        *("add", "subtract", "multiply", "true_divide", "maximum", "greater", "tanh"),
        *("_reduce_sum", "_reduce_max", "_reduce_all", "_reduce_any"),
    )
}
"""Programs of single operations, which NumPy does without one."""


@pytest.mark.slow
def test_a_solve_compiles_nothing_more(float64: None) -> None:
    model, _ = cantilever((8, 4, 6))
    tables = build_tables(model.lattice, model.levels)
    moduli = jnp.asarray(np.random.default_rng(0).uniform(0.1, 1, model.lattice.cells))
    system = System(jnp.asarray(tables.blocks), model.supports, moduli, model.forces)
    degree, guess = jnp.asarray(2), jnp.zeros_like(model.forces)
    limits = jnp.asarray(1e-8), jnp.asarray(99)
    compile_multigrid(tables, system, "float32")
    compiled: list[str] = []
    jax.monitoring.register_event_duration_secs_listener(
        lambda event, _, **__: compiled.append(event) if event == EVENT else None
    )
    hierarchy = build_hierarchy(tables, system.supports, moduli, precision="float32")
    result = multigrid_cg(system, hierarchy, degree, guess, *limits)
    assert compiled == []
    assert float(jnp.max(result.relative_residual)) <= 1e-8
    compiled.clear()
    build_hierarchy(tables, system.supports, moduli, precision="float64")
    assert compiled == [EVENT]


@pytest.mark.slow
def test_the_step_compiles_nothing_more(mikron: Scene, float64: None) -> None:
    prepared = prepare(mikron.with_optimise(resolution_mm=4.5))
    problem = build_problem(prepared.scene, prepared.domain, prepared.cases)
    jax.clear_caches()  # else another test may have compiled them
    compile_optimality_criteria(problem)
    names: list[str] = []
    with compiled(names):
        loop.step(problem, loop.init(problem))
    assert "jit(_nominal)" in names
    assert "jit(update)" not in names
    assert not OF_NO_FUNCTION & set(names)


def test_a_problem_is_built_by_functions_alone(mikron: Scene, float64: None) -> None:
    """No program for the copy of an array or one quotient: each takes 10 ms for every new shape."""
    names: list[str] = []
    with compiled(names):
        prepared = prepare(mikron.with_optimise(resolution_mm=3.9))
        build_problem(prepared.scene, prepared.domain, prepared.cases)
    assert names
    assert not OF_NO_FUNCTION & set(names)


def test_programs_are_loaded_from_a_folder_of_the_user_alone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
) -> None:
    """What is loaded is run: whoever can write there would run code as this user."""
    caplog.set_level(logging.INFO, logger="cranktopo.notes")
    precision._tell_not_kept.cache_clear()
    for open_to_others in (".", ".."):
        monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path / f"cache{open_to_others}x"))
        folder = precision.cache_folder()
        assert folder is not None
        assert folder.stat().st_mode & 0o777 == 0o700
        with precision.double_precision():
            assert str(folder) == jax.config.jax_compilation_cache_dir
        (folder / open_to_others).chmod(0o777)
        with precision.double_precision():
            assert jax.config.jax_compilation_cache_dir is None
    assert [record.message for record in caplog.records] == [
        "compiled programs are not kept: no cache is this user's alone; set XDG_CACHE_HOME to your own folder"
    ]


@contextmanager
def compiled(names: list[str]) -> Iterator[None]:
    """Collect the names of programs that are compiled meanwhile."""

    class Handler(logging.Handler):
        def emit(self, record: logging.LogRecord) -> None:
            if record.getMessage().startswith("Finished XLA compilation of"):
                names.append(record.getMessage().split()[4])

    handler, logger = Handler(), logging.getLogger("jax._src.dispatch")
    logger.addHandler(handler)
    try:
        with jax.log_compiles():
            yield
    finally:
        logger.removeHandler(handler)


@pytest.mark.slow
def test_the_memory_of_compilers_is_given_back() -> None:
    """Of a user's own process some 300 MiB for the programs of a solve; the allocator would keep most."""
    here = os.environ | {"JAX_ENABLE_COMPILATION_CACHE": "false", "XLA_FLAGS": ""}
    done = subprocess.run(
        [sys.executable, "-c", MEMORY], env=here, capture_output=True, text=True, check=True
    )
    known = json.loads(done.stdout)
    assert known["after"] < known["before"] - 100


@pytest.mark.slow
def test_kernels_ahead_are_those_of_a_solve(float64: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """`pytest -m slow` of this file, 10 s."""
    made: list[tuple[str, str]] = []
    register = processor._register

    def noted(kernel: str, precision: str, *width_and_threads: int) -> str:
        made.append((kernel, precision))
        return register(kernel, precision, *width_and_threads)

    monkeypatch.setattr(processor, "_register", noted)
    processor.compile_kernels()
    ahead, _ = set(made), made.clear()
    jax.clear_caches()
    model, _ = cantilever((32, 16, 16))
    moduli = jnp.ones(model.lattice.cells)
    u = solve(model, moduli).displacements
    compliance_gradients(model, u)
    assert set(made) == ahead


def test_clocks_share_one_listener(monkeypatch: pytest.MonkeyPatch) -> None:
    """JAX keeps every listener for the life of the process."""
    registered: list[object] = []
    register = jax.monitoring.register_event_duration_secs_listener
    monkeypatch.setattr(
        jax.monitoring,
        "register_event_duration_secs_listener",
        lambda listener: (registered.append(listener), register(listener)),
    )
    clocks = [CompileClock() for _ in range(3)]
    assert len(registered) <= 1
    del clocks[0]
    jax.monitoring.record_event_duration_secs(EVENT, 1e-9)
    assert all(clock.compile_s > 0 for clock in clocks)


def test_the_clock_counts_what_overlaps_once(monkeypatch: pytest.MonkeyPatch) -> None:
    now = [100.0]
    monkeypatch.setattr("time.perf_counter", lambda: now[0])
    clock = CompileClock()
    for now[0], seconds in ((105.0, 4.0), (106.0, 3.0), (110.0, 1.0), (109.9, 0.2)):
        jax.monitoring.record_event_duration_secs(EVENT, seconds)
    jax.monitoring.record_event_duration_secs("/jax/other", 50.0)
    assert clock.compile_s == pytest.approx(5.0 + 1.0)


@pytest.mark.parametrize(
    ("installed", "own", "found"),
    [
        ("0.10.2", None, "--xla_cpu_use_fusion_emitters=false"),
        ("0.10.2", "--xla_dump_to=x", "--xla_dump_to=x"),
        ("0.5.0", None, None),
        ("0.11.0", None, None),
    ],
)
def test_only_versions_that_were_tested_get_the_flag(
    installed: str, own: str | None, found: str | None, monkeypatch: pytest.MonkeyPatch
) -> None:
    """An unknown flag ends the process; a user's own flags stay."""
    monkeypatch.setattr(precision, "version", lambda _: installed)
    monkeypatch.delenv("XLA_FLAGS", raising=False)
    if own is not None:
        monkeypatch.setenv("XLA_FLAGS", own)
    precision.compile_quickly()
    assert os.environ.get("XLA_FLAGS") == found


@pytest.mark.slow
def test_both_emitters_make_programs_with_the_same_digits() -> None:
    """Of a solve by kernels, and of one by JAX code in float64."""
    code = """
import jax.numpy as jnp, numpy as np, sys
from cranktopo.numerics.grid.conjugate_gradients import System, multigrid_cg
from cranktopo.numerics.grid.multigrid import build_hierarchy, build_tables
from cranktopo.numerics.precision import double_precision
from tests.studies.cantilever import cantilever
with double_precision():
    model, _ = cantilever((16, 8, 8))
    tables = build_tables(model.lattice, model.levels)
    moduli = jnp.asarray(np.random.default_rng(0).uniform(0.1, 1, model.lattice.cells))
    system = System(jnp.asarray(tables.blocks), model.supports, moduli, model.forces)
    for precision in ("float32", "float64"):
        hierarchy = build_hierarchy(tables, system.supports, moduli, precision=precision)
        limits = jnp.asarray(2), jnp.zeros_like(model.forces), jnp.asarray(1e-8), jnp.asarray(99)
        print(np.asarray(multigrid_cg(system, hierarchy, *limits).displacements).tobytes().hex())
"""
    said = []
    for flags, kernels in product(("", "--xla_cpu_use_fusion_emitters=false"), ("on", "off")):
        more = {"XLA_FLAGS": flags, "CRANKTOPO_KERNELS": kernels}
        ended = subprocess.run(
            [sys.executable, "-c", code], env=os.environ | more, capture_output=True, text=True, check=True
        )
        said.append(ended.stdout)
    assert len(said[0]) > 10_000
    assert said[:2] == said[2:]
