"""A load case of one's own: one file, one line, and plan, optimise and evaluate take it.

Gas force and centrifugal load together, at the running speed: a force on the pin and a body force, so that
its displacements are the sum of those of the two.
"""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import jax.numpy as jnp
import pytest

from cranktopo.base.errors import ExitCode
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design import load_kinds
from cranktopo.design.loading import load_scene
from cranktopo.engine.load_case import LoadCase
from cranktopo.tasks.density.model import build_model, case_forces
from cranktopo.tasks.density.response import solve
from cranktopo.tasks.density.stage import prepare

FILE = '''
"""The largest radial force with the throw's own body force at the running speed."""

from cranktopo.engine.extreme_state import ExtremeState
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.load_cases import bending
from cranktopo.engine.load_type import LoadType


def states(throw):
    (largest,) = bending.LOAD_TYPE.states(throw)
    case = LoadCase(
        name="firing",
        kind="firing",
        radial_N=largest.case.radial_N,
        speed_rpm=throw.analysis.engine.speed_rpm,
        source="gas force at the running speed",
    )
    return (ExtremeState("firing", case, largest.deg),)


LOAD_TYPE = LoadType("firing", "firing", "radial_N", "gas force", states, bending.LOAD_TYPE.energy_Nmm)
'''
HEAD = "LOAD_KINDS = {\n"
LINE = '    "firing": LoadKeys("Load case of gas force and body force.", weight=0.25),\n'
PROGRAM = """
import os, sys, types

folder = sys.argv[1]
kinds = types.ModuleType("cranktopo.design.load_kinds")
sys.modules[kinds.__name__] = kinds
exec(open(folder + "/load_kinds.py", encoding="utf-8").read(), vars(kinds))
import cranktopo.engine.load_cases

cranktopo.engine.load_cases.__path__.append(folder)

from cranktopo.app.main import main

if "optimise" in sys.argv:
    from tests.plain_runs import plain_runs
else:
    from contextlib import nullcontext as plain_runs

options = {
    "optimise": ["--resolution-mm", "4.5", "--max-iterations", "2", "--out", folder + "/run"],
    "evaluate": ["--element-size-mm", "16"],
}
with plain_runs():
    for command in sys.argv[2:]:
        code = main([command, folder + "/own.toml", *options.get(command, []), "--json", "--quiet"])
        print(f"end of {command} with {code:d}", flush=True)
os._exit(0)  # before nanobind lists what is left in caches
"""
DESIGN = "mikron-iiic-plain"
ROOT = Path(__file__).parents[2]


def told(folder: Path, *commands: str) -> dict[str, Any]:
    """Return what commands print of a design with the case on, by their names; each may not converge."""
    (folder / "firing.py").write_text(FILE, encoding="utf-8")
    source = Path(load_kinds.__file__).read_text(encoding="utf-8")
    assert source.count(HEAD) == 1
    (folder / "load_kinds.py").write_text(source.replace(HEAD, HEAD + LINE), encoding="utf-8")
    design = (ROOT / "designs" / f"{DESIGN}.toml").read_text(encoding="utf-8")
    on = design.replace("[effects]\n", '[effects]\nfiring = "on"\n').replace(f'"{DESIGN}"', '"own"', 1)
    (folder / "own.toml").write_text(on, encoding="utf-8")
    program = [sys.executable, "-c", PROGRAM, str(folder), *commands]
    done = subprocess.run(program, cwd=ROOT, capture_output=True, text=True, env=os.environ)
    assert done.returncode == 0, done.stderr
    parts = re.split(r"(?m)^end of (\w+) with (\d)$", done.stdout)
    assert set(parts[2::3]) <= {"0", f"{ExitCode.NOT_CONVERGED:d}"}, done.stderr
    return {name: json.loads(text) for name, text in zip(parts[1::3], parts[::3], strict=False)}


def test_a_file_and_a_line_add_a_load_case(tmp_path: Path) -> None:
    """The plan has it beside bending, with the energy of its force."""
    effects = {effect["name"]: effect for effect in told(tmp_path, "plan")["plan"]["effects"]}
    assert effects["firing"]["state"] == "on"
    assert effects["firing"]["reason"].startswith("set on in the scene; gas force 32,")
    assert effects["firing"]["estimate_percent"] == pytest.approx(effects["bending"]["estimate_percent"])


@pytest.mark.slow
def test_an_optimisation_and_an_evaluation_take_it(float64: None, tmp_path: Path) -> None:
    found = told(tmp_path, "optimise", "evaluate")
    cases = found["optimise"]["load_cases"]
    assert list(cases) == ["firing", "bending", "torsion"]
    assert "stiffness_N_per_mm" not in cases["firing"], "a body force has none"
    assert cases["firing"]["compliance_N_mm"] < cases["bending"]["compliance_N_mm"], "the webs pull outward"
    original = found["optimise"]["original_web"]["load_cases"]["firing"]
    assert original["compliance_N_mm"] == pytest.approx(work_of_both(original["load"]), rel=1e-5)
    (evaluation,) = found["evaluate"]["evaluations"]
    assert evaluation["bending"]["pinned_N_per_mm"] > 0


def work_of_both(case: dict[str, Any]) -> float:
    """(F + G) (u + v) on the original web, solved for the two loads by the kinds that are there, N mm."""
    scene = load_scene(DESIGN).with_optimise(resolution_mm=4.5)
    force = LoadCase(name="force", kind="bending", radial_N=case["radial_N"])
    mass = LoadCase(name="mass", kind="centrifugal", speed_rpm=case["speed_rpm"])
    ready = prepare(scene)
    web = build_domain(ready.scene, 4.5, "web", ready.domain.extent, ready.domain.grid).passive_fraction
    model, solid = build_model(ready.scene, ready.domain, (force, mass)), jnp.asarray(web)
    loads = case_forces(model, solid)
    u = solve(model, solid, forces=loads).displacements
    return float(jnp.sum(loads.sum(axis=0) * u.sum(axis=0))) * model.modulus_MPa / model.share
