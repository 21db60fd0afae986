"""Estimates of the plan where inertia outweighs the gas and counterweights pull against the rods."""

from __future__ import annotations

import math
import re
from typing import Any

import numpy as np
import pytest

from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import plan, plan_for_stress
from cranktopo.engine.plan.simulated import strip_features
from cranktopo.engine.states import load_cases
from cranktopo.engine.throw_compliance import radial_energy_Nmm, throw_compliance
from cranktopo.throw.journal import Journal
from tests.fast_twin import ENGINE, fast_twin

NO_SHAFT: dict[str, Any] = {"effects": {"torsional_vibration": "off"}}


def test_fatigue_takes_both_ends_of_the_radial_force() -> None:
    """F / 2 x lever / (B W^2 / 6) and T / (pi D^3 / 16) by hand, half of each range over the cycle.

    The two largest pulls, both outward, were taken for the ends: 12 MPa, and off below the threshold for a
    strong steel.
    """
    bend = (18_605 + 73_512) / 2 / 2 * (30 / 2 + 22 / 2) / (64 * 22**2 / 6)
    assert bend == pytest.approx(116.0, abs=0.1)
    shear = (999.15e3 + 376.50e3) / 2 / (math.pi * 44**3 / 16)
    effect = plan(fast_twin(**NO_SHAFT))["fatigue"]
    strength = fast_twin().material.fatigue_bending_MPa
    assert strength is not None
    assert effect.estimate_percent == pytest.approx(
        100 * math.hypot(bend, math.sqrt(3) * shear) / strength, rel=1e-3
    )


def test_a_radial_force_that_turns_round_is_told_as_that() -> None:
    """-73.5 kN with all inertia, a push of the gas without the pistons': no percentage says that."""
    twin = fast_twin(**NO_SHAFT)
    change = plan(twin)["reciprocating_inertia"].changes
    full = next(one.radial_N for one in load_cases(twin) if one.name == "bending")
    found = re.fullmatch(r"radial force ([\d,]+) N in place of (-[\d,]+) N", change)
    assert found is not None
    assert float(found[2].replace(",", "")) == pytest.approx(full, abs=1)


OVERSPEED: dict[str, Any] = {"engine": {**ENGINE, "overspeed_rpm": 13_000.0}}


def size_N(text: str) -> list[float]:
    """Return the forces that a reason tells."""
    return [float(number.replace(",", "")) for number in re.findall(r"(-?[\d,]+) N", text)]


@pytest.mark.parametrize("inertia", ["reciprocating_inertia", "rotating_rod_mass"])
def test_inertia_is_compared_by_the_load_case_with_and_without_it(inertia: str) -> None:
    """The case without it was the push of the gas at the engine's speed: 47,973 N, a change of 153 %."""
    twin = fast_twin(**NO_SHAFT, **OVERSPEED)
    effect, effects = (
        plan(twin)[inertia],
        {"bending", "torsion", "reciprocating_inertia", "rotating_rod_mass"},
    )
    cases = (load_cases(twin, frozenset(on))[0].radial_N for on in (effects, effects - {inertia}))
    assert size_N(effect.reason)[:2] == pytest.approx(list(cases), abs=0.5)


def test_rods_without_big_ends_pull_less_by_their_centrifugal_force() -> None:
    """2 x 0.3 kg x 33.75 mm x w^2 less, by hand: 40 %, and it stays a pull."""
    effect = plan(fast_twin(**NO_SHAFT, **OVERSPEED))["rotating_rod_mass"]
    with_it, without = size_N(effect.reason)[:2]
    big_ends = 0.6 * 0.03375 * (13_000 * math.pi / 30) ** 2
    assert without - with_it == pytest.approx(big_ends, rel=1e-3)
    assert effect.estimate_percent == pytest.approx(100 * big_ends / -with_it, rel=1e-3)


def test_bending_is_estimated_by_the_case_that_is_solved() -> None:
    """With a centrifugal case the pull at the overspeed is in that; the plan told it as bending, too."""
    twin = fast_twin(effects={**NO_SHAFT["effects"], "centrifugal": "on"}, **OVERSPEED)
    for found in (plan(twin), plan_for_stress(twin)):
        bending = load_cases(twin, found.enabled)[0]
        assert bending.radial_N == pytest.approx(-73_512, abs=10)
        assert size_N(found["bending"].reason)[0] == pytest.approx(bending.radial_N, abs=0.5)
        compliance = throw_compliance(strip_features(twin, "fillets"))
        energy = bending.radial_N**2 * compliance.bending_mm_per_N / 2000
        assert f"({energy:.3g} J)" in found["bending"].reason
    alone = fast_twin(**NO_SHAFT, **OVERSPEED)
    assert size_N(plan(alone)["bending"].reason)[0] == pytest.approx(load_cases(alone)[0].radial_N, abs=0.5)


def straight(scene: Scene) -> Scene:
    """Return a throw that is nearly all journal, its webs thin and stiff at the quarters of the span."""
    half = Journal(outer_diameter_mm=42.0, length_mm=2500.0)
    throw = scene.throw.model_copy(update={"main_journal": half, "crankpin": half, "radius_mm": 0.01})
    web = scene.web.model_copy(update={"thickness_mm": 0.1, "width_mm": 5e7})
    return scene.model_copy(update={"throw": throw, "web": web})


@pytest.mark.parametrize(("pin_N", "web_N"), [(1000.0, 0.0), (0.0, 700.0), (1000.0, -500.0), (1000.0, 300.0)])
def test_energy_of_opposed_forces_is_that_of_a_straight_beam(pin_N: float, web_N: float) -> None:
    """Two supports, a force at each quarter and one spread over the middle half: M^2 / 2 E I, summed up."""
    scene = straight(load_scene("mikron-iiic-plain"))
    span, z = 5000.0, np.linspace(0.0, 2500.0, 20_001)
    spread = pin_N / 2500.0 * np.clip(z - span / 4, 0.0, None)
    moment = (pin_N / 2 + web_N) * z - web_N * np.clip(z - span / 4, 0.0, None)
    moment -= spread * np.clip(z - span / 4, 0.0, None) / 2
    stiffness = scene.material.E_GPa * 1000 * math.pi / 64 * 42.0**4
    energy = 2 * float(np.trapezoid(moment**2, z)) / (2 * stiffness)
    assert radial_energy_Nmm(scene, pin_N, web_N) == pytest.approx(energy, rel=0.005)


def test_energy_of_a_force_on_the_pin_alone_is_that_of_the_compliance() -> None:
    scene = fast_twin()
    own = 1000.0**2 * throw_compliance(scene).bending_mm_per_N / 2
    assert radial_energy_Nmm(scene, 1000.0, 0.0) == pytest.approx(own, rel=1e-12)
