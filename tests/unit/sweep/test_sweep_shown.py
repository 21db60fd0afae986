"""Units of a sweep: readers see kN m/rad and kN/mm as everywhere, files keep their names."""

from __future__ import annotations

import json
import re
from pathlib import Path

import pytest

from cranktopo.design.loading import load_scene
from cranktopo.tasks.sweep.fineness import Fineness
from cranktopo.tasks.sweep.page import sweep_html
from cranktopo.tasks.sweep.plan import sweep_plan
from cranktopo.tasks.sweep.points import balance_line, points_of
from cranktopo.tasks.sweep.result import SweepFiles, SweepResult, SweepSeconds
from cranktopo.tasks.sweep.stages import run_stage
from cranktopo.tasks.sweep.text import frame_of, safety_words, sweep_summary
from cranktopo.tasks.sweep.variation import read_option
from cranktopo.tasks.web_shape import run as shape_run
from tests.shape_stand_in import LESS_SAFE_IN_SHAFT, ShapeStandIn
from tests.sweep_cases import point_result

NUMBERS = {
    "mass_kg": 2.0,
    "torsion_Nm_per_rad": 134_390.0,
    "bending_N_per_mm": 216_300.0,
    "torsion_per_mass_Nm_per_rad_kg": 67_195.0,
    "bound_torsion_Nm_per_rad": 150_000.0,
}
KEY = "supports.bearing_stiffness_N_per_mm"


def sweep() -> SweepResult:
    """One point, whose varied key is a stiffness too."""
    point = point_result("a", varied={KEY: 50_000.0}, design="d", stage="evaluate", **NUMBERS)
    return SweepResult(
        run="run",
        design="d",
        varied=(KEY,),
        sampling="grid",
        points=(point,),
        ends={"done": 1},
        original=point,
        objectives={"mass_kg": "less", "torsion_Nm_per_rad": "more"},
        front=("a",),
        picks={"lightest": "a"},
        files=SweepFiles(table="table.csv", parquet="table.parquet", page="report.html"),
        seconds=SweepSeconds(total=1.0),
    )


def test_the_terminal_has_the_units_of_every_table() -> None:
    text = sweep_summary(sweep(), Path("run"))
    assert "Pareto front of mass, torsion: 1 points" in text
    assert re.search(r"kg\s+kN m/rad\s+kN/mm", text)
    assert re.search(r"2\.000\s+134\.39\s+216\.30", text)
    assert f"{KEY} = 50000" in text, "a key of the scene stays in its unit"


def test_the_page_has_them_too() -> None:
    data = json.loads(
        re.findall(r"<script[^>]*application/json[^>]*>(.*?)</script>", sweep_html(sweep(), {}))[0]
    )
    found = {
        column["name"]: (column["unit"], row, column["bound"])
        for column, row in zip(data["columns"], data["rows"][0], strict=True)
    }
    assert found["torsion_Nm_per_rad"] == ("kN m/rad", 134.39, 150.0)
    assert found["bending_N_per_mm"] == ("kN/mm", 216.3, None)
    assert found["torsion_per_mass_Nm_per_rad_kg"][1] == 67.195
    assert found[KEY][:2] == ("N/mm", 50_000.0)


def test_the_page_tells_a_balance_that_moved_above_the_picks() -> None:
    """The line was on stderr alone, where nobody sees it who opens the page later."""
    plan = sweep_plan(["car-diesel"], [read_option("web.width_mm=62,70,78")])
    line = balance_line(plan, points_of(plan))
    page = sweep_html(sweep().model_copy(update={"balance": line}), {})
    told = f'<p class="headline">B{line[1:]}.</p>'
    assert line
    assert told in page
    assert page.index(told) < page.index('class="pick"')
    assert "balance factor" not in sweep_html(sweep(), {})


def test_webs_without_fillets_are_told() -> None:
    one = sweep()
    surface = one.points[0].model_copy(update={"stage": "optimise"})
    bare, mixed = (
        one.model_copy(update={"points": points}) for points in ((surface,), (*one.points, surface))
    )
    assert "All webs, the original among them, are without fillets" in sweep_summary(bare, Path("run"))
    assert "Points of the stage optimise are without fillets" in sweep_html(mixed, {})
    assert "fillets" not in sweep_summary(one, Path("run"))


def test_files_keep_names_and_units() -> None:
    one = sweep()
    frame = frame_of(one.points, one.original)
    assert frame["torsion_Nm_per_rad"][0] == 134_390.0
    assert frame["bending_N_per_mm"][0] == 216_300.0
    assert one.as_json()["points"][0]["torsion_Nm_per_rad"] == 134_390.0


def test_the_original_is_a_row_and_only_once() -> None:
    own, other = (point_result(name, design="d", mass_kg=mass) for name, mass in (("o", 2.0), ("a", 1.9)))
    for points, told in (((other,), [True, False]), ((other, own), [False, True])):
        frame = frame_of(points, own)
        assert frame["original"].tolist() == told
        assert frame["mass_kg"][told.index(True)] == 2.0


def test_a_web_that_loses_safety_in_its_shaft_says_so_beside_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    stand_in = ShapeStandIn(more={"shaft_check": LESS_SAFE_IN_SHAFT})
    monkeypatch.setattr(shape_run, "shape_design", stand_in.design)
    monkeypatch.setattr("cranktopo.tasks.sweep.stages.web_view", lambda *_: "")
    told = run_stage("shape", load_scene("mikron-iiic-plain"), tmp_path, Fineness())
    assert (told["safety_in_shaft"], told["safety_in_shaft_of_original"]) == (1.086, 1.267)
    numbers = {"less_safe_in_shaft": told["less_safe_in_shaft"], "fatigue_place": "pin fillet"}
    words = safety_words(point_result("a", fatigue_safety=1.2, **numbers))
    assert words.startswith(
        ", least fatigue safety 1.200 at pin fillet; LESS SAFE IN ITS SHAFT: 1.086 (web 8"
    )
