"""How fast this machine is, and how much memory a piece of work takes."""

from __future__ import annotations

import os
import platform
import resource
import sys
import time
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

_SIDE, _PRODUCTS, _DENSE = 40, 20, 700
_REPEATS = 3
_STATUS, _RESET = Path("/proc/self/status"), Path("/proc/self/clear_refs")
_RESET_PEAK = "5"
_KIB_PER_MIB = 1024.0


@dataclass(frozen=True)
class Machine:
    """A machine that rungs were timed on.

    Attributes:
        processor: its name.
        cores: that a process may use.
        reference_s: wall time of a fixed piece of work there, `reference_seconds`.
    """

    processor: str
    cores: int
    reference_s: float

    def as_json(self) -> dict[str, Any]:
        """The machine as an object."""
        return asdict(self)

    def same_kind(self, other: Machine) -> bool:
        """Whether times of one hold for the other but for a common factor."""
        return (self.processor, self.cores) == (other.processor, other.cores)


def this_machine() -> Machine:
    """This machine, its speed measured now."""
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return Machine(_processor(), cores, reference_seconds())


def reference_seconds() -> float:
    """Wall time of a fixed piece of work, least of three: sparse products and a dense factorisation.

    The two kinds of work that the judge's and the optimiser's solvers spend their time on.
    """
    import numpy as np
    import scipy.sparse as sp

    line = sp.diags([-1.0, 2.0, -1.0], [-1, 0, 1], shape=(_SIDE, _SIDE))
    one = sp.identity(_SIDE)
    matrix = (
        sp.kron(sp.kron(line, one), one) + sp.kron(sp.kron(one, line), one) + sp.kron(sp.kron(one, one), line)
    ).tocsr()
    dense = np.eye(_DENSE) * _DENSE + np.ones((_DENSE, _DENSE))
    vectors = np.ones((matrix.shape[0], 3))
    times = []
    for _ in range(_REPEATS):
        began = time.perf_counter()
        for _ in range(_PRODUCTS):
            matrix @ vectors
        np.linalg.cholesky(dense)
        times.append(time.perf_counter() - began)
    return min(times)


def peak_memory_MiB() -> float:
    """Largest resident memory of this process so far, MiB."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return round(peak / (1024.0**2 if sys.platform == "darwin" else 1024.0), 1)


class PeakMemory:
    """Largest resident memory of this process since the object was made.

    Where the system cannot forget an earlier peak (it is not Linux), the largest of the whole process.
    """

    def __init__(self) -> None:
        try:
            _RESET.write_text(_RESET_PEAK)
        except OSError:
            return

    @property
    def MiB(self) -> float:
        """The peak so far."""
        try:
            line = next(row for row in _STATUS.read_text().splitlines() if row.startswith("VmHWM"))
        except (OSError, StopIteration):
            return peak_memory_MiB()
        return float(line.split()[1]) / _KIB_PER_MIB


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
