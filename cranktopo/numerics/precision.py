"""The one place that touches settings of JAX: 64-bit numbers and stored programs, for a `with` block."""

from __future__ import annotations

import atexit
import hashlib
import os
import platform
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from functools import cache
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Literal
from weakref import WeakSet

from cranktopo.base.errors import CranktopoError, ExitCode, quoted
from cranktopo.base.machine import addresses_of_threads_MiB, check_addresses, private_cache
from cranktopo.base.notes import note

Precision = Literal["float32", "float64"]

_XLA_ADDRESSES_MIB = 1400.0
"""Memory of XLA beside its threads (1000 to 1250 measured); where it cannot be had, it aborts."""
_OLDER_EMITTER = "--xla_cpu_use_fusion_emitters=false"
_KNOW_IT = "0.9.", "0.10."
"""Versions of jaxlib that were tested with it: an unknown flag ends the process."""
_FOLDER_SETTING, _KEEPING = "jax_compilation_cache_dir", "jax_enable_compilation_cache"


def compile_quickly() -> None:
    """Have XLA compile by its older emitter: in half the time, programs as fast with the same digits.

    For processes of our own, before JAX begins: it holds for all of a process. XLA_FLAGS of the user stay.
    """
    with suppress(PackageNotFoundError):  # whoever needs it says so
        if version("jaxlib").startswith(_KNOW_IT):
            os.environ.setdefault("XLA_FLAGS", _OLDER_EMITTER)


def skip_clean_up() -> None:
    """Have JAX not take its programs apart for 0.2 s when the process ends: the system gets them back anyway.

    For processes of our own, at their end.
    """
    clean_up = getattr(sys.modules.get("jax._src.api"), "clean_up", None)
    if clean_up is not None:
        atexit.unregister(clean_up)


@contextmanager
def double_precision() -> Iterator[None]:
    """Allow float64 in JAX, and keep compiled programs for the next process, inside a `with` block.

    Nothing is changed outside it, so importing cranktopo never alters the settings of a user's own JAX
    program; a compilation cache that the user has set up is left alone, and
    JAX_ENABLE_COMPILATION_CACHE=false switches ours off too.
    """
    import jax

    check_device()
    with jax.enable_x64(True), _stored_compilations():
        yield


def check_room() -> None:
    """Check that JAX can be loaded and begun: without the addresses that it takes it ends the process."""
    check_addresses("JAX", _XLA_ADDRESSES_MIB + addresses_of_threads_MiB())


@cache
def check_device() -> None:
    """Check that JAX has something to compute on; raises CranktopoError where it has not, or cannot begin."""
    check_room()
    import jax

    try:
        jax.devices()
    except Exception as error:  # JAX raises whatever its plugins raise, an empty AssertionError among it
        platforms = os.environ.get("JAX_PLATFORMS")
        setting = f" (JAX_PLATFORMS = {quoted(platforms)})" if platforms else ""
        reason = str(error).splitlines()[0][:200] if str(error) else type(error).__name__
        raise CranktopoError(
            f"JAX finds no device to compute on{setting}: {reason}.",
            hint="Unset JAX_PLATFORMS, or install JAX for that device: see `cranktopo doctor`.",
            code=ExitCode.MISSING_TOOL,
        ) from None


def cache_folder() -> Path | None:
    """Return where compiled programs are kept: one folder per JAX version and kind of processor.

    None where no folder can be had that is the user's alone: what is loaded from it is run.
    """
    import jax

    # versions before had one that others could read, "jax-..."
    return private_cache(f"programs-{jax.__version__}-{_processor()}")


def folder_of_programs() -> Path | None:
    """Return the folder in which `double_precision()` keeps programs.

    None outside it, where keeping is switched off, and where the user has set up a cache of JAX's own.
    """
    import jax

    set_up = getattr(jax.config, _FOLDER_SETTING) if getattr(jax.config, _KEEPING) else None
    folder = None if set_up is None else cache_folder()
    return folder if str(folder) == set_up else None


class CompileClock:
    """The time during which JAX traces or compiles from now on, in any thread of this process."""

    def __init__(self) -> None:
        self._began = time.perf_counter()
        self._spans: list[tuple[float, float]] = []
        _listen()
        _clocks.add(self)

    @property
    def compile_s(self) -> float:
        """Seconds; what several threads compile at the same time counts once."""
        total, until = 0.0, self._began
        for start, end in sorted(self._spans):
            total += max(0.0, end - max(start, until))
            until = max(until, end)
        return total

    def add(self, start: float, end: float) -> None:
        """Count a compilation between two times of `time.perf_counter`."""
        self._spans.append((start, end))


_clocks: WeakSet[CompileClock] = WeakSet()


@cache
def _listen() -> None:
    """Tell the clocks that are in use of every compilation: one listener per process, JAX never drops one."""
    import jax

    def listener(event: str, duration_secs: float, **_: str | int) -> None:
        if event.startswith("/jax/core/compile/"):
            now = time.perf_counter()
            for clock in list(_clocks):
                clock.add(now - duration_secs, now)

    jax.monitoring.register_event_duration_secs_listener(listener)


@contextmanager
def _stored_compilations() -> Iterator[None]:
    import jax
    from jax.experimental.compilation_cache import compilation_cache

    keeping = getattr(jax.config, _KEEPING) and getattr(jax.config, _FOLDER_SETTING) is None
    folder = cache_folder() if keeping else None
    if folder is None:
        if keeping:
            _tell_not_kept()
        yield
        return
    settings = {
        _FOLDER_SETTING: str(folder),
        "jax_persistent_cache_min_compile_time_secs": 0.0,  # tiny programs are many: half of all compiling
    }
    before = {name: getattr(jax.config, name) for name in settings}
    try:
        _configure(settings)
        yield
    finally:
        _configure(before)
        compilation_cache.reset_cache()  # else JAX goes on using the folder


def _configure(settings: dict[str, object]) -> None:
    import jax

    for name, value in settings.items():
        jax.config.update(name, value)


@cache
def _tell_not_kept() -> None:
    note(
        "compiled programs are not kept: no cache is this user's alone; set XDG_CACHE_HOME to your own folder"
    )


@cache
def _processor() -> str:
    """Digest of the processor's features: a program compiled for one kind may not run on another."""
    try:
        lines = Path("/proc/cpuinfo").read_text(encoding="utf-8").splitlines()
        features = next(line for line in lines if line.startswith(("flags", "Features")))
    except (OSError, StopIteration):
        features = platform.processor()
    return hashlib.sha256(f"{platform.machine()} {features}".encode()).hexdigest()[:8]
