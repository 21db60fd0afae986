"""What is wanted: goal and limits as they are read, completed and refused."""

from __future__ import annotations

import math

import pytest

from cranktopo.errors import CranktopoError
from cranktopo.scene import Scene, parse_scene, scene_from_dict
from cranktopo.scene.goal import QUANTITIES, Limit
from cranktopo.scene.goal.wanted import wanted
from cranktopo.scene.loading import designs_folder

MIKRON = (designs_folder() / "mikron-iiic.toml").read_text(encoding="utf-8")


def scene_with(goal: str, text: str = MIKRON) -> Scene:
    return parse_scene(text + "\n" + goal, "my.toml")


def limits(goal: str) -> list[str]:
    found = wanted(scene_with(goal))
    assert found is not None
    return [str(limit) + (" assumed" if limit.assumed else "") for limit in found.limits]


def error_of(goal: str, text: str = MIKRON) -> str:
    with pytest.raises(CranktopoError) as caught:
        scene_with(goal, text)
    return str(caught.value)


def with_limit(text: str, goal: str = 'minimise = "mass"') -> str:
    return f"[goal]\n{goal}\n[goal.limits]\n{text}"


def test_a_scene_without_a_goal_wants_nothing_more() -> None:
    assert wanted(scene_with("")) is None


@pytest.mark.parametrize(
    ("goal", "expected"),
    [
        ('minimise = "mass"', ["torsion >= 100 %", "bending >= 100 %", "fatigue_safety >= 100 %"]),
        ('maximise = "torsion"', ["mass <= 100 %", "bending >= 100 %", "fatigue_safety >= 100 %"]),
        ('maximise = "bending_per_mass"', ["mass <= 100 %", "torsion >= 100 %", "fatigue_safety >= 100 %"]),
        ('maximise = "fatigue_safety"', ["mass <= 100 %", "torsion >= 100 %", "bending >= 100 %"]),
    ],
)
def test_by_default_nothing_gets_worse(goal: str, expected: list[str]) -> None:
    assert limits(f"[goal]\n{goal}") == [f"{limit} assumed" for limit in expected]


def test_a_given_limit_replaces_the_default_one_of_its_quantity() -> None:
    found = limits(with_limit('torsion = ">= 120 %"\nbending = "none"\nunbalance = "<= 0.04 kg m"'))
    assert found == ["unbalance <= 40 kg mm", "torsion >= 120 %", "fatigue_safety >= 100 % assumed"]


def test_a_range_is_two_limits() -> None:
    found = limits(with_limit('mass = [">= 90 %", "<= 1.5 kg"]', 'maximise = "torsion"'))
    assert found[:2] == ["mass >= 90 %", "mass <= 1.5 kg"]


@pytest.mark.parametrize(
    ("quantity", "text", "value"),
    [
        ("mass", "<= 1500 g", 1.5),
        ("inertia", "<= 2.5e-3 kg·m²", 2500.0),
        ("torsion", ">= 150 kNm/rad", 150e3),
        ("torsion", ">= 1 N m/deg", 180 / math.pi),
        ("bending", ">= 200 N/µm", 200e3),
        ("torsion_per_mass", ">= 90 kN*m/rad/kg", 90e3),
        ("bending_per_mass", ">=120kN/mm/kg", 120e3),
        ("pin_displacement", "≤ 150 um", 0.15),
        ("twist", "<= 5 mrad", math.degrees(5e-3)),
        ("fatigue_safety", ">= 1.5", 1.5),
        ("unbalance", ">= -3 kg mm", -3.0),
    ],
)
def test_units_become_the_internal_one(quantity: str, text: str, value: float) -> None:
    found = wanted(
        scene_with(
            with_limit(
                f'{quantity} = "{text}"',
                'maximise = "torsion"' if quantity == "mass" else 'minimise = "mass"',
            )
        )
    )
    assert found is not None
    (limit,) = (limit for limit in found.limits if not limit.assumed)
    assert limit == Limit(QUANTITIES[limit.quantity].name, limit.sense, pytest.approx(value))


def test_a_goal_survives_being_stored() -> None:
    scene = scene_with(with_limit('torsion = [">= 100 %", "<= 120 %"]'))
    assert scene_from_dict(scene.model_dump(mode="json")) == scene


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ('mas = "<= 3 kg"', "unknown key goal.limits.mas. Did you mean 'mass'?"),
        ('torsion = "> 3 %"', "goal.limits.torsion = '> 3 %': '>' is no sign of a limit. Write '>= 3 %'."),
        ('torsion = "= 3 %"', "For a fixed value give a list: ['>= 3 %', '<= 3 %']."),
        ('torsion = "100 %"', "must begin with <= or >=. Write '>= 100 %'."),
        ('torsion = ">= much"', "a number must follow the sign"),
        ('torsion = ">= nan %"', "the number must be finite"),
        ('torsion = ">= -inf N m/rad"', "the number must be finite"),
        ('torsion = ">= 1e999 N m/rad"', "the number must be finite"),
        ('torsion = ">= 1,5 %"', "'1,5' is not a number. Write a decimal point and no separators."),
        ('torsion = ">= 100"', "the unit is missing; valid: N m/rad, kN m/rad, MN m/rad, N m/deg, %."),
        ('torsion = ">= 100 kN/rad"', "unknown unit 'kN/rad'; valid: N m/rad, kN m/rad,"),
        ('unbalance = "<= 40 kg mm2"', "valid: kg mm, kg m, g mm, g m, %. Did you mean 'kg mm'?"),
        ('fatigue_safety = ">= 2 mm"', "unknown unit 'mm'; valid: none, or %."),
        ('torsion = ">= -5 %"', "the percentage must be > 0 and <= 10000"),
        ('inertia = "<= 0 kg mm2"', "the number must be > 0"),
        ("torsion = 100", "goal.limits.torsion = 100: must be text with a sign, a number"),
        ("torsion = [100]", "must be text with a sign, a number and a unit"),
        ("torsion = []", "no limit is given"),
        ('torsion = ""', "must begin with <= or >="),
        ('torsion = "<= 100 %"', "is wanted high: a limit on its own is >=. Write '>= 100 %'"),
        ('bending = [">= 50 kN/mm", "<= 40 kN/mm"]', "contradictory: nothing is >= 50000 and <= 40000 N/mm."),
        ('bending = [">= 50 %", ">= 60 %"]', "two limits from below. Keep the tighter one"),
    ],
)
def test_a_limit_that_cannot_be_read_says_what_to_write(text: str, message: str) -> None:
    assert message in error_of(with_limit(text))


@pytest.mark.parametrize(
    ("goal", "message"),
    [
        ('maximise = "mass"', "goal.maximise = 'mass': mass is wanted low. Write minimise = 'mass'."),
        ('minimise = "torsion"', "goal.minimise = 'torsion': torsional stiffness is wanted high."),
        ('minimise = "weight"', "goal.minimise = 'weight': unknown quantity. Did you mean 'mass'?"),
        ('maximise = "torsoin"', "Did you mean 'torsion'?"),
        ('minimise = "twist"', "can be limited but is no goal. Write maximise = 'torsion'"),
        (
            "minimise = 3",
            "goal.minimise = 3: must be the name of a quantity. Valid: mass, inertia, unbalance.",
        ),
        ('minimise = "mass"\nmaximise = "torsion"', "minimise and maximise are both given"),
        ("", "neither minimise nor maximise is given"),
        ('minimize = "mass"', "unknown key goal.minimize. Did you mean 'minimise'?"),
    ],
)
def test_a_goal_that_makes_no_sense_is_refused(goal: str, message: str) -> None:
    assert message in error_of(f"[goal]\n{goal}")


def test_all_mistakes_are_listed() -> None:
    message = error_of(with_limit('torsion = ">= 100"\nbending = 3\nmas = "<= 3 kg"', 'minimise = "torsion"'))
    assert "my.toml: 4 errors." in message
