"""The set of concentration factors that governs the check by the crankshaft rule; what is not judged."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from cranktopo import load_scene, with_values
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import redirected
from cranktopo.bodies.volume import half_throw_volume_mm3, throw_volume_mm3
from cranktopo.design.halves import halves
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.bench import live
from cranktopo.tasks.bench.results import _outlet_words
from cranktopo.tasks.fatigue import rule_page
from cranktopo.tasks.fatigue.m53 import (
    FilletCheck,
    concentration_factors,
    dimensions,
    nominal_stresses,
    outside_validity,
)
from cranktopo.tasks.fatigue.m53_material import process_remark, uncovered_material
from cranktopo.tasks.fatigue.m53_outlet import (
    OutletCheck,
    check_outlets,
    outlet_equivalent_MPa,
    unchecked_journal_outlets,
)
from cranktopo.tasks.fatigue.mesh_quality import MeshChecks, RuleQuality
from cranktopo.tasks.fatigue.outlet_elements import OutletFactors
from cranktopo.tasks.fatigue.result import (
    AlternatingLoads,
    FatigueResult,
    OutletAcceptance,
    OutletElementsAcceptance,
)
from cranktopo.tasks.fatigue.rule_check import RuleCheck, check_rule
from cranktopo.tasks.fatigue.rule_tables import acceptability_table, quality_table, size_table
from cranktopo.tasks.fatigue.stress_model import RULE_FRACTION
from cranktopo.tasks.fatigue.text import compare_fatigue, outlet_table, rule_remarks, rule_table
from cranktopo.tasks.fatigue.throw_verdict import throw_verdict
from cranktopo.tasks.fatigue.verdicts import verdicts
from cranktopo.tasks.fea.targets import Target
from cranktopo.throw.drilling.table import drill_bores

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


def test_the_mass_is_that_of_the_drilled_throw(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each web is judged in a throw of two such webs, of another mass than the throw."""
    plain = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    for name in ("main_journal", "crankpin"):
        plain["throw"][name]["bore_diameter_mm"] = 0.0
    plain["throw"]["drilling"] = [drilling_of("first", 6.0)]
    scene = scene_from_dict(plain, "drilled", whole=True)
    monkeypatch.setattr(
        "cranktopo.tasks.fatigue.rule_check._check", lambda *_: replace(check(ALLOWED, ALLOWED), web="first")
    )
    exact = throw_volume_mm3(scene) * scene.material.density_kg_m3 * 1e-9
    found = check_rule(Target("drilled", scene))
    assert [one.throw_kg for one in found] == pytest.approx([exact] * 2, rel=1e-6)
    plain["throw"].pop("drilling")
    undrilled = 2 * half_throw_volume_mm3(scene_from_dict(plain)) * scene.material.density_kg_m3 * 1e-9
    assert exact < undrilled * (1 - 1e-3)


def drilling_of(web: str, place_mm: float) -> dict[str, Any]:
    return {
        "diameter_mm": 4.0,
        "outlet_radius_mm": 1.0,
        "web": web,
        "from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": 6.0},
        "to": {"on": "crankpin", "angle_deg": 0.0, "place_mm": place_mm},
    }


def test_elements_of_a_web_have_the_drilling_that_it_alone_has(monkeypatch: pytest.MonkeyPatch) -> None:
    """In the first half of a throw that has the web twice; it was left out, and so were its outlets.

    Outlets have the keys of the scene: the first drilling of the second web is not the first of all.
    """
    plain = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    for name in ("main_journal", "crankpin"):
        plain["throw"][name]["bore_diameter_mm"] = 0.0
    plain["throw"]["drilling"] = [drilling_of("first", 8.0), drilling_of("second", 10.0)]
    scene = scene_from_dict(plain, "drilled", whole=True)
    solved: list[Scene] = []

    def model(target: Target, *_: object, **__: object) -> Any:
        solved.append(target.scene)
        return SimpleNamespace(throw_kg=1.0, quality=replace(MISSED, jump_percent=4.0))

    factors = concentration_factors(dimensions(scene))
    monkeypatch.setattr("cranktopo.tasks.fatigue.rule_check.solve_stresses", model)
    monkeypatch.setattr("cranktopo.tasks.fatigue.rule_check.element_factors", lambda _: factors)
    by_elements = OutletFactors(2.4, 4.4, MeshChecks(1.0, 1.0))
    monkeypatch.setattr("cranktopo.tasks.fatigue.m53_outlet.element_outlet_factors", lambda *_: by_elements)
    found = check_rule(Target("drilled", scene))
    assert len(solved) == 2
    for of_web, place_mm in zip(solved, (8.0, 10.0), strict=True):
        first, second = halves(of_web)
        assert [drilling.end.place_mm for drilling in first.throw.drilling] == [place_mm]
        assert not second.throw.drilling
        assert [bore.alone for bore in drill_bores(of_web)] == [True], "else its mirror image is meshed too"
    outlets = [one for each in found for one in each.outlets]
    assert [one.key for one in outlets] == ["throw.drilling[0]", "throw.drilling[1]"]
    assert [one.governed_by for one in outlets] == ["elements"] * 2
    assert [each.web for each in found] == ["first web", "second web"]


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


def test_an_outlet_has_the_error_of_its_own_elements() -> None:
    weak = leaning((12.0, 14.0), jump_percent=2.7)
    assert replace(check(ALLOWED, ALLOWED), outlets=(weak,)).least_error_percent == 2.7
    by_rule = replace(check(WEAK, ALLOWED), outlets=(leaning((2.0, 2.0)),))
    assert by_rule.least_error_percent == 0.0, "polynomials have none"


def test_by_the_rule_a_coarse_mesh_tells_no_small_difference() -> None:
    """Elements that miss the checks decide both acceptabilities, 3 % apart."""
    base, other = (
        replace(check(ALLOWED, FilletCheck(200.0, strength)), name=name, quality=MISSED)
        for name, strength in (("base", 230.0), ("other", 236.9))
    )
    (line,) = verdicts([base, other], 0)
    assert "+3.0 +-11.1 % safety: not told apart from base: the mesh of other and of base misses" in line


def test_an_outlet_outside_the_rule_is_told_by_no_number_and_leaves_the_throw_unjudged() -> None:
    wide = OutletCheck("throw.drilling[0]", 30.0, 3.0, 4.0, 10.0, 5.0, FilletCheck(50.0, 300.0), ("d/D 0.3",))
    found = replace(check(ALLOWED, ALLOWED), outlets=(wide,))
    assert found.not_judged == {wide.place: "d/D 0.3"}
    assert wide.place not in found.places
    assert found.verdict == "not judged"
    assert replace(found, rule_checks={"pin": WEAK, "journal": ALLOWED}).verdict == "not accepted"
    assert outlet_table([found]).rows[0]["Q"] is None
    assert acceptability_table(found).rows[-1]["Q"] is None
    assert "not judged, d/D 0.3" in rule_remarks([found])[0]
    low = replace(wide, check=FilletCheck(300.0, 300.0), outside=())
    assert replace(found, outlets=(low,)).safety == pytest.approx(1.0)
    good = replace(wide, check=FilletCheck(200.0, 300.0), outside=())
    assert replace(found, outlets=(good,)).verdict == "accepted"


def test_the_place_that_governs_is_told_with_its_factors() -> None:
    """An outlet that elements judge has less than both fillets, then the pin fillet has."""
    weak = leaning((12.0, 14.0))
    found = replace(check(FilletCheck(200.0, 240.0), FilletCheck(200.0, 250.0)), outlets=(weak,))
    (row,) = rule_table([found], None).rows
    assert row["governing_Q"] == weak.by_elements.acceptability < 1.2
    assert row["governed_by"] == "outlet at 0 deg (throw.drilling[0]) by elements"
    told = rule_page._governs(found)
    assert f"elements at the {weak.place}" in told
    assert f"The least is {row['governing_Q']:.3f}, {weak.place} by elements." in told
    assert throw_verdict("one", [found]).reason == f"{weak.place} by elements"
    sound = replace(found, outlets=(leaning((2.0, 2.0)),))
    assert rule_table([sound], None).rows[0]["governed_by"] == "pin fillet by polynomials"
    assert "1.200, pin fillet by polynomials." in rule_page._governs(sound)


def test_the_bench_tells_each_outlet_with_its_factors() -> None:
    """One that elements judge, and one that nothing does."""
    elements = OutletElementsAcceptance(
        gamma_bending=3.0,
        gamma_torsion=4.0,
        equivalent_MPa=1.0,
        acceptability=0.742,
        normal_percent=1.0,
        jump_percent=2.7,
        proven=True,
    )
    one = OutletAcceptance(
        key="throw.drilling[0]",
        angle_deg=0.0,
        gamma_bending=3.0,
        gamma_torsion=4.0,
        bending_MPa=1.0,
        torsion_MPa=1.0,
        equivalent_MPa=1.0,
        strength_MPa=1.0,
        acceptability=None,
        outside_validity=("leans",),
        elements=elements,
        governed_by="elements",
    )
    told = _outlet_words(one)
    assert told == "outlet at 0 deg (throw.drilling[0]): 0.742 by elements; elements govern"
    open_one = one.model_copy(update={"elements": None, "governed_by": None})
    assert _outlet_words(open_one) == "outlet at 0 deg (throw.drilling[0]): not judged"


def leaning(gammas: tuple[float, float], jump_percent: float = 1.0, **more: Any) -> OutletCheck:
    """An outlet under 20 and 10 MPa with a strength of 300 MPa, and the factors that elements have there."""
    found = OutletFactors(*gammas, MeshChecks(1.0, jump_percent))
    check = FilletCheck(outlet_equivalent_MPa(3.0 * 20.0, 4.0 * 10.0), 300.0)
    outlet = OutletCheck("throw.drilling[0]", 0.0, 3.0, 4.0, 20.0, 10.0, check, ("leans 27 deg",), found)
    return replace(outlet, **more)


def test_elements_judge_a_leaning_outlet_if_their_mesh_proves_it() -> None:
    sound, weak = leaning((4.0, 5.0)), leaning((12.0, 14.0))
    stress = outlet_equivalent_MPa(4.0 * 20.0, 5.0 * 10.0)
    assert sound.governed_by == "elements"
    assert sound.judged == FilletCheck(stress, 300.0)
    accepted, refused = (replace(check(ALLOWED, ALLOWED), outlets=(one,)) for one in (sound, weak))
    assert (accepted.verdict, refused.verdict) == ("accepted", "not accepted")
    assert refused.safety == pytest.approx(300.0 / outlet_equivalent_MPa(12.0 * 20.0, 14.0 * 10.0))
    assert "judged by elements, leans 27 deg" in rule_remarks([accepted])[0]
    coarse, sharp = leaning((4.0, 5.0), jump_percent=7.0), leaning((4.0, 5.0), sharp=True)
    for one, why in ((coarse, "jump between elements 7.0 %"), (sharp, "outlet_radius_mm = 0")):
        found = replace(check(ALLOWED, ALLOWED), outlets=(one,))
        assert found.verdict == "not judged"
        assert why in found.not_judged[one.place]
        assert f"Q {300.0 / stress:.3f} by these elements" in found.not_judged[one.place]
        assert outlet_table([found]).rows[0]["governed_by"] == "not judged"


@pytest.mark.parametrize(
    ("wanted", "gammas", "governs"),
    [
        ("lower", (4.0, 5.0), "elements"),
        ("lower", (2.0, 3.0), "polynomials"),
        ("elements", (2.0, 3.0), "elements"),
        ("polynomials", (4.0, 5.0), "polynomials"),
    ],
)
def test_the_lower_set_governs_at_a_radial_outlet(
    wanted: Any, gammas: tuple[float, float], governs: str
) -> None:
    radial = leaning(gammas, outside=(), m53_factors=wanted)
    assert radial.governed_by == governs
    found = replace(check(ALLOWED, ALLOWED), outlets=(radial,))
    rows = acceptability_table(found).rows[-2:]
    assert [row["factors_by"] for row in rows] == ["elements", "polynomials"]
    assert radial.judged is not None
    assert radial.judged.acceptability in [row["Q"] for row in rows]
    lines = [line for line in rule_remarks([found]) if "polynomials govern" in line]
    assert bool(lines) == (wanted == "polynomials")


def test_lower_numbers_of_elements_that_prove_nothing_leave_a_radial_outlet_open() -> None:
    coarse = leaning((4.0, 5.0), jump_percent=7.0, outside=())
    assert coarse.governed_by is None
    found = replace(check(ALLOWED, ALLOWED), outlets=(coarse,))
    assert found.verdict == "not judged"
    assert (found.uncovered, list(found.unproven)) == ({}, [coarse.place])
    (line,) = rule_remarks([found])
    assert "jump between elements 7.0 %" in line
    assert "a smaller --fillet-fraction of `fatigue` may help" in line
    (line,) = rule_remarks([replace(found, outlets=(leaning((2.0, 3.0), jump_percent=7.0),))])
    assert "jump between elements 7.0 %" in line
    assert (
        "only with elements of a smaller --fillet-fraction; `cranktopo fatigue --method lsa` counts it"
        in line
    )
    (line,) = rule_remarks([replace(found, outlets=(leaning((2.0, 3.0), sharp=True),))])
    assert "only with an analysis of its own" in line
    refused = replace(coarse, check=FilletCheck(290.0, 300.0))
    assert refused.governed_by == "polynomials", "they refuse it by themselves"
    assert leaning((2.0, 3.0), jump_percent=7.0, outside=()).governed_by == "polynomials"
    broken = replace(found, outlets=(leaning((12.0, 14.0), jump_percent=7.0, outside=()),))
    assert (broken.verdict, broken.least_place) == ("not accepted", coarse.place)


def test_lower_numbers_at_a_sharp_outlet_are_said() -> None:
    """The largest stress of an edge is that of the mesh: no doubt of the polynomials."""
    sharp = leaning((4.0, 5.0), sharp=True, outside=())
    assert sharp.governed_by == "polynomials"
    (line,) = rule_remarks([replace(check(ALLOWED, ALLOWED), outlets=(sharp,))])
    assert "by polynomials govern, elements have" in line
    assert "outlet_radius_mm = 0" in line


def test_dimensions_by_the_rule_have_the_oil_bores() -> None:
    scene = with_values(load_scene("industrial-gas"), {"throw.drilling[0].outlet_radius_mm": 1.5})
    outlets = check_outlets(scene, "extremes", frozenset(), 1e6)
    assert outlets
    rows = size_table(replace(check(ALLOWED, ALLOWED), outlets=outlets)).rows[-2 * len(outlets) :]
    assert [(row["symbol"], row["value_mm"]) for row in rows] == [
        ("DO", scene.throw.drilling[0].diameter_mm),
        ("-", 1.5),
    ] * len(outlets)
    assert all(outlets[0].place in str(row["dimension"]) for row in rows[:2])


def test_an_outlet_on_a_thin_main_journal_is_not_judged() -> None:
    drilled = load_scene("industrial-gas")
    assert unchecked_journal_outlets(drilled) == {}
    thin = with_values(drilled, {"throw.main_journal.outer_diameter_mm": 110.0})
    ((place, why),) = unchecked_journal_outlets(thin).items()
    assert "main journal" in place
    assert "thinner than the crankpin" in why
    assert replace(check(ALLOWED, ALLOWED), journal_outlets={place: why}).verdict == "not judged"


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

    monkeypatch.setattr("cranktopo.tasks.fatigue.rule_check._check", checked)
    lines: list[str] = []
    with redirected(lines.append):
        check_rule(Target("t", load_scene("mikron-iiic-plain")), fillet_fraction=fraction)
    assert asked == [fraction, pytest.approx(0.8 * fraction)][:solved]
    assert sum("judged anew with a fillet fraction of 0.136" in line for line in lines) == solved - 1
