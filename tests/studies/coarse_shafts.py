"""Error of the coarse mesh on which `shape` judges a web in its shaft.

    python -m tests.studies.coarse_shafts [DESIGN...]

Of each design (or web.toml of a run) the least safety of all webs in the shaft over its range of speeds, on
the mesh of the check and on that of an evaluation, with the processor time of each.
"""

from __future__ import annotations

import sys
import time

from cranktopo.design.loading import load_scene
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
from cranktopo.tasks.web_shape.each_web.loaded_shaft import loaded_shaft
from cranktopo.tasks.web_shape.in_shaft import in_its_shaft
from cranktopo.tasks.web_shape.shaft_check import FILLET_FRACTION
from tests.studies.own_webs import DESIGNS

SHAFTS = tuple(name for name in DESIGNS if not name.startswith("opposed-piston"))
"""Built-in designs of several throws."""
HEAD = ("design", "coarse", "s", "fine", "s", "coarse over fine")


def row(name: str) -> str:
    """Return the row of a design."""
    cells, safeties = [name], []
    for fraction in (FILLET_FRACTION, RULE_FRACTION):
        began = time.process_time()
        found = loaded_shaft(in_its_shaft(load_scene(name)), fraction).figures
        safeties.append(found.safety)
        cells += [f"{found.safety:.3f}", f"{time.process_time() - began:.0f}"]
    return f"| {' | '.join([*cells, f'{100 * (safeties[0] / safeties[1] - 1):+.1f} %'])} |"


def main(*designs: str) -> None:
    """Print the table as Markdown."""
    print(f"| {' | '.join(HEAD)} |\n|{'---|' * len(HEAD)}", flush=True)
    for name in designs or SHAFTS:
        print(row(name), flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
