"""Outlets of oil bores by the crankshaft rule: which factors judge them, and where none does."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from cranktopo import load_scene, with_values
from cranktopo.bodies.volume import half_throw_volume_mm3, throw_volume_mm3
from cranktopo.design.halves import halves
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.bench.results import _outlet_words
from cranktopo.tasks.throw_fatigue import rule_page
from cranktopo.tasks.throw_fatigue.m53 import (
    FilletCheck,
    concentration_factors,
    dimensions,
)
from cranktopo.tasks.throw_fatigue.m53_outlet import (
    OutletCheck,
    check_outlets,
    outlet_equivalent_MPa,
    unchecked_journal_outlets,
)
from cranktopo.tasks.throw_fatigue.mesh_quality import MeshChecks
from cranktopo.tasks.throw_fatigue.outlet_elements import OutletFactors
from cranktopo.tasks.throw_fatigue.result import (
    OutletAcceptance,
    OutletElementsAcceptance,
)
from cranktopo.tasks.throw_fatigue.rule_check import check_rule
from cranktopo.tasks.throw_fatigue.rule_tables import acceptability_table, size_table
from cranktopo.tasks.throw_fatigue.rule_text import outlet_table, rule_remarks, rule_table
from cranktopo.tasks.throw_fatigue.throw_verdict import throw_verdict
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.throw.drilling.table import drill_bores
from tests.unit.fatigue.test_governing_factors import ALLOWED, MISSED, WEAK, check


def test_the_mass_is_that_of_the_drilled_throw(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each web is judged in a throw of two such webs, of another mass than the throw."""
    plain = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    for name in ("main_journal", "crankpin"):
        plain["throw"][name]["bore_diameter_mm"] = 0.0
    plain["throw"]["drilling"] = [drilling_of("first", 6.0)]
    scene = scene_from_dict(plain, "drilled", whole=True)
    monkeypatch.setattr(
        "cranktopo.tasks.throw_fatigue.rule_check._check",
        lambda *_: replace(check(ALLOWED, ALLOWED), web="first"),
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
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.rule_check.solve_stresses", model)
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.rule_check.element_factors", lambda _: factors)
    by_elements = OutletFactors(2.4, 4.4, MeshChecks(1.0, 1.0))
    monkeypatch.setattr(
        "cranktopo.tasks.throw_fatigue.m53_outlet.element_outlet_factors", lambda *_: by_elements
    )
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


def test_an_outlet_has_the_error_of_its_own_elements() -> None:
    weak = leaning((12.0, 14.0), jump_percent=2.7)
    assert replace(check(ALLOWED, ALLOWED), outlets=(weak,)).least_error_percent == 2.7
    by_rule = replace(check(WEAK, ALLOWED), outlets=(leaning((2.0, 2.0)),))
    assert by_rule.least_error_percent == 0.0, "polynomials have none"


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
