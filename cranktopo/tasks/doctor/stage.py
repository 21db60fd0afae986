"""What `cranktopo doctor` looks at."""

from __future__ import annotations

import importlib
import os
import platform
import re
import shutil
import sys
from dataclasses import asdict, dataclass
from importlib import metadata
from pathlib import Path
from typing import Any, Literal

from cranktopo.base.extras import EXTRAS, install_line
from cranktopo.base.machine import usable_cores

_EXAMPLE = "mikron-iiic"
"""Its default optimisation is what the memory must hold."""
PYTHON = (3, 11)
_NEED_GMSH = "evaluate, compare, accuracy, fatigue, shaft, remodel, iterate, export and report --stress"
_GMSH_LIBRARIES = "apt-get install -y libglu1-mesa libxcursor1 libxft2 libxinerama1"

State = Literal["ok", "missing", "absent"]


@dataclass(frozen=True)
class Check:
    """One thing looked at.

    Attributes:
        state: ok; missing (needed); absent (optional).
        cost: what cannot be done without it.
        remedy: the line that installs it.
    """

    name: str
    state: State
    value: str
    cost: str = ""
    remedy: str = ""

    def as_json(self) -> dict[str, Any]:
        """Return the check as `doctor --json` prints it."""
        return asdict(self)


@dataclass(frozen=True)
class Tool:
    """An optional program.

    Attributes:
        programs: names on the path, any of them.
        cost: what cannot be done without it.
        remedy: the line that installs it.
    """

    name: str
    programs: tuple[str, ...]
    cost: str
    remedy: str


_TOOLS = (
    Tool("CalculiX", ("ccx",), "tests against a second code are skipped", "apt-get install -y calculix-ccx"),
    Tool(
        "Chromium",
        ("chromium", "chromium-browser", "google-chrome"),
        "tests of the report in a browser are skipped",
        "apt-get install -y chromium",
    ),
)


def check_machine() -> list[Check]:
    """Return every check, what is needed first."""
    needed = [python(), *packages(), gmsh(), jax_device(), cores(), memory(), _runs_folder(), cache()]
    return [*needed, *extras(), *tools()]


def python(version: tuple[int, ...] = sys.version_info[:3]) -> Check:
    """Version of the interpreter."""
    text = ".".join(str(part) for part in version)
    if version >= PYTHON:
        return Check("Python", "ok", text)
    least = ".".join(str(part) for part in PYTHON)
    return Check("Python", "missing", text, "cranktopo does not run", f"install Python {least} or newer")


def packages() -> list[Check]:
    """Return one check that names the installed packages, or one per missing package."""
    names = _required("")
    missing = _missing(names)
    if not missing:
        return [Check("packages", "ok", f"all {len(names)} installed")]
    return [
        Check(f"package {name}", "missing", "", "the commands that use it fail", f"pip install {name}")
        for name in missing
    ]


def gmsh() -> Check:
    """Tell whether gmsh finds its system libraries."""
    cost = f"no exact solids, no body-fitted evaluation, no STEP: {_NEED_GMSH} fail"
    try:
        module = importlib.import_module("gmsh")
    except ImportError:
        return Check("gmsh", "missing", "not installed", cost, "pip install gmsh")
    except OSError as error:
        return Check("gmsh", "missing", f"a library is missing: {error}", cost, _GMSH_LIBRARIES)
    return Check("gmsh", "ok", str(module.__version__))


def jax_device() -> Check:
    """Return the devices that the optimiser would run on."""
    try:
        import jax

        device, *others = jax.devices()
    except Exception as error:  # jax raises what its plugins raise, all meaning this
        return Check("JAX", "missing", str(error), "no optimisation", "pip install jax")
    kind = f"{device.platform.upper()}: {device.device_kind}"
    own = f", {_kernels()}" if device.platform == "cpu" else ""
    return Check("JAX", "ok", f"{jax.__version__}, {f'{1 + len(others)} x ' if others else ''}{kind}{own}")


def _kernels() -> str:
    from cranktopo.numerics.kernels.registry import why_no_kernels

    reason = why_no_kernels()
    return f"no own kernels: {reason}" if reason else "own kernels"


def cores() -> Check:
    """Cores that this process may use."""
    return Check("cores", "ok", f"{usable_cores()} of {os.cpu_count()}, {platform.machine()}")


def memory() -> Check:
    """Memory that a run may take now."""
    from cranktopo.bodies.memory import available_memory_MiB, optimiser_memory_MiB
    from cranktopo.design.loading import load_scene

    scene, available = load_scene(_EXAMPLE), available_memory_MiB()
    needed = optimiser_memory_MiB(scene, scene.optimise.resolution_mm, quarter=True, cases=2)
    text = f"{available:.0f} MiB available, the default run needs {needed:.0f} MiB"
    if available >= needed:
        return Check("memory", "ok", text)
    cost = "the default run fails"
    return Check("memory", "absent", text, cost, "close other programs, or use a larger --resolution-mm")


def _runs_folder(folder: Path | None = None) -> Check:
    """Tell whether runs can be written in the current folder.

    Args:
        folder: where runs/ is or would be; the current folder by default.
    """
    here = folder or Path.cwd()
    free = shutil.disk_usage(here).free / 2**30
    if os.access(here, os.W_OK):
        return Check("runs folder", "ok", f"{here / 'runs'}, {free:.1f} GiB free")
    return Check("runs folder", "absent", f"{here} is not writable", "no runs here", "give --out DIR")


def cache() -> Check:
    """Return the folder of compiled programs."""
    from cranktopo.numerics.precision import cache_folder

    folder = cache_folder()
    state: State = "ok" if _writable(folder) else "absent"
    return Check("compiled programs", state, str(folder), "every run compiles again", "set XDG_CACHE_HOME")


def extras() -> list[Check]:
    """Packages that some commands alone need."""
    return [_extra(name) for name in EXTRAS]


def _extra(name: str) -> Check:
    names = _required(name)
    missing = _missing(names)
    value = f"missing: {', '.join(missing)}" if missing else f"all {len(names)} installed"
    state: State = "absent" if missing else "ok"
    return Check(f"extra {name}", state, value, f"no {EXTRAS[name]}", install_line(name))


def tools() -> list[Check]:
    """Return the optional programs."""
    return [_tool(tool) for tool in _TOOLS]


def _tool(tool: Tool) -> Check:
    path = next((found for name in tool.programs if (found := shutil.which(name))), None)
    return Check(tool.name, "ok" if path else "absent", path or "", tool.cost, tool.remedy)


def _required(extra: str) -> list[str]:
    """Packages that an extra requires; those of the core for an empty name."""
    marked = [
        re.match(r"([\w.-]+)(?:.*extra == ['\"](.+)['\"])?", line)
        for line in metadata.requires("cranktopo") or []
    ]
    return [found[1] for found in marked if found and (found[2] or "") == extra]


def _missing(names: list[str]) -> list[str]:
    return [name for name in names if not _installed(name)]


def _installed(name: str) -> bool:
    try:
        metadata.version(name)
    except metadata.PackageNotFoundError:
        return False
    return True


def _writable(folder: Path) -> bool:
    existing = next(path for path in (folder, *folder.parents) if path.exists())
    return os.access(existing, os.W_OK)
