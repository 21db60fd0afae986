"""What one stage writes the next one reads: engines drawn at random, from 6 to 600 mm, through every command.

`pytest -m slow -n 0 tests/hard/test_random_engines.py` walks all sixty; `--log-file walk.log
--log-file-level=INFO` writes the seconds of every command.
"""

from __future__ import annotations

import io
import logging
import time
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import ExitCode
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.writing import toml_text
from cranktopo.tasks.refit.stage import remodel_run
from tests.random_engines import random_engine

ENGINES = range(60)
LOOPS = 6
"""The loop of one step is walked by the first of every so many engines: it repeats what the others do."""
CELLS_PER_RADIUS = 9
ELEMENTS_PER_JOURNAL = 4
FEW_SEARCHES = {"max_stations": 5, "starts": 1, "least_gain_percent": 1.0}
DONE, NOT_CONVERGED = int(ExitCode.DONE), int(ExitCode.NOT_CONVERGED)
_LOG = logging.getLogger(__name__)


class Walk:
    """One engine in the current folder: its design, its lengths, and the commands that it went through."""

    def __init__(self, seed: int) -> None:
        data = random_engine(seed)
        self.design = f"engine-{seed}.toml"
        Path(self.design).write_text(toml_text(scene_from_dict(data), "drawn at random"), encoding="utf-8")
        throw = data["throw"]
        journals = [throw[name] for name in ("main_journal", "crankpin")]
        journal = min(table["outer_diameter_mm"] for table in journals)
        wall = min(table["outer_diameter_mm"] - table["bore_diameter_mm"] for table in journals) / 2
        self.cell_mm = f"{min(throw['radius_mm'] / CELLS_PER_RADIUS, 0.49 * wall):.4g}"
        self.size = ("--element-size-mm", f"{journal / ELEMENTS_PER_JOURNAL:.4g}")
        self.fit = {"cell_mm": journal / 20, **FEW_SEARCHES}

    def run(self, *arguments: str, codes: tuple[int, ...] = (DONE,)) -> str:
        """A command's standard output; its exit code must be one of these."""
        out, err = io.StringIO(), io.StringIO()
        start = time.monotonic()
        with redirect_stdout(out), redirect_stderr(err):
            code = main(list(arguments))
        _LOG.info("%s exit %d %.1f s: %s", self.design, code, time.monotonic() - start, " ".join(arguments))
        assert code in codes, f"cranktopo {' '.join(arguments)}: exit {code}\n{err.getvalue()[-3000:]}"
        return out.getvalue()


@pytest.mark.slow
@pytest.mark.parametrize("seed", ENGINES)
def test_engine_through_every_command(seed: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    walk = Walk(seed)
    look_at_design(walk)
    exports(walk)
    a_run(walk)
    remodelled(walk)
    fatigue(walk)
    if seed % LOOPS == 0:
        a_loop(walk)


def look_at_design(walk: Walk) -> None:
    walk.run("plan", walk.design)
    walk.run("loads", walk.design, "--csv", "loads.csv", "--plot", "loads.png")
    walk.run("designs", "copy", walk.design, "copy.toml")
    walk.run("shaft", walk.design, *walk.size, "--quiet")
    walk.run("accuracy", walk.design, "--budget", "1s", "--quiet")


def exports(walk: Walk) -> None:
    """Every part and kind of file; the half throw is read again."""
    walk.run("export", walk.design, "drawing.pdf")
    walk.run("export", walk.design, "throw.stl")
    for part in ("half", "web", "crankshaft"):
        walk.run("export", walk.design, f"{part}.step", "--part", part)
    walk.run("evaluate", "half.step", "--design", walk.design, *walk.size, "--quiet")


def a_run(walk: Walk) -> None:
    """Optimise, and everything that reads a run."""
    few = ("--max-iterations", "12", "--resolution-mm", walk.cell_mm, "--volume-fraction", "0.4")
    walk.run("optimise", walk.design, *few, "--out", "run", "--quiet", codes=(DONE, NOT_CONVERGED))
    walk.run("evaluate", "run", *walk.size, "--quiet")
    walk.run("extract", "run", "--iteration", "5", "--format", "glb", "--quiet")
    walk.run("extract", "run", "--out", "last.stl", "--quiet")
    walk.run("shaft", "last.stl", "--design", walk.design, *walk.size, "--quiet")
    walk.run("report", "run", "--quiet")
    walk.run("runs", "list", "--root", ".")
    walk.run("runs", "show", "run", "--root", ".")


def remodelled(walk: Walk) -> None:
    """The re-modelled web, and everything that reads it."""
    remodel_run("run", Path("remodel"), walk.fit, evaluated=False)
    (web,) = (str(path) for path in Path("remodel").glob("*.toml"))
    walk.run("export", web, "web.pdf")
    walk.run("export", web, "web_throw.step")
    walk.run(
        "compare", web, "--baseline", walk.design, *walk.size, "--report", "all.html", "--no-bound", "--quiet"
    )


def fatigue(walk: Walk) -> None:
    walk.run("fatigue", walk.design, "--fillet-fraction", "0.5", "--out", "fatigue", "--quiet")


def a_loop(walk: Walk) -> None:
    cells = ("--resolution-mm", walk.cell_mm, "--cell-mm", f"{walk.fit['cell_mm']:.4g}", *walk.size)
    walk.run("iterate", walk.design, "--steps", "1", "--no-shape", *cells, "--out", "loop", "--quiet")
