"""A key that changes nothing beside the others of a design is told in a line when the design is read."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cranktopo.base.notes import redirected
from cranktopo.design.idle_keys import idle_keys
from cranktopo.design.loading import builtin_designs, designs_folder, load_scene, scene_from_dict
from cranktopo.design.toml_text import parse_toml
from cranktopo.design.writing import toml_text
from tests.hostile.scenes import dumped
from tests.keys.readings import of_scene
from tests.keys.scenes import Data, builtin, changed, files, resolved, throw, twin, web

DISK = {"inertia_kg_m2": 0.002, "stiffness_Nm_per_rad": 2e5}
COUPLING = {"inertia_kg_m2": 0.05, "stiffness_Nm_per_rad": 2e4}
BOLT = {"thread": "M10", "grip_mm": 40.0}
HEAVY = {"outer_radius_mm": 66.0, "half_angle_deg": 60.0}


def weighted(name: str) -> Data:
    body = web("obround", width_mm=70.0, counterweight=HEAVY)
    return throw(**({"web": body} if name == "web" else {"web": web("obround", width_mm=70.0), name: body}))


def joint(**more: Any) -> Data:
    return throw(bolted_joint=[BOLT | {"max_force_N": 5000.0} | more])


def traced() -> Data:
    return changed(builtin("mikron-iiic-plain"), {"engine.gas": {"indicator_csv": "a.csv"}})


def rod(**more: Any) -> Data:
    return changed(builtin("mikron-iiic-rod-i"), {f"rod.{key}": value for key, value in more.items()})


def processed(process: str) -> Data:
    return builtin("mikron-iiic-plain", optimise={"process": process})


def balancer() -> Data:
    return changed(builtin("balancer-shaft"), {"balancer.material": {"name": "42CrMo4"}})


def aiming() -> Data:
    return builtin("mikron-iiic-plain", goal={"minimise": "mass"}, optimise={})


def oiled(**more: Any) -> Data:
    return builtin("mikron-iiic-plain", bearings={"clearance_mm": 0.05} | more)


FILES = ("small.stl", "large.stl")
CURVE = [[40.0, 90.0], [100.0, 11.0]]
Case = tuple[str, Data, str, tuple[Any, Any], str]
CASES: list[Case] = [
    *(
        ("web", weighted(name), f"{name}.counterweight.face", ("journal", "pin"), "body")
        for name in ("web", "second_web")
    ),
    *(
        ("coupling", twin(coupling=COUPLING, **{part: DISK}), f"shaft.{part}.{key}", (0.01, 0.02), "carried")
        for part in ("driven", "propeller")
        for key in ("mass_kg", "overhang_mm", "diametral_inertia_kg_m2")
    ),
    *(
        ("massless", twin(**{part: DISK}), f"shaft.{part}.{key}", (0.01, 0.02), "carried")
        for part in ("pulley", "flywheel", "driven", "propeller")
        for key in ("overhang_mm", "diametral_inertia_kg_m2")
    ),
    ("trace", traced(), "engine.gas.exhaust_pressure_MPa", (0.11, 0.12), "loads"),
    ("trace", traced(), "engine.gas.burn_duration_deg", (50.0, 60.0), "loads"),
    ("trace", traced(), "engine.gas.wiebe_shape", (1.8, 2.0), "loads"),
    ("trace", traced(), "engine.gas.polytropic_compression", (1.3, 1.32), "loads"),
    ("trace", traced(), "engine.gas.polytropic_expansion", (1.25, 1.3), "loads"),
    ("rod", rod(), "engine.masses.rod_rotating_kg", (0.3, 0.4), "rod"),
    ("rod", rod(), "engine.masses.rod_reciprocating_kg", (0.3, 0.4), "rod"),
    ("viscosity", oiled(viscosity_mPas=8.0), "bearings.oil", ("ISO VG 46", "ISO VG 100"), ""),
    ("viscosity", oiled(viscosity_mPas=8.0), "bearings.temperature_C", (90.0, 110.0), ""),
    *(
        ("supply", oiled(), f"bearings.{key}", values, "")
        for key, values in (
            ("supply_pressure_MPa", (0.2, 0.4)),
            ("feed_hole_mm", (3.0, 5.0)),
            ("feed_hole_deg", (0.0, 40.0)),
        )
    ),
    ("groove", oiled(permitted_film_um=1.0, groove_mm=5.0), "bearings.feed_hole_deg", (0.0, 40.0), ""),
    ("curve", oiled(viscosity_curve_mPas=CURVE), "bearings.oil", ("ISO VG 46", "ISO VG 100"), ""),
    ("shank", joint(), "bolted_joint[0].shank_diameter_mm", (8.0, 9.0), "bolts"),
    ("preload", joint(preload_N=2e4), "bolted_joint[0].utilisation", (0.7, 0.8), "bolts"),
    ("force", joint(), "bolted_joint[0].bolts", (2, 4), "bolts"),
    ("no bolt", builtin("balancer-shaft"), "balancer.weight[0].bolts", (2, 4), "balancer"),
    ("hole", builtin("balancer-shaft"), "balancer.notch[1].radius_mm", (0.5, 1.0), "balancer"),
    ("plain", rod(shank="plain", flange_mm=None), "rod.flange_mm", (3.0, 4.0), "rod"),
    ("plain", rod(shank="plain", web_mm=None), "rod.web_mm", (3.0, 4.0), "rod"),
    ("square", rod(), "rod.split_friction", (0.1, 0.2), "rod"),
    ("rod", rod(material={"name": "42CrMo4"}), "rod.material.fatigue_torsion_MPa", (200.0, 300.0), "rod"),
    ("lsa", balancer(), "balancer.material.fatigue_torsion_MPa", (200.0, 300.0), "balancer"),
    ("lsa", balancer(), "balancer.material.fkm_group", ("Steel", "Forg_Steel"), "balancer"),
    ("no bush", rod(bush_thickness_mm=None), "rod.bush_interference_um", (10.0, 20.0), "rod"),
    ("no bush", rod(bush_thickness_mm=None), "rod.bush_E_GPa", (100.0, 115.0), "rod"),
    ("no bush", rod(bush_thickness_mm=None), "rod.bush_density_kg_m3", (8000.0, 8800.0), "rod"),
    ("milled", processed("milled"), "optimise.draft_deg", (0.0, 5.0), ""),
    ("free", processed("free"), "optimise.draft_deg", (0.0, 5.0), ""),
    ("milled", processed("milled"), "optimise.parting", ("lateral", "web_faces"), ""),
    ("free", processed("free"), "optimise.parting", ("lateral", "web_faces"), ""),
    ("forged", processed("forged"), "optimise.tool_radius_mm", (4.0, 5.0), ""),
    ("alike", builtin("mikron-iiic-plain", original={"file": "a.stl"}), "original.second_file", FILES, ""),
    ("goal", aiming(), "optimise.volume_fraction", (0.3, 0.4), ""),
    ("goal", aiming(), "optimise.combine", ("sum", "worst"), ""),
]  # fmt: skip


@pytest.mark.parametrize("case", CASES, ids=[f"{case[0]} {case[2]}" for case in CASES])
def test_it_changes_nothing_and_is_told_once(case: Case, tmp_path: Path) -> None:
    _, data, key, values, reading = case
    files(tmp_path)
    told = []
    for value in values:
        path, lines = tmp_path / "design.toml", list[str]()
        path.write_text(dumped(changed(data, {key: value})), encoding="utf-8")
        with redirected(lines.append):
            scene = load_scene(path, whole=True)
        assert (
            len([line for line in lines if f"changes nothing as the design stands: {key}: " in line]) == 1
        ), lines
        told.append(of_scene(scene, reading) if reading else ())
    assert told[0] == told[1]


@pytest.mark.parametrize("case", CASES, ids=[f"{case[0]} {case[2]}" for case in CASES])
def test_only_what_is_written_is_told(case: Case, tmp_path: Path) -> None:
    _, data, key, _, _ = case
    files(tmp_path)
    without = resolved(changed(data, {key: None}), tmp_path)
    assert not any(
        line.startswith(f"{key}: ") for line in idle_keys(scene_from_dict(without, whole=True), without)
    )


@pytest.mark.parametrize("name", builtin_designs())
def test_no_built_in_design_has_one(name: str) -> None:
    text = (designs_folder() / f"{name}.toml").read_text(encoding="utf-8")
    assert idle_keys(load_scene(name, whole=True), parse_toml(text, name)) == ()


def test_what_acts_is_not_told() -> None:
    """A trace is compared with the compression, and a misfire expands it to where the exhaust opens."""
    acting = [
        changed(traced(), {"engine.gas.compression_ratio": 8.0, "engine.gas.exhaust_opening_deg": 120.0}),
        changed(weighted("web"), {"web.counterweight.thickness_mm": 12.0, "web.counterweight.face": "pin"}),
        twin(driven=DISK | {"mass_kg": 4.0, "overhang_mm": 20.0}),
        joint(shank_mm=20.0, shank_diameter_mm=8.0, utilisation=0.8),
        rod(split_angle_deg=None, bush_interference_um=20.0, flange_mm=3.0, web_mm=3.0),
        changed(processed("milled"), {"optimise.tool_radius_mm": 5.0}),
        changed(processed("cast"), {"optimise.draft_deg": 5.0, "optimise.parting": "web_faces"}),
        oiled(oil="ISO VG 68", temperature_C=90.0),
    ]
    for data in acting:
        assert idle_keys(scene_from_dict(data, whole=True), data) == ()


@pytest.mark.parametrize("case", CASES, ids=[f"{case[0]} {case[2]}" for case in CASES])
def test_a_stored_scene_is_written_without_what_nobody_gave_and_changes_nothing(
    case: Case, tmp_path: Path
) -> None:
    """A run holds every key; the design written of it reads back the same, and nothing of it is told."""
    _, data, key, _, _ = case
    files(tmp_path)
    plain = scene_from_dict(resolved(changed(data, {key: None}), tmp_path), whole=True)
    stored = scene_from_dict(plain.model_dump(mode="json"), whole=True)
    written = parse_toml(toml_text(stored, "of a run"), "written")
    again = scene_from_dict(written, whole=True)
    assert again == stored
    assert not [line for line in idle_keys(again, written) if line.startswith(f"{key}: ")]


def test_what_a_user_gave_is_written_and_told_though_it_changes_nothing() -> None:
    data = joint(shank_diameter_mm=9.0)
    written = parse_toml(toml_text(scene_from_dict(data, whole=True), "given"), "written")
    assert written["bolted_joint"][0]["shank_diameter_mm"] == 9.0
    assert idle_keys(scene_from_dict(written, whole=True), written)
