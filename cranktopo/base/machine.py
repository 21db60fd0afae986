"""The machine: its cores, its speed, and the memory that a process takes."""

from __future__ import annotations

import os
import platform
import resource
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

_NUMBERS, _REPEATS = 1_000_000, 5


@dataclass(frozen=True)
class Machine:
    """A machine; `reference_s` is its wall time for a fixed piece of work, the smaller the faster."""

    processor: str
    cores: int
    reference_s: float

    def same_kind(self, other: Machine) -> bool:
        """Tell whether times of one hold for the other but for a common factor."""
        return (self.processor, self.cores) == (other.processor, other.cores)


def usable_cores() -> int:
    """Return the cores that this process may use."""
    usable = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    return usable or 1


def this_machine() -> Machine:
    """Return this machine, its speed measured now: the least of five times to sort a million numbers."""
    import numpy as np

    numbers, times = np.random.default_rng(0).random(_NUMBERS), []
    for _ in range(_REPEATS):
        began = time.perf_counter()
        np.sort(numbers)
        times.append(time.perf_counter() - began)
    return Machine(_processor(), usable_cores(), min(times))


def peak_memory_MiB() -> float:
    """Return the largest resident memory of this process so far, or since `forget_peak_memory`, MiB."""
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return round(peak / (1024.0**2 if sys.platform == "darwin" else 1024.0), 1)


def forget_peak_memory() -> None:
    """Start the peak anew; only Linux can, elsewhere it stays that of the whole process."""
    with suppress(OSError):
        Path("/proc/self/clear_refs").write_text("5", encoding="ascii")


def _processor() -> str:
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        return next(line.split(":", 1)[1].strip() for line in lines if line.startswith("model name"))
    except (OSError, StopIteration):
        return platform.processor() or platform.machine()
