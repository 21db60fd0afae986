"""State of an optimisation: explicit, immutable, serialisable, enough to continue bit for bit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from types import MappingProxyType
from typing import Any, Literal, NamedTuple

import numpy as np
from pydantic import TypeAdapter, ValidationError

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.faults import faults_of
from cranktopo.base.files import json_text

ARRAY_FIELDS = ("x", "evaluated", "displacements")
"""Of a state, kept as arrays."""
MEMORY = "memory."
Status = Literal["running", "converged", "stopped", "infeasible"]


@dataclass(frozen=True)
class Record:
    """One row of the history.

    Attributes:
        iteration: number of the design, from 1.
        objective: what is minimised, scaled: the weighted sum of the compliances over their initial values,
            or the goal over its reference.
        compliance_N_mm: per load case, full throw.
        greyness: 0 black and white, 1 all grey.
        change: largest change of a design variable by the step that followed.
        goals, limits: values of the responses of the goals and of the limits, in their units.
        broken: largest share by which a limit is broken; negative where all hold.
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
    goals: tuple[float, ...] = ()
    limits: tuple[float, ...] = ()
    broken: float = 0.0


@dataclass(frozen=True)
class MovedBounds:
    """A converged design that was evaluated, and the bounds of the limits in the model from then on."""

    iteration: int
    bounds: tuple[float, ...]


@dataclass(frozen=True)
class CoarseStart:
    """Iterations on larger cells before the first one.

    Attributes:
        cell_mm: their largest edge.
    """

    cell_mm: float
    iterations: int
    seconds: float


@dataclass(frozen=True)
class State:
    """Present state of an optimisation.

    Attributes:
        x: design variables of the next design (nx, ny, nw).
        evaluated: design variables of the last design evaluated, the result once done.
        displacements: of the last design, and after them those of its eroded form where members or gaps have
            a least size: warm start of the next solves.
        beta: projection steepness of the next design.
        stage_start: iterations done when the current beta began.
        initial_N_mm: compliances of the first design, the normalisation of the objective; of that on larger
            cells where these came first.
        history: one record per design evaluated.
        status: running, converged (all criteria met), stopped (the iterations are spent) or infeasible (no
            design was found that meets every limit).
        memory: what the optimiser remembers of its steps, by name.
        rounds: how the limits were moved by an evaluation of the design, in order.
        coarse_start: where the first design comes from, None where it was uniform.
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
    memory: Mapping[str, Array] = field(default_factory=dict)
    rounds: tuple[MovedBounds, ...] = ()
    coarse_start: CoarseStart | None = None

    @property
    def bounds(self) -> tuple[float, ...]:
        """Bounds of the limits that hold now; empty while they are those of the problem."""
        return self.rounds[-1].bounds if self.rounds else ()

    @property
    def last(self) -> Record:
        """Record of the last design evaluated."""
        return self.history[-1]

    @property
    def done(self) -> bool:
        """True where no further step is wanted."""
        return self.status != "running"


class Proposal(NamedTuple):
    """The next design variables, what the present design reached as in `Record`, and what is remembered."""

    x: Array
    objective: float
    goals: tuple[float, ...] = ()
    limits: tuple[float, ...] = ()
    violation: float = 0.0
    memory: Mapping[str, Array] = MappingProxyType({})


def to_checkpoint(state: State) -> tuple[dict[str, Array], dict[str, Any]]:
    """Return the state as named arrays and JSON-able data."""
    data = asdict(state)
    arrays = {name: data.pop(name) for name in ARRAY_FIELDS}
    arrays |= {MEMORY + name: array for name, array in data.pop("memory").items()}
    return arrays, data


@dataclass(frozen=True)
class _Plain:
    """Plain data of a sound checkpoint."""

    history: tuple[Record, ...]
    beta: float
    stage_start: int
    status: Status
    reason: str
    initial_N_mm: tuple[float, ...]
    rounds: tuple[MovedBounds, ...] = ()
    coarse_start: CoarseStart | None = None


def damaged(fault: str) -> CranktopoError:
    """Return the error for a checkpoint that no optimisation wrote so."""
    return CranktopoError(f"checkpoint/state.npz: damaged, {fault}.", hint="Start a new run of the design.")


def _sound(data: Mapping[str, Any]) -> _Plain:
    """Return the plain data of a checkpoint; raises CranktopoError where they are damaged."""
    try:
        plain = TypeAdapter(_Plain).validate_json(json_text(data, "state"), strict=True)
    except ValidationError as error:
        raise damaged(str(faults_of(error)[0])) from None
    counted = [row.iteration for row in plain.history] == list(range(1, len(plain.history) + 1))
    if not counted or plain.stage_start < 0 or plain.beta <= 0:
        raise damaged("its history does not add up")
    return plain


def _check_arrays(arrays: Mapping[str, Array]) -> None:
    missing = [name for name in ARRAY_FIELDS if name not in arrays]
    if missing:
        raise damaged(f"{', '.join(missing)} missing")
    wrong = [name for name, array in arrays.items() if array.dtype.kind not in "fiu" or np.isnan(array).any()]
    if wrong:
        raise damaged(f"{', '.join(wrong)} without numbers")


def from_checkpoint(arrays: dict[str, Array], data: dict[str, Any]) -> State:
    """Return the state from what `to_checkpoint` returned, exactly; raises CranktopoError."""
    _check_arrays(arrays)
    memory = {name[len(MEMORY) :]: value for name, value in arrays.items() if name.startswith(MEMORY)}
    own: dict[str, Any] = {name: arrays[name] for name in ARRAY_FIELDS}
    return State(**own, **vars(_sound(data)), memory=memory)
