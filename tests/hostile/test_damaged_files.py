"""Damaged STEP, STL and stored files of every kind: exit codes, no traceback, no signal, no long wait.

`python -m tests.hostile.test_damaged_files KIND FIRST COUNT` prints a summary by exit code and every fault;
the kinds are step, stl, optimise, sweep and shape.
"""

from __future__ import annotations

import random
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from unittest.mock import patch

import pytest

from cranktopo import shape_settings, sweep
from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.bodies.solid.files import export_solid
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import design_text, load_scene
from tests import sweep_cases
from tests.hostile import outcome
from tests.hostile.commands import Case
from tests.hostile.damage import damaged
from tests.plain_runs import plain_runs
from tests.shape_stand_in import ShapeStandIn

DESIGN = "mikron-iiic-plain"
QUICK = {"step": 3, "stl": 60, "optimise": 60, "sweep": 30, "shape": 60}
SLOW = {"step": 150, "stl": 650, "optimise": 600, "sweep": 350, "shape": 350}
Files = dict[str, bytes]
STORED = {
    "optimise": (
        "runs show run", "runs list --root .", "report run", "extract run", "extract run --iteration 2",
        "evaluate run", f"compare {DESIGN} --baseline run", "remodel run", "optimise --resume run",
        "export run y.stl", "shape run", "fatigue run", "runs clean --root . --yes", "plan run",
        "vibration run",
    ),
    "sweep": (
        "runs show run", "runs list --root .", "sweep --resume run",
        "compare run --baseline mikron-iiic-plain", "report run", "evaluate run", "plan run",
    ),
    "shape": (
        "runs show run", "runs list --root .", "shape --resume run",
        "compare run --baseline mikron-iiic-plain",
        "evaluate run", "evaluate run --sensitivities", "export run y.stl", "fatigue run", "plan run",
        "iterate run", "shape run",
    ),
}  # fmt: skip
# What long work begins with, where a case is harmless; a process that reads a STEP file is not held back.
WORK = (
    "gmsh.initialize",
    "cranktopo.tasks.optimise.stage.iterate",
    "cranktopo.tasks.sweep.computed.compute",
    "cranktopo.tasks.shape.run.optimise_shape",
    "cranktopo.tasks.refit.stage.fit_web",
    "cranktopo.tasks.fea.evaluation.condensed_stiffness",
    "cranktopo.tasks.importing.imported_body.mesh_step_for_stress",
    "cranktopo.tasks.importing.imported_body.tetrahedralise",
    "cranktopo.tasks.importing.imported_body.in_child",
)


def made(kind: str, folder: Path) -> Files:
    """The undamaged files of a kind by name."""
    scene, run = load_scene(DESIGN), folder / "run"
    if kind in ("step", "stl"):
        export_solid(scene, "half", folder / f"x.{kind}", 6.0)
        return {f"x.{kind}": (folder / f"x.{kind}").read_bytes()}
    if kind == "optimise":
        words = ["optimise", DESIGN, "--volume-fraction", "0.3", "--resolution-mm", "4.5", "--quiet"]
        with plain_runs():
            assert main([*words, "--max-iterations", "3", "--out", str(run)]) == 5
    elif kind == "sweep":
        sweep(DESIGN, {"web.width_mm": [50, 52, 3]}, out=run, function=sweep_cases.empty, workers=1)
    else:
        goal = with_goal(scene, minimise="mass")
        ShapeStandIn().design(goal, shape_settings(goal), run, "", ["cranktopo", "shape"], None)
    skipped = (".lock", ".html", ".png", ".vtu", ".parquet")
    found = [file for file in run.rglob("*") if file.is_file() and not file.name.endswith(skipped)]
    return {str(file.relative_to(folder)): file.read_bytes() for file in found}


def _run_case(r: random.Random, kind: str, files: Files) -> Case:
    weights = [4 if name.endswith((".json", ".npz")) else 1 for name in files]
    changed: dict[str, bytes | str] = dict(files)
    for _ in range(r.choice([1, 1, 1, 2])):
        name = r.choices(list(files), weights)[0]
        changed[name] = damaged(r, Path(name).name, files[name])
    return Case(r.choice(STORED[kind]).split(), changed)


def _body_case(r: random.Random, kind: str, files: Files) -> Case:
    (name,) = files
    words = r.choice(
        [
            ["evaluate", name, "--design", DESIGN, "--element-size-mm", "12"],
            ["evaluate", name, "--design", DESIGN, "--element-size-mm", "12", "--json"],
            ["fatigue", name, "--design", DESIGN],
            ["compare", name, "--baseline", DESIGN, "--design", DESIGN],
            ["plan", "x.toml"],
            ["optimise", "x.toml", "--resolution-mm", "4.5"],
        ]
    )
    table = "original" if words[0] == "optimise" else "envelope"
    shape = 'shape = "stl"\n' if table == "envelope" else ""
    text = design_text(DESIGN)
    text = text.partition("[envelope]")[0] if table == "envelope" else text
    design = f'{text}\n[{table}]\n{shape}file = "{name}"\n'
    return Case(words, {name: damaged(r, name, files[name]), "x.toml": design.encode()})


def faults_of(kind: str, seeds: range, folder: Path) -> tuple[list[str], Counter[int], float]:
    """Faults by seed, number of cases by exit code, and the longest time, s."""
    source = folder / "source"
    source.mkdir()
    files, found, codes, longest = made(kind, source), list[str](), Counter[int](), 0.0
    make: Callable[[random.Random, str, Files], Case] = _run_case if kind in STORED else _body_case
    with _no_work():
        for seed in seeds:
            place = folder / str(seed)
            place.mkdir()
            case = make(random.Random(f"{kind} {seed}"), kind, files)
            ended = outcome.run_case(case, place)
            codes[ended.code] += 1
            longest = max(longest, ended.seconds)
            faults = [fault for fault in ended.faults if not fault.startswith("writes")]  # a run that fails
            if faults:
                what = "; ".join(faults)
                found.append(f"{kind} {seed}: {' '.join(case.arguments)}: {what}: {ended.stderr[-400:]}")
    return found, codes, longest


@contextmanager
def _no_work() -> Iterator[None]:
    with ExitStack() as stack:
        stack.enter_context(patch.object(outcome, "LIMIT_S", 30.0))
        for target in WORK:
            error = CranktopoError("no work here.", code=ExitCode.SOLVER)
            stack.enter_context(patch(target, side_effect=error))
        yield


@pytest.mark.parametrize(
    "kind", [pytest.param(kind, marks=[pytest.mark.slow] * (kind in ("optimise", "step"))) for kind in QUICK]
)
def test_damaged_files(kind: str, tmp_path: Path) -> None:
    faults, codes, _ = faults_of(kind, range(QUICK[kind]), tmp_path)
    assert not faults, "\n".join(faults)
    assert codes[3] >= QUICK[kind] / 4


@pytest.mark.slow
@pytest.mark.parametrize("kind", list(SLOW))
def test_two_thousand_damaged_files(kind: str, tmp_path: Path) -> None:
    faults, codes, longest = faults_of(kind, range(1000, 1000 + SLOW[kind]), tmp_path)
    print(kind, dict(sorted(codes.items())), f"longest {longest:.1f} s")
    assert not faults, "\n".join(faults)


if __name__ == "__main__":
    named, first, count = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    began = time.perf_counter()
    with tempfile.TemporaryDirectory() as where:
        told, by_code, most = faults_of(named, range(first, first + count), Path(where))
    print("\n".join(told))
    took = time.perf_counter() - began
    print(f"{named}: {count} cases in {took:.0f} s, longest {most:.1f} s, {len(told)} faults, by exit code:")
    print(dict(sorted(by_code.items())))
