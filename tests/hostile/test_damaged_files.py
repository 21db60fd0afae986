"""Damaged STEP, STL and stored files of every kind: exit codes, no traceback, no signal, no long wait.

What a command tells of stored files is that of the sound ones, or it refuses them.

`python -m tests.hostile.test_damaged_files KIND FIRST COUNT` prints a summary by exit code and every fault;
the kinds are those of `SLOW`.
"""

from __future__ import annotations

import os
import random
import re
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path
from unittest.mock import patch

import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.loading import design_text
from tests.hostile import outcome
from tests.hostile.commands import Case
from tests.hostile.damage import damaged
from tests.hostile.undamaged import CACHE, DESIGN, BenchOfFiles, Files, made, server_of_files

QUICK = {"step": 3, "stl": 40, "optimise": 60, "sweep": 20, "shape": 40, "accuracy": 30, "bench": 60}
SLOW = {
    "step": 100, "brep": 50, "stl": 300, "3mf": 100, "obj": 100, "optimise": 350, "sweep": 200, "shape": 200,
    "iterate": 150, "each-web": 150, "accuracy": 100, "remodel": 100, "import": 100, "bench": 150,
}  # fmt: skip
assert sum(SLOW.values()) >= 2000
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
    "iterate": (
        "runs show run", "runs list --root .", "report run", "iterate --resume run", "evaluate run",
        "plan run/step-01/web.toml", "export run/step-01/web.toml y.stl",
        "compare mikron-iiic --baseline run", "shape run",
        "evaluate run/step-01/web.step --design mikron-iiic",
    ),
    "each-web": (
        "runs show run", "runs list --root .", "report run", "shape --resume run", "shape run",
        "plan run/own-webs/crank.toml", "loads run/own-webs/crank.toml --throw 2", "evaluate run",
        "drawing run/own-webs/crank.toml y.svg", "compare mikron-iiic --baseline run",
    ),
    "accuracy": (
        f"evaluate {DESIGN} --accuracy 1%", f"evaluate {DESIGN} --budget 60s",
        f"compare {DESIGN} --baseline {DESIGN} --accuracy 3%",
        f"compare {DESIGN} --baseline {DESIGN} --budget 5min",
    ),
    "remodel": (
        "report run", "evaluate run/remodel/mikron-iiic-plain.toml", "remodel run",
        "plan run/remodel/mikron-iiic-plain.toml",
        "runs show run", "evaluate run/remodel/half_throw.step --design mikron-iiic-plain",
    ),
    "import": (
        "plan imported/throw.toml", "loads imported/throw.toml", "balance imported/throw.toml",
        "drawing imported/throw.toml y.svg", "evaluate imported/throw.toml", "import throw.step --out again",
    ),
    "bench": ("bench x.toml --no-browser",),
}  # fmt: skip
# What long work begins with, where a case is harmless; a process that reads a STEP file is not held back.
WORK = (
    "gmsh.initialize",
    "cranktopo.tasks.optimise.stage.iterate",
    "cranktopo.tasks.sweep.computed.compute",
    "cranktopo.tasks.web_shape.run.optimise_shape",
    "cranktopo.tasks.refit.stage.fit_web",
    "cranktopo.tasks.throw_fea.throw_stiffness.condensed_stiffness",
    "cranktopo.tasks.importing.imported_body.mesh_step_for_stress",
    "cranktopo.tasks.importing.imported_body.tetrahedralise",
    "cranktopo.tasks.importing.imported_body.in_child",
    "cranktopo.tasks.iterate.one_step.optimised_surface",
    "cranktopo.tasks.web_shape.each_web.run.loaded_shaft",
    "cranktopo.tasks.web_shape.each_web.rounds.loaded_shaft",
    "cranktopo.tasks.bench.command._announce",
)


_TIMES = re.compile(r"^[\d.]+ s\b.*$", re.MULTILINE)
"""Lines that tell how long a command took."""


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
    if kind in ("brep", "3mf", "obj"):  # a target is a STEP or STL; these are made designs of
        words = ["import", name, "--out", "y", *r.choice([[], ["--json"]])]
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
    named = {word for line in STORED.get(kind, ()) for word in line.split() if "/" in word}
    assert named <= set(files), "a command names a file that is not there"
    make: Callable[[random.Random, str, Files], Case] = _run_case if kind in STORED else _body_case
    with _no_work():
        for seed in seeds:
            place = folder / str(seed)
            place.mkdir()
            cache = {"XDG_CACHE_HOME": str(place / CACHE)} if kind == "accuracy" else {}
            case = make(random.Random(f"{kind} {seed}"), kind, files)
            with patch.dict(os.environ, cache):
                ended = outcome.run_case(case, place)
            codes[ended.code] += 1
            longest = max(longest, ended.seconds)
            faults = [fault for fault in ended.faults if not fault.startswith("writes")]  # a run that fails
            if kind in STORED and _believes(case, files, ended, folder):
                faults.append(f"tells what was changed: {ended.stdout[-400:]}")
            if faults:
                what = "; ".join(faults)
                found.append(f"{kind} {seed}: {' '.join(case.arguments)}: {what}: {ended.stderr[-400:]}")
    return found, codes, longest


def _believes(case: Case, files: Files, ended: outcome.Outcome, folder: Path) -> bool:
    """Tell whether a command that ended well told other than of the sound files; a list names damage."""
    if ended.code != ExitCode.DONE or case.arguments[:2] == ["runs", "list"]:
        return False
    place = folder / f"sound {' '.join(case.arguments)}".replace("/", "-")
    told = place / ".told"
    if not place.exists():
        place.mkdir()
        told.write_text(outcome.run_case(Case(case.arguments, dict(files)), place).stdout, encoding="utf-8")
    return _TIMES.sub("", ended.stdout) != _TIMES.sub("", told.read_text(encoding="utf-8"))


@contextmanager
def _no_work() -> Iterator[None]:
    with ExitStack() as stack:
        stack.enter_context(patch.object(outcome, "LIMIT_S", 30.0))
        for target in WORK:
            error = CranktopoError("no work here.", code=ExitCode.SOLVER)
            stack.enter_context(patch(target, side_effect=error))
        stack.enter_context(patch("cranktopo.tasks.bench.stage.Bench", BenchOfFiles))
        stack.enter_context(patch("cranktopo.tasks.bench.stage.Server", server_of_files))
        yield


@pytest.mark.parametrize(
    "kind",
    [
        pytest.param(kind, marks=[pytest.mark.slow] * (kind in ("optimise", "step", "bench", "accuracy")))
        for kind in QUICK
    ],
)
def test_damaged_files(kind: str, tmp_path: Path) -> None:
    faults, codes, _ = faults_of(kind, range(QUICK[kind]), tmp_path)
    assert not faults, "\n".join(faults)
    assert codes[3] >= QUICK[kind] / 4 or kind == "accuracy", "a damaged study is measured again"


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
