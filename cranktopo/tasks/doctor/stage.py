"""Checks of `cranktopo doctor`."""

from __future__ import annotations

import importlib
import os
import platform
import re
import shutil
import sys
from collections.abc import Callable
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from typing import Literal

from cranktopo.base.errors import EXTRAS, CranktopoError, install_line, lacks_memory
from cranktopo.base.machine import usable_cores
from cranktopo.numerics.precision import check_room

_EXAMPLE = "mikron-iiic"
"""Its default optimisation is what the memory must hold."""
_PYTHON = (3, 11)
_NEED_GMSH = "evaluate, compare, accuracy, fatigue, shaft, remodel, iterate, export and report --stress"
_GMSH_LIBRARIES = "apt-get install -y libglu1-mesa libxcursor1 libxft2 libxinerama1"
_MORE_MEMORY = "Allow more memory (ulimit -v)."
_TOOLS = {
    "CalculiX": (("ccx",), "tests against a second code are skipped", "apt-get install -y calculix-ccx"),
    "Chromium": (
        ("chromium", "chromium-browser", "google-chrome"),
        "tests of the report in a browser are skipped",
        "apt-get install -y chromium",
    ),
}
"""Optional programs: their names on the path, any of them, then cost and remedy of a `Check`."""


@dataclass(frozen=True)
class Check:
    """One thing looked at, as `doctor --json` prints it.

    Attributes:
        state: ok; missing (needed); short (needed, and this process may not have the memory); absent
            (optional).
        cost: what cannot be done without it.
        remedy: the line that installs it.
    """

    name: str
    state: Literal["ok", "missing", "short", "absent"]
    value: str
    cost: str = ""
    remedy: str = ""


def check_machine() -> list[Check]:
    """Return every check, what is needed first."""
    needed = {
        "Python": lambda: [python()],
        "packages": packages,
        "gmsh": lambda: [_gmsh()],
        "JAX": lambda: [_jax_device()],
        "cores": lambda: [_cores()],
        "memory": lambda: [memory()],
        "runs folder": lambda: [_runs_folder()],
        "compiled programs": lambda: [_cache()],
        "extras": extras,
        "tools": _tools,
    }
    return [check for name, checks in needed.items() for check in within_memory(name, checks)]


def within_memory(name: str, checks: Callable[[], list[Check]]) -> list[Check]:
    """Return what a check finds, or that there is no memory for it: the next one may do with less."""
    try:
        return checks()
    except Exception as error:
        if not lacks_memory(error):
            raise
        return [Check(name, "short", "not enough memory to check it", "it cannot be used", _MORE_MEMORY)]


def python(version: tuple[int, ...] = sys.version_info[:3]) -> Check:
    """Check the version of the interpreter."""
    text, oldest = (".".join(str(part) for part in parts) for parts in (version, _PYTHON))
    if version >= _PYTHON:
        return Check("Python", "ok", text)
    return Check("Python", "missing", text, "cranktopo does not run", f"install Python {oldest} or newer")


def packages() -> list[Check]:
    """Return one check that names the installed packages, or one per missing package."""
    names, missing = _required("")
    if not missing:
        return [Check("packages", "ok", f"all {len(names)} installed")]
    return [
        Check(f"package {name}", "missing", "", "the commands that use it fail", f"pip install {name}")
        for name in missing
    ]


def _gmsh() -> Check:
    cost = f"no exact solids, no body-fitted evaluation, no STEP: {_NEED_GMSH} fail"
    try:
        module = importlib.import_module("gmsh")
    except ImportError as error:
        if lacks_memory(error):
            raise
        return Check("gmsh", "missing", "not installed", cost, "pip install gmsh")
    except OSError as error:
        if lacks_memory(error):
            raise
        return Check("gmsh", "missing", f"a library is missing: {error}", cost, _GMSH_LIBRARIES)
    return Check("gmsh", "ok", str(module.__version__))


def _jax_device() -> Check:
    try:
        check_room()
    except CranktopoError as error:
        return Check("JAX", "short", error.message, "no optimisation", error.hint)
    try:
        import jax

        device, *others = jax.devices()
    except Exception as error:  # jax raises what its plugins raise, all meaning this
        if lacks_memory(error):
            raise
        return Check("JAX", "missing", str(error), "no optimisation", "pip install jax")
    kind = f"{device.platform.upper()}: {device.device_kind}"
    own = f", {_kernels()}" if device.platform == "cpu" else ""
    return Check("JAX", "ok", f"{jax.__version__}, {f'{1 + len(others)} x ' if others else ''}{kind}{own}")


def _kernels() -> str:
    from cranktopo.numerics.kernels.registry import why_no_kernels

    reason = why_no_kernels()
    return f"no own kernels: {reason}" if reason else "own kernels"


def _cores() -> Check:
    return Check("cores", "ok", f"{usable_cores()} of {os.cpu_count()}, {platform.machine()}")


def memory() -> Check:
    """Check the memory that a run may take now."""
    from cranktopo.bodies.memory import available_memory_MiB, optimiser_memory_MiB
    from cranktopo.design.loading import load_scene

    scene, available = load_scene(_EXAMPLE), available_memory_MiB()
    needed = optimiser_memory_MiB(scene, scene.optimise.resolution_mm, quarter=True, cases=2)
    text = f"{available:.0f} MiB available, the default run needs {needed:.0f} MiB"
    if available >= needed:
        return Check("memory", "ok", text)
    cost = "the default run fails"
    return Check(
        "memory",
        "absent",
        text,
        cost,
        "close other programs, or use a larger --resolution-mm of cranktopo optimise",
    )


def _runs_folder() -> Check:
    here = Path.cwd()
    free = shutil.disk_usage(here).free / 2**30
    if os.access(here, os.W_OK):
        return Check("runs folder", "ok", f"{here / 'runs'}, {free:.1f} GiB free")
    return Check(
        "runs folder",
        "absent",
        f"{here} is not writable",
        "no runs here",
        "give --out DIR, as to cranktopo optimise",
    )


def _cache() -> Check:
    from cranktopo.numerics.precision import cache_folder

    folder = cache_folder()
    return Check(
        "compiled programs",
        "ok" if folder else "absent",
        str(folder or "no cache is this user's alone"),
        "every run compiles again",
        "set XDG_CACHE_HOME",
    )


def extras() -> list[Check]:
    """Check the packages that some commands alone need."""
    return [_extra(name) for name in EXTRAS]


def _extra(name: str) -> Check:
    names, missing = _required(name)
    cost, remedy = f"no {EXTRAS[name]}", install_line(name)
    if missing:
        return Check(f"extra {name}", "absent", f"missing: {', '.join(missing)}", cost, remedy)
    return Check(f"extra {name}", "ok", f"all {len(names)} installed", cost, remedy)


def _tools() -> list[Check]:
    found = []
    for name, (programs, cost, remedy) in _TOOLS.items():
        path = next((path for program in programs if (path := shutil.which(program))), "")
        found.append(Check(name, "ok" if path else "absent", path, cost, remedy))
    return found


def _required(extra: str) -> tuple[list[str], list[str]]:
    """Return the packages that an extra requires, the core for an empty name, and which are missing."""
    marked = [
        re.match(r"([\w.-]+)(?:.*extra == ['\"](.+)['\"])?", line)
        for line in metadata.requires("cranktopo") or []
    ]
    names = [found[1] for found in marked if found and (found[2] or "") == extra]
    return names, [name for name in names if not _installed(name)]


def _installed(name: str) -> bool:
    try:
        metadata.version(name)
    except metadata.PackageNotFoundError:
        return False
    return True
