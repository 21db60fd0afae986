"""Journals with play in rigid bearings: against another minimiser, and conditions that an answer keeps."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from cranktopo.base.errors import CranktopoError
from cranktopo.numerics import ring_contact
from cranktopo.numerics.ring_contact import sections_in_rings

JOURNALS, STATES = 5, 40
PLAY = np.array([0.02, 0.03, 0.025, 0.04, 0.02])


def shaft(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """A stiffness that resists no motion of the whole as one straight body, as that of a shaft, and loads."""
    draw = np.random.default_rng(seed)
    along = np.arange(JOURNALS) - 2.0
    rigid = np.kron(np.stack([np.ones(JOURNALS), along], axis=1), np.eye(2))
    rigid, _ = np.linalg.qr(rigid)
    free = np.eye(2 * JOURNALS) - rigid @ rigid.T
    root = free @ draw.normal(0.0, 600.0, (2 * JOURNALS, 2 * JOURNALS))
    sizes = draw.uniform(100.0, 2e4, STATES)
    return root @ root.T, sizes * draw.normal(0.0, 1.0, (2 * JOURNALS, STATES))


@pytest.mark.parametrize("seed", [1, 2])
def test_the_energy_is_that_of_another_minimiser(seed: int) -> None:
    """SLSQP of every load by itself. Forces push to the middle, and none where a journal does not touch."""
    stiffness, load = shaft(seed)
    found = sections_in_rings(stiffness, load, PLAY)
    force = (load - stiffness @ found).T.reshape(STATES, JOURNALS, 2)
    offset = found.T.reshape(STATES, JOURNALS, 2)
    size, scale = np.linalg.norm(offset, axis=2), np.abs(load).max()
    assert (size <= PLAY * (1 + 2e-9)).all()
    pressed = np.linalg.norm(force, axis=2)
    assert np.abs(force - pressed[..., None] * offset / size[..., None]).max() < 1e-8 * scale
    touching = size > PLAY * (1 - 1e-6)
    assert 0.1 < touching.mean() < 0.9
    assert pressed[~touching].max() < 2e-9 * scale
    for number, one in enumerate(load.T[:3]):
        unit = scale * PLAY.max()

        def energy(u: np.ndarray, one: np.ndarray = one, unit: float = unit) -> float:
            v = u * PLAY.max()
            return float((v @ stiffness @ v / 2 - one @ v) / unit)

        rings = {
            "type": "ineq",
            "fun": lambda u: (PLAY / PLAY.max()) ** 2 - (u.reshape(JOURNALS, 2) ** 2).sum(axis=1),
        }
        other = minimize(energy, np.zeros(2 * JOURNALS), constraints=[rings], tol=1e-12)
        assert energy(found[:, number] / PLAY.max()) <= other.fun + 1e-9
        assert energy(found[:, number] / PLAY.max()) == pytest.approx(other.fun, rel=1e-5, abs=1e-8)


def test_turned_loads_turn_the_answer() -> None:
    """Rings are alike in every direction; so is a stiffness that is the same along x and y."""
    stiffness = np.kron(np.array([[1.0, -2.0, 1.0], [-2.0, 4.0, -2.0], [1.0, -2.0, 1.0]]) * 1e5, np.eye(2))
    load = np.random.default_rng(4).normal(0.0, 5e3, (6, 20))
    turn = np.kron(np.eye(3), [[0.6, -0.8], [0.8, 0.6]])
    play = np.full(3, 0.03)
    one, other = (sections_in_rings(stiffness, own, play) for own in (load, turn @ load))
    assert np.abs(turn @ one - other).max() < 1e-9


def test_what_has_no_answer_is_an_error(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(ring_contact, "_ROUNDS", 0)
    stiffness, load = shaft(1)
    with pytest.raises(CranktopoError, match="40 of 40 states of the shaft have no answer"):
        sections_in_rings(stiffness, load, PLAY)
