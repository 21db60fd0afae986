"""The set of concentration factors that governs the check by the crankshaft rule; what is not judged."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from cranktopo import load_scene, with_values
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import redirected
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.bench import live
from cranktopo.tasks.throw_fatigue.m53 import (
    FilletCheck,
    concentration_factors,
    dimensions,
    nominal_stresses,
    outside_validity,
)
from cranktopo.tasks.throw_fatigue.m53_material import process_remark, uncovered_material
from cranktopo.tasks.throw_fatigue.mesh_quality import RuleQuality
from cranktopo.tasks.throw_fatigue.result import (
    AlternatingLoads,
    FatigueResult,
)
from cranktopo.tasks.throw_fatigue.rule_check import RuleCheck, check_rule
from cranktopo.tasks.throw_fatigue.rule_tables import acceptability_table, quality_table
from cranktopo.tasks.throw_fatigue.rule_text import rule_remarks, rule_table
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
from cranktopo.tasks.throw_fatigue.text import compare_fatigue
from cranktopo.tasks.throw_fatigue.throw_verdict import throw_verdict
from cranktopo.tasks.throw_fatigue.verdicts import verdicts
from cranktopo.tasks.throw_fea.targets import Target

ALLOWED = FilletCheck(200.0, 240.0)
"""Q = 1.2."""
WEAK = FilletCheck(200.0, 226.0)
"""Q = 1.13, below the 1.15 of the rule."""
MISSED = RuleQuality(1.0, 0.2, 5000, 1.0, 5.4, 1.0, 1.0)
"""A mesh that misses the jump of 5 % between elements."""


def check(pin_by_rule: FilletCheck, pin_by_elements: FilletCheck) -> RuleCheck:
    size = dimensions(load_scene("mikron-iiic-plain"))
    factors = concentration_factors(size)
    return RuleCheck(
        "throw",
        1.6,
        size,
        AlternatingLoads(18000.0, 265.5, 410.0),
        (),
        factors,
        factors,
        nominal_stresses(size, 265500.0, 9000.0, 410000.0),
        {"pin": pin_by_rule, "journal": ALLOWED},
        {"pin": pin_by_elements, "journal": ALLOWED},
        RuleQuality(0.4, 0.2, 20000, 1.0, 4.0, 5.0, 5.0),
    )


def test_the_lower_of_two_valid_sets_governs() -> None:
    found = check(WEAK, ALLOWED)
    assert found.governing == {"pin": "polynomials", "journal": "elements"}
    assert found.safety == pytest.approx(1.13)
    assert found.verdict == "not accepted"
    assert check(ALLOWED, WEAK).governing["pin"] == "elements"
    (row,) = rule_table([found], None).rows
    assert row["governing_Q"] == min(row[key] for key in row if "_Q_" in key)


def test_polynomials_that_are_not_valid_do_not_govern() -> None:
    found = replace(check(WEAK, ALLOWED), outside=("web width / pin diameter",))
    assert found.governing["pin"] == "elements"
    assert found.verdict == "accepted"
    assert found.departures == ()


@pytest.mark.parametrize(("wanted", "safety"), [("elements", 1.2), ("polynomials", 1.13), ("lower", 1.13)])
def test_the_scene_chooses(wanted: str, safety: float) -> None:
    scene = with_values(load_scene("mikron-iiic"), {"fatigue.m53_factors": wanted})
    assert scene.fatigue.m53_factors == wanted
    found = replace(check(WEAK, ALLOWED), m53_factors=scene.fatigue.m53_factors)
    assert found.safety == pytest.approx(safety)


def test_a_difference_beyond_the_error_of_the_elements_is_said() -> None:
    (line,) = rule_remarks([check(WEAK, ALLOWED)])
    assert "pin fillet: Q 1.130 by polynomials, 1.200 by elements (+6.2 %" in line
    assert rule_remarks([check(ALLOWED, FilletCheck(200.0, 244.0))]) == []


def test_a_mesh_that_misses_the_rules_checks_is_said() -> None:
    coarse = replace(check(ALLOWED, ALLOWED), quality=RuleQuality(1.0, 0.4, 5000, 6.7, 9.2, 1.0, 1.0))
    assert any("surface-normal stress 6.7 % (at most 3 %)" in line for line in rule_remarks([coarse]))
    assert coarse.governing == {"pin": None, "journal": None}
    assert coarse.verdict == "not judged", "elements that prove nothing have no more than the polynomials"
    assert (coarse.places, coarse.safety, coarse.judged_safety) == ({}, pytest.approx(1.2), None)
    assert rule_table([coarse], None).rows[0]["governed_by"] == "not judged"
    low = {"pin": FilletCheck(200.0, 236.0), "journal": FilletCheck(200.0, 236.0)}
    assert replace(coarse, rule_checks=low).verdict == "accepted", "the polynomials govern, and suffice"
    refused = replace(check(WEAK, FilletCheck(200.0, 220.0)), quality=coarse.quality)
    assert refused.governing["pin"] == "polynomials"
    assert refused.verdict == "not accepted", "the polynomials alone refuse it"
    outside = replace(refused, outside=("web width / pin diameter",))
    assert outside.governing["pin"] is None
    assert outside.verdict == "not accepted", "a number below what is asked is never accepted"


def test_elements_that_prove_nothing_are_nowhere_accepted() -> None:
    """Pin 1.3 by polynomials and 1.2 by elements, journal 1.2 and 1.25: the mesh misses the jump alone."""
    found = replace(check(FilletCheck(200.0, 260.0), ALLOWED), quality=MISSED)
    found = replace(found, fem_checks=found.fem_checks | {"journal": FilletCheck(200.0, 250.0)})
    assert found.governing == {"pin": None, "journal": "polynomials"}
    assert found.not_judged["pin fillet"].endswith("(Q 1.200 by these elements)")
    rows = acceptability_table(found).rows
    assert [row["accepted"] for row in rows] == ["not judged", "not judged", "yes", "yes"]
    assert [row["factors_by"] for row in rows[:2]] == ["elements (prove nothing here)"] * 2
    assert [line for line in found.departures if "govern" in line and "neither governs" not in line] == []


def test_a_comparison_says_first_what_the_rule_answers() -> None:
    weak, sound = check(WEAK, ALLOWED), check(ALLOWED, ALLOWED)
    nothing = FatigueResult(
        method="m53", loads="extremes", baseline=None, fatigue=(), percent_of_baseline=None
    )
    told = compare_fatigue(
        [sound, weak], 0, nothing, [throw_verdict(n, [c]) for n, c in (("a", sound), ("b", weak))]
    ).verdicts
    assert told[0].endswith(
        f": accepted by UR M53, least Q {sound.safety:.3f}, 1.15 asked (pin fillet by elements)."
    )
    assert told[1].endswith(
        ": not accepted by UR M53, least Q 1.130, 1.15 asked (pin fillet by polynomials)."
    )


def test_a_comparison_says_where_the_loads_differ() -> None:
    """A torque amplitude 5 % above the baseline's; one within 0.1 % is the same."""
    base = replace(check(ALLOWED, ALLOWED), name="base")
    near = replace(base, name="near", loads=AlternatingLoads(18000.0, 265.5, 410.3))
    other = replace(base, name="other", loads=AlternatingLoads(18000.0, 265.5, 430.5))
    told = verdicts([base, near, other], 0)
    assert [line for line in told if "load" in line] == [
        "other: other load amplitudes than base: torque 0.4305 against 0.41 kN m."
    ]


@pytest.mark.parametrize(
    ("other_MPa", "words"),
    [
        (FilletCheck(200.0, 236.0), "-1.7 +-7.9 % safety: equal to base within their error: 1.180 +-4.0 %"),
        (FilletCheck(200.0, 224.0), "-6.7 +-7.5 % safety: equal to base within their error: 1.120 +-4.0 %"),
        (FilletCheck(200.0, 216.0), "-10.0 +-7.2 % safety: less safe than base."),
    ],
)
def test_a_change_within_the_errors_of_both_is_no_verdict(other_MPa: FilletCheck, words: str) -> None:
    """Both pins by elements, whose stress jumps by 4 % at the peak: 8 % between two of them."""
    strong = FilletCheck(200.0, 300.0)
    base, other = (
        replace(check(strong, pin), name=name, rule_checks={"pin": strong, "journal": strong})
        for name, pin in (("base", ALLOWED), ("other", other_MPa))
    )
    (line,) = verdicts([base, other], 0)
    assert words in line
    nothing = FatigueResult(
        method="m53", loads="extremes", baseline=None, fatigue=(), percent_of_baseline=None
    )
    assert compare_fatigue([base, other], 0, nothing).change_error_percent(1, 0) == pytest.approx(8.0)


def test_by_the_rule_a_coarse_mesh_tells_no_small_difference() -> None:
    """Elements that miss the checks decide both acceptabilities, 3 % apart."""
    base, other = (
        replace(check(ALLOWED, FilletCheck(200.0, strength)), name=name, quality=MISSED)
        for name, strength in (("base", 230.0), ("other", 236.9))
    )
    (line,) = verdicts([base, other], 0)
    assert "+3.0 +-11.1 % safety: not told apart from base: the mesh of other and of base misses" in line


def test_a_choice_that_flatters_is_said_even_within_the_error_of_the_elements() -> None:
    near = FilletCheck(200.0, 237.0)
    assert check(near, ALLOWED).departures == ()
    (line,) = replace(check(near, ALLOWED), m53_factors="elements").departures
    assert "elements govern" in line


@pytest.mark.slow
def test_a_solved_throw_is_governed_by_the_lower_factors_and_not_accepted_past_its_outlet() -> None:
    (found,) = check_rule(Target("gas", load_scene("industrial-gas")), fillet_fraction=0.5)
    by_rule, by_elements = found.rule_checks["journal"], found.fem_checks["journal"]
    assert by_rule.acceptability < by_elements.acceptability
    assert found.governing == {"pin": "elements", "journal": "polynomials"}
    assert found.safety == pytest.approx(by_rule.acceptability)
    assert found.safety > 1.15
    assert found.verdict == "not judged"
    assert "leans 25 deg" in next(iter(found.uncovered.values()))


def test_polynomials_asked_for_outside_their_validity_are_refused_before_a_solve() -> None:
    scene = with_values(
        load_scene("mikron-iiic-plain"), {"fatigue.m53_factors": "polynomials", "web.width_mm": 120.0}
    )
    assert outside_validity(dimensions(scene))
    with pytest.raises(CranktopoError, match=r"fatigue\.m53_factors.*Take 'lower' or 'elements'"):
        check_rule(Target("throw", scene))


def test_a_comparison_says_what_the_strengths_do_not_hold_for() -> None:
    """Every form of a table has it, not the terminal alone."""
    entry = SimpleNamespace(target="thick", strength_remarks=("that of sections to 16 mm",))
    told = compare_fatigue([check(ALLOWED, ALLOWED)], 0, SimpleNamespace(fatigue=[entry, entry])).verdicts
    assert told.count("thick: material: that of sections to 16 mm.") == 1


IRON = {"material.name": "EN-GJS-700-2"}


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, ""),
        ({"material.name": "16MnCr5"}, ""),
        ({"material.fkm_group": "GS"}, ""),
        (IRON, "EN-GJS-700-2 is nodular cast iron; UR M53, 1.2"),
        ({"material.name": "EN-AW-2031"}, "is wrought aluminium"),
        ({"material.fkm_group": "GJL"}, "is grey cast iron"),
        ({"material.E_GPa": 114.0}, "no steel by its Young's modulus of 114 GPa"),
    ],
)
def test_the_rule_covers_steel_alone(changes: dict[str, Any], words: str) -> None:
    found = uncovered_material(steel_or(changes))
    assert words in found
    assert bool(found) == bool(words)


def steel_or(changes: dict[str, Any]) -> Scene:
    """The plain Mikron; a named material with nothing of its own but what is changed."""
    scene = load_scene("mikron-iiic-plain")
    if "material.name" not in changes:
        return with_values(scene, changes)
    data = scene.model_dump(mode="json", exclude_none=True)
    return scene_from_dict(data | {"material": {"name": changes["material.name"]}}, "named")


def test_a_material_that_the_rule_does_not_cover_is_never_accepted() -> None:
    why = uncovered_material(steel_or(IRON))
    found = replace(check(ALLOWED, ALLOWED), not_covered=why)
    assert (check(ALLOWED, ALLOWED).verdict, found.verdict) == ("accepted", "not covered")
    assert rule_remarks([found])[0].startswith("throw: NOT COVERED by the rule, and not accepted: EN-GJS")
    assert {row["accepted"] for row in acceptability_table(found).rows} == {"not covered"}
    nothing = FatigueResult(
        method="m53", loads="extremes", baseline=None, fatigue=(), percent_of_baseline=None
    )
    assert (
        "throw: not covered by UR M53"
        in compare_fatigue([found], 0, nothing, [throw_verdict("throw", [found])]).verdicts[0]
    )
    assert any(why in line for line in live.notes(steel_or(IRON)))


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({}, ""),
        ({"material.fkm_group": "GS", "fatigue.process_factor": 0.93}, ""),
        ({"material.fkm_group": "GS"}, "is cast steel"),
        ({"optimise.process": "cast"}, "optimise.process = 'cast'"),
    ],
)
def test_cast_steel_with_the_factor_of_a_forging_is_remarked(changes: dict[str, Any], words: str) -> None:
    remark = process_remark(with_values(load_scene("mikron-iiic-plain"), changes))
    assert words in remark
    assert bool(remark) == bool(words)
    assert rule_remarks([replace(check(ALLOWED, ALLOWED), process_remark=remark)]) == (
        [f"throw: {remark}."] if words else []
    )


@pytest.mark.parametrize(("edge", "kept"), [(0.2499, True), (0.250052, False)])
def test_one_function_decides_on_the_checks_of_the_mesh(edge: float, kept: bool) -> None:
    """An edge above a quarter stood as missed in the table, where the card said that all checks are kept."""
    quality = RuleQuality(1.0, edge, 5000, 1.0, 4.0, 1.0, 1.0)
    found = replace(check(ALLOWED, WEAK), quality=quality)
    assert quality.within_limits == kept == all(row["kept"] == "yes" for row in quality_table(found).rows)
    assert (found.governing["pin"] == "elements") == kept
    if not kept:
        assert "over its radius 0.2501 (at most 0.25)" in quality.shortfall


@pytest.mark.parametrize(("fraction", "solved"), [(RULE_FRACTION, 2), (0.15, 1)])
def test_a_default_mesh_that_leaves_a_place_open_is_made_finer_once(
    fraction: float, solved: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[float] = []

    def checked(*given: Any) -> RuleCheck:
        asked.append(given[-1])
        return replace(check(ALLOWED, WEAK), quality=MISSED)

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.rule_check._check", checked)
    lines: list[str] = []
    with redirected(lines.append):
        check_rule(Target("t", load_scene("mikron-iiic-plain")), fillet_fraction=fraction)
    assert asked == [fraction, pytest.approx(0.8 * fraction)][:solved]
    assert sum("judged anew with a fillet fraction of 0.136" in line for line in lines) == solved - 1
