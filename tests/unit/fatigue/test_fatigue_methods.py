"""The fatigue formulae against printed numbers."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import at_extreme_speeds
from cranktopo.engine.plan.planning import plan_for_stress
from cranktopo.engine.vibration.vibrating_shaft import extreme_speeds_rpm
from cranktopo.tasks.fatigue.criteria import shortfall_words
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.fkm import FkmStrength, fkm
from cranktopo.tasks.fatigue.lsa import LsaStrength, lsa
from cranktopo.tasks.optimise.text import fatigue_fact
from cranktopo.tasks.throw_fatigue import rule_check
from cranktopo.tasks.throw_fatigue.m53 import (
    ConcentrationFactors,
    Dimensions,
    Nominal,
    concentration_factors,
    fatigue_strength_MPa,
    journal_equivalent_MPa,
    nominal_stresses,
    outside_validity,
    pin_equivalent_MPa,
)
from cranktopo.tasks.throw_fatigue.result import FatigueResult, FieldFatigue
from cranktopo.tasks.throw_fatigue.text import FatigueComparison, field_remarks, inclusions
from cranktopo.tasks.throw_fea.targets import Target

# J. Voparil, Brno University of Technology, 2011: amplitude, mean, related gradient of two crank webs.
ORIGINAL, VARIANT_II = (241.08, 330.95, 0.228), (226.27, 309.58, 0.235)
RULE_EXAMPLE = Dimensions(
    pin=60, journal=70, throw=45, web_thickness=22, web_width=100, pin_fillet=3.6, journal_fillet=3.6
)


def one(amplitude: float, mean: float, gradient: float) -> LocalStress:
    return LocalStress(np.array([amplitude]), np.array([mean]), np.array([gradient]))


@pytest.mark.parametrize(
    ("case", "ultimate", "printed"),
    [(ORIGINAL, 1283, 1.038), (VARIANT_II, 1283, 1.108), (ORIGINAL, 1100, 0.994), (VARIANT_II, 1100, 1.061)],
)
def test_lsa_as_printed(case: tuple[float, float, float], ultimate: float, printed: float) -> None:
    found = lsa(one(*case), LsaStrength(495, 525, 900, ultimate))
    assert found.safety[0] == pytest.approx(printed, abs=5e-4)
    assert found.amplitude_term[0] > found.mean_term[0] > 0
    assert 1 / (found.amplitude_term[0] + found.mean_term[0]) == found.safety[0]


def test_lsa_factors_as_printed() -> None:
    found = lsa(one(*ORIGINAL), LsaStrength(495, 525, 900, 1283))
    assert found.support_factor[0] == pytest.approx(1.052, abs=5e-4)
    assert found.notch_ratio[0] == pytest.approx(1.017, abs=1e-3)


def test_lsa_treatment_credits_the_amplitude_only_and_compression_earns_nothing() -> None:
    plain, hard = LsaStrength(495, 525, 900, 1100), LsaStrength(495, 525, 900, 1100, treatment_factor=1.3)
    a, b = lsa(one(*ORIGINAL), plain), lsa(one(*ORIGINAL), hard)
    assert b.amplitude_term[0] == pytest.approx(a.amplitude_term[0] / 1.3)
    assert b.mean_term[0] == a.mean_term[0]
    pressed, reversed_ = lsa(one(241.08, -100, 0.228), plain), lsa(one(241.08, 0, 0.228), plain)
    assert pressed.safety[0] == reversed_.safety[0]


def test_fkm_regression() -> None:
    found = fkm(one(94.7, 5.2, 0.172), FkmStrength(473, "Steel", 25))
    assert found.reversed_MPa == pytest.approx(213, abs=0.5)
    assert found.support_factor[0] == pytest.approx(1.088, abs=5e-4)
    assert found.design_factor[0] == pytest.approx(0.979, abs=5e-4)
    assert found.reversed_MPa / found.design_factor[0] == pytest.approx(217, abs=0.5)
    assert found.mean_factor[0] == pytest.approx(0.996, abs=5e-4)
    assert found.limit_MPa[0] == pytest.approx(216, abs=0.7)
    assert found.safety[0] == pytest.approx(found.limit_MPa[0] / 94.7)


def test_fkm_treats_points_apart() -> None:
    """A point's answer does not depend on its neighbours in the array; tension costs strength."""
    points = LocalStress(np.array([100.0] * 4), np.array([-100.0, -50, 0, 150]), np.array([0.1, 0.5, 1, 2]))
    together = fkm(points, FkmStrength(1100))
    for i in range(4):
        alone = fkm(
            one(points.amplitude_MPa[i], points.mean_MPa[i], points.gradient_per_mm[i]), FkmStrength(1100)
        )
        assert alone.limit_MPa[0] == together.limit_MPa[i]
    assert (np.diff(together.mean_factor) < 0).all()
    assert together.mean_factor[2] == pytest.approx(1.0)


def test_m53_regression() -> None:
    f = concentration_factors(RULE_EXAMPLE)
    assert f.alpha_bending == pytest.approx(2.02605, abs=5e-6)
    assert f.alpha_torsion == pytest.approx(1.94423, abs=5e-6)
    assert f.beta_bending == pytest.approx(2.11245, abs=5e-6)
    assert f.beta_shear == pytest.approx(3.57756, abs=5e-6)
    assert f.beta_torsion == pytest.approx(2.0220, abs=5e-5)
    assert fatigue_strength_MPa(100, 6, 700, 1.0) == pytest.approx(274.248, abs=5e-4)
    assert outside_validity(RULE_EXAMPLE) == ()


def test_m53_stresses_by_hand() -> None:
    n = nominal_stresses(RULE_EXAMPLE, 1e6, 5e4, 2e6)
    assert n.bending_MPa == pytest.approx(6e6 / (100 * 22**2))
    assert n.shear_MPa == pytest.approx(5e4 / 2200)
    assert n.pin_torsion_MPa == pytest.approx(2e6 * 16 / (np.pi * 60**3))
    assert n.journal_torsion_MPa == pytest.approx(2e6 * 16 / (np.pi * 70**3))
    f, n = ConcentrationFactors(2.0, 1.5, 3.0, 4.0, 1.25), Nominal(100.0, 10.0, 20.0, 40.0)
    assert pin_equivalent_MPa(f, n, 10.0) == pytest.approx(np.sqrt(210**2 + 3 * 30**2))
    assert journal_equivalent_MPa(f, n, 0.0) == pytest.approx(np.sqrt(340**2 + 3 * 50**2))


def test_m53_names_what_is_outside() -> None:
    thin = Dimensions(
        pin=60, journal=70, throw=45, web_thickness=10, web_width=100, pin_fillet=1.0, journal_fillet=3.6
    )
    found = " ".join(outside_validity(thin))
    assert "web thickness / pin diameter = 0.167" in found
    assert "pin fillet / pin diameter = 0.0167" in found


def test_m53_takes_its_own_supports(monkeypatch: pytest.MonkeyPatch) -> None:
    """Clamped journals would share the moment, which the rule takes as that of a beam on two bearings."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["supports"] = {**data["supports"], "bending": "clamped", "torsion": "held"}
    held: list[Scene] = []

    def solved(target: Target, *_: object, **__: object) -> None:
        held.append(target.scene)
        raise CranktopoError("enough")

    monkeypatch.setattr(rule_check, "solve_stresses", solved)
    with pytest.raises(CranktopoError, match="enough"):
        rule_check.check_rule(Target("clamped", scene_from_dict(data)))
    assert (held[0].supports.bending, held[0].supports.torsion) == ("pinned", "free")
    assert held[0].throw == load_scene("mikron-iiic-plain").throw


def judged_field(name: str, scene: Scene, labels: tuple[str, ...], safety: float = 1.2) -> Any:
    return SimpleNamespace(
        method="lsa",
        model=SimpleNamespace(name=name, scene=scene),
        critical=SimpleNamespace(safety=safety, states=labels[:2]),
        labels=labels,
        hardening={},
        lives={},
        scatter={},
    )


def test_targets_judged_over_other_loads_are_told_first_and_the_deciding_speed() -> None:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["shaft"] = {"flywheel": {"inertia_kg_m2": 0.2}}
    on, off = (scene_from_dict(data | {"effects": {"torsional_vibration": state}}) for state in ("on", "off"))
    several, alone = ("1 deg, 1500 rpm", "2 deg, 1500 rpm", "3 deg, 2100 rpm"), ("1 deg", "2 deg")
    fields = [judged_field("one", on, several), judged_field("two", off, alone)]
    first, *others = field_remarks(fields)
    assert "one with torsional vibration" in first
    assert "two without" in first
    assert "[effects] torsional_vibration" in first
    assert others == ["one: decided at 1500 rpm, of 2 speeds that are judged."]
    (told,) = field_remarks([judged_field("joined", on, alone)])
    analysed = [
        engine.speed_rpm
        for engine in (at.engine for at in at_extreme_speeds(on, plan_for_stress(on).enabled)[1:])
        if engine
    ]
    assert told.endswith(f"torque, of {' and '.join(f'{rpm:.0f}' for rpm in analysed)} rpm.")
    assert field_remarks([fields[1], judged_field("three", off, alone)]) == []


def test_a_safety_below_one_is_called_a_failure() -> None:
    """As safe as another that fails is no comfort: a comparison alone does not say it."""
    fields: Any = [
        SimpleNamespace(
            method=method,
            model=SimpleNamespace(name=name, scene=SimpleNamespace(engine=None)),
            critical=SimpleNamespace(safety=safety),
            hardening={},
            lives={},
            scatter={},
        )
        for name, method, safety in (
            ("weak", "lsa", 0.872),
            ("sound", "lsa", 1.0),
            ("short", "fkm", 1.168),
            ("asked", "fkm", 1.2),
        )
    ]
    assert field_remarks(fields) == [
        "weak: safety 0.872 is below 1: by this method it fails.",
        "short: safety 1.168 is below 1.2, the least that the FKM guideline asks for: by this method it is "
        "not enough.",
    ]
    of_lsa, of_fkm = inclusions(fields)
    assert of_lsa.endswith("names no least safety.")
    assert "FKM asks for 1.2 to 1.5" in of_fkm


def test_the_overspeed_that_decides_is_told_with_the_speeds_of_the_torques() -> None:
    """Joined extremes at the overspeed have the torques of a vibrating shaft at other speeds."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["shaft"] = {"flywheel": {"inertia_kg_m2": 0.2}}
    data["engine"]["overspeed_rpm"] = 2800.0
    on, off = (scene_from_dict(data | {"effects": {"torsional_vibration": state}}) for state in ("on", "off"))
    joined, angle = ("largest radial force with largest torque, 2800 rpm",), ("12 deg, 2800 rpm",)
    (with_torques,) = field_remarks([judged_field("a", on, joined)])
    rpm = " and ".join(f"{one:.0f}" for one in extreme_speeds_rpm(on, plan_for_stress(on).enabled))
    at = "a: the least safety is that at the overspeed of 2800 rpm"
    assert with_torques == f"{at}, with the vibrating shaft's largest and smallest torque, of {rpm} rpm."
    assert field_remarks([judged_field("a", on, angle)]) == [f"{at}."]
    assert field_remarks([judged_field("a", off, joined)]) == [f"{at}."]


def test_the_slower_speed_that_decides_is_told_with_its_pressure() -> None:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["shaft"] = {"flywheel": {"inertia_kg_m2": 0.2}, "speed_min_rpm": 900.0}
    scene = scene_from_dict(data | {"effects": {"torsional_vibration": "off"}})
    at = "a: the least safety is that at 900 rpm, the slower speed at which gas less inertia pushes hardest"
    decided = judged_field("a", scene, ("12 deg, 900 rpm",))
    assert field_remarks([decided]) == [f"{at} (with the pressure of 2100 rpm)."]
    peaks = [{"rpm": rpm, "peak_pressure_MPa": 5.0, "peak_angle_deg": 12.0} for rpm in (900.0, 2100.0)]
    data["engine"]["gas"] = {"map": peaks, "compression_ratio": 6.0}
    mapped = scene_from_dict(data | {"effects": {"torsional_vibration": "off"}})
    assert field_remarks([judged_field("a", mapped, ("12 deg, 900 rpm",))]) == [f"{at}."]


@pytest.mark.parametrize(
    ("method", "safety", "words"),
    [
        ("lsa", 0.98, "is below 1: by this method it fails"),
        ("lsa", 1.15, ""),
        ("fkm", 0.98, "is below 1: by this method it fails"),
        (
            "fkm",
            1.15,
            "is below 1.2, the least that the FKM guideline asks for: by this method it is not enough",
        ),
        ("fkm", 1.2, ""),
    ],
)
def test_every_command_has_the_same_words_for_a_safety(method: str, safety: float, words: str) -> None:
    """`compare` said that 1.162 by FKM fails, `fatigue` that it is not enough, `shaft` nothing."""
    assert shortfall_words(method, safety) == words
    one = FieldFatigue.model_construct(target="mine", safety=safety)
    judged = FatigueResult.model_construct(method=method, fatigue=(one,), baseline=None)
    failing = FatigueComparison((safety,), (), judged).failing
    assert failing == ({"mine": f"by {method}: safety {safety:.3f} {words}"} if words else {})
    fact = fatigue_fact(judged, "")
    assert fact.status == ("bad" if words else "good")
    assert words in fact.note
