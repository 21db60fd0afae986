"""A quantity that several commands print has one number: every pair of commands, on three engines.

The pages of `fatigue --report` and `compare --report` are among them, read as Markdown. With everything that
takes elements: `pytest -m slow -s tests/cli/test_one_number.py`, which prints the count of pairs.
"""

from __future__ import annotations

import json
import math
import re
from itertools import combinations

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import ExitCode
from cranktopo.design.loading import designs_folder, load_scene
from cranktopo.tasks.iterate import one_step
from cranktopo.tasks.throw_fea import levels
from tests.cli.test_iterate import with_stand_ins
from tests.engine_arrangements import MIKRON

_PLAIN = MIKRON[: MIKRON.index("[envelope]")]
_WEIGHT = "[web.counterweight]\nouter_radius_mm = 60.0\nhalf_angle_deg = 70.0\n[material]"
_VEE = "[engine.arrangement]\nlayout = 'V'\nbank_angle_deg = 90.0\nthrow_angles_deg = [0.0]\n"
_SHAFT = "\n[shaft]\nthrow_loss_factor = 0.02\n[shaft.propeller]\ninertia_kg_m2 = 0.6\n"
SCENES = {
    "four with a propeller": _PLAIN + _SHAFT,
    "V2, half of the oscillating masses to be balanced": _PLAIN.replace("[material]", _WEIGHT, 1)
    .replace("cylinders = 4", "cylinders = 2")
    .replace("[1, 3, 4, 2]", "[1, 2]")
    .replace("[engine.masses]", f"{_VEE}balanced_oscillating_share = 0.5\n[engine.masses]"),
    "two different webs": _PLAIN.replace(
        "[material]", "[second_web]\nthickness_mm = 23.0\noutline = 'obround'\nwidth_mm = 60.0\n[material]", 1
    ),
}
_OIL = "\n[bearings]\nclearance_mm = 0.05\noil = 'ISO VG 46'\n"
CLOSED_FORM = {"loads": ["loads"], "balance": ["balance"], "plan": ["plan"], "film": ["film"]}
BY_ELEMENTS = {
    "evaluate": ["evaluate"],
    "shaft": ["shaft"],
    "vibration": ["vibration"],
    "modes": ["modes"],
    "sweep": ["sweep", "--vary", "web.thickness_mm=20", "--out", "{folder}/sweep"],
}

_FOUR, _TWO = ("four", "V2, half of the oscillating masses to be balanced")
_ENVELOPE = MIKRON[MIKRON.index("[envelope]") :]
_WIDE = _ENVELOPE.replace("y_min_mm = -34.0", "y_min_mm = -62.0").replace(
    "width_mm = 48.0", "width_mm = 62.0"
)
IN_AN_ENVELOPE = {_FOUR: _PLAIN + _ENVELOPE, _TWO: SCENES[_TWO] + _WIDE}
_COARSE = ["--resolution-mm", "4.5"]
_LOOP = ["--steps", "1", "--volume-fraction", "0.6", "--no-shape", "--no-bound", "--out", "{folder}/loop"]
OPTIMISED = {
    "loads": ["loads"],
    "evaluate": ["evaluate"],
    "sweep": BY_ELEMENTS["sweep"],
    "iterate": ["iterate", *_LOOP, *_COARSE],
    "accuracy": ["accuracy", "--budget", "1s", "--out", "{folder}/accuracy"],
    "bound": ["bound", *_COARSE],
    "optimise": ["optimise", "--minimise", "mass", "--max-iterations", "2", "--out", "{folder}/o", *_COARSE],
}


def _loads(data):
    throw, torque = data["balance"], data["engine_torque_Nm"]
    yield from {
        "speed": data["speed_rpm"],
        "counterweights of a throw": throw["counterweight_kg_mm"],
        "counterweights that a throw has": throw["own_counterweight_kg_mm"],
        "balance factor": throw["balance_factor_percent"],
        "mass of the throw": throw["throw_mass_kg"],
        "mass of the first web": throw["web_mass_kg"],
        "mass of the second web": throw["second_web_mass_kg"],
        "inertia of the throw": throw["inertia_kg_mm2"],
        "unbalance of the throw": throw["throw_unbalance_kg_mm"],
        "largest load of the first main bearing": data["extremes"]["main_journal_force_N"]["max"]["value"],
        "push at the small end": data["extremes"]["small_end_force_N"]["max"]["value"],
        "mean torque of the engine": torque["mean"],
    }.items()
    yield from _effects(data)


def _effects(data):
    for effect in data["effects"]:
        yield f"estimate of {effect['name']}", effect["estimate_percent"]
        yield f"state of {effect['name']}", effect["state"]


def _balance(data):
    webs = [web for web in data["counterweights"] if web["throw"] == 1]
    yield from {
        "speed": data["speed_rpm"],
        "counterweights of a throw": -sum(
            web["unbalance_kg_mm"] * math.cos(math.radians(web["deg"])) for web in webs
        ),
        "counterweights that a throw has": sum(web["own_kg_mm"] for web in webs),
        "balance factor": data["balance_factor_percent"],
        "largest load of the first main bearing": data["main_bearings"][0]["max_N"],
        "angles of the throws": data["arrangement"]["throw_angles_deg"],
    }.items()


def _film(data):
    (at,) = data["speeds"]
    main = next(one for one in at["bearings"] if one["bearing"] == "main 1")
    yield "speed", at["rpm"]
    yield "largest load of the first main bearing", main["max_N"]


def _modes(data):
    twists = [mode["disks_Hz"] for mode in data["modes"] if mode["disks_Hz"] is not None]
    twists += [shared["disks_Hz"] for shared in data["disks_shared"]]
    if twists:
        yield "first natural frequency by disks", min(twists)


def _sweep(data):
    """The original, which stands beside every point; the point itself is another web."""
    told = data["original"]
    names = {"mass_kg": "mass of the throw", "web_mass_kg": "mass of the first web"}
    names |= {"inertia_kg_mm2": "inertia of the throw", "unbalance_kg_mm": "unbalance of the throw"}
    names |= {"torsion_Nm_per_rad": "torsional stiffness", "bending_N_per_mm": "bending stiffness"}
    names |= {"second_web_mass_kg": "mass of the second web"}
    yield from ((name, told[key]) for key, name in names.items() if key in told)


def _evaluate(data):
    entry = data["evaluations"][0]
    yield from {
        "mass of the throw": entry["mass_kg"]["throw"],
        "mass of the first web": entry["mass_kg"]["web"],
        "inertia of the throw": entry["inertia_kg_mm2"],
        "unbalance of the throw": entry["unbalance_kg_mm"],
        "balance factor": entry["balance_factor_percent"],
        "torsional stiffness": entry["torsion"]["free_Nm_per_rad"],
        "bending stiffness": entry["bending"]["pinned_N_per_mm"],
        "torsional stiffness per mass": entry["stiffness_per_mass"]["torsion_Nm_per_rad_kg"],
        "bending stiffness per mass": entry["stiffness_per_mass"]["bending_N_per_mm_kg"],
    }.items()
    for case, percent in entry["error_estimate_percent"].items():
        yield f"error bound of the {case}", percent
    if "second_web" in entry["mass_kg"]:
        yield "mass of the second web", entry["mass_kg"]["second_web"]


def _iterate(data):
    """The original web, whose row comes first."""
    original = data["steps"][0]
    yield from {
        "mass of the throw": original["throw_kg"],
        "mass of the first web": original["web_kg"],
        "torsional stiffness": original["torsion_Nm_per_rad"],
        "bending stiffness": original["bending_N_per_mm"],
        "torsional stiffness per mass": original["torsion_per_mass_Nm_per_rad_kg"],
        "bending stiffness per mass": original["bending_per_mass_N_per_mm_kg"],
        "error bound of the torsion": original["torsion_error_percent"],
        "error bound of the bending": original["bending_error_percent"],
    }.items()


def _accuracy(data):
    """The mesh that the other commands take by default."""
    (rung,) = (one for one in data["rungs"] if one["name"].startswith("graded"))
    yield "torsional stiffness", rung["torsion_Nm_per_rad"]
    yield "bending stiffness", rung["bending_N_per_mm"]
    yield "error bound of the torsion", rung["own_bounds_percent"]["torsion_Nm_per_rad"]
    yield "error bound of the bending", rung["own_bounds_percent"]["bending_N_per_mm"]


def _bound(data):
    """The original web in the model of the proof: on cells."""
    names = {"mass": "mass of the throw", "torsion": "torsional stiffness", "bending": "bending stiffness"}
    names |= {f"{case}_per_mass": f"{names[case]} per mass" for case in ("torsion", "bending")}
    yield from ((f"{name} on cells", data["original"][key]) for key, name in names.items())
    for case, percent in data["model_error_percent"].items():
        yield f"error bound of the {case} on cells", percent


def _optimise(data):
    original = data["original_web"]
    torsion, bending = (original["load_cases"][case] for case in ("torsion", "bending"))
    yield from {
        "mass of the throw on cells": original["mass_kg"]["throw"],
        "torsional stiffness on cells": torsion["stiffness_Nm_per_rad"],
        "bending stiffness on cells": bending["stiffness_N_per_mm"],
        "torsional stiffness per mass on cells": original["stiffness_per_mass"]["torsion_Nm_per_rad_kg"],
        "bending stiffness per mass on cells": original["stiffness_per_mass"]["bending_N_per_mm_kg"],
        "error bound of the torsion on cells": torsion["error_estimate_percent"],
        "error bound of the bending on cells": bending["error_estimate_percent"],
    }.items()


def _shaft(data):
    disks, throws = data["opentorsion"]["disks"], data["torsion"]["throws_Nm_per_rad"]
    yield from {
        "mass of the throw": data["mass_kg"] / len(throws),
        "angles of the throws": data["throw_angles_deg"],
        "inertia of a throw that moves": disks[0]["I"],
    }.items()
    if len(throws) > 1:
        yield "stiffness between the first throws", data["opentorsion"]["shafts"][0]["k"]
        yield "first natural frequency of the bare shaft", data["natural_frequencies_Hz"][0]
    if len(throws) == 1:  # alone it has no neighbours that hold it
        yield "torsional stiffness", throws[0]


def _vibration(data):
    sections = [one for one in data["sections"] if one["name"] == "throw 1 - throw 2"]
    yield "inertia of a throw that moves", data["disks"][0]["inertia_kg_m2"]
    yield "stiffness between the first throws", sections[0]["stiffness_Nm_per_rad"]
    stiffer = (1 + data["damping"]["throw_loss_factor"] ** 2) ** 0.25  # what swings has |k (1 + i loss)|
    yield "first natural frequency by disks", data["natural_frequencies_Hz"][0] / stiffer
    if all(disk["name"].startswith("throw ") for disk in data["disks"]):
        yield "first natural frequency of the bare shaft", data["natural_frequencies_Hz"][0] / stiffer


def _fatigue(data):
    entry = data["fatigue"][0]
    yield "mass of the throw", entry["throw_kg"]
    yield "acceptability", min(one["safety"] for one in data["fatigue"])
    yield "alternating torque", entry["alternating"]["torque_Nm"]
    yield "alternating bending moment", entry["alternating"]["moment_Nm"]


def _compare(data):
    yield from _evaluate(data)
    yield from _fatigue(data["fatigue"])


_SWINGS = r"swings most at (\d+) rpm[^:]*: \+-([\d,.]+) N m"


def _page(text):
    """Frequency and speed of the vibration, and the load case of torsion, as a page has them."""
    found = re.search(
        r"first natural frequency (\S+) Hz.*?worst at (\d+) rpm, [^:;]*?order (\d+\.?\d*)", text
    )
    names = ("first natural frequency", "speed where it swings most", "order that swings most")
    yield from zip(names, map(float, found.groups()), strict=True)
    row = next(line for line in text.splitlines() if line.startswith("| torsion | ") and "vibrating" in line)
    yield "torque of the load case", float(row.split("|")[4].replace(",", ""))


def _fast(data):
    """Of the highest speed, where the pull of the masses is largest."""
    yield "pull at the small end", -data["extremes"]["small_end_force_N"]["min"]["value"]


def _rod(data):
    yield "push at the small end", data["push_N"]
    yield "pull at the small end", data["pull_N"]
    yield "pull in the cap", next(one for one in data["sections"] if one["section"] == "cap")["pull_N"]
    yield from _joint(data["bolt"])


def _bolts(data):
    joint = next(joint for joint in data["joints"] if joint["name"] == "rod")
    yield "pull in the cap", 2 * joint["max_force_N"]
    yield from _joint(joint)


def _joint(joint):
    for key in ("max_force_N", "smallest_safety", "governing"):
        yield f"{key} of the rod's bolt", joint[key]
    for method in ("vdi_2230", "shigley"):
        yield from ((f"{key} of the rod's bolt by {method}", value) for key, value in joint[method].items())


_READERS = {
    "loads of its highest speed": _fast,
    "rod": _rod,
    "bolts": _bolts,
    "loads": _loads,
    "balance": _balance,
    "plan": _effects,
    "evaluate": _evaluate,
    "shaft": _shaft,
    "vibration": _vibration,
    "fatigue": _fatigue,
    "compare": _compare,
    "film": _film,
    "modes": _modes,
    "sweep": _sweep,
    "iterate": _iterate,
    "accuracy": _accuracy,
    "bound": _bound,
    "optimise": _optimise,
}
_TELLING = (ExitCode.DONE, ExitCode.NOT_CONVERGED, ExitCode.CRITERION_NOT_MET)


def told(capsys, path, commands):
    """What each command tells, by command and quantity; a shaft of one throw has no torsional vibration."""
    found = {}
    for name, (command, *options) in commands.items():
        as_json = ["--format", "json"] if command == "compare" else ["--json"]
        chosen = [option.format(folder=path.parent) for option in options]
        code = main([command, str(path), *chosen, *as_json])
        data = json.loads(capsys.readouterr().out)
        if code in _TELLING:
            found[name] = dict(_READERS[name](data))
        else:
            assert "one throw with nothing joined to it" in data["error"]["message"]
    return found


def pairs(found):
    """Every two commands that tell the same quantity, with both values."""
    names = sorted({name for quantities in found.values() for name in quantities})
    for name in names:
        tellers = [command for command, quantities in found.items() if name in quantities]
        for one, other in combinations(tellers, 2):
            yield name, one, other, found[one][name], found[other][name]


def check(found, least):
    every = list(pairs(found))
    differ = [pair for pair in every if not _alike(*pair[3:])]
    print(f"\n{len(every)} pairs of commands tell the same quantity, {len(every) - len(differ)} agree")
    assert differ == []
    assert len(every) >= least


def _alike(one, other):
    return one == other if isinstance(one, str | None) else one == pytest.approx(other, rel=1e-9, abs=1e-9)


@pytest.mark.parametrize(
    "scene",
    [pytest.param(scene, marks=() if scene == _TWO else pytest.mark.slow) for scene in SCENES],
)
def test_what_closed_forms_tell(capsys, tmp_path, scene):
    path = tmp_path / "engine.toml"
    path.write_text(SCENES[scene] + _OIL)
    check(told(capsys, path, CLOSED_FORM), least=34)


def test_what_an_own_rod_tells(capsys, tmp_path):
    """It pushes most at the rated speed, by the gas, and pulls most at the highest."""
    path = tmp_path / "engine.toml"
    path.write_text((designs_folder() / "mikron-iiic-rod.toml").read_text(encoding="utf-8") + _OIL)
    fast = {"loads of its highest speed": ["loads", "--speed", "2800"]}
    check(told(capsys, path, CLOSED_FORM | fast | {"rod": ["rod"], "bolts": ["bolts"]}), least=70)


@pytest.mark.slow
@pytest.mark.parametrize("scene", SCENES)
def test_what_elements_tell(capsys, tmp_path, scene):
    path = tmp_path / "engine.toml"
    path.write_text(SCENES[scene] + _OIL)
    found = told(capsys, path, CLOSED_FORM | BY_ELEMENTS)
    with capsys.disabled():
        check(found, least=58)


@pytest.mark.slow
@pytest.mark.parametrize("scene", IN_AN_ENVELOPE)
def test_what_optimisers_tell_of_the_original(capsys, tmp_path, monkeypatch, scene):
    """The steps of the loop are stand-ins, the mesh of `accuracy` is the one that the others take too."""
    evaluated = one_step.evaluate
    with_stand_ins(monkeypatch)
    monkeypatch.setattr(one_step, "evaluate", evaluated)
    monkeypatch.setattr(levels, "MESHES", (levels.EvaluationMesh(0, graded=True),))
    path = tmp_path / "engine.toml"
    path.write_text(IN_AN_ENVELOPE[scene])
    found = told(capsys, path, OPTIMISED)
    with capsys.disabled():
        check(found, least=46)


@pytest.mark.parametrize(
    "scene",
    [
        pytest.param(name, marks=[pytest.mark.slow] * (name == "four with a propeller"))
        for name in SCENES
        if name != "two different webs"
    ],
)
def test_the_exported_solid_weighs_what_is_told(capsys, tmp_path, scene):
    """Its volume by the CAD kernel; the line has it to 0.1 mm3."""
    path = tmp_path / "engine.toml"
    path.write_text(SCENES[scene])
    (balance,) = told(capsys, path, {"loads": ["loads"]}).values()
    assert main(["export", str(path), str(tmp_path / "throw.step")]) == 0
    volume_mm3 = float(re.search(r"throw, ([\d.]+) mm3", capsys.readouterr().out).group(1))
    density = load_scene(str(path)).material.density_kg_m3
    assert balance["mass of the throw"] == pytest.approx(1e-9 * volume_mm3 * density, rel=2e-5)


@pytest.mark.slow
def test_what_the_rule_and_its_pages_tell(capsys, tmp_path):
    """The shaft vibrates: dossier and comparison take the stiffness of its throws by elements."""
    path, dossier, page = (tmp_path / name for name in ("engine.toml", "dossier.md", "page.md"))
    path.write_text(SCENES["four with a propeller"])
    rule = ["--method", "m53", "--report", str(dossier)]
    beside = ["--baseline", str(path), "--fatigue", "m53", "--report", str(page)]
    report = tmp_path / "shaft.md"
    commands = {"fatigue": ["fatigue", *rule], "compare": ["compare", *beside]}
    found = told(capsys, path, commands | {"vibration": ["vibration", "--report", str(report)]})
    found |= {one.stem: dict(_page(one.read_text(encoding="utf-8"))) for one in (dossier, page)}
    swings = [re.search(_SWINGS, one.read_text(encoding="utf-8")) for one in (dossier, report)]
    assert swings[0].groups() == swings[1].groups()
    with capsys.disabled():
        check(found, least=8)
