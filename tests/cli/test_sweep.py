"""`cranktopo sweep` and `cranktopo.sweep`: rows, files, errors and resumption."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pandas as pd
import pytest

from cranktopo import sweep
from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import redirected
from cranktopo.design.loading import load_scene
from cranktopo.tasks.compare.picks import with_picks
from cranktopo.tasks.sweep.result import SweepResult
from cranktopo.tasks.sweep.run import SweptRun
from tests import sweep_cases
from tests.packed_scenes import small_web
from tests.sweep_cases import FILLET, WIDTH


def swept(scheduler: str, out: Path, **settings: Any) -> pd.DataFrame:
    return sweep(scheduler=scheduler, out=out, **{"function": sweep_cases.empty, **settings})


def test_table_front_and_files(scheduler: str, tmp_path: Path, trace: Path) -> None:
    out, lines = tmp_path / "out", list[str]()
    vary = {WIDTH: [50, 52, 3], FILLET: [2.0, 2.5]}
    with redirected(lines.append):
        frame = swept(scheduler, out, design="mikron-iiic-plain", vary=vary)
    assert frame["status"].tolist() == ["done"] * 4 + ["impossible"] * 2
    assert frame["mass_kg"].tolist()[:4] == pytest.approx([50 / 30, 50 / 30, 52 / 30, 52 / 30])
    assert frame[FILLET].tolist() == [2.0, 2.5] * 3
    assert frame["on_front"].tolist() == [True, False, True, False, False, False]
    assert frame["reason"].str.contains("bore_diameter_mm").tolist() == [False] * 4 + [True] * 2
    assert len(trace.read_text().splitlines()) == 4, "the original is one of the points"
    data = json.loads((out / "sweep.json").read_text())
    assert (data["schema_version"], data["varied"], data["ends"]) == (
        1,
        [WIDTH, FILLET],
        {"done": 4, "impossible": 2},
    )
    assert data["original"]["varied"] == {WIDTH: 50.0, FILLET: 2.5}
    assert [p["id"] for p in data["points"] if p["id"] in data["front"]] == frame["id"][
        frame["on_front"]
    ].tolist()
    assert all((out / point["run"] / "point.json").is_file() for point in data["points"][:4])
    pd.testing.assert_frame_equal(pd.read_parquet(out / "table.parquet"), frame, check_like=False)
    with (out / "table.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [row["sha256"] for row in rows] == frame["sha256"].tolist()
    assert {row["version"] for row in rows} == {data["points"][0]["version"]}
    assert any(line.startswith("scheduler: tcp") for line in lines)


def test_a_balance_that_moved_is_in_the_files(scheduler: str, tmp_path: Path, trace: Path) -> None:
    swept(scheduler, tmp_path / "out", design="car-diesel", vary={WIDTH: [62, 78]})
    told = json.loads((tmp_path / "out" / "sweep.json").read_text())["balance"]
    assert told.startswith("balance factors of ")
    assert f"B{told[1:]}." in (tmp_path / "out" / "report.html").read_text()


def test_resuming_repeats_nothing(scheduler: str, tmp_path: Path, trace: Path) -> None:
    out = tmp_path / "out"
    first = swept(scheduler, out, vary={WIDTH: "48:54:4"})
    calls = len(trace.read_text().splitlines())
    lost = out / first["run"][2]
    (lost / "point.json").unlink()
    for file in ("sweep.json", "table.csv", "table.parquet", "report.html"):
        (out / file).unlink()
    again = sweep(scheduler=scheduler, resume=out, function=sweep_cases.empty)
    assert len(trace.read_text().splitlines()) == calls + 1
    pd.testing.assert_frame_equal(first.drop(columns="seconds"), again.drop(columns="seconds"))
    with pytest.raises(CranktopoError, match=r"was started with .*empty"):
        sweep(scheduler=scheduler, resume=out)
    with pytest.raises(CranktopoError, match="exists and is not empty"):
        swept(scheduler, out, vary={WIDTH: [50]})


def test_what_fails_is_a_row(scheduler: str, tmp_path: Path) -> None:
    """A web that cannot be and a failed solve are ends; a defect is tried again by --resume."""
    out = tmp_path / "out"
    frame = swept(scheduler, out, vary={WIDTH: [50, 51, 52, 53]}, function=sweep_cases.failing)
    assert frame["status"].tolist() == ["done", "failed", "impossible", "failed"]
    assert frame["reason"].tolist() == [
        "",
        "the solver failed.",
        "no such web.",
        "ZeroDivisionError: a defect",
    ]
    assert [(out / run / "point.json").is_file() for run in frame["run"]] == [True, True, True, False]


def test_nothing_is_written_where_no_point_can_be(scheduler: str, tmp_path: Path) -> None:
    with pytest.raises(CranktopoError, match="no point of the sweep can be: throw"):
        swept(scheduler, tmp_path / "out", design="mikron-iiic-plain", vary={WIDTH: [1, 2]})
    assert not (tmp_path / "out").exists()


def test_no_scheduler_is_said(tmp_path: Path) -> None:
    with pytest.raises(CranktopoError, match="cannot be reached") as raised:
        sweep(
            vary={WIDTH: [50, 52]}, scheduler="nonsense://1", out=tmp_path / "out", function=sweep_cases.empty
        )
    assert raised.value.code == ExitCode.INVALID_INPUT
    assert not (tmp_path / "out").exists()


def test_a_sweep_of_evaluations(scheduler: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """The same numbers as `evaluate` gives; `runs show` and `compare` take the directory."""
    out, coarse = tmp_path / "out", ["--element-size-mm", "14"]
    words = ["sweep", "--vary", f"{WIDTH}=50", *coarse, "--out", str(out), "--scheduler", scheduler, "--json"]
    assert main(words) == 0
    data = json.loads(capfd.readouterr().out)
    (point,) = data["points"]
    web = small_web(json.loads((out / point["run"] / "point.json").read_text())["view"])
    density = load_scene("mikron-iiic-plain").material.density_kg_m3
    assert 2 * web.volume_mm3 * density * 1e-9 == pytest.approx(point["mass_kg"], rel=0.02)
    assert "view" not in point, "only the page shows it"
    assert 'id="viewer"' in (out / "report.html").read_text()
    assert data["picks"]["lightest that is no softer"] == point["id"]
    file = out / point["run"] / point["target"]
    assert with_picks(["mikron-iiic-plain", str(out)]) == ["mikron-iiic-plain", str(file)]
    assert main(["evaluate", str(file), *coarse, "--json"]) == 0
    (entry,) = json.loads(capfd.readouterr().out)["evaluations"]
    assert entry["target"] == f"mikron-iiic-{point['id']}"
    assert entry["mass_kg"]["throw"] == point["mass_kg"]
    assert entry["torsion"]["free_Nm_per_rad"] == point["torsion_Nm_per_rad"]
    assert entry["bending"]["pinned_N_per_mm"] == point["bending_N_per_mm"]
    assert main(["runs", "show", str(out)]) == 0
    assert "1 points: 1 done" in capfd.readouterr().out


@pytest.mark.slow
def test_only_what_may_be_on_the_front_is_refined(scheduler: str, tmp_path: Path) -> None:
    """Softer steel is beaten, clearly or within the error bound; front and picks are those of full accuracy.

    `python -m pytest -m slow tests/cli/test_sweep.py -n 0 -k refined`, some seconds.
    """
    size, vary = {"element_size_mm": 14.0}, {"material.E_GPa": [200, 209.9, 210]}
    place = {"scheduler": scheduler, "vary": vary, **size}
    whole = sweep(out=tmp_path / "all", **place)
    out = tmp_path / "front"
    frame = sweep(out=out, refine="front", **place)
    full = frame["accuracy"] == "full"
    assert full.tolist() == [False, True, True]
    assert frame["on_front"].tolist() == [False, False, True]
    assert frame.loc[full, "id"].tolist() == whole.loc[full, "id"].tolist()
    assert frame.loc[full, "torsion_Nm_per_rad"].tolist() == whole.loc[full, "torsion_Nm_per_rad"].tolist()
    assert (frame.attrs["front"], frame.attrs["picks"]) == (whole.attrs["front"], whole.attrs["picks"])
    assert frame["torsion_Nm_per_rad"][0] > 1.001 * whole["torsion_Nm_per_rad"][0], "coarse is too stiff"
    kept = {file: file.stat().st_mtime_ns for file in out.glob("points/*/point.json")}
    again = sweep(resume=out, scheduler=scheduler)
    assert {file: file.stat().st_mtime_ns for file in out.glob("points/*/point.json")} == kept
    pd.testing.assert_frame_equal(frame, again)


def test_an_interrupted_sweep_says_how_to_go_on(scheduler: str, tmp_path: Path) -> None:
    def interrupted(line: str) -> None:
        if line.startswith("scheduler"):
            raise KeyboardInterrupt

    out = tmp_path / "out"
    advice = f"cranktopo sweep --resume {out}"
    with redirected(interrupted), pytest.raises(CranktopoError, match=advice) as raised:
        swept(scheduler, out, vary={WIDTH: [50, 52]})
    assert raised.value.code == ExitCode.INTERRUPTED
    assert (
        sweep(resume=out, scheduler=scheduler, function=sweep_cases.empty)["status"].tolist() == ["done"] * 2
    )


def test_a_sweep_without_a_possible_point_fails(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    """Webs that turn out to be impossible when they are computed, not when the plan is read."""
    swept_points = SimpleNamespace(points=[SimpleNamespace(status="impossible", reason="no web.")])
    done = SweptRun(tmp_path, cast(SweepResult, swept_points))
    monkeypatch.setattr("cranktopo.tasks.sweep.run.run_sweep", lambda *_: done)
    monkeypatch.setattr("cranktopo.tasks.sweep.text.sweep_summary", lambda *_: "1 points")
    assert main(["sweep", "mikron-iiic-plain", "--vary", f"{WIDTH}=50,51"]) == ExitCode.INVALID_INPUT
    assert "no point of the sweep is possible; the first: no web." in capsys.readouterr().err
