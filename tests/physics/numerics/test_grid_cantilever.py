"""A cantilever by `numerics.grid` alone: cells, supports, load, solve; no crank in sight."""

from __future__ import annotations

from dataclasses import replace

import jax.numpy as jnp
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.numerics.grid import equilibrium
from cranktopo.numerics.grid.boundary_conditions import CaseSupports, SectionMotion, build_supports
from cranktopo.numerics.grid.conjugate_gradients import System
from cranktopo.numerics.grid.equilibrium import METHODS, Advice, solve_system
from cranktopo.numerics.grid.lattice import Lattice
from cranktopo.numerics.grid.multigrid import GridTables, build_tables

MODULUS_MPA, LOAD_N = 210e3, 1000.0
WIDTH, DEPTH, LENGTH = 4, 8, 64


def cantilever(width: int, depth: int, length: int) -> tuple[GridTables, System]:
    """Cells of 1 mm, the first face clamped, the last one free to sink, tilt and slide under a load."""
    lattice = Lattice((width, depth, length), 1.0, 1.0, (1.0,) * length, 0.0)
    free = (SectionMotion(-1, "ty", load=LOAD_N), SectionMotion(-1, "rx"), SectionMotion(-1, "tz"))
    centre_mm = (-width / 2, -depth / 2)
    supports, forces = build_supports(lattice, centre_mm, 2, (CaseSupports((), (), free),))
    tables = build_tables(lattice, 2)
    moduli = jnp.full(lattice.cells, MODULUS_MPA)
    return tables, System(jnp.asarray(tables.blocks), supports, moduli, jnp.asarray(forces))


@pytest.mark.slow
def test_a_rigid_end_face_sinks_as_a_beam_does(float64: None) -> None:
    """F L^3 / (3 E I) + F L / (k G A)."""
    tables, system = cantilever(WIDTH, DEPTH, LENGTH)
    found = solve_system(tables, system, jnp.zeros(system.forces.shape), 1e-9, ("end load",))
    inertia, area = WIDTH * DEPTH**3 / 12, WIDTH * DEPTH
    shear_MPa = MODULUS_MPA / 2
    bending = LOAD_N * LENGTH**3 / (3 * MODULUS_MPA * inertia)
    expected = bending + LOAD_N * LENGTH / (10 / 12 * shear_MPa * area)
    sunk = found.displacements[0, 1, :, :, -1]
    assert float(jnp.ptp(sunk)) == pytest.approx(0.0, abs=1e-9 * expected)
    # Shear is 0.9 % of it, so it counts.
    assert float(sunk.mean()) == pytest.approx(expected, rel=2e-3)


@pytest.mark.slow
@pytest.mark.parametrize("advice", [None, Advice("softer hands", "softer hands")])
def test_who_calls_the_solver_says_what_helps(
    float64: None, monkeypatch: pytest.MonkeyPatch, advice: Advice | None
) -> None:
    monkeypatch.setattr(equilibrium, "METHODS", tuple(replace(method, cap=1) for method in METHODS))
    tables, system = cantilever(4, 4, 8)
    with pytest.raises(CranktopoError, match="load case end load stopped") as caught:
        solve_system(
            tables,
            system,
            jnp.zeros(system.forces.shape),
            1e-12,
            ("end load",),
            **{"advice": advice} if advice else {},
        )
    assert ("softer hands" in caught.value.hint) == bool(advice)
    assert "journal" not in caught.value.hint
