"""The balance factor of the original is the one that `loads` and `balance` tell, not that of the cells."""

from __future__ import annotations

import pytest

from cranktopo.design.loading import load_scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.optimise.metrics import _balance_moved


def test_it_is_brought_to_the_exact_one() -> None:
    scene = load_scene("industrial-gas")
    own = throw_balance(scene)
    assert own.balance_factor_percent is not None
    in_cells = own.balance_factor_percent + 0.8, own.throw_unbalance_kg_mm - 0.2
    before = dict(zip(("balance_factor", "unbalance"), in_cells, strict=True))
    after = {"balance_factor": before["balance_factor"] - 10, "unbalance": before["unbalance"] + 3}
    moved = _balance_moved(scene, after, before)
    assert moved is not None
    assert moved.original_percent == own.balance_factor_percent
    assert moved.balance_factor_percent == pytest.approx(own.balance_factor_percent - 10, rel=1e-12)
