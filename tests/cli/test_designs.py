"""`cranktopo designs`, and targets that a copied design makes alike."""

from __future__ import annotations

import json
import re
import shlex
from collections.abc import Sequence
from pathlib import Path

import pytest

from cranktopo.app.main import main
from cranktopo.design.loading import builtin_designs, designs_folder, load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine import starting_gas
from cranktopo.runs.directories import create_run
from cranktopo.tasks.throw_fea.targets import resolve_target, resolve_targets
from tests.cli.test_run_scene import with_files


def test_list_names_every_built_in_design(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["designs", "list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert [line.split()[0] for line in lines if not line.startswith(" ")] == builtin_designs()
    assert main(["designs", "list", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)["designs"]
    assert found[0] == {
        "name": builtin_designs()[0],
        "description": load_scene(builtin_designs()[0]).description,
    }


def test_without_a_word_they_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["designs"]) == 0
    listed = capsys.readouterr().out
    assert main(["designs", "list"]) == 0
    assert listed == capsys.readouterr().out
    assert "mikron-iiic" in listed


def test_a_new_large_engine_says_what_its_strength_holds_for(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    line = ["designs", "new", str(tmp_path / "six.toml"), "--bore-mm", "320", "--material", "34CrNiMo6"]
    assert main(line) == 0
    assert (
        "material: ultimate_MPa = 1100 of 34CrNiMo6 is that of sections to 40 mm" in capsys.readouterr().out
    )


@pytest.mark.parametrize("name", builtin_designs())
def test_copy_is_the_design_under_its_own_name(name: str, tmp_path: Path) -> None:
    path = tmp_path / "my-engine.toml"
    assert main(["designs", "copy", name, str(path)]) == 0
    original, copy = load_scene(name), load_scene(str(path))
    assert copy == original.model_copy(update={"name": "my-engine", "published": None})


@pytest.mark.parametrize(
    ("stem", "name"),
    [
        ("my engine", "my-engine"),
        ("-wide (2)", "wide-2"),
        ("a.b_c", "a.b_c"),
        ("für 2", "f-r-2"),
    ],
)
def test_copy_has_a_name_that_is_allowed(
    stem: str, name: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / f"{stem}.toml"
    assert main(["designs", "copy", "--", "mikron-iiic-plain", str(path)]) == 0
    command = shlex.split(capsys.readouterr().out.strip().partition("for example: ")[2])
    assert command == ["cranktopo", "compare", str(path), "--baseline", "mikron-iiic-plain"]
    assert load_scene(str(path)) == load_scene("mikron-iiic-plain").model_copy(update={"name": name})


def test_copy_is_named_whatever_the_quotes(tmp_path: Path) -> None:
    """The top-level name in single quotes, and a table that has a name of its own."""
    text = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    (tmp_path / "one.toml").write_text(
        text.replace('name = "mikron-iiic-plain"', "name='one'"), encoding="utf-8"
    )
    assert main(["designs", "copy", str(tmp_path / "one.toml"), str(tmp_path / "two.toml")]) == 0
    assert load_scene(str(tmp_path / "two.toml")) == load_scene("mikron-iiic-plain").model_copy(
        update={"name": "two"}
    )


def test_copy_finds_the_files_of_the_original(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    design = with_files(tmp_path / "made")
    (tmp_path / "other").mkdir()
    monkeypatch.chdir(tmp_path)
    for place in ("other/copy.toml", "made/copy.toml", "copy.toml"):
        assert main(["designs", "copy", "made/engine.toml", place]) == 0
        assert load_scene(place) == load_scene(str(design)).model_copy(update={"name": "copy"})
    assert "indicator_csv = 'p.csv'" in Path("made/copy.toml").read_text(encoding="utf-8")


def test_copy_refuses_what_it_cannot_do(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = tmp_path / "mine.toml"
    path.write_text("mine", encoding="utf-8")
    for arguments, words in (
        (["mikron-iiic-plain", str(path)], "exists. Give --force"),
        (["mikron-iic", str(tmp_path / "other.toml")], "Did you mean 'mikron-iiic'?"),
        (["mikron-iiic-plain", str(tmp_path / "other.txt")], "must end in .toml"),
        (["mikron-iiic-plain", str(tmp_path / "(+).toml")], "no name of a design can be made of '(+)'"),
        (["mikron-iiic-plain", str(tmp_path / "none" / "other.toml")], "its folder does not exist"),
    ):
        assert main(["designs", "copy", *arguments]) in (2, 3)
        assert words in capsys.readouterr().err
    assert path.read_text() == "mine"
    assert [p.name for p in tmp_path.iterdir()] == ["mine.toml"]


def test_targets_of_one_name_are_told_apart(tmp_path: Path) -> None:
    """A design copied by hand keeps its name: the file's name tells it from the original."""
    path = tmp_path / "wider.toml"
    main(["designs", "copy", "mikron-iiic-plain", str(path)])
    path.write_text(
        path.read_text().replace('name = "wider"', 'name = "mikron-iiic-plain"'), encoding="utf-8"
    )
    assert [target.name for target in resolve_targets(["mikron-iiic-plain", str(path)])] == [
        "mikron-iiic-plain",
        "wider",
    ]


def test_run_is_a_target_by_its_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    scene = load_scene("mikron-iiic-plain")
    main(["designs", "copy", "mikron-iiic-plain", "own.toml"])
    run = create_run(
        design="own",
        design_toml=Path("own.toml").read_text(),
        scene=scene.model_dump(mode="json"),
        options={},
        command=["cranktopo"],
        inputs={},
        out=None,
    )
    (run.path / "web.stl").write_bytes(b"solid")
    found = resolve_target(run.name[:12])
    assert found.file is not None
    assert found.file.resolve() == (run.path / "web.stl").resolve()


def test_new_design_is_valid_and_named_after_its_file(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "my engine.toml"
    assert main(["designs", "new", str(path)]) == 0
    assert load_scene(str(path)).name == "my-engine"
    command = shlex.split(capsys.readouterr().out.strip().partition("for example: ")[2])
    assert command[0] == "cranktopo"
    assert main(command[1:]) == 0


def test_new_design_takes_a_name_and_no_place_that_is_taken(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "a.toml"
    assert main(["designs", "new", str(path), "--name", "wide-2"]) == 0
    assert load_scene(str(path)).name == "wide-2"
    before = path.read_text(encoding="utf-8")
    assert main(["designs", "new", str(path)]) == 2
    assert "exists. Give --force" in capsys.readouterr().err
    assert path.read_text(encoding="utf-8") == before
    assert main(["designs", "new", str(tmp_path / "b.toml"), "--name", "two words"]) == 3
    assert not (tmp_path / "b.toml").exists()


def test_copy_keeps_comments_and_order(tmp_path: Path) -> None:
    """Line by line what was written, but for the name and what was published."""
    text = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    (tmp_path / "one.toml").write_text(text, encoding="utf-8")
    assert main(["designs", "copy", str(tmp_path / "one.toml"), str(tmp_path / "two.toml")]) == 0
    copied = (tmp_path / "two.toml").read_text(encoding="utf-8")
    assert copied == text.replace('name = "mikron-iiic-plain"', 'name = "two"')


def test_new_design_of_a_layout(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Firing order, throws and proportions are proposed; every command takes the file."""
    path = tmp_path / "eight.toml"
    assert main(["designs", "new", str(path), "--layout", "V", "--cylinders", "8", "--bore-mm", "86"]) == 0
    first, gas, strength, last = capsys.readouterr().out.splitlines()
    assert strength.startswith("material: ultimate_MPa")
    assert first.startswith("assumed: firing order 1-3-7-2-6-5-4-8, every 90 deg")
    assert gas.startswith("assumed: peak 7 MPa at 12 deg, intake 0.101 MPa")
    assert last.startswith(str(path))
    engine = load_scene(str(path)).engine
    assert engine is not None
    assert (engine.bore_mm, engine.throws, engine.bank_angle_deg) == (86.0, 4, 90.0)
    assert "all of them assumed" in " ".join(path.read_text(encoding="utf-8").replace("#", "").split())
    assert main(["balance", str(path), "--json"]) == 0


SIX = ["--cylinders", "6", "--bore-mm", "320", "--stroke-mm", "480", "--speed-rpm", "750"]


def test_a_charge_that_a_power_needs_is_told(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """An intake above ambient pressure, with the power that the same peak gives without it."""
    path, words = tmp_path / "twin.toml", "--layout V --cylinders 2 --bore-mm 76.2 --stroke-mm 96.8"
    asked = f"{words} --speed-rpm 5000 --peak-pressure-MPa 5.5 --power-kW 38"
    assert main(["designs", "new", str(path), *asked.split()]) == 0
    gas = next(line for line in capsys.readouterr().out.splitlines() if "intake" in line)
    told = re.search(r"that of a charged engine: without a charge this peak gives (\S+) kW", gas)
    assert told
    text = re.sub(r"(?m)^(intake|exhaust)_pressure_MPa = .*$", "", path.read_text(encoding="utf-8"))
    path.write_text(text, encoding="utf-8")
    assert main(["loads", str(path), "--json"]) == 0
    power = json.loads(capsys.readouterr().out)["indicated_power_kW"]
    assert power == pytest.approx(float(told[1]), rel=1e-3)


TWIN = ["--layout", "V", "--cylinders", "2", "--bore-mm", "98", "--stroke-mm", "66", "--speed-rpm", "10000"]


@pytest.mark.slow
def test_a_power_at_a_peak_is_had_wherever_neighbours_have_it(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """The intake grows with the peak, without a gap; air is no charge; a hint does what it says."""
    more = ["--rod-length-mm", "124", "--compression-ratio", "12", "--power-kW", "115"]
    asked, intakes = [*TWIN, *more, "--peak-pressure-MPa"], list[float]()
    for number, peak in enumerate((7.8, 7.9, 8.0, 8.4, 9.0)):
        assert main(["designs", "new", str(tmp_path / f"{number}.toml"), *asked, f"{peak}"]) == 0
        told = capsys.readouterr().out
        (intake,) = re.findall(r"intake (\S+) MPa", told)
        intakes.append(float(intake))
        assert ("charged engine" in told) == (intakes[-1] > 1.05 * 0.1013)
        assert "burn duration 60 deg: 115 kW" in told
    assert intakes == sorted(intakes)
    assert main(["designs", "new", str(tmp_path / "low.toml"), *asked, "7.5"]) == 3
    hint = re.search(r"A peak pressure of (\S+) MPa .--peak-pressure-MPa. would do", capsys.readouterr().err)
    assert hint
    assert main(["designs", "new", str(tmp_path / "low.toml"), *asked, hint[1]]) == 0
    assert "115 kW" in capsys.readouterr().out


def test_a_hint_tries_few_peaks(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Each takes a second: a search in steps of a percent kept a refusal waiting for a minute."""
    tried, at_peak = list[float](), starting_gas._at_peak

    def counted(scene: Scene, mean: float, peak: float, ratios: Sequence[float]) -> object:
        tried.append(peak)
        return at_peak(scene, mean, peak, ratios)

    monkeypatch.setattr(starting_gas, "_at_peak", counted)
    asked = [*TWIN, "--rod-length-mm", "124", "--compression-ratio", "12", "--peak-pressure-MPa", "8"]
    assert main(["designs", "new", str(tmp_path / "never.toml"), *asked, "--power-kW", "900"]) == 3
    assert len(tried) <= 4


def test_new_design_of_a_power(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Whatever gives the power is said, and that nobody looked at strength."""
    path = tmp_path / "six.toml"
    power = ["--peak-pressure-MPa", "20", "--power-kW", "3150", "--material", "34CrNiMo6"]
    assert main(["designs", "new", str(path), *SIX, *power]) == 0
    assert "compression ratio 17, burn duration 30 deg: 3150 kW at 750 rpm" in capsys.readouterr().out
    scene = load_scene(str(path))
    assert scene.material.name == "34CrNiMo6"
    assert "strength is not checked" in " ".join(path.read_text(encoding="utf-8").replace("#", "").split())


@pytest.mark.parametrize(("cylinders", "bank"), [(2, 45), (6, 60), (8, 60)])
def test_new_design_of_a_compression_and_a_bank_angle(
    cylinders: int, bank: float, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """Both are in the file, and in the power; the throws stay those of the usual crank of such a V."""
    usual, own = str(tmp_path / "usual.toml"), str(tmp_path / "own.toml")
    new = ["designs", "new", "--layout", "V", "--cylinders", str(cylinders)]
    assert (
        main([*new, usual])
        == main([*new, own, "--compression-ratio", "12.5", "--bank-angle-deg", str(bank)])
        == 0
    )
    out = capsys.readouterr().out
    assert f"banks {bank} deg apart" in out
    assert "compression ratio 12.5" in out
    before, now = load_scene(usual).engine, load_scene(own).engine
    assert before is not None
    assert now is not None
    assert now.gas is not None
    assert (now.gas.compression_ratio, now.bank_angle_deg) == (12.5, bank)
    assert now.throw_angles_deg == before.throw_angles_deg
    assert now.firing_angles_deg[-1] != before.firing_angles_deg[-1]


def test_new_design_of_a_power_keeps_the_compression_that_is_known(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    known = ["--peak-pressure-MPa", "20", "--power-kW", "4000", "--compression-ratio", "14.5"]
    assert main(["designs", "new", str(tmp_path / "six.toml"), *SIX, *known]) == 0
    assert "compression ratio 14.5, burn duration" in capsys.readouterr().out
    more = [*SIX, *known[:2], "--power-kW", "9000", *known[4:]]
    assert main(["designs", "new", str(tmp_path / "more.toml"), *more]) == 3
    assert "compression ratio 14.5, burn duration 20 to 60 deg" in capsys.readouterr().err


@pytest.mark.slow
def test_new_design_of_much_power(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """More than engines in series have is said, more than the pressure gives is refused."""
    strong = [*SIX, "--peak-pressure-MPa", "25", "--power-kW", "6000"]
    assert main(["designs", "new", str(tmp_path / "strong.toml"), *strong]) == 0
    assert "is more than engines in series have (3.5 MPa): look at power" in capsys.readouterr().out
    more = [*SIX, "--peak-pressure-MPa", "20", "--power-kW", "9000"]
    assert main(["designs", "new", str(tmp_path / "more.toml"), *more]) == 3
    hint = re.search(r"A peak pressure of (\S+) MPa .--peak-pressure-MPa. would do", capsys.readouterr().err)
    assert hint
    assert main(["designs", "new", str(tmp_path / "more.toml"), *more[:-3], hint[1], *more[-2:]]) == 0


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["--layout", "V", "--cylinders", "14"], "known: 2, 4, 6, 8, 10, 12"),
        (["--layout", "boxxer"], "Did you mean 'boxer'?"),
        (["--bank-angle-deg", "60"], "--bank-angle-deg: layout 'single' has no banks"),
        (["--layout", "boxer", "--bank-angle-deg", "180"], "give --layout V"),
        (["--layout", "V", "--bank-angle-deg", "181"], "must be a number >= 1 and <= 180"),
        (["--compression-ratio", "1"], "must be a number >= 1.5 and <= 40"),
        (["--cylinders", "7"], "no firing order is known for layout 'in-line'"),
    ],
)
def test_new_design_of_an_unknown_layout(
    arguments: list[str], words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["designs", "new", str(tmp_path / "mine.toml"), *arguments]) == 2
    assert words in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []
