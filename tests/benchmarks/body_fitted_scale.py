"""Exponent of cost over mesh size of commands on body-fitted meshes.

    python -m tests.benchmarks.body_fitted_scale [--evaluate MM...] [--fatigue FRACTION...]

Every row is the command itself, `evaluate --element-size-mm MM` or `fatigue --fillet-fraction FRACTION`, in a
process of its own on `mikron-iiic`. Seconds of the mesh and after it are those of its JSON: assembly, solves,
and bounds of errors or stresses. In all is the whole process, its start included. Asked for is an exponent of
at most 1.15; it is the slope of a straight line through the logarithms of all rows of a command.
"""

from __future__ import annotations

import argparse
import json
import math
import os
import sys
import tempfile
import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from cranktopo.base.errors import ExitCode

DESIGN = "mikron-iiic"
EVALUATE_MM = (7.0, 4.2, 2.2, 1.3, 0.85)
FATIGUE_FRACTIONS = (0.5, 0.2, 0.1, 0.065, 0.043)
"""`fatigue` has one general element size; only its fillets can be refined, 0.5 is the coarsest it takes."""
REGULAR_ABOVE = 0.2
"""Fractions above it have elements of another kind and no fitted stresses: their row is not in the slope."""
_PROGRAM = "import sys; from cranktopo.app.launch import main; sys.exit(main())"
_WORKED = {ExitCode.DONE, ExitCode.CRITERION_NOT_MET}
_AXES_PER_NODE = 3
_SECONDS = ("mesh_s", "after_s", "all_s", "cpu_s")
HEADS = (
    "command",
    "element",
    "unknowns",
    "mesh s",
    "after the mesh s",
    "in all s",
    "CPU s",
    "peak MiB",
    "bytes per unknown",
    "per further unknown",
    "result",
)


@dataclass(frozen=True)
class ScaleRow:
    """Costs of a command on one mesh, and its result; `told` instead where it gave nothing."""

    size: float
    unknowns: int = 0
    mesh_s: float = 0.0
    after_s: float = 0.0
    all_s: float = 0.0
    cpu_s: float = 0.0
    peak_MiB: float = 0.0
    result: str = ""
    told: str = ""


def evaluated(found: dict[str, Any]) -> dict[str, Any]:
    """Unknowns, seconds and result of the JSON of `evaluate`."""
    (one,) = found["evaluations"]
    torsion, bending = one["torsion"]["free_Nm_per_rad"], one["bending"]["pinned_N_per_mm"]
    return {
        "unknowns": _AXES_PER_NODE * one["mesh"]["nodes"],
        "mesh_s": one["seconds"]["mesh"],
        "after_s": one["seconds"]["solve"],
        "result": f"{torsion / 1e3:.3f} kN m/rad, {bending / 1e3:.3f} kN/mm",
    }


def assessed(found: dict[str, Any]) -> dict[str, Any]:
    """Unknowns, seconds and result of the JSON of `fatigue`."""
    (one,) = found["fatigue"]
    quality = one["quality"]
    return {
        "unknowns": _AXES_PER_NODE * quality["nodes"],
        "mesh_s": quality["mesh_seconds"],
        "after_s": quality["solve_seconds"],
        "result": f"least safety {one['safety']:.4f}",
    }


@dataclass(frozen=True)
class ScaledCommand:
    """A command whose mesh an option refines."""

    name: str
    option: str
    unit: str
    read: Callable[[dict[str, Any]], dict[str, Any]]

    def counted(self, row: ScaleRow) -> bool:
        """Tell whether a row is one of those that the exponent is of."""
        return not row.told and not (self.name == "fatigue" and row.size > REGULAR_ABOVE)

    def words(self, size: float) -> list[str]:
        """Words of the command line."""
        return [self.name, DESIGN, self.option, f"{size:g}", "--json"]


COMMANDS = {
    "evaluate": ScaledCommand("evaluate", "--element-size-mm", "mm", evaluated),
    "fatigue": ScaledCommand("fatigue", "--fillet-fraction", "r", assessed),
}


def exponent(unknowns: Sequence[float], costs: Sequence[float]) -> float:
    """Slope of the straight line through the logarithms by least squares; nan of less than two sizes."""
    if len(set(unknowns)) < 2:
        return math.nan
    return float(np.polyfit(np.log(unknowns), np.log(costs), 1)[0])


def table_rows(command: ScaledCommand, rows: Sequence[ScaleRow]) -> list[str]:
    """Lines of a command: its meshes, and last the exponents of all its seconds."""
    counted = [row for row in rows if command.counted(row)]
    return [*(table_row(command, row, rows[0]) for row in rows), exponent_row(command, counted)]


def table_row(command: ScaledCommand, row: ScaleRow, smallest: ScaleRow) -> str:
    """Line of one mesh; bytes per further unknown are those beyond the smallest mesh."""
    head = [f"`{command.name}`", f"{row.size:g} {command.unit}"]
    if row.told:
        return _line([*head, *["-"] * (len(HEADS) - 3), row.told])
    more = row.unknowns - smallest.unknowns
    further = f"{(row.peak_MiB - smallest.peak_MiB) * 2**20 / more:,.0f}" if more > 0 else "-"
    seconds = [f"{getattr(row, key):.2f}" for key in _SECONDS]
    each = f"{row.peak_MiB * 2**20 / row.unknowns:,.0f}"
    return _line([*head, f"{row.unknowns:,}", *seconds, f"{row.peak_MiB:,.0f}", each, further, row.result])


def exponent_row(command: ScaledCommand, rows: Sequence[ScaleRow]) -> str:
    """Line of the exponents of seconds over unknowns."""
    unknowns = [row.unknowns for row in rows]
    slopes = [exponent(unknowns, [getattr(row, key) for row in rows]) for key in _SECONDS]
    reach = f"{min(unknowns):,} to {max(unknowns):,}" if len(rows) > 1 else "-"
    cells = ["-" if math.isnan(slope) else f"**{slope:.2f}**" for slope in slopes]
    return _line([f"`{command.name}`: exponent", "-", reach, *cells, "-", "-", "-", "-"])


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def measured(command: ScaledCommand, size: float) -> ScaleRow:
    """Run a command in a process of its own, whose peak memory is its own."""
    here = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path))}
    words = [sys.executable, "-c", _PROGRAM, *command.words(size)]
    with tempfile.TemporaryDirectory() as folder:
        told, notes = Path(folder) / "told.json", Path(folder) / "notes.txt"
        began = time.perf_counter()
        with told.open("wb") as out, notes.open("wb") as err:
            streams = [(os.POSIX_SPAWN_DUP2, file.fileno(), to) for file, to in ((out, 1), (err, 2))]
            child = os.posix_spawn(sys.executable, words, here, file_actions=streams)
            _, status, usage = os.wait4(child, 0)
        seconds, code = time.perf_counter() - began, os.waitstatus_to_exitcode(status)
        if code not in _WORKED:
            return ScaleRow(size, told=failure(code, notes.read_text(encoding="utf-8")))
        found = json.loads(told.read_text(encoding="utf-8"))
    cpu_s, peak_MiB = usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1024
    return ScaleRow(size, all_s=seconds, cpu_s=cpu_s, peak_MiB=peak_MiB, **command.read(found))


def failure(code: int, notes: str) -> str:
    """The reason that a command gave nothing: the error that it told, or the signal that ended it."""
    lines = notes.strip().splitlines()
    start = max((i for i, line in enumerate(lines) if line.startswith("error:")), default=len(lines) - 1)
    reason = " ".join(line.strip() for line in lines[max(start, 0) :]) or "no message"
    return f"signal {-code}" if code < 0 else f"exit {code}: {reason}".replace("|", "/")


def main() -> None:
    """Print the table as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--evaluate", type=float, nargs="*", default=EVALUATE_MM, metavar="MM")
    parser.add_argument("--fatigue", type=float, nargs="*", default=FATIGUE_FRACTIONS, metavar="FRACTION")
    asked = parser.parse_args()
    print(f"{_line(HEADS)}\n|{'---|' * len(HEADS)}", flush=True)
    for name, command in COMMANDS.items():
        rows = list[ScaleRow]()
        for size in getattr(asked, name):
            rows.append(measured(command, size))
            print(table_row(command, rows[-1], rows[0]), flush=True)
        if rows:
            print(table_rows(command, rows)[-1], flush=True)


if __name__ == "__main__":
    main()
