"""The machine: its cores, its speed, the memory that a process takes or may take, the user's cache on it."""

from __future__ import annotations

import math
import os
import platform
import re
import resource
import stat
import sys
import time
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from cranktopo.base.errors import CranktopoError

_OURS_ALONE = 0o700
_MIB = 1024.0**2


def private_cache(name: str) -> Path | None:
    """Return a folder in the user's cache that nobody else can read or write, made if it is not there.

    What is run may come from nowhere else. None where it cannot be had: the folder is another user's, others
    may use it, it is a link, or the user has no home, as in a container, and all users share what is left.
    """
    cache = _user_cache()
    if cache is None:
        return None
    folder = cache / name
    try:
        cache.mkdir(parents=True, exist_ok=True)
        with suppress(FileExistsError):
            folder.mkdir(mode=_OURS_ALONE)
        found, above = folder.lstat(), cache.stat()
    except OSError:
        return None
    ours = stat.S_ISDIR(found.st_mode) and {found.st_uid, above.st_uid} == {os.getuid()}
    private = found.st_mode & 0o777 == _OURS_ALONE and not above.st_mode & stat.S_IWOTH
    return folder if ours and private else None


def _user_cache() -> Path | None:
    """Return the folder in `$XDG_CACHE_HOME` or the user's home, None where there is neither."""
    folder = os.environ.get("XDG_CACHE_HOME", "")
    if os.path.isabs(folder):  # a relative one is to be ignored (XDG Base Directory Specification)
        return Path(folder) / "cranktopo"
    try:
        return Path.home() / ".cache" / "cranktopo"
    except RuntimeError:
        return None


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


def addresses_left_MiB() -> float:
    """Return how many more addresses this process may take (`ulimit -v`), MiB; infinite without a limit."""
    limit, _ = resource.getrlimit(resource.RLIMIT_AS)
    if limit == resource.RLIM_INFINITY:
        return math.inf
    import psutil

    return max(limit - int(psutil.Process().memory_info().vms), 0) / _MIB


_PER_CORE_MIB = 70.0
"""Addresses of a thread: its stack, and a heap of its own by the C library (64 MiB)."""


def addresses_of_threads_MiB() -> float:
    """Return the addresses that one thread per core takes, MiB: libraries begin one each."""
    return _PER_CORE_MIB * usable_cores()


def check_addresses(what: str, needed_MiB: float) -> None:
    """Check that so many addresses are left (`ulimit -v`): a library that finds none ends the process."""
    left = addresses_left_MiB()
    if left < needed_MiB:
        raise CranktopoError(
            f"memory: {what} needs {needed_MiB / 1024:.1f} GiB of addresses, {left / 1024:.1f} left.",
            hint="Allow more (ulimit -v).",
        )


_OWN_CGROUPS, _CGROUPS = Path("/proc/self/cgroup"), Path("/sys/fs/cgroup")


def container_memory_left_MiB() -> float:
    """Return what the control groups of this process still allow, MiB; infinite where none sets a limit.

    What is used counts without the files that the system keeps and would give back.
    """
    try:
        lines = _OWN_CGROUPS.read_text(encoding="utf-8").splitlines()
    except OSError:
        return math.inf
    own = {controllers: path.lstrip("/") for _, controllers, path in (line.split(":", 2) for line in lines)}
    found = [math.inf]
    for folder, names in (
        (_CGROUPS / own.get("", ""), ("memory.max", "memory.current", "inactive_file")),
        (
            _CGROUPS / "memory" / own.get("memory", ""),
            ("memory.limit_in_bytes", "memory.usage_in_bytes", "total_inactive_file"),
        ),
    ):
        for group in (folder, *folder.parents):
            with suppress(OSError, ValueError):  # no such group, or "max": no limit
                limit, used = (int((group / name).read_text()) for name in names[:2])
                kept = re.search(rf"^{names[2]} (\d+)", (group / "memory.stat").read_text(), re.MULTILINE)
                found.append(max(limit - used + int(kept[1] if kept else 0), 0) / _MIB)
    return min(found)


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
