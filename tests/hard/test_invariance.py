"""The same structure in other units, another precision of the cycle, with an island more."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import jax
import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.numerics.grid.conjugate_gradients import CgResult, System, multigrid_cg
from cranktopo.numerics.grid.equilibrium import METHODS, Method, run_method
from cranktopo.numerics.grid.multigrid import GridTables, build_hierarchy, build_tables
from cranktopo.numerics.precision import Precision
from cranktopo.tasks.density.response import solve
from tests.hard import fields
from tests.hard.cases import Block

FIELD = fields.two_phase(fields.blobs(0.4), 1e-6)


def displacements(block: Block) -> np.ndarray:
    return np.asarray(solve(block.model(), jnp.asarray(block.moduli), tolerance=1e-11).displacements[0])


@pytest.mark.parametrize("factor", [1e-3, 1e3])
def test_dimensions(float64: None, factor: float) -> None:
    """u = F / (E L): the same forces on a body so many times as large move it so many times less."""
    reference = displacements(Block("", FIELD))
    scaled = displacements(Block("", FIELD, lattice=fields.stretched((factor, factor, factor))))
    assert np.abs(scaled * factor - reference).max() < 1e-9 * np.abs(reference).max()


@pytest.mark.parametrize("factor", [1e-6, 1e6])
def test_moduli(float64: None, factor: float) -> None:
    reference = displacements(Block("", FIELD))
    scaled = displacements(Block("", factor * FIELD))
    assert np.abs(scaled * factor - reference).max() < 1e-9 * np.abs(reference).max()


@pytest.mark.parametrize("factor", [1e-6, 1e6])
def test_loads(float64: None, factor: float) -> None:
    reference = displacements(Block("", FIELD))
    scaled = displacements(Block("", FIELD, forces=factor * fields.tip_load()))
    assert np.abs(scaled / factor - reference).max() < 1e-9 * np.abs(reference).max()


@pytest.mark.slow
@pytest.mark.parametrize("void", [1e-3, 1e-9])
def test_precision_of_the_cycle(float64: None, void: float) -> None:
    """float32 inside costs no accuracy, and no cycles."""
    system, tables = assembled(Block("", fields.two_phase(fields.blobs(0.4), void)))
    results, precisions = {}, ("float32", "float64")
    for precision in precisions:
        results[precision] = cycle(system, tables, precision)
    single, double = (results[p] for p in precisions)
    assert max(single[1], double[1]) <= 1e-8
    assert single[0] == pytest.approx(double[0], rel=1e-11)
    assert abs(single[2] - double[2]) <= 0.1 * double[2] + 2


def assembled(block: Block) -> tuple[System, GridTables]:
    model = block.model()
    tables = build_tables(model.lattice, model.levels)
    return System(jnp.asarray(tables.blocks), model.supports, jnp.asarray(block.moduli), model.forces), tables


def cycle(
    system: System, tables: GridTables, precision: Precision, solver: Callable[..., CgResult] = multigrid_cg
) -> tuple[float, float, int]:
    hierarchy = build_hierarchy(tables, system.supports, system.moduli, precision=precision)
    start, limits = jnp.zeros_like(system.forces), (jnp.asarray(1e-8), jnp.asarray(200))
    result = solver(system, hierarchy, jnp.asarray(METHODS[0].degree), start, *limits)
    work = float(jnp.sum(system.forces * result.displacements))
    return work, float(result.relative_residual[0]), int(result.iterations)


@pytest.mark.slow
def test_half_the_smoothing_of_large_grids(float64: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """The same answer after more, cheaper cycles; far fewer than without the coarse levels."""
    system, tables = assembled(Block("", FIELD))
    found = {}
    for nodes in (10**9, 0):
        monkeypatch.setattr("cranktopo.numerics.grid.multigrid._LARGE_NODES", nodes)
        afresh = jax.jit(lambda *given: multigrid_cg.__wrapped__(*given))
        found[nodes] = cycle(system, tables, "float32", afresh)
    whole, half = found.values()
    assert max(whole[1], half[1]) <= 1e-8
    assert half[0] == pytest.approx(whole[0], rel=1e-11)
    assert whole[2] < half[2] <= 2 * whole[2]


def test_precision_is_the_callers_choice(float64: None, monkeypatch: pytest.MonkeyPatch) -> None:
    """The first method gets it; what both give is compared above."""
    block, asked = Block("", FIELD), []

    def watched(method: Method, *arguments: Any) -> Any:
        asked.append((method.name, method.precision))
        return run_method(METHODS[0], *arguments)

    monkeypatch.setattr("cranktopo.numerics.grid.equilibrium.run_method", watched)
    for precision in ("float32", "float64"):
        solve(block.model(), jnp.asarray(block.moduli), precision=precision)
    assert asked == [("multigrid CG", "float32"), ("multigrid CG", "float64")]


def test_an_island_in_nothing_changes_nothing(float64: None) -> None:
    """Void of modulus 0: the island may move freely, the matrix is singular, the answer is not."""
    beam = fields.island()
    beam[6:] = False
    with_island, without = (Block("", fields.two_phase(solid, 0.0)) for solid in (fields.island(), beam))
    expected = displacements(without)[:, :5]
    assert np.abs(displacements(with_island)[:, :5] - expected).max() < 1e-9 * np.abs(expected).max()
