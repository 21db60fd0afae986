"""`cranktopo fatigue --method m53 --report`: what decides, what is assumed, mistakes before a solve."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.design.halves import difference, halves
from cranktopo.design.loading import designs_folder
from cranktopo.tasks.throw_fatigue.m53 import (
    FilletCheck,
    concentration_factors,
    dimensions,
    nominal_stresses,
    outside_validity,
)
from cranktopo.tasks.throw_fatigue.m53_material import uncovered_material
from cranktopo.tasks.throw_fatigue.mesh_quality import Quality
from cranktopo.tasks.throw_fatigue.result import AlternatingLoads
from cranktopo.tasks.throw_fatigue.rule_check import RuleCheck
from cranktopo.tasks.throw_fea.targets import Target

QUALITY = Quality(0.4, 0.24, 1000, 1.0, 4.0, 1.0, 2.0)


def checked(target: Target, *_: object) -> tuple[RuleCheck, ...]:
    """Closed forms for either set of factors, and a journal fillet a little too weak; each web a check."""
    if difference(target.scene):
        sides = zip(("first", "second"), halves(target.scene), strict=True)
        return tuple(
            replace(checked(replace(target, scene=half))[0], web=f"{web} web") for web, half in sides
        )
    size = dimensions(target.scene)
    factors = concentration_factors(size)
    loads = AlternatingLoads(18000.0, 265.5, 410.0)
    nominal = nominal_stresses(size, 265500.0, 9000.0, 410000.0)
    fillets = {"pin": FilletCheck(200.0, 400.0), "journal": FilletCheck(200.0, 229.0)}
    outside = outside_validity(size)
    check = RuleCheck(
        target.name, 1.6, size, loads, outside, factors, factors, nominal, fillets, fillets, QUALITY
    )
    return (replace(check, not_covered=uncovered_material(target.scene)),)


@pytest.fixture
def no_solve(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.stage.check_rule", checked)


def row(text: str, first: str) -> list[str]:
    """Cells of the table row that begins with a word."""
    line = next(line for line in text.splitlines() if line.startswith(f"| {first} |"))
    return [cell.strip() for cell in line.strip("|").split("|")]


@pytest.mark.usefixtures("no_solve")
def test_a_dossier_says_first_that_a_throw_is_not_accepted(tmp_path: Path) -> None:
    path = tmp_path / "dossier.md"
    assert main(["fatigue", "mikron-iiic-plain", "--method", "m53", "--report", str(path), "--quiet"]) == 6
    text = path.read_text(encoding="utf-8").replace("\\", "")
    assert "is NOT accepted" in text
    assert "Q = 1.145 at the journal, 1.15 asked" in text
    assert "above the threshold of 2 %: tangential 25" in text.split("\n## ")[0]
    assert row(text, "journal")[1:] == ["elements", "200.0", "229.0", "1.145", "0.046", "no"]
    assert row(text, "RH")[2] == "2.50"
    assert row(text, "overlap / pin diameter")[1:] == ["-0.143", "any", "0.5", "yes"]
    assert row(text, "radial force on the crankpin")[1:] == ["18000.0", "N"]
    assert row(text, "jump between elements at the peak")[1:] == ["4.00", "5.00", "%", "yes"]
    assert row(text, "fatigue.process_factor")[1] == "1"
    assert row(text, "fatigue.additional_stress_MPa")[1] == "10 MPa"
    assert row(text, "alpha B")[1:] == ["bending at the crankpin fillet", "2.763", "2.763", "0.0"]
    assert row(text, "torsional vibration")[1] == "off"
    assert row(text, "manufacturing constraint")[3].startswith("optimise.process is forged; a die that")
    assert "signature" in text
    assert list((tmp_path / "dossier-pictures").glob("drawing.png"))


def test_a_difference_of_the_sets_beyond_the_error_is_told_on_the_page(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    weak = {"pin": FilletCheck(200.0, 226.0), "journal": FilletCheck(200.0, 240.0)}
    strong = {"pin": FilletCheck(200.0, 240.0), "journal": FilletCheck(200.0, 240.0)}

    def check(target: Target, *_: object) -> tuple[RuleCheck, ...]:
        return tuple(replace(one, rule_checks=weak, fem_checks=strong, outside=()) for one in checked(target))

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.stage.check_rule", check)
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.dossier._drawings", lambda _: ())
    path = tmp_path / "dossier.md"
    assert main(["fatigue", "mikron-iiic-plain", "--method", "m53", "--report", str(path), "--quiet"]) == 6
    text = path.read_text(encoding="utf-8").replace("\\", "")
    assert "The sets differ at the pin fillet: Q 1.130 by polynomials, 1.200 by elements (+6.2 %" in text
    assert "The sets differ at the journal" not in text


def test_a_material_that_the_rule_does_not_cover_is_said_first_and_not_accepted(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Every number is allowed."""
    strong = {name: FilletCheck(200.0, 400.0) for name in ("pin", "journal")}

    def check(target: Target, *_: object) -> tuple[RuleCheck, ...]:
        return tuple(replace(one, rule_checks=strong, fem_checks=strong) for one in checked(target))

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.stage.check_rule", check)
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.dossier._drawings", lambda _: ())
    design, path = tmp_path / "iron.toml", tmp_path / "dossier.md"
    text = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    design.write_text(text.replace('name = "31CrMoV9"', 'name = "EN-GJS-700-2"'), encoding="utf-8")
    assert main(["fatigue", str(design), "--method", "m53", "--report", str(path), "--quiet"]) == 6
    assert capsys.readouterr().out.startswith("mikron-iiic-plain: NOT COVERED by the rule, and not accepted")
    told = path.read_text(encoding="utf-8").replace("\\", "")
    assert "The throw is NOT COVERED by the rule (EN-GJS-700-2 is nodular cast iron; UR M53, 1.2," in told
    assert row(told, "journal")[-1] == "not covered"


def test_only_a_check_that_the_mesh_misses_is_told_as_missed() -> None:
    one = replace(QUALITY, normal_percent=3.2)
    assert (
        one.shortfall
        == "the mesh misses the checks of IACS UR M53: surface-normal stress 3.2 % (at most 3 %)"
    )
    assert "jump between elements 4.0 % (at most 5 %)" in one.kept
    assert "jump" in replace(one, jump_percent=5.1).shortfall


def test_a_fillet_of_elements_that_prove_nothing_has_no_card_of_its_q(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    strong, better = FilletCheck(200.0, 250.0), FilletCheck(200.0, 260.0)
    by_rule, by_elements = (
        {"pin": better, "journal": strong},
        {"pin": FilletCheck(200.0, 248.0), "journal": better},
    )

    def check(target: Target, *_: object) -> tuple[RuleCheck, ...]:
        quality = replace(QUALITY, jump_percent=5.4)
        (one,) = checked(target)
        return (replace(one, rule_checks=by_rule, fem_checks=by_elements, quality=quality),)

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.stage.check_rule", check)
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.dossier._drawings", lambda _: ())
    path = tmp_path / "dossier.md"
    line = ["fatigue", "mikron-iiic-plain", "--method", "m53", "--report", str(path), "--json", "--quiet"]
    main(line)
    (entry,) = json.loads(capsys.readouterr().out)["fatigue"]
    assert entry["governing_factors"] == {"pin": None, "journal": "polynomials"}
    assert (entry["verdict"], entry["safety"]) == ("not judged", pytest.approx(1.24))
    text = path.read_text(encoding="utf-8").replace("\\", "")
    assert "Q = 1.240 at the pin, 1.15 asked, with concentration factors from finite elements that" in text
    assert text.count("Q at the pin") == 1, "the card that says not judged"
    assert "neither set at the pin fillet, polynomials at the journal fillet" in text
    elements = [one for one in text.splitlines() if "| elements (prove nothing here) |" in one]
    assert [one.strip("| ").split(" | ")[-1] for one in elements] == ["not judged", "not judged"]


@pytest.mark.parametrize(("journal_MPa", "code"), [(230.0, 0), (229.0, 6)])
def test_the_exit_code_tells_what_the_rule_accepts(
    journal_MPa: float, code: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """1.15 is asked, 200 MPa are there."""

    def check(target: Target, *_: object) -> tuple[RuleCheck, ...]:
        fillets = {"pin": FilletCheck(200.0, 400.0), "journal": FilletCheck(200.0, journal_MPa)}
        return tuple(replace(one, rule_checks=fillets, fem_checks=fillets) for one in checked(target))

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.stage.check_rule", check)
    assert main(["fatigue", "mikron-iiic", "--method", "m53", "--json", "--quiet"]) == code


@pytest.mark.slow
@pytest.mark.usefixtures("no_solve")
def test_a_dossier_on_paper(tmp_path: Path) -> None:
    path = tmp_path / "dossier.pdf"
    assert main(["fatigue", "mikron-iiic-plain", "--method", "m53", "--report", str(path), "--quiet"]) == 6
    assert path.read_bytes().startswith(b"%PDF")


@pytest.mark.slow
@pytest.mark.usefixtures("no_solve")
def test_the_dossier_of_two_webs_has_both(tmp_path: Path) -> None:
    path, scene = tmp_path / "dossier.md", tmp_path / "two.toml"
    design = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    scene.write_text(f'{design}\n[second_web]\nthickness_mm = 25.0\noutline = "obround"\nwidth_mm = 54.0\n')
    assert main(["fatigue", str(scene), "--method", "m53", "--report", str(path), "--quiet"]) == 6
    text = path.read_text(encoding="utf-8").replace("\\", "")
    for web, thickness in (("first web", "19.00"), ("second web", "25.00")):
        size = text[text.index(f"## Dimensions by the rule, {web}") :]
        assert row(size, "W")[2] == thickness
        assert f"## Acceptability, {web}" in text
    assert "Q = 1.145 at the journal, first web, 1.15 asked" in text


@pytest.mark.usefixtures("no_solve")
@pytest.mark.parametrize(
    "source", [pytest.param("", marks=pytest.mark.slow), "rolled, tests of the forge 12/2025"]
)
def test_a_factor_of_the_surface_treatment_is_told_with_its_source(
    source: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, path = tmp_path / "treated.toml", tmp_path / "dossier.md"
    design = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    given = f'surface_treatment_factor = 1.3\nsurface_treatment_source = "{source}"\n'
    scene.write_text(f"{design}\n[fatigue]\n{given}", encoding="utf-8")
    assert main(["fatigue", str(scene), "--method", "m53", "--report", str(path), "--json"]) == 6
    told = capsys.readouterr()
    said = source or "NO SOURCE"
    assert f"times 1.3 for their surface treatment: {said}" in told.err
    assert f"times 1.3 for their surface treatment: {said}" in path.read_text(encoding="utf-8")
    entry = json.loads(told.out)["fatigue"][0]
    assert entry["surface_treatment"] == {"factor": 1.3, "source": source or None}
    assert not any("source" in assumed["key"] for assumed in entry["assumed"])


@pytest.mark.parametrize(
    ("arguments", "code", "words"),
    [
        (["--method", "lsa", "--report", "a.html"], 2, "--method is 'lsa'"),
        (["opposed-piston", "--method", "m53", "--report", "a.html"], 2, "here are 2"),
        (["--method", "m53", "--report", "nowhere/a.html"], 2, "nowhere/a.html"),
        (["--method", "m53", "--report", "a.docx"], 2, "a.docx"),
    ],
    ids=["method", "two targets", "folder", "format"],
)
def test_mistakes_before_any_solve(
    arguments: list[str],
    code: int,
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.stage.check_rule", lambda *_: pytest.fail("solved"))
    assert main(["fatigue", "mikron-iiic-plain", *arguments]) == code
    assert words in capsys.readouterr().err
    assert not list(tmp_path.iterdir())
