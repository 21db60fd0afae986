"""Engines of throws with two different halves: balance, whole shaft, chain of disks."""

from __future__ import annotations

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cranktopo.bodies.solid.throw import add_full_throw
from cranktopo.design.halves import halves
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.free_forces import (
    TurningMasses,
    counterweights,
    free_forces,
    inner_moment,
    rotating_force,
    turning_masses,
)
from cranktopo.engine.balance.throw import product_of_inertia_kg_mm2
from cranktopo.engine.balance.whole_engine import main_bearings
from cranktopo.engine.throw_compliance import first_half_share, throw_torsion_rad_per_Nmm
from cranktopo.engine.vibration.shaft_chain import shaft_chain
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.tasks.shaft.stage import evaluate_shaft
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import Target
from tests.physics.fea.test_two_webs import ACROSS, POCKET, SECOND, WEB, scene_with

NEAR_MM, FAR_MM = -27.5, 30.5
"""Middle of webs of 19 and 25 mm from the cylinder's plane, on a crankpin of 36 mm."""
THICKER = {**WEB, "thickness_mm": 25.0}
HEAVY = {"outer_radius_mm": 50.0, "half_angle_deg": 45.0}
SHAFT = {"pulley": {"inertia_kg_m2": 0.01}, "flywheel": {"inertia_kg_m2": 1.0}}


def engine(cylinders: int, **tables: Any) -> Scene:
    order = {1: [1], 4: [1, 3, 4, 2]}[cylinders]
    own = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)["engine"]
    arranged = {**own, "cylinders": cylinders, "firing_order": order}
    return scene_with(tables.pop("throw", None), engine=arranged, envelope=None, **tables)


def uneven(cylinders: int, *, swapped: bool = False) -> Scene:
    """Two webs, one with a counterweight and a pocket beside the mirror plane, and four journals."""
    near, far = WEB, {**THICKER, "counterweight": HEAVY, "pocket": [{**POCKET, "x_mm": 9.0}]}
    main, pin = (40.0, 50.0), (36.0, 40.0)
    if swapped:
        near, far, main, pin = far, near, main[::-1], pin[::-1]
    own = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)["throw"]
    throw = {
        "main_journal": {**own["main_journal"], "length_mm": main[0]},
        "crankpin": {**own["crankpin"], "length_mm": pin[0]},
        "second_main_journal_length_mm": main[1],
        "second_crankpin_length_mm": pin[1],
    }
    return engine(cylinders, throw=throw, web=near, second_web=far)


@pytest.mark.parametrize(
    "scene",
    [uneven(1), pytest.param(engine(1, throw={"drilling": [ACROSS]}), marks=pytest.mark.slow)],
    ids=["webs", "drilling"],
)
def test_couple_is_the_product_of_inertia_of_the_exact_solid(scene: Scene) -> None:
    """The kernel errs by 1.5e-5 of the moments themselves, whose difference it is; the drilling 10 s."""
    near = halves(scene)[0].pitch_mm / 2
    with cad_session("couple") as gmsh:
        occ = gmsh.model.occ
        pair = next(p for p in add_full_throw(occ, scene) if p[0] == 3)
        mass, centre = occ.getMass(*pair), np.array(occ.getCenterOfMass(*pair))
        about_centre = np.array(occ.getMatrixOfInertia(*pair)).reshape(3, 3)
    across = mass * centre[:2] * centre[2] - about_centre[:2, 2] - mass * centre[:2] * near
    density = scene.material.density_kg_m3 * 1e-9
    found = product_of_inertia_kg_mm2(scene)
    scale = density * mass * centre[1] * near
    assert abs(found) > 5e-4 * scale
    assert found == pytest.approx(density * complex(across[1], across[0]), abs=3e-5 * scale)


def test_two_thicknesses_in_closed_form() -> None:
    """Obrounds of 50 mm with two bores of 24 mm, on one throw: couple, free moment, counterweights."""
    masses = turning_masses(engine(1, second_web=THICKER))
    area = 50.0 * 48.0 + math.pi * (25.0**2 - 2 * 12.0**2)
    webs = [7.85e-6 * thick * area * 24.0 for thick in (19.0, 25.0)]
    assert masses.web_kg_mm == pytest.approx(webs, rel=1e-9)
    couple = webs[0] * NEAR_MM + webs[1] * FAR_MM
    assert masses.couple_kg_mm2 == pytest.approx(couple, rel=1e-9)
    free = rotating_force(masses)
    moment = (masses.throw_kg_mm * -3.0 + couple) * masses.w2 / 1e6  # the cylinder is 3 mm off the middle
    assert free.moment.forward == pytest.approx(moment, rel=1e-9)
    left = rotating_force(masses, counterweighted=True)
    assert (left.force.largest, left.moment.largest) == (0, 0)
    one, other = (w.unbalance_kg_mm * np.exp(1j * np.radians(w.deg)) for w in counterweights(masses))
    assert one + other == pytest.approx(-masses.throw_kg_mm, abs=1e-9)
    assert one * NEAR_MM + other * FAR_MM == pytest.approx(-couple, abs=1e-7)
    shaft = [w.shaft_unbalance_kg_mm * np.exp(1j * np.radians(w.shaft_deg)) for w in counterweights(masses)]
    assert shaft == pytest.approx([one, other], abs=1e-9)  # of one throw both are the same


def test_bearings_carry_the_couple_as_a_pair() -> None:
    scene = uneven(1)
    masses = turning_masses(scene)
    loads, without = (main_bearings(scene, m).load_N for m in (masses, replace(masses, couple_kg_mm2=0j)))
    size = abs(masses.couple_kg_mm2) * masses.w2 / 1000 / scene.pitch_mm
    pair = loads - without
    assert np.abs(pair) == pytest.approx(np.full(pair.shape, size), rel=1e-9)
    assert pair[0] == pytest.approx(-pair[1], rel=1e-9)


@pytest.mark.parametrize("cylinders", [1, 4])
def test_webs_in_the_other_order_are_the_mirrored_engine(cylinders: int) -> None:
    """Forces stay, moments change their sign, webs and bearings are told from the other end."""
    one, other = (turning_masses(uneven(cylinders, swapped=swapped)) for swapped in (False, True))
    for weighted in (False, True):
        for free, seen in zip(free_forces(one, weighted), free_forces(other, weighted), strict=True):
            assert seen.force.forward == pytest.approx(free.force.forward, abs=1e-9)
            assert seen.moment.forward == pytest.approx(-free.moment.forward, abs=1e-9)
            assert seen.moment.backward == pytest.approx(-free.moment.backward, abs=1e-9)
    assert abs(free_forces(one)[0].moment.forward) > 1 or cylinders == 4
    assert told(other) == pytest.approx(told(one)[::-1], rel=1e-9)
    for weights in ((), "all"):
        bent, seen = (inner_moment(m, counterweights(m) if weights else ()) for m in (one, other))
        assert seen.moment_Nm == pytest.approx(bent.moment_Nm, rel=1e-9)
        if cylinders == 1:  # of four throws two are bent alike
            assert seen.z_mm == pytest.approx(-bent.z_mm, abs=1e-9)


def told(masses: TurningMasses) -> list[float]:
    """Of every web from the free end: what it has, and what it needs for its throw and for the shaft."""
    return [
        w.web_kg_mm + 2 * w.own_kg_mm + 3 * w.unbalance_kg_mm + 5 * w.shaft_unbalance_kg_mm
        for w in counterweights(masses)
    ]


def test_inner_moment_against_cuts() -> None:
    """Of a shaft of four uneven throws, what its webs have where they are; the cuts see only forces."""
    masses = turning_masses(uneven(4))
    layout, along = masses.layout, np.exp(1j * np.radians(masses.layout.throw_angle_deg))
    near, far = layout.web_places_mm
    own = np.array(masses.web_kg_mm)
    rest = masses.couple_kg_mm2 - own @ [near, far]
    pair = np.array([-rest, rest]) / (far - near) + own
    z = np.concatenate([layout.throw_z_mm, *(layout.throw_z_mm[:, None] + [near, far])])
    force = np.concatenate([(masses.throw_kg_mm - own.sum()) * along, np.outer(along, pair).ravel()])
    force = force * masses.w2 / 1000
    first, last = layout.bearing_z_mm[[0, -1]]
    takeoff = -(force * (z - first)).sum() / (last - first)
    places = np.linspace(first, last, 4001)
    behind = np.maximum(z - places[:, None], 0.0) @ force + takeoff * (last - places)
    assert inner_moment(masses).moment_Nm == pytest.approx(np.abs(behind).max() / 1000, rel=2e-4)


def test_equal_halves_have_no_couple_and_half_of_all(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bit for bit: a second web like the first changes nothing, and no couple is integrated."""
    plain, named = engine(4), engine(4, second_web=WEB)
    monkeypatch.setattr("cranktopo.engine.balance.throw._half_product", None)
    for one, other in zip(*(counterweights(turning_masses(scene)) for scene in (plain, named)), strict=True):
        assert one == other
    masses = turning_masses(named)
    assert masses.couple_kg_mm2 == 0
    assert counterweights(masses)[0].unbalance_kg_mm == masses.throw_kg_mm.real / 2
    assert first_half_share(named) == 0.5


@pytest.mark.slow
def test_a_shaft_of_one_throw_is_the_throw() -> None:
    """In two parts by the mirror in x; rigid bearings carry nothing of a torque on one throw; 10 s."""
    target = Target("two", engine(1, second_web=SECOND))
    throw, shaft = evaluate(target, 24.0), evaluate_shaft(target, "rigid", 24.0)
    free = throw.fine.torsion["free"]
    assert shaft.stiffness.end_to_end_Nm_per_rad == pytest.approx(free, rel=1e-5)
    assert shaft.error_percent == pytest.approx(throw.fine.torsion_error_percent["free"], rel=0.05)
    assert shaft.mass_kg == pytest.approx(throw.throw_kg, rel=1e-12)


def test_chain_has_all_halves_in_series() -> None:
    """Compliance of pulley, four throws and flywheel; the ends have the half that is there."""
    scene = engine(4, second_web=SECOND, shaft=SHAFT)
    near, far = (throw_torsion_rad_per_Nmm(half) for half in halves(scene))
    share = near / (near + far)
    assert abs(share - 0.5) > 0.01
    stiffness = (1e5, 1.1e5, 1.2e5, 1.3e5)
    softness = 1 / np.array(shaft_chain(scene, 2000.0, stiffness).chain.stiffness_Nm_per_rad)
    assert softness.sum() == pytest.approx(sum(1 / k for k in stiffness), rel=1e-12)
    assert softness[0] == pytest.approx(share / stiffness[0], rel=1e-12)
    assert softness[1] == pytest.approx((1 - share) / stiffness[0] + share / stiffness[1], rel=1e-12)
    assert softness[-1] == pytest.approx((1 - share) / stiffness[-1], rel=1e-12)


@pytest.mark.slow
def test_a_throw_is_as_soft_as_its_halves_in_series() -> None:
    """What optimising the webs one by one promises of the pair, by three meshes; 20 s."""
    scene = engine(1, second_web=SECOND)
    targets = (Target("throw", one) for one in (scene, *halves(scene)))
    whole, first, second = (evaluate(target, 8.0).fine.torsion["free"] or 0.0 for target in targets)
    print(
        f"{whole:.0f} N m/rad; halves {first:.0f} and {second:.0f}, in series", 2 / (1 / first + 1 / second)
    )
    assert second > 1.1 * first
    assert whole == pytest.approx(2 / (1 / first + 1 / second), rel=3e-3)
