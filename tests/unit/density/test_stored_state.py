"""A checkpoint that no optimisation wrote is one line, whatever in it is changed."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.tasks.density.state import Record, State, from_checkpoint, to_checkpoint

Data = dict[str, Any]


def stored() -> tuple[Data, Data]:
    row = Record(1, 1.0, 1.0, (2.0, 3.0), 0.3, 0.1, 0.2, 10, 0.5)
    x = np.full((3, 2, 2), 0.4)
    state = State(x, x, np.zeros((2, 4, 3, 3, 3)), 1.0, 0, (2.0, 3.0), (row,), memory={"low": x})
    return to_checkpoint(state)


def test_what_was_written_is_read() -> None:
    state = from_checkpoint(*stored())
    assert (state.last.iteration, state.beta, state.memory["low"].shape) == (1, 1.0, (3, 2, 2))


@pytest.mark.parametrize("name", ["x", "evaluated", "displacements", "memory.low"])
@pytest.mark.parametrize("value", [np.full((3, 2, 2), np.nan), np.array("text")], ids=["nan", "text"])
def test_arrays_without_numbers(name: str, value: np.ndarray) -> None:
    arrays, data = stored()
    with pytest.raises(CranktopoError, match=f"damaged, {name} without numbers"):
        from_checkpoint({**arrays, name: value}, data)


def _row(**changed: Any) -> Callable[[Data, Data], Any]:
    return lambda arrays, data: data["history"][0].update(changed)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (lambda arrays, data: arrays.pop("evaluated"), "evaluated missing"),
        (lambda arrays, data: data.pop("beta"), "beta: field required"),
        (lambda arrays, data: data.update(beta="1"), "beta: .*valid number"),
        (lambda arrays, data: data.update(beta=-1.0), "its history does not add up"),
        (lambda arrays, data: data.update(stage_start=-1), "its history does not add up"),
        (lambda arrays, data: data.update(status="finished"), "status: input should be"),
        (lambda arrays, data: data.update(history={}), "history: "),
        (lambda arrays, data: data.update(rounds=[{"iteration": 1}]), "rounds.0.bounds"),
        (lambda arrays, data: data.update(coarse_start=3), "coarse_start"),
        (_row(iteration=4), "its history does not add up"),
        (_row(compliance_N_mm=None), "history.0.compliance_N_mm"),
    ],
)
def test_a_changed_state(change: Callable[[Data, Data], Any], words: str) -> None:
    arrays, data = stored()
    change(arrays, data)
    with pytest.raises(CranktopoError, match=f"checkpoint/state.npz: damaged, {words}"):
        from_checkpoint(arrays, data)
