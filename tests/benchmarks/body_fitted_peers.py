"""One body-fitted mesh solved by cranktopo, scikit-fem and CalculiX.

    python -m tests.benchmarks.body_fitted_peers [MM...] [--codes WORD...] [--limit-s S]

The mesh is that of `evaluate mikron-iiic --element-size-mm MM`, by default its own size; ten-node elements of
four points everywhere. Each code solves both load cases of `body_fitted_codes.py` in a process of its own and
may take most of the free memory. Iterative solvers are asked for a relative residual of 1e-8; CalculiX has a
tolerance of its own. Its times hold its files, and it prints six digits.
"""

from __future__ import annotations

import argparse
import json
import os
import resource
import signal
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path

from cranktopo.bodies.memory import available_memory_MiB
from cranktopo.design.halves import default_element_size_mm
from cranktopo.tasks.throw_fea.evaluation import mesh_target
from cranktopo.tasks.throw_fea.targets import resolve_targets
from tests.benchmarks.body_fitted_codes import (
    chosen,
    codes,
    free_residual,
    load_cases,
    needs_scene,
    quarter_cases,
    stiffnesses,
)

DESIGN = "mikron-iiic"
_OF_MEMORY = 0.9
"""Part of the free memory that the addresses of a code may take: the system would end others beyond it."""
HEADS = (
    "unknowns",
    "code, solver",
    "assembly s",
    "solve s",
    "in all s",
    "to cranktopo",
    "CPU s",
    "peak MiB",
    "residual",
    "torsion kN m/rad",
    "% off",
    "pin kN/mm",
    "% off",
)


@dataclass(frozen=True)
class PeerRow:
    """Costs of a code for both load cases, and its results; `told` instead where it gave nothing.

    Attributes:
        residual: the larger one of both cases, relative; None of displacements in six digits.
        torsion: kN m/rad, section turned and otherwise held.
        pin: kN/mm, sections held.
    """

    code: str
    unknowns: int = 0
    assembly_s: float = 0.0
    solve_s: float = 0.0
    cpu_s: float = 0.0
    peak_MiB: float = 0.0
    residual: float | None = None
    torsion: float = 0.0
    pin: float = 0.0
    told: str = ""

    @property
    def all_s(self) -> float:
        """Assembly and both solves."""
        return self.assembly_s + self.solve_s


def table_row(row: PeerRow, own: PeerRow) -> str:
    """Line of a code beside cranktopo's own."""
    head = f"| {own.unknowns:,} | {row.code} "
    if row.told:
        return f"{head}| {row.told} {'| - ' * (len(HEADS) - 3)}|"
    ratio = row.all_s / own.all_s if own.all_s else 1.0
    seconds = f"{row.assembly_s:.2f} | {row.solve_s:.2f} | {row.all_s:.2f} | {ratio:.1f} | {row.cpu_s:.2f}"
    residual = "-" if row.residual is None else f"{row.residual:.0e}"
    pairs = ((row.torsion, own.torsion), (row.pin, own.pin))
    found = " | ".join(f"{value:.4f} | {100 * (value / other - 1):+.5f}" for value, other in pairs)
    return f"{head}| {seconds} | {row.peak_MiB:,.0f} | {residual} | {found} |"


def solved(code: str, file: Path) -> PeerRow:
    """Solve both cases in this very process, which is to have no other work."""
    most = int(_OF_MEMORY * available_memory_MiB() * 2**20)
    cases = load_cases(file)
    resource.setrlimit(resource.RLIMIT_AS, (most, most))
    (target,) = resolve_targets([DESIGN], whole=True) if needs_scene(code) else (None,)
    before = _cpu_s()
    found = codes()[code](cases, file.parent, **({"scene": target.scene} if target else {}))
    cpu_s = _cpu_s(children=found.printed) - (0.0 if found.printed else before)
    peak = found.peak_MiB or resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024
    model = cases.assembled()
    fields = enumerate(found.displacements_mm)
    left = None if found.printed else max(free_residual(model, cases, case, field) for case, field in fields)
    times = found.assembly_s, found.solve_s, cpu_s, peak
    return PeerRow(
        code, cases.points_mm.size, *times, left, *stiffnesses(model, cases, found.displacements_mm)
    )


def _cpu_s(*, children: bool = False) -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN if children else resource.RUSAGE_SELF)
    return used.ru_utime + used.ru_stime


def in_own_process(code: str, file: Path, limit_s: float) -> PeerRow:
    """Solve in a process of its own; one that needs too long or too much memory says so."""
    # Threads of OpenBLAS wait busily between its short calls: scikit-fem's CG took sixty times as long.
    here = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "OPENBLAS_NUM_THREADS": "1"}
    words = [sys.executable, "-m", "tests.benchmarks.body_fitted_peers", "--solve", code, str(file)]
    pipes = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "text": True}
    with subprocess.Popen(words, env=here, start_new_session=True, **pipes) as child:
        try:
            told, notes = child.communicate(timeout=limit_s)
        except subprocess.TimeoutExpired:
            os.killpg(child.pid, signal.SIGKILL)  # and what it started
            return PeerRow(code, told=f"not within {limit_s:g} s")
    if child.returncode:
        return PeerRow(code, told=failure(child.returncode, notes))
    return PeerRow(**json.loads(told.splitlines()[-1]))


_LACKS = ("memory", "alloc", "mmap")


def failure(code: int, notes: str) -> str:
    """The reason that a process gave nothing, from its exit code and its last line on stderr."""
    last = (notes.strip().splitlines() or ["no message"])[-1].replace("|", "/")
    if any(word in last.lower() for word in _LACKS):
        return "out of memory"
    return f"ended by signal {-code}" if code < 0 else f"failed: {last[:120]}"


def save_cases(size_mm: float | None, file: Path) -> None:
    """Mesh the design and write its load cases to a file; by default elements of the size of `evaluate`."""
    (target,) = resolve_targets([DESIGN], whole=True)
    size = size_mm or default_element_size_mm(target.scene)
    quarter_cases(mesh_target(target, size).mesh, target.scene).save(file)


def compare(size_mm: float | None, names: Sequence[str], limit_s: float) -> None:
    """Print the rows of one mesh."""
    with tempfile.TemporaryDirectory() as folder:
        file = Path(folder) / "cases.npz"
        save_cases(size_mm, file)
        own: PeerRow | None = None
        for code in names:
            row = in_own_process(code, file, limit_s)
            own = own or row
            print(table_row(row, own), flush=True)


def main() -> None:
    """Print the table as Markdown."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("sizes", nargs="*", type=float, metavar="MM")
    parser.add_argument("--codes", nargs="*", default=[], metavar="WORD", help="words in the names of codes")
    parser.add_argument("--limit-s", type=float, default=600.0, help="longest time of one code on one mesh")
    parser.add_argument("--solve", nargs=2, help=argparse.SUPPRESS)
    asked = parser.parse_args()
    if asked.solve:
        print(json.dumps(asdict(solved(asked.solve[0], Path(asked.solve[1])))))
        return
    print(f"| {' | '.join(HEADS)} |\n|{'---|' * len(HEADS)}", flush=True)
    for size in asked.sizes or [None]:
        compare(size, chosen(asked.codes), asked.limit_s)


if __name__ == "__main__":
    main()
