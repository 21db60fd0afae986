"""`compare --report`: the page of a comparison, without the finite elements."""

from __future__ import annotations

import csv
import io
import json
import re
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import design_text, designs_folder, load_scene
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.bound.result import BoundStatements, NoBound
from cranktopo.tasks.compare import stage as pages
from cranktopo.tasks.compare.result import Entry, compare
from cranktopo.tasks.throw_fatigue import stage
from cranktopo.tasks.throw_fatigue.m53 import ConcentrationFactors, FilletCheck, Nominal, dimensions
from cranktopo.tasks.throw_fatigue.mesh_quality import RuleQuality
from cranktopo.tasks.throw_fatigue.result import AlternatingLoads, FatigueResult
from cranktopo.tasks.throw_fatigue.rule_check import RuleCheck
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
from cranktopo.tasks.throw_fea.evaluation import Evaluation
from cranktopo.tasks.throw_fea.quantities import TORSION
from cranktopo.tasks.throw_fea.stage import MeshRequest
from cranktopo.tasks.throw_fea.targets import Target, resolve_targets
from cranktopo.tasks.throw_fea.throw_stiffness import Stiffness
from tests.page_text import typed_page

NO_FATIGUE = FatigueResult(
    method="lsa", loads="extremes", baseline=None, fatigue=(), percent_of_baseline=None
)
NAMES = ["opposed-piston", "opposed-piston-casting"]


def invented(target: Target, *_: object) -> Evaluation:
    """An invented evaluation: the casting is lighter and stiffer per mass."""
    light = target.name.endswith("casting")
    torsion, bending = (90e3, 50e3) if light else (100e3, 70e3)
    fine = Stiffness({"free": torsion}, {"pinned": bending}, 1234, 4.0, 1.0, 2.0)
    mass = 1.5 if light else 2.0
    return Evaluation(target.name, mass, mass / 3, 5000, 50, fine, "free", "pinned", 0.3, 0.4, 3.0 + light)


def evaluated(name: str, torsion: float, error: float) -> Evaluation:
    fine = Stiffness({"free": torsion}, {"pinned": 50e3}, 1234, 4.0, 1.0, 2.0)
    return Evaluation(name, 2.0, 0.6, 5000, 50, fine, "free", "pinned", error, 0.4, 3.0)


@pytest.fixture(scope="module", autouse=True)
def _bodies_made_once() -> Iterator[None]:
    """Pages of these tests show the same designs: each is meshed and tried in its die once."""
    bodies, undercuts = dict[str, Any](), dict[str, Any]()
    mesh, withdraw = pages.half_throws, pages.design_undercuts

    def shown(target: Target) -> Any:
        key = target.scene.model_dump_json()
        if key not in bodies:
            bodies[key] = mesh(target)
        return bodies[key]

    def held(name: str, surface: SurfaceMesh, scene: Scene) -> Any:
        if name not in undercuts:
            undercuts[name] = withdraw(name, surface, scene)
        return undercuts[name]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(pages, "half_throws", shown)
        patch.setattr(pages, "design_undercuts", held)
        yield


@pytest.fixture(autouse=True)
def _without_finite_elements(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("cranktopo.tasks.throw_fea.stage.evaluate", invented)
    monkeypatch.setattr("cranktopo.tasks.compare.stage.bounds_for_result", lambda *_: NoBound(none=""))


@pytest.mark.slow
def test_what_no_web_can_beat(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Of the leading web at its mass, as a curve in the plots; not asked for where it is switched off."""
    asked: list[dict[str, float]] = []

    def bounds(scene: Scene, reached: dict[str, float], *_: object) -> BoundStatements:
        asked.append(reached)
        entry = {"quantity": "torsion", "value": 1.0, "percent_of_original": 108.0, "dropped": []}
        told = {
            "reached_percent": reached["torsion"],
            "at_mass_percent": 75.0,
            "model": {"cell_mm": 4.0, "error_percent": {}},
        }
        curves = {"mass_percent": [70.0, 100.0], "torsion_percent": [None, 115.0]}
        return BoundStatements.of_json({"statements": [entry | told], "stiffest": curves}, "bound")

    monkeypatch.setattr("cranktopo.tasks.compare.stage.bounds_for_result", bounds)
    path = tmp_path / "page.html"
    command = ["compare", NAMES[0], str(copied(NAMES[0], tmp_path)), "--baseline", NAMES[0], "--quiet"]
    assert main([*command, "--report", str(path), "--plot", str(tmp_path / "plot.png")]) == 0
    assert len(asked) == 1
    assert set(asked[0]) == {"mass", "torsion", "bending"}
    assert "of at most +8.0 % at this mass" in typed_page(path)
    assert main([*command, "--report", str(path), "--no-bound"]) == 0
    assert len(asked) == 1
    assert "of at most" not in typed_page(path)


def copied(name: str, folder: Path) -> Path:
    """The same design under another name."""
    text = design_text(name)
    path = folder / "copy.toml"
    path.write_text(re.sub("^name = .*$", 'name = "copy"', text, count=1, flags=re.M), encoding="utf-8")
    return path


def test_html(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "page.html"
    assert main(["compare", *NAMES, "--baseline", NAMES[0], "--report", str(path), "--quiet"]) == 0
    assert capsys.readouterr().err == ""
    text = path.read_text(encoding="utf-8")
    assert path.stat().st_size < 8_000_000
    leader = r"opposed-piston-casting is the stiffest in torsion per kilogram: \+20\.0 ±0\.0\d\s% against"
    assert re.search(leader, text)
    assert re.findall(r'data-value="([^"]*)"', text)[:3] == ["2.0", "100.0", "70.0"]
    assert text.count("<option") == 2
    assert "Released by a die" in text
    assert re.search(r"<dt>Lightest</dt>.*?[\d.]+\skg, ", text), "cards tell the mass"
    assert "2 of 2" in text
    assert "less than the error estimate" not in text
    assert "no clear best" not in text
    assert "SHA-256 of the scene" in text
    assert f"Loads: {NAMES[0]}" in text, "whose they are"
    assert "A load counts here by the stress" not in text, "no fatigue was asked for"


@pytest.fixture
def alike(monkeypatch: pytest.MonkeyPatch) -> None:
    """Both weigh the same; the torsional stiffnesses differ by 0.17 N m/rad, the estimate is 0.3 %."""

    def near(target: Target, *_: object) -> Evaluation:
        found = invented(target)
        return replace(found, throw_kg=2.0, fine=replace(found.fine, torsion={"free": 100e3 + found.web_kg}))

    monkeypatch.setattr("cranktopo.tasks.throw_fea.stage.evaluate", near)


@pytest.mark.slow
@pytest.mark.usefixtures("alike")
def test_gain_below_the_error_estimate_is_no_gain(tmp_path: Path) -> None:
    path = tmp_path / "page.md"
    assert main(["compare", *NAMES, "--baseline", NAMES[1], "--report", str(path), "--quiet"]) == 0
    text = path.read_text(encoding="utf-8")
    change = r"\+0\.0\d* \+-0\.0\d % against the baseline's 50 kN m/rad/kg"
    assert re.search(rf"{change}; .*, the baseline itself; they differ by less than the error estimate", text)
    assert "opposed-piston and opposed-piston-casting are level in torsion per kilogram, within the" in text


@pytest.mark.usefixtures("alike")
@pytest.mark.parametrize("baseline", NAMES)
def test_no_star_below_the_error_estimate(baseline: str, capsys: pytest.CaptureFixture[str]) -> None:
    """Bending differs by 29 %, torsion by less than its estimate, whichever of them is the baseline."""
    assert main(["compare", *NAMES, "--baseline", baseline, "--json", "--quiet"]) == 0
    best = json.loads(capsys.readouterr().out)["best"]
    assert best["torsion_kNm_per_rad"] is None
    assert best["torsion_per_mass_kNm_per_rad_kg"] is None
    assert best["bending_kN_per_mm"] == best["bending_per_mass_kN_per_mm_kg"] == NAMES[0]
    assert main(["compare", *NAMES, "--baseline", baseline, "--format", "markdown", "--quiet"]) == 0
    text = capsys.readouterr().out
    assert "| opposed-piston | 2.000* | 100.00 | 70.00* | 0.30 | 0.40 | 50.00 | 35.00* | 5000* |" in text


def test_latex_for_a_thesis(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """A name with an underscore, stars and the note on them; `--report` names the option for LaTeX."""
    path = tmp_path / "own.toml"
    text = design_text(NAMES[1]).replace('name = "opposed-piston-casting"', 'name = "light_casting"')
    path.write_text(text, encoding="utf-8")
    assert '"light_casting"' in text
    assert main(["compare", str(path), "--baseline", NAMES[0], "--format", "latex", "--quiet"]) == 0
    out = capsys.readouterr().out
    assert out.startswith(r"% needs \usepackage{booktabs}")
    assert out.count(r"\begin{tabular}") == out.count(r"\bottomrule") == out.count(r"\end{tabular}") >= 4
    assert r"light\_casting & 1.500\rlap{*} & 90.00 & 50.00 & 0.30 & 0.40 \\" in out
    assert " & kg & kN\\,m/rad & kN/mm & \\% & \\% \\\\" in out
    assert out.rstrip().endswith(
        "A star marks the best of a column, unless another is within the error bound."
    )
    assert main(["compare", str(path), "--baseline", NAMES[0], "--report", "page.tex"]) == 2
    assert "tables for LaTeX come from --format latex > page.tex" in capsys.readouterr().err


@pytest.mark.parametrize("form", ["table", "markdown", "csv", "latex"])
def test_estimates_beside_the_values(form: str, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["compare", *NAMES, "--baseline", NAMES[0], "--format", form, "--quiet"]
    assert main(arguments) == 0
    header, *rest = capsys.readouterr().out.splitlines()
    if form == "latex":
        assert " &  &  &  & torsion & bending \\\\" in rest
        assert sum("0.30 & 0.40" in line for line in rest) == 2
    elif form == "csv":
        names = header.split(",")
        assert names[:6] == [
            "target",
            "mass_kg",
            "torsion_kNm_per_rad",
            "bending_kN_per_mm",
            "torsion_error_percent",
            "bending_error_percent",
        ]
        assert len(set(names)) == len(names)
        assert [line.split(",")[4:6] for line in rest] == [["0.3", "0.4"]] * 2
    else:
        assert "torsion error" in header
        assert "bending error" in header
        assert sum("0.30" in line and "0.40" in line for line in rest) == 2


def test_a_change_has_a_smaller_bound_than_its_values(capsys: pytest.CaptureFixture[str]) -> None:
    """Both values are within 0.3 %, their ratio within a third of it; triangles are within 0.3 % as well."""
    assert main(["compare", *NAMES, "--baseline", NAMES[0], "--json", "--quiet"]) == 0
    base, casting = json.loads(capsys.readouterr().out)["change_error_percent"]
    assert base == {"target": NAMES[0], "torsion": 0.0, "bending": 0.0}
    assert 0 < casting["torsion"] < 0.1
    exact, remeshed = evaluated("a", 90e3, 0.3), replace(evaluated("b", 91e3, 0.3), triangles=True)
    one, other = (
        compare([Entry(exact), Entry(second)], "a")
        for second in (replace(remeshed, triangles=False), remeshed)
    )
    assert one.change_error_percent(1, 0, TORSION) < 0.1
    assert other.change_error_percent(1, 0, TORSION) == 0.3


def test_no_bound_without_a_page_changes_nothing(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["compare", *NAMES, "--baseline", NAMES[0]]) == 0
    plain = capsys.readouterr()
    assert main(["compare", *NAMES, "--baseline", NAMES[0], "--no-bound"]) == 0
    said = capsys.readouterr()
    assert said.out == plain.out
    assert "--no-bound: changes nothing without --plot or --report" in said.err


def test_markdown(tmp_path: Path) -> None:
    path = tmp_path / "page.md"
    assert main(["compare", NAMES[1], "--baseline", NAMES[0], "--report", str(path)]) == 0
    text = path.read_text(encoding="utf-8")
    names = re.findall(r"!\[.*?\]\((.*?)\)", text)
    assert len(names) >= 3
    assert all((tmp_path / name).is_file() for name in names)
    assert "| opposed-piston-casting | 1.500* | 90.00 |" in text
    assert "optimise.process is forged; a die that parts" in text
    assert "set on in the scene" not in text


def test_plot_in_capitals(tmp_path: Path) -> None:
    path = tmp_path / "plot.PNG"
    assert main(["compare", *NAMES, "--baseline", NAMES[0], "--plot", str(path), "--quiet"]) == 0
    assert path.read_bytes().startswith(b"\x89PNG")
    assert list(tmp_path.iterdir()) == [path]


def test_a_longer_engine_is_told_on_page_table_and_in_json(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """It stood in a line between those of progress alone."""
    base, page = designs_folder() / f"{NAMES[0]}.toml", tmp_path / "page.html"
    scene = load_scene(NAMES[0])
    thicker = scene.web.thickness_mm + 1
    text = re.sub(r"(?m)^thickness_mm = .*", f"thickness_mm = {thicker:g}", base.read_text(), count=1)
    thick = tmp_path / "thick.toml"
    thick.write_text(re.sub(r'(?m)^name = ".*"', 'name = "thick"', text, count=1))
    words = ["compare", str(thick), "--baseline", NAMES[0], "--no-bound", "--quiet"]
    assert main([*words, "--report", str(page)]) == 0
    told = f"pitch {scene.pitch_mm + 2:g} mm, {NAMES[0]} has {scene.pitch_mm:g} mm: the engine is longer"
    assert told in " ".join(capsys.readouterr().out.split())
    assert typed_page(page).count(told) == 2, "in the headline and above the table"
    assert main([*words, "--json"]) == 0
    pitches = json.loads(capsys.readouterr().out)["pitch_mm"]
    assert pitches == pytest.approx({NAMES[0]: scene.pitch_mm, "thick": scene.pitch_mm + 2})
    assert main(["compare", NAMES[1], "--baseline", NAMES[0], "--json", "--quiet"]) == 0
    assert "pitch_mm" not in json.loads(capsys.readouterr().out)


@pytest.mark.slow
def test_unlike_halves_have_no_stresses_and_the_page_does_not_advise_them(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """With --stress or without: the page sent its reader to an option that brings nothing."""
    text = (designs_folder() / f"{NAMES[0]}.toml").read_text(encoding="utf-8")
    uneven, page = tmp_path / "uneven.toml", tmp_path / "page.html"
    length = load_scene(NAMES[0]).throw.main_journal.length_mm + 2
    key = f"second_main_journal_length_mm = {length:g}"
    uneven.write_text(text.replace("[throw]\n", f"[throw]\n{key}\n", 1))
    told = (
        "Not solved: both halves of a throw must be alike, and those of opposed-piston are not "
        "(throw.second_main_journal_length_mm)."
    )
    words = ["compare", str(uneven), "--baseline", str(uneven), "--no-bound", "--report", str(page)]
    for more in ([], ["--stress"]):
        assert main([*words, *more]) == 0
        assert told in typed_page(page)
        assert "adds them to this page" not in typed_page(page)
        assert (told.replace("Not solved", "no stresses") in capsys.readouterr().err) == bool(more)


@pytest.fixture
def safeties(monkeypatch: pytest.MonkeyPatch) -> None:
    """Invented safeties by the rule: the casting has 1.05 against 1.3 of the baseline."""

    def checked(target: Target, *_: object) -> tuple[RuleCheck, ...]:
        light = target.name.endswith("casting")
        fillet = {"pin": FilletCheck(200.0, 210.0 if light else 260.0), "journal": FilletCheck(200.0, 400.0)}
        factors, nominal = ConcentrationFactors(2.0, 1.5, 2.0, 3.0, 1.5), Nominal(50.0, 5.0, 20.0, 20.0)
        quality = RuleQuality(0.4, 0.24, 1000, 1.0, 4.0, 1.0, 2.0)
        mass = 1.5 if light else 2.0
        size, loads = dimensions(target.scene), AlternatingLoads(100.0, 1.0, 1.0)
        check = RuleCheck(
            target.name, mass, size, loads, (), factors, factors, nominal, fillet, fillet, quality
        )
        return (check,)

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.stage.check_inputs", lambda *_: None)
    monkeypatch.setattr("cranktopo.tasks.compare.judged.check_inputs", lambda *_: None)
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.stage.check_rule", checked)


@pytest.mark.usefixtures("safeties")
@pytest.mark.parametrize("form", ["table", "markdown", "latex", "csv", "json"])
def test_safety_beside_stiffness(form: str, capsys: pytest.CaptureFixture[str]) -> None:
    arguments = ["compare", *NAMES, "--baseline", NAMES[0], "--fatigue", "m53", "--format", form, "--quiet"]
    assert main(arguments) == 0
    text = capsys.readouterr().out
    verdict = "opposed-piston-casting: -25.0 % mass, -19.2 +-6.5 % safety: less safe than opposed-piston."
    if form == "json":
        found = json.loads(text)
        assert found["best"]["safety"] == NAMES[0]
        assert found["percent_of_baseline"][1]["safety_percent"] == pytest.approx(100 * 1.05 / 1.3)
        assert [entry["safety"] for entry in found["fatigue"]["fatigue"]] == pytest.approx([1.3, 1.05])
        assert found["fatigue"]["method"] == "m53"
    elif form == "csv":
        header, base, casting = text.splitlines()
        column = header.split(",").index("safety")
        assert float(base.split(",")[column]) == pytest.approx(1.3)
        assert float(casting.split(",")[header.split(",").index("safety_percent")]) == pytest.approx(
            80.769, abs=1e-3
        )
    else:
        shown = verdict.replace("%", r"\%") if form == "latex" else verdict
        assert text.rstrip().endswith(shown)
        assert ("1.300\\rlap{*}" if form == "latex" else "1.300*") in text
        assert "80.8" in text


@pytest.mark.usefixtures("safeties")
@pytest.mark.parametrize("loads", ["extremes", "cycle"])
def test_the_safety_is_of_the_loads_that_are_asked_for(
    loads: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    asked, judged_by = list[object](), stage.assess_by_methods

    def assessed(targets: Any, methods: Any, **rest: Any) -> Any:
        asked.append(rest["loads"])
        return judged_by(targets, methods, **rest)

    monkeypatch.setattr("cranktopo.tasks.compare.judged.assess_by_methods", assessed)
    assert main([*BESIDE, "--format", "json", "--loads", loads, "--quiet"]) == 0
    assert asked == [loads]
    assert json.loads(capsys.readouterr().out)["fatigue"]["loads"] == loads


@pytest.mark.usefixtures("safeties")
def test_the_size_in_the_fillets_is_the_one_that_is_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its advice was a smaller --fillet-fraction, which `compare` did not have."""
    asked, checked = list[object](), stage.check_rule

    def check(target: Target, loads: Any, fraction: float) -> Any:
        asked.append(fraction)
        return checked(target, loads, fraction)

    monkeypatch.setattr(stage, "check_rule", check)
    assert main([*BESIDE, "--fillet-fraction", "0.12", "--json", "--quiet"]) == 0
    assert main([*BESIDE, "--json", "--quiet"]) == 0
    assert asked == [0.12, 0.12, RULE_FRACTION, RULE_FRACTION]


@pytest.mark.slow
@pytest.mark.usefixtures("safeties")
def test_safety_on_the_page(tmp_path: Path) -> None:
    path = tmp_path / "page.html"
    assert main(["compare", *NAMES, "--baseline", NAMES[0], "--fatigue", "m53", "--report", str(path)]) == 0
    text = path.read_text(encoding="utf-8")
    assert "Safest against fatigue" in text
    assert "less safe than opposed-piston." in text
    assert "not assessed" not in text


@pytest.mark.usefixtures("safeties")
def test_what_the_rule_does_not_accept_is_said_first(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """In the headline, and on the card where the safest of all is no safer than that."""
    assert main([*BESIDE, "--report", str(tmp_path / "page.html"), "--quiet"]) == 0
    text = typed_page(tmp_path / "page.html")
    failing = (
        "opposed-piston-casting not accepted by UR M53, least Q 1.050, 1.15 asked (pin fillet by elements)"
    )
    assert f"FATIGUE: {failing}. opposed-piston" in text
    assert "opposed-piston not accepted" not in text
    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.rule_check.LEAST_FACTOR", 1.5)
    assert main([*BESIDE, "--report", str(tmp_path / "all.html"), "--quiet"]) == 0
    assert "the baseline itself; not accepted by UR M53" in typed_page(tmp_path / "all.html")


@pytest.fixture
def second_web_open(monkeypatch: pytest.MonkeyPatch, safeties: None) -> None:
    """Invented: of the casting the first web is accepted, the second waits for a finer mesh, as safe."""
    factors, nominal = ConcentrationFactors(2.0, 1.5, 2.0, 3.0, 1.5), Nominal(50.0, 5.0, 20.0, 20.0)
    good = {"pin": FilletCheck(200.0, 280.0), "journal": FilletCheck(200.0, 270.0)}
    less = good | {"pin": FilletCheck(200.0, 276.0)}

    def checked(target: Target, *_: object) -> tuple[RuleCheck, ...]:
        size, loads = dimensions(target.scene), AlternatingLoads(100.0, 1.0, 1.0)
        kept, missed = (RuleQuality(0.4, 0.24, 1000, normal, 4.0, 1.0, 2.0) for normal in (2.0, 3.3))
        first = RuleCheck(target.name, 2.0, size, loads, (), factors, factors, nominal, good, good, kept)
        if not target.name.endswith("casting"):
            weak = good | {"journal": FilletCheck(200.0, 240.0)}
            return (replace(first, rule_checks=weak, fem_checks=weak),)
        first = replace(first, name=f"{target.name}, first web", web="first web")
        second = replace(first, name=f"{target.name}, second web", web="second web")
        return first, replace(second, fem_checks=less, quality=missed)

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.stage.check_rule", checked)


OPEN = (
    "second web, pin fillet: the mesh misses the checks of IACS UR M53: surface-normal stress 3.3 % "
    "(at most 3 %)"
)


@pytest.mark.usefixtures("second_web_open")
@pytest.mark.parametrize("form", ["table", "markdown", "latex", "csv", "json"])
def test_a_throw_has_the_worst_verdict_of_its_webs(form: str, capsys: pytest.CaptureFixture[str]) -> None:
    """The terminal told that of the web with the least factor alone; a file told none."""
    assert main([*BESIDE, "--format", form, "--quiet"]) == 0
    text = " ".join(capsys.readouterr().out.split()).replace("\\%", "%")
    if form == "json":
        found = json.loads(text)
        assert found["verdicts"][NAMES[0]] == {
            "verdict": "accepted",
            "reason": "journal fillet by elements",
        }
        assert found["verdicts"][NAMES[1]]["verdict"] == "not judged"
        assert found["verdicts"][NAMES[1]]["reason"].startswith(OPEN)
        assert found["best"]["safety"] is None, "of one that is judged there is no best"
    elif form == "csv":
        assert f'not judged,"{OPEN}' in text
    else:
        assert (
            f"{NAMES[1]}: not judged by UR M53, least Q 1.350, 1.15 asked (second web, pin fillet: the mesh"
            in text
        )
        assert f"{NAMES[1]}: accepted" not in text
        assert text.endswith(
            "not rated against opposed-piston: the rule does not judge opposed-piston-casting."
        )
        assert "safer than" not in text


@pytest.mark.usefixtures("second_web_open")
def test_the_page_has_the_worst_verdict_too(tmp_path: Path) -> None:
    assert main([*BESIDE, "--report", str(tmp_path / "page.html"), "--quiet"]) == 0
    text = typed_page(tmp_path / "page.html")
    assert text.count(f"{NAMES[1]} not judged by UR M53, least Q 1.350") == 1, "in the headline"
    assert text.count(f"{NAMES[1]}: not judged by UR M53, least Q 1.350") == 1, "under Variants"
    assert "first web: accepted" not in text
    text = " ".join(re.sub("<[^>]*>", " ", text).split())
    assert "Safest against fatigue not compared only opposed-piston was judged: 1.200, the baseline" in text


@pytest.fixture
def half_judged(monkeypatch: pytest.MonkeyPatch, safeties: None) -> list[str]:
    """Names of the targets whose edges are sharp, to be filled by a test."""
    sharp: list[str] = []

    def checked(target: Target, *_: object) -> None:
        if target.name in sharp:
            raise CranktopoError(f"target '{target.name}': a surface file has no true fillets.")

    monkeypatch.setattr("cranktopo.tasks.compare.judged.check_inputs", checked)
    return sharp


BESIDE = ["compare", *NAMES, "--baseline", NAMES[0], "--fatigue", "m53"]
WHY = "opposed-piston-casting: safety not judged: a surface file has no true fillets."


@pytest.mark.parametrize("form", ["table", "markdown", "latex", "csv", "json"])
def test_a_target_without_fillets_has_an_empty_safety(
    form: str, half_judged: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    half_judged.append(NAMES[1])
    assert main([*BESIDE, "--format", form]) == 0
    out, err = capsys.readouterr()
    assert err.count(WHY) == 1
    if form == "json":
        found = json.loads(out)
        assert found["safety_by_method"] == {"m53": {NAMES[0]: pytest.approx(1.3), NAMES[1]: None}}
        assert [row["safety_percent"] for row in found["percent_of_baseline"]] == [100.0, None]
        assert found["not_judged"]["m53"][NAMES[1]].endswith("a surface file has no true fillets.")
        assert found["best"]["safety"] is None
        assert [one["target"] for one in found["fatigue"]["fatigue"]] == [NAMES[0]]
    elif form == "csv":
        own = [row["safety"] for row in csv.DictReader(io.StringIO(out))]
        assert own == ["1.3", ""]
    else:
        assert out.count(WHY) == 1
        assert "1.300*" not in out
        assert "textbf{1.300}" not in out
        last = [line.rstrip(" |\\").split()[-1] for line in out.splitlines() if NAMES[1] in line]
        assert {"latex": "--"}.get(form, "-") in last


def test_a_failing_one_that_is_judged_alone_is_still_bad(half_judged: list[str], tmp_path: Path) -> None:
    """The card starred the only safety as the safest."""
    half_judged.append(NAMES[0])
    page = tmp_path / "page.md"
    assert main([*BESIDE, "--quiet", "--report", str(page)]) == 0
    text = page.read_text(encoding="utf-8")
    said = "only opposed-piston-casting was judged: 1.050, the baseline was not judged; not accepted by"
    assert said in text


@pytest.fixture
def balance_moved(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> Path:
    """Invented: a web that takes 86.4 % of the oscillating mass, where the baseline takes 49.4 %."""

    def moved(target: Target, *_: object) -> Evaluation:
        factor, unbalance = (86.4, -48.2) if target.name == "copy" else (49.4, -34.9)
        found = invented(target)
        return replace(found, balance_factor_percent=factor, unbalance_kg_mm=unbalance)

    monkeypatch.setattr("cranktopo.tasks.throw_fea.stage.evaluate", moved)
    return copied("industrial-gas", tmp_path)


MOVED = "copy: balance factor 86.4 % of the oscillating mass instead of 49.4 % as industrial-gas has."


@pytest.mark.parametrize("form", ["table", "markdown", "latex", "json"])
def test_a_balance_that_moved_is_said_first(
    form: str, balance_moved: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """`optimise` began with it, a comparison of its run was silent."""
    command = ["compare", str(balance_moved), "--baseline", "industrial-gas", "--quiet"]
    assert main([*command, "--format", form]) == 0
    out = capsys.readouterr().out.replace("\\%", "%")
    if form == "json":
        (told,) = json.loads(out)["balance"].items()
        assert told[0] == "copy"
        assert told[1]["balance_factor_percent"] == 86.4
        assert told[1]["original_percent"] == 49.4
        assert "industrial-gas has 49.4 % (unbalance -48.2 and -34.9 kg mm)" in told[1]["told"]
    else:
        first = next(line for line in out.splitlines() if line.strip() and line[0] not in "%\\")
        assert first.startswith(MOVED)


@pytest.mark.slow
def test_the_headline_begins_with_a_balance_that_moved(balance_moved: Path, tmp_path: Path) -> None:
    page = tmp_path / "page.html"
    command = ["compare", str(balance_moved), "--baseline", "industrial-gas", "--quiet"]
    assert main([*command, "--report", str(page)]) == 0
    assert f'class="headline">{MOVED} None is stiffer' in typed_page(page)


def test_goals_and_the_page_without_a_safety(
    tmp_path: Path, half_judged: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """A limit of the safety is unknown, every other one is judged; the page says why."""
    path = tmp_path / "goal.toml"
    goal = '\n[goal]\nminimise = "mass"\nlimits = { fatigue_safety = ">= 1.2", torsion = ">= 40 %" }\n'
    named = design_text(NAMES[1]).replace('name = "opposed-piston-casting"', 'name = "own-casting"')
    path.write_text(named + goal, encoding="utf-8")
    half_judged.append("own-casting")
    page = tmp_path / "page.md"
    command = ["compare", str(path), "--baseline", NAMES[0], "--fatigue", "m53", "--quiet"]
    assert main([*command, "--report", str(page)]) == 0
    out = capsys.readouterr().out
    assert re.search(r"fatigue_safety >= 1\.2 .*unknown", out)
    assert re.search(r"bending >= 70,000 N/mm .*NO", out)
    text = page.read_text(encoding="utf-8")
    assert "own-casting: safety not judged: a surface file has no true fillets." in text


@pytest.mark.slow
def test_a_baseline_that_is_not_judged(
    tmp_path: Path, half_judged: list[str], capsys: pytest.CaptureFixture[str]
) -> None:
    """The others keep their safety, without percent and without verdicts."""
    half_judged.append(NAMES[0])
    page = tmp_path / "page.md"
    assert main([*BESIDE, "--json", "--quiet", "--report", str(page)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["safety_by_method"] == {"m53": {NAMES[0]: None, NAMES[1]: pytest.approx(1.05)}}
    assert [row["safety_percent"] for row in found["percent_of_baseline"]] == [None, None]
    assert found["fatigue"]["baseline"] is None
    text = page.read_text(encoding="utf-8")
    assert "No safety is compared with it." in text
    assert "1.050, the baseline was not judged" in text


def test_no_target_that_can_be_judged(half_judged: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    half_judged.extend(NAMES)
    assert main(BESIDE) == 3
    out, err = capsys.readouterr()
    assert out == ""
    assert "a surface file has no true fillets" in err


def test_sharp_fillets_are_found_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of every target before the first is solved; where all have them nothing is left to judge."""

    def solved(*_: object) -> None:
        raise AssertionError("solved before the inputs were checked")

    monkeypatch.setattr("cranktopo.tasks.throw_fatigue.target_safety.solve_stresses", solved)
    text = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    path = tmp_path / "sharp.toml"
    path.write_text(text.replace("fillet_mm = 2.5", "fillet_mm = 0.0"), encoding="utf-8")
    assert main(["compare", str(path), "--baseline", str(path), "--fatigue", "lsa"]) == 3
    out, err = capsys.readouterr()
    assert out == ""
    assert "fillet_mm = 0" in err


@pytest.fixture
def _nothing_solved(monkeypatch: pytest.MonkeyPatch) -> None:
    def solved(*_: object) -> None:
        raise AssertionError("solved before everything was checked")

    monkeypatch.setattr("cranktopo.tasks.throw_fea.stage.evaluate", solved)


@pytest.mark.usefixtures("_nothing_solved")
@pytest.mark.parametrize(
    ("option", "name"),
    [
        ("--report", "page.pdf"),
        ("--report", "page"),
        ("--report", "absent/page.html"),
        ("--plot", "plot.jpg"),
        ("--plot", "absent/plot.png"),
    ],
)
def test_bad_name_is_refused_before_the_work(
    option: str, name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["compare", *NAMES, "--baseline", NAMES[0], option, str(tmp_path / name)]) == 2
    out, err = capsys.readouterr()
    assert out == ""
    assert len(err.strip().splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


@pytest.mark.usefixtures("_nothing_solved")
def test_differing_supports_are_refused_before_the_work(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    text = (designs_folder() / "opposed-piston.toml").read_text(encoding="utf-8")
    assert 'bending = "pinned"' in text
    path = tmp_path / "spring.toml"
    path.write_text(text.replace('bending = "pinned"', 'bending = "spring"'), encoding="utf-8")
    assert main(["compare", str(path), "--baseline", NAMES[0]]) == 3
    out, err = capsys.readouterr()
    assert out == ""
    assert "different [supports]" in err
    assert "bending 'pinned'; torsion 'free', bending 'spring'" in err


@pytest.fixture
def beside_a_run(
    tmp_path: Path, half_judged: list[str], monkeypatch: pytest.MonkeyPatch
) -> Callable[[Scene], pages.ComparedTargets]:
    """Compare the surface of a run of the first design, and another design, with it."""
    monkeypatch.setattr(pages, "bounds_for_result", lambda *_: NoBound(none="a stand-in"))
    base = resolve_targets([NAMES[0]])[0]
    run = replace(base, name="run", file=tmp_path / "web.stl", run=tmp_path)
    half_judged.append("run")
    return lambda other: pages.compare_targets([run, other], NAMES[0], MeshRequest(), "m53")


def test_goals_beside_a_run_keep_the_limit_of_the_safety(
    beside_a_run: Callable[[Scene], pages.ComparedTargets],
) -> None:
    """All are compared without fillets then, and without fillets a design has no safety to limit."""
    other = with_values(load_scene(NAMES[1]), {"name": "own", "goal": {"minimise": "mass"}})
    limits = beside_a_run(other).comparison.goals["own"].limits
    assert "fatigue_safety" in {limit.quantity for limit in limits}


def test_a_run_of_the_baseline_has_a_bound_and_another_throw_is_told(
    beside_a_run: Callable[[Scene], pages.ComparedTargets], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Planned scenes differ in what is stripped of each; the bound was left out without a word."""
    told: list[str] = []
    monkeypatch.setattr(pages, "note", told.append)
    own = load_scene(NAMES[0])
    alike = with_values(own, {"name": "alike"})
    assert pages.comparison_bound(beside_a_run(alike)) is not None
    assert not any(line.startswith("no bound") for line in told)
    longer = with_values(
        own, {"name": "longer", "throw.crankpin.length_mm": own.throw.crankpin.length_mm + 1}
    )
    assert pages.comparison_bound(beside_a_run(longer)) is None
    assert "no bound: longer has another throw than the baseline" in told
