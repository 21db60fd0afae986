"""Time of the safety of every fillet of a shaft over its speeds: `python -m tests.benchmarks.shaft_safety`.

    python -m tests.benchmarks.shaft_safety [--speeds N] [DESIGN...]

One process per design. Processor seconds of all its threads, and by the clock, of each part of
`shaft --method lsa --speeds` at every degree of the cycle; asked for are 60 s on two cores after the mesh.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable
from importlib import import_module
from typing import Any

import numpy as np

SPEEDS_RPM = {"mikron-iiic": (1000.0, 2800.0), "industrial-gas": (750.0, 1800.0)}
"""Of a four and of a six in line, with 8 and 12 webs."""
_STRESS, _JUDGED = "cranktopo.tasks.throw_fatigue.shaft_stress", "cranktopo.tasks.shaft_safety.judged"
PARTS = {
    "mesh": ((_STRESS, "mesh_for_stress"),),
    "unit fields": ((_STRESS, "throw_body"),),
    "their stresses": ((_STRESS, "stress_model"),),
    "states": ((_JUDGED, "solved_cycle"), (_JUDGED, "factors_of")),
    "safety": ((_JUDGED, "least_safeties"), (_JUDGED, "field_of_states")),
}
"""Functions whose time is that of a part; they run one after the other."""
REST = "moments, bearings, mesh error"


def _spent() -> tuple[float, float]:
    """Processor seconds of this process and of those that it waited for, and the clock."""
    own, children = (resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN))
    return sum(one.ru_utime + one.ru_stime for one in (own, children)), time.perf_counter()


def _timed(part: str, function: Callable[..., Any], taken: dict[str, Counter[str]]) -> Callable[..., Any]:
    def timed(*given: Any, **named: Any) -> Any:
        before = _spent()
        try:
            return function(*given, **named)
        finally:
            for kind, start, end in zip(taken, before, _spent(), strict=True):
                taken[kind][part] += end - start

    return timed


def rows(design: str, speeds: int) -> str:
    """Return the two rows of a design, from this very process."""
    from cranktopo.design.loading import load_scene
    from cranktopo.tasks.shaft_safety.judged import judged_shaft
    from cranktopo.tasks.throw_fea.targets import resolve_target

    taken = {"CPU s": Counter[str](), "s": Counter[str]()}
    for part, places in PARTS.items():
        for module, name in places:
            owner = import_module(module)
            setattr(owner, name, _timed(part, getattr(owner, name), taken))
    target = resolve_target(load_scene(design), fillets=True, whole=True, crank=True)
    begin = _spent()
    _, judged = judged_shaft(target, "rigid", "lsa", np.linspace(*SPEEDS_RPM[design], speeds).tolist())
    found = judged.safety()
    whole = dict(zip(taken, np.subtract(_spent(), begin), strict=True))
    states = found.load_states // speeds
    told = f"{design}, {len(found.webs)} webs, {speeds} speeds, {states} states each"
    return "\n".join(_row(f"{told}: {kind}", own, whole[kind]) for kind, own in taken.items())


def _row(name: str, taken: Counter[str], whole: float) -> str:
    each = [taken[part] for part in PARTS]
    after = sum(each) - taken["mesh"]
    cells = [*each, after, whole - sum(each), whole]
    return f"| {name} | {' | '.join(f'{value:.1f}' for value in cells)} |"


def main() -> None:
    """Print the table as Markdown."""
    parser = argparse.ArgumentParser()
    parser.add_argument("designs", nargs="*", default=list(SPEEDS_RPM))
    parser.add_argument("--speeds", type=int, default=100)
    parser.add_argument("--rows", action="store_true", help="print the rows of one design alone")
    asked = parser.parse_args()
    if asked.rows:
        print(rows(asked.designs[0], asked.speeds))
        return
    heads = ["shaft", *PARTS, "safety after the mesh", REST, "all"]
    print(f"| {' | '.join(heads)} |\n|{'---|' * len(heads)}", flush=True)
    # As in the program: threads of OpenBLAS wait busily, which would count as work.
    here = os.environ | {"PYTHONPATH": os.pathsep.join(filter(None, sys.path)), "OPENBLAS_NUM_THREADS": "1"}
    for design in asked.designs:
        own = [sys.executable, "-m", "tests.benchmarks.shaft_safety", "--rows", design]
        words = [*own, "--speeds", str(asked.speeds)]
        told = subprocess.run(words, env=here, stdout=subprocess.PIPE, text=True, check=True)
        print(told.stdout, end="", flush=True)


if __name__ == "__main__":
    main()
