"""State of an optimisation: explicit, immutable, serialisable, enough to continue bit for bit."""

from __future__ import annotations

from dataclasses import asdict, dataclass
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
ARRAY_FIELDS = ("x", "evaluated", "displacements")
Status = Literal["running", "converged", "stopped"]


@dataclass(frozen=True)
class Record:
    """One row of the history.

    Attributes:
        iteration: number of the design, from 1.
        objective: weighted sum of the compliances over their initial values.
        compliance_N_mm: per load case, full throw.
        greyness: 0 black and white, 1 all grey.
        change: largest change of a design variable by the step that followed.
        notice: what the solver had to say, one sentence when its first method was not enough, else empty.
    """

    iteration: int
    beta: float
    objective: float
    compliance_N_mm: tuple[float, ...]
    volume_fraction: float
    greyness: float
    change: float
    cg_iterations: int
    seconds: float
    notice: str = ""


@dataclass(frozen=True)
class State:
    """Where an optimisation stands.

    Attributes:
        x: design variables of the next design (nx, ny, nw).
        evaluated: design variables of the last design evaluated, the result once done.
        displacements: of the last design, warm start of the next solve.
        beta: projection steepness of the next design.
        stage_start: iterations done when the current beta began.
        initial_N_mm: compliances of the first design, the normalisation of the objective.
        history: one record per design evaluated.
        status: running, converged (all criteria met) or stopped (a limit was hit).
    """

    x: Array
    evaluated: Array
    displacements: Array
    beta: float
    stage_start: int = 0
    initial_N_mm: tuple[float, ...] = ()
    history: tuple[Record, ...] = ()
    status: Status = "running"
    reason: str = ""

    @property
    def last(self) -> Record:
        """Record of the last design evaluated."""
        return self.history[-1]

    @property
    def done(self) -> bool:
        """Whether no further step is wanted."""
        return self.status != "running"


def to_checkpoint(state: State) -> tuple[dict[str, Array], dict[str, Any]]:
    """The state as named arrays and JSON-able data."""
    data = asdict(state)
    arrays = {name: data.pop(name) for name in ARRAY_FIELDS}
    return arrays, data


def from_checkpoint(arrays: dict[str, Array], data: dict[str, Any]) -> State:
    """The state from what `to_checkpoint` returned, exactly."""
    records = [{**row, "compliance_N_mm": tuple(row["compliance_N_mm"])} for row in data["history"]]
    return State(
        x=arrays["x"],
        evaluated=arrays["evaluated"],
        displacements=arrays["displacements"],
        beta=data["beta"],
        stage_start=data["stage_start"],
        initial_N_mm=tuple(data["initial_N_mm"]),
        history=tuple(Record(**row) for row in records),
        status=data["status"],
        reason=data["reason"],
    )
