"""Seconds and peak memory of each command: `python -m tests.benchmarks.commands [NAME...]`.

Every command is a process of its own on the default design, first with an empty cache of compiled programs
(cold), then again with what that left (warm). `extract`, `remodel` and `report` work on the run that
`optimise` made, which is measured whenever one of them is asked for.
"""

from __future__ import annotations

import os
import sys
import tempfile
import time
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from cranktopo.base.errors import ExitCode

RUN = "RUN"
# Commands that refuse to write where something is, so that cold and warm need folders of their own.
_WITH_OUT = {"optimise", "remodel"}
COMMANDS: dict[str, tuple[str, ...]] = {
    "optimise": ("optimise", "--volume-fraction", "0.3"),
    "extract": ("extract", RUN),
    "remodel": ("remodel", RUN),
    "report": ("report", RUN),
    "plan": ("plan",),
    "loads": ("loads",),
    "balance": ("balance",),
    "vibration": ("vibration",),
    "evaluate": ("evaluate", "mikron-iiic-plain"),
    "fatigue": ("fatigue", "mikron-iiic-plain"),
    "bound": ("bound", "--minimise", "mass"),
    "shape": ("shape", "--minimise", "mass"),
}
WORKED = {ExitCode.DONE, ExitCode.CRITERION_NOT_MET}
_PROGRAM = "import sys; from cranktopo.app.launch import main; sys.exit(main())"


class Used(NamedTuple):
    """What a process used, its children included."""

    seconds: float
    cpu_s: float
    peak_MiB: float


def measured(arguments: Sequence[str], cache: Path, folder: Path) -> Used:
    """What a command uses in a working folder, with the compiled programs of a cache.

    Raises:
        SystemExit: the command fails.
    """
    log = folder / "output.txt"
    here = os.environ | {"XDG_CACHE_HOME": str(cache), "PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    began = time.perf_counter()
    with log.open("w", encoding="utf-8") as output:
        child = os.posix_spawn(
            sys.executable,
            [sys.executable, "-c", f"import os; os.chdir({str(folder)!r}); {_PROGRAM}", *arguments],
            here,
            file_actions=[(os.POSIX_SPAWN_DUP2, output.fileno(), stream) for stream in (1, 2)],
        )
        _, status, usage = os.wait4(child, 0)
    seconds = time.perf_counter() - began
    if os.waitstatus_to_exitcode(status) not in WORKED:
        raise SystemExit(f"cranktopo {' '.join(arguments)}:\n{log.read_text(encoding='utf-8')}")
    return Used(seconds, usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024)


def rows(names: Sequence[str], folder: Path) -> None:
    """Print one row per command, as soon as it is known."""
    run = str(folder / "optimise-cold")
    for name, arguments in COMMANDS.items():
        needed = name in names or (name == "optimise" and any(RUN in COMMANDS[n] for n in names))
        if not needed:
            continue
        used = []
        for state in ("cold", "warm"):
            out = ("--out", str(folder / f"{name}-{state}")) if name in _WITH_OUT else ()
            known = [run if word == RUN else word for word in arguments]
            used.append(measured([*known, *out], folder / f"cache-{name}", folder))
        cells = [f"{u.seconds:.1f} | {u.cpu_s:.1f} | {u.peak_MiB:.0f}" for u in used]
        print(f"| `{' '.join(arguments)}` | {' | '.join(cells)} |", flush=True)


def main() -> None:
    """Print the table as Markdown."""
    names = sys.argv[1:] or list(COMMANDS)
    unknown = [name for name in names if name not in COMMANDS]
    if unknown:
        raise SystemExit(f"{', '.join(unknown)}: not among {', '.join(COMMANDS)}")
    print("| command | cold s | CPU s | peak MiB | warm s | CPU s | peak MiB |")
    print("|---|---|---|---|---|---|---|", flush=True)
    with tempfile.TemporaryDirectory() as folder:
        rows(names, Path(folder))


if __name__ == "__main__":
    main()
