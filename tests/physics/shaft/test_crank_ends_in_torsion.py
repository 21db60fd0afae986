"""Ends and own main journals in the torsional chain, against stepped shafts by hand."""

from __future__ import annotations

import math
from itertools import pairwise
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.end_chain import end_chain, tip_remarks
from cranktopo.engine.vibration.shaft_chain import bare_chain, estimated_chain

NOSE = {"kind": "cylinder", "diameter_mm": 30.0, "length_mm": 60.0, "bore_diameter_mm": 10.0}
CONE = {"kind": "cone", "diameter_mm": 40.0, "outer_end_diameter_mm": 30.0, "length_mm": 50.0}


def mikron(ends: dict[str, list[dict[str, Any]]], **shaft: Any) -> Scene:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    data["crank"] = {"end": [{"side": side, "step": steps} for side, steps in ends.items()]}
    return scene_from_dict(data | ({"shaft": shaft} if shaft else {}), "crank")


def shear_MPa(scene: Scene) -> float:
    return scene.material.E_GPa * 1000 / (2 + 2 * scene.material.poisson)


def test_stiffness_of_a_stepped_end() -> None:
    """Half a journal, a hollow cylinder and a cone in series; a solid cone has a closed form."""
    scene = mikron({"free": [NOSE, CONE]})
    journal = 20.0 / (math.pi / 32 * (42.0**4 - 24.0**4))
    nose = 60.0 / (math.pi / 32 * (30.0**4 - 10.0**4))
    a, b = 20.0, 15.0
    cone = 2 * 50.0 * (a**2 + a * b + b**2) / (3 * math.pi * (a * b) ** 3)
    end = end_chain(scene, "free", 0.0)
    assert end is not None
    expected = shear_MPa(scene) / (journal + nose + cone) / 1000
    assert end.stiffness_Nm_per_rad == pytest.approx(expected, rel=1e-9)


def test_an_end_without_a_rotor_is_a_disk_of_its_own() -> None:
    plain = estimated_chain(load_scene("mikron-iiic-plain"))
    whole = estimated_chain(mikron({"free": [NOSE], "output": [CONE]}))
    assert plain.names == ("throw 1", "throw 2", "throw 3", "throw 4")
    assert whole.names == ("free end", *plain.names, "output end")
    assert whole.first == 1
    assert all(whole.in_crankshaft)


def test_rotors_sit_at_the_tips_of_the_ends() -> None:
    rotors = {"pulley": {"inertia_kg_m2": 0.01}, "flywheel": {"inertia_kg_m2": 0.2}}
    plain = estimated_chain(mikron({}, **rotors))
    whole = estimated_chain(mikron({"free": [NOSE], "output": [CONE]}, **rotors))
    assert whole.names == plain.names == ("pulley", *(f"throw {n}" for n in range(1, 5)), "flywheel")
    for section, side in ((0, "free"), (-1, "output")):
        end = end_chain(mikron({"free": [NOSE], "output": [CONE]}), side, 0.0)  # type: ignore[arg-type]
        assert end is not None
        found, before = (1 / chain.chain.stiffness_Nm_per_rad[section] for chain in (whole, plain))
        assert found - before == pytest.approx(1 / end.stiffness_Nm_per_rad, rel=1e-9)
    total = sum(whole.chain.inertia_kg_m2) - sum(plain.chain.inertia_kg_m2)
    ends = [end_chain(mikron({"free": [NOSE], "output": [CONE]}), side, 0.0) for side in ("free", "output")]
    assert total == pytest.approx(sum(e.inner_kg_m2 + e.tip_kg_m2 for e in ends if e), rel=1e-9)


def test_a_given_stiffness_replaces_that_of_the_end() -> None:
    pulley = {"inertia_kg_m2": 0.01, "stiffness_Nm_per_rad": 5e4}
    plain, whole = (estimated_chain(mikron(ends, pulley=pulley)) for ends in ({}, {"free": [NOSE]}))
    assert whole.chain.stiffness_Nm_per_rad == plain.chain.stiffness_Nm_per_rad


def test_lowest_frequency_of_a_long_nose_with_a_disk() -> None:
    """Against a chain in which the nose is cut into a hundred pieces: the lever rule errs by 1e-3."""
    scene = mikron({"free": [{**NOSE, "length_mm": 200.0}]}, pulley={"inertia_kg_m2": 0.01})
    shaft = estimated_chain(scene)
    inertia, stiffness = list(shaft.chain.inertia_kg_m2), list(shaft.chain.stiffness_Nm_per_rad)
    bare = estimated_chain(mikron({}, pulley={"inertia_kg_m2": 0.01}))
    cuts, g = 100, shear_MPa(scene) / 1000
    density = scene.material.density_kg_m3 * 1e-9
    polar = [math.pi / 32 * (42.0**4 - 24.0**4)] * 10 + [math.pi / 32 * (30.0**4 - 10.0**4)] * cuts
    length = [2.0] * 10 + [2.0] * cuts
    pieces = list(zip(polar, length, strict=True))[::-1]  # from the tip
    disks = [0.01, *[density * area * long * 1e-6 for area, long in pieces], *bare.chain.inertia_kg_m2[1:]]
    springs = [g * area / long for area, long in pieces]
    half = [2 * springs[0], *[1 / (0.5 / a + 0.5 / b) for a, b in pairwise(springs)]]
    half.append(1 / (0.5 / springs[-1] + 1 / bare.chain.stiffness_Nm_per_rad[0]))
    fine = _lowest(disks, [*half, *bare.chain.stiffness_Nm_per_rad[1:]])
    assert _lowest(inertia, stiffness) == pytest.approx(fine, rel=2e-3)


def _lowest(inertia: list[float], stiffness: list[float]) -> float:
    matrix = np.zeros((len(inertia), len(inertia)))
    for i, k in enumerate(stiffness):
        matrix[i : i + 2, i : i + 2] += k * np.array([[1.0, -1.0], [-1.0, 1.0]])
    return float(np.sqrt(eigh(matrix, np.diag(inertia), eigvals_only=True)[1]))


def test_own_main_journals_make_their_throws_softer() -> None:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    data["crank"] = {"main_journal": [{"number": 2, "length_mm": 60.0}]}
    plain, own = (estimated_chain(s) for s in (load_scene("mikron-iiic-plain"), scene_from_dict(data)))
    before, after = plain.chain.stiffness_Nm_per_rad, own.chain.stiffness_Nm_per_rad
    assert after[1] < 0.95 * before[1]
    assert after[0] == pytest.approx(before[0], rel=0.02)


def test_the_bare_shaft_has_a_disk_and_a_spring_for_each_end() -> None:
    scene = mikron({"free": [NOSE], "output": []})
    model = bare_chain(scene, 4000.0, (1e5,) * 4)
    assert len(model.inertia_kg_m2) == 6
    plain = bare_chain(load_scene("mikron-iiic-plain"), 4000.0, (1e5,) * 4)
    assert model.stiffness_Nm_per_rad[1:4] == plain.stiffness_Nm_per_rad


def test_the_rotor_at_a_tip_is_told_with_the_spring_to_it() -> None:
    """A thin stub behind a cone takes most of the twist; a rotor with a stiffness of its own is not there."""
    stub = {"kind": "thread", "diameter_mm": 16.0, "length_mm": 30.0, "thread": "M16"}
    wheel = {"inertia_kg_m2": 0.2}
    (told,) = tip_remarks(mikron({"output": [CONE, stub]}, flywheel=wheel))
    end = end_chain(mikron({"output": [CONE, stub]}), "output", 0.0)
    assert end is not None
    assert told.startswith("the flywheel sits at the tip of the crank's output end: ")
    assert f"{end.stiffness_Nm_per_rad:,.0f} N m/rad" in told
    own = 30.0 / (math.pi / 32 * 16.0**4) / shear_MPa(mikron({})) * 1000  # rad per N m
    assert f"{100 * own * end.stiffness_Nm_per_rad:.0f} % of the twist in its thread" in told
    assert (
        tip_remarks(mikron({"output": [CONE, stub]}, flywheel={**wheel, "stiffness_Nm_per_rad": 1e6})) == []
    )
    assert tip_remarks(mikron({"free": [NOSE]}, flywheel=wheel)) == []
