"""Programs compiled side by side are the ones that a solve finds; the clock counts overlaps once."""

from __future__ import annotations

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.fem.compiling import compile_multigrid
from cranktopo.fem.conjugate_gradients import System, multigrid_cg
from cranktopo.fem.multigrid import build_hierarchy, build_tables
from cranktopo.fem.precision import CompileClock
from tests.studies.cantilever import cantilever

EVENT = "/jax/core/compile/backend_compile_duration"


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
    hierarchy = build_hierarchy(tables, system.supports, moduli, "float32")
    result = multigrid_cg(system, hierarchy, degree, guess, *limits)
    assert compiled == []
    assert float(jnp.max(result.relative_residual)) <= 1e-8
    compiled.clear()
    build_hierarchy(tables, system.supports, moduli, "float64")
    assert compiled == [EVENT]


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
