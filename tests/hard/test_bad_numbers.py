"""Numbers that no solver should touch, and load cases that differ."""

from __future__ import annotations

from dataclasses import replace

import jax.numpy as jnp
import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.numerics.grid.lattice import Lattice
from cranktopo.tasks.density.response import compliances, solve
from tests.hard import fields
from tests.hard.cases import THROW_LOADS, Block, cases
from tests.hard.outcome import direct
from tests.physics.density.throw_cases import clamped_beam

FIELD = fields.two_phase(fields.blobs(0.4), 1e-6)


@pytest.mark.parametrize("value", [np.nan, np.inf, -1.0])
def test_moduli(float64: None, value: float) -> None:
    moduli = FIELD.copy()
    moduli[3, 4, 5] = value
    with pytest.raises(CranktopoError, match="relative moduli") as caught:
        solve(Block("", FIELD).model(), jnp.asarray(moduli))
    assert caught.value.code == ExitCode.SOLVER


def test_one_modulus_among_many(float64: None) -> None:
    """So many that a compiled minimum passes over it."""
    lattice = Lattice((12, 28, 16), 1.0, 1.0, (1.0,) * 16, 0.3)
    moduli = jnp.ones(lattice.cells).at[10, 0, 8].set(jnp.nan)
    with pytest.raises(CranktopoError, match="or no number"):
        solve(clamped_beam(lattice, 1, 2, 1000.0), moduli)


def test_no_stiffness_at_all(float64: None) -> None:
    with pytest.raises(CranktopoError, match="one positive"):
        solve(Block("", FIELD).model(), jnp.zeros(fields.CELLS))


@pytest.mark.parametrize("value", [np.nan, np.inf])
def test_forces(float64: None, value: float) -> None:
    model = Block("", FIELD).model()
    with pytest.raises(CranktopoError, match="load case tip has forces that are not finite") as caught:
        solve(model, jnp.asarray(FIELD), forces=model.forces.at[0, 1, 2, 3, 4].set(value))
    assert caught.value.code == ExitCode.SOLVER


@pytest.mark.slow
def test_a_spoilt_guess_is_thrown_away(float64: None) -> None:
    model = Block("", FIELD).model()
    fresh = solve(model, jnp.asarray(FIELD))
    guess = jnp.zeros_like(model.forces).at[0, 1, 2, 3, 4].set(jnp.nan)
    again = solve(model, jnp.asarray(FIELD), guess=guess)
    work = [float(compliances(model, s.displacements)[0]) for s in (fresh, again)]
    assert work[1] == pytest.approx(work[0], rel=1e-10)
    assert again.notice


@pytest.mark.slow
def test_a_load_case_without_load_rests(float64: None) -> None:
    """Beside another one that is solved; its displacements are exactly zero."""
    throw = cases()["throw, journals overlap"]
    model = throw.model()
    forces = model.forces.at[1].set(0.0)
    solution = solve(model, jnp.asarray(throw.moduli), forces=forces)
    assert not np.any(solution.displacements[1])
    work = float(compliances(model, solution.displacements, forces)[0])
    expected = direct(throw.name)[0].compliance / model.modulus_MPa
    assert work / model.modulus_MPa * model.share == pytest.approx(expected, rel=1e-9)


@pytest.mark.slow
def test_the_error_names_the_load_case(float64: None) -> None:
    throw = cases()["throw, journals overlap"]
    model, moduli = throw.model(), np.asarray(throw.moduli).copy()
    cell = np.argwhere(moduli[:, :, 2:-2] == moduli[moduli > 0].min())[-1] + [0, 0, 2]
    node = tuple(cell)
    moduli[tuple(slice(i - 1, i + 1) for i in node)] = 1e-9
    forces = model.forces.at[(1, 1, *node)].add(float(jnp.abs(model.forces).max()))
    with pytest.raises(CranktopoError, match=f"load case {THROW_LOADS[1].name}.*no material"):
        solve(replace(model, forces=forces), jnp.asarray(moduli))
