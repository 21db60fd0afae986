"""What varies in a sweep, and the points that follow from it."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.design.loading import scene_from_dict
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.sweep.job import Job, keep_result, kept_result, point_result
from cranktopo.tasks.sweep.plan import SweepPlan, is_plan, read_plan, sweep_plan
from cranktopo.tasks.sweep.points import balance_line, original_of, pitch_line, points_of
from cranktopo.tasks.sweep.variation import read_entry, read_option

WIDTH, FILLET = "web.width_mm", "throw.crankpin.fillet_mm"


@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("optimise.volume_fraction=0.2:0.4:5", (0.2, 0.25, 0.3, 0.35, 0.4)),
        (f"{FILLET}=2,2.5,3", (2, 2.5, 3)),
        ("engine.speed_rpm=1000:3000:3", (1000, 2000, 3000)),
        ("engine.speed_rpm=1000:2000:4", (1000.0, 1333.33333333, 1666.66666667, 2000.0)),
        ("goal.limits.torsion=>= 90 %,>= 100 %", (">= 90 %", ">= 100 %")),
        ("goal.limits.torsion=>= 90:100:3 %", (">= 90 %", ">= 95 %", ">= 100 %")),
        ("goal.limits.unbalance=<= -1.5:1.5:3 kg mm", ("<= -1.5 kg mm", "<= 0 kg mm", "<= 1.5 kg mm")),
        ("optimise.connected=true", (True,)),
    ],
)
def test_values_of_an_option(text: str, values: tuple[object, ...]) -> None:
    assert read_option(text).values == values


@pytest.mark.parametrize(
    "text",
    [
        "",
        "=1",
        WIDTH,
        f"{WIDTH}=",
        f"{WIDTH}=1:2:1",
        f"{WIDTH}=1:2:1.5",
        f"{WIDTH}=2:1",
        f"{WIDTH}=50,inf",
        "goal.limits.torsion=>= 90:80:1 %",
        "a..b=1",
        "a[x]=1",
    ],
)
def test_other_forms_are_refused(text: str) -> None:
    with pytest.raises(CranktopoError, match=r"must be|below the second"):
        read_option(text)


def test_a_grid_takes_all_combinations_once_each() -> None:
    plan = sweep_plan(
        ["mikron-iiic-plain"], [read_option(f"{WIDTH}=50,52"), read_option(f"{FILLET}=2,2.5,2")]
    )
    points = points_of(plan)
    assert [tuple(point.varied.values()) for point in points] == [(50, 2), (50, 2.5), (52, 2), (52, 2.5)]
    assert len({point.id for point in points}) == 4
    assert points[1].sha256 == original_of(plan).sha256, "the design's own values are the original"
    assert points_of(SweepPlan.of_json(plan.as_json(), "run")) == points


@pytest.mark.parametrize(
    ("stages", "fillets"), [(("optimise",), "off"), (("remodel",), "auto"), (("optimise", "remodel"), "auto")]
)
def test_the_original_has_fillets_where_the_points_have(stages: tuple[str, ...], fillets: str) -> None:
    """Surfaces of runs have none: beside 2 % stiffer fillets they looked softer than they are."""
    vary = [read_option("optimise.volume_fraction=0.3,0.4"), read_option(f"stage={','.join(stages)}")]
    original = original_of(sweep_plan(["mikron-iiic-plain"], vary))
    assert scene_from_dict(original.tables, "original").effects.fillets == fillets


def test_the_hash_is_that_of_the_scene_and_the_settings() -> None:
    def first(width: str = "52", stage: str = "evaluate", element_size_mm: float | None = None) -> str:
        vary = [read_option(f"{WIDTH}={width}")]
        plan = sweep_plan(["mikron-iiic-plain"], vary, stage=stage, element_size_mm=element_size_mm)
        return points_of(plan)[0].sha256

    assert first() == first(width="52.0")
    usual = sweep_plan(["mikron-iiic-plain"], [read_option("optimise.penalty=3")])
    assert points_of(usual)[0].sha256 == original_of(usual).sha256, "a default that is written out"
    assert len({first(), first(width="53"), first(stage="fatigue"), first(element_size_mm=9.0)}) == 4


def test_a_limit_with_a_range_varies_and_one_without_stays() -> None:
    limits = ["torsion >= 90:130:5 %", "bending >= 95 %"]
    plan = sweep_plan(["mikron-iiic-plain"], stage="shape", minimise="mass", limits=limits)
    points = points_of(SweepPlan.of_json(plan.as_json(), "run"))
    assert [p.varied for p in points] == [
        {"goal.limits.torsion": f">= {n} %"} for n in (90, 100, 110, 120, 130)
    ]
    assert points[1].tables["goal"] == {
        "minimise": "mass",
        "limits": {"bending": ">= 95 %", "torsion": ">= 100 %"},
    }
    with pytest.raises(CranktopoError, match="stage evaluate has no goal"):
        sweep_plan(["mikron-iiic-plain"], minimise="mass", limits=limits)
    with pytest.raises(CranktopoError, match="Did you mean 'torsion'"):
        sweep_plan(["mikron-iiic-plain"], stage="shape", minimise="mass", limits=["torsoin >= 90:130:5 %"])


def test_a_first_look_has_hashes_of_its_own() -> None:
    plan = sweep_plan(
        ["mikron-iiic-plain"], [read_option(f"{WIDTH}=50,52")], accuracy_percent=0.5, refine="front"
    )
    looks = points_of(plan, fineness=plan.fineness.first_look)
    plain = sweep_plan(["mikron-iiic-plain"], [read_option(f"{WIDTH}=50,52")])
    assert len({p.id for p in (*points_of(plan), *looks, *points_of(plain))}) == 6
    assert points_of(plain)[0].id == "0a4ac7e01d6d", "points of earlier sweeps keep their names"
    with pytest.raises(CranktopoError, match="--refine front"):
        sweep_plan(["mikron-iiic-plain"], [read_option(f"{WIDTH}=50,52")], budget_s=60.0)


def test_the_pitch_stays_where_it_is_asked_for() -> None:
    def swept(keep: str) -> SweepPlan:
        vary = [read_option("web.thickness_mm=19,21,60")]
        return sweep_plan(["mikron-iiic-plain"], vary, keep=keep)

    free, kept = ([point.tables for point in points_of(swept(keep))] for keep in ("journals", "pitch"))
    lengths = [tables["throw"]["main_journal"]["length_mm"] for tables in (*free[:2], *kept[:2])]
    assert lengths == pytest.approx([lengths[0], lengths[0], lengths[0], lengths[0] - 4])
    same, longer = (scene_from_dict(tables, "x").pitch_mm for tables in (kept[1], free[1]))
    assert (same, longer) == pytest.approx((scene_from_dict(free[0], "x").pitch_mm, same + 4))
    impossible = points_of(swept("pitch"))[2]
    assert "throw.main_journal.length_mm" in impossible.reason
    told = [pitch_line(plan, points_of(plan)) for plan in map(swept, ("journals", "pitch"))]
    assert told[0].startswith(
        f"pitch of the throws {same:g} to {same + 82:g} mm, the original has {same:g} mm"
    )
    assert told[1] == "", "nothing is told of a pitch that stays"
    with pytest.raises(CranktopoError, match="the pitch decides it"):
        sweep_plan(["mikron-iiic-plain"], [read_option("throw.main_journal.length_mm=40,42")], keep="pitch")


def test_points_that_are_balanced_otherwise_are_told() -> None:
    """By the closed form of each point; where nothing moves or no counterweight is, nothing is said."""
    swept = sweep_plan(["car-diesel"], [read_option("web.width_mm=62,70,78")])
    points = points_of(swept)
    factors = [throw_balance(scene_from_dict(one.tables, "x")).balance_factor_percent for one in points]
    low, high = min(factors), max(factors)
    assert high - low > 2
    assert balance_line(swept, points).startswith(f"balance factors of {low:.3g} to {high:.3g} % of the")
    for design, vary in (("car-diesel", "material.E_GPa=200,210"), ("mikron-iiic", "web.width_mm=48,52")):
        other = sweep_plan([design], [read_option(vary)])
        assert balance_line(other, points_of(other)) == ""


def test_impossible_webs_are_points_with_a_reason() -> None:
    good, thin, word = points_of(sweep_plan(["mikron-iiic-plain"], [read_option(f"{WIDTH}=52,3,wide")]))
    assert (good.reason, thin.reason.split(" =")[0]) == ("", "throw.main_journal.bore_diameter_mm")
    assert "web.width_mm = 'wide': must be a finite number" in word.reason


@pytest.mark.parametrize(
    ("vary", "words"),
    [
        ("web.widht_mm=1", "unknown key web.widht_mm. Did you mean 'width_mm'?"),
        ("web.pocket[2].y_mm=1", r"no entry \[2\]; the design has 0"),
        ("throw.radius_mm.x=1", "which is no table"),
        ("stage=evaluate,shap", "Did you mean 'shape'?"),
        (f"{WIDTH}=44:60", "two ends and no number"),
    ],
)
def test_what_no_scene_has_stops_everything(vary: str, words: str) -> None:
    with pytest.raises(CranktopoError, match=words.replace("?", r"\?")):
        sweep_plan(["mikron-iiic-plain"], [read_option(vary)])


@pytest.mark.parametrize("sampling", ["latin", "sobol"])
def test_samples_fill_the_space_between_the_ends(sampling: str) -> None:
    """One sample in each eighth of the width, every fillet about as often; the same again."""
    vary = [read_option(f"{WIDTH}=44:60"), read_option(f"{FILLET}=2,2.5")]
    plan = sweep_plan(["mikron-iiic-plain"], vary, sampling=sampling, samples=8)
    points = points_of(plan)
    assert sorted(int((float(p.varied[WIDTH]) - 44) / 2) for p in points) == list(range(8))
    assert [p.varied[FILLET] for p in points].count(2) == 4
    assert points == points_of(plan)
    assert points[:5] != points_of(sweep_plan(["mikron-iiic-plain"], vary, sampling=sampling, samples=5))[:4]


def test_a_file_says_the_same_as_options(tmp_path: Path) -> None:
    file = tmp_path / "sweep.toml"
    file.write_text(
        'design = "mikron-iiic-plain"\nstage = "fatigue"\nelement_size_mm = 9\n'
        f'[vary]\n"{WIDTH}" = "50:54:3"\nthrow.crankpin.fillet_mm = [2.0, 2.5]\n'
    )
    vary = [read_entry(WIDTH, [50, 52, 54]), read_entry(FILLET, [2.0, 2.5])]
    assert is_plan(str(file))
    assert points_of(read_plan(file)) == points_of(
        sweep_plan(["mikron-iiic-plain"], vary, stage="fatigue", element_size_mm=9.0)
    )
    assert not is_plan("mikron-iiic-plain")


def test_a_file_may_list_scenes_beside_it(tmp_path: Path) -> None:
    for name, width in (("a", 50.0), ("b", 52.0)):
        (tmp_path / f"{name}.toml").write_text(
            Path("designs/mikron-iiic-plain.toml")
            .read_text()
            .replace("width_mm = 50.0", f"width_mm = {width}")
        )
    file = tmp_path / "sweep.toml"
    file.write_text('scenes = ["a.toml", "b.toml"]\n')
    points = points_of(read_plan(file))
    assert [Path(point.design).name for point in points] == ["a.toml", "b.toml"]
    assert original_of(read_plan(file)).sha256 == points[0].sha256


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("vary = 3\ndesign = 'mikron-iiic-plain'\n", "vary = 3: must be a table"),
        ("design = 'mikron-iiic-plain'\nscenes = []\n", "either design or scenes"),
        ("desing = 'x'\nvary = {}\n", "Did you mean 'design'"),
        ("design = 'mikron-iiic-plain'\nsamples = 'x'\n", "samples = 'x': must be an integer"),
        ("design = 'mikron-iiic-plain'\nsampling = 'sobol'\n", "needs a number of samples"),
        ("design = 'mikron-iiic-plain'\nelement_size_mm = -1\n", "element_size_mm = -1: must be a number"),
        ("design = 'mikron-iiic-plain'\nlimits = 'mass'\n", "limits = 'mass': must be a list"),
        ("design = 'mikron-iiic-plain'\nrefine = 'frnt'\n", "Did you mean 'front'"),
    ],
)
def test_bad_files_say_what_is_wrong(tmp_path: Path, text: str, words: str) -> None:
    file = tmp_path / "sweep.toml"
    file.write_text(text)
    with pytest.raises(CranktopoError, match=words) as raised:
        read_plan(file)
    assert raised.value.code in (ExitCode.INVALID_INPUT, ExitCode.USAGE)


@pytest.mark.parametrize("damage", ["other", "empty", "cut", "leads out", "number", "unsealed", "none"])
def test_a_point_that_was_damaged_is_computed_again(tmp_path: Path, damage: str) -> None:
    plan = sweep_plan(["mikron-iiic-plain"], [read_option(f"{WIDTH}=50,52")])
    job, other = (Job(point, str(tmp_path)) for point in points_of(plan))
    told = point_result(job, "done", mass_kg=1.0, target="web.toml")
    keep_result(job, told)
    file = job.folder / "point.json"
    text = file.read_text()
    content = {
        "other": json.dumps(point_result(other, "done", mass_kg=2.0).as_json()),
        "empty": "{}",
        "cut": text[:40],
        "leads out": text.replace("web.toml", "../../x.toml"),
        "number": text.replace('"mass_kg": 1.0', '"mass_kg": 0.5'),
        "unsealed": json.dumps(told.as_json()),
        "none": text,
    }[damage]
    file.write_text(content)
    assert kept_result(job) == (told if damage == "none" else None)
    keep_result(job, told)
    assert kept_result(job) == told
