"""`cranktopo sweep` and `cranktopo.sweep`: rows, files, errors, kills and resumption."""

from __future__ import annotations

import csv
import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pandas as pd
import pytest

from cranktopo import sweep
from cranktopo.cli.main import main
from cranktopo.errors import CranktopoError, ExitCode
from tests import sweep_cases
from tests.sweep_cases import TRACE

WIDTH, FILLET = "web.width_mm", "throw.crankpin.fillet_mm"


@pytest.fixture(scope="module")
def scheduler() -> Iterator[str]:
    """A Dask scheduler with two workers in this process: what costs least to start."""
    import logging

    from distributed import LocalCluster

    with LocalCluster(
        n_workers=2,
        threads_per_worker=1,
        processes=False,
        protocol="tcp",
        dashboard_address=None,
        silence_logs=logging.CRITICAL,
    ) as cluster:
        yield cluster.scheduler_address


@pytest.fixture
def trace(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """File with a line for every point that was computed."""
    path = tmp_path / "trace"
    path.touch()
    monkeypatch.setenv(TRACE, str(path))
    return path


def swept(scheduler: str, out: Path, **settings: Any) -> pd.DataFrame:
    return sweep(scheduler=scheduler, out=out, **{"function": sweep_cases.empty, **settings})


def test_table_front_and_files(scheduler: str, tmp_path: Path, trace: Path) -> None:
    out, lines = tmp_path / "out", list[str]()
    vary = {WIDTH: [50, 52, 3], FILLET: [2.0, 2.5]}
    frame = swept(scheduler, out, vary=vary, info=lines.append)
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
    assert any(line.startswith("dashboard: http") for line in lines)


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
        swept(scheduler, tmp_path / "out", vary={WIDTH: [1, 2]})
    assert not (tmp_path / "out").exists()


def test_no_scheduler_is_said(tmp_path: Path) -> None:
    with pytest.raises(CranktopoError, match="cannot be reached") as raised:
        sweep(
            vary={WIDTH: [50, 52]}, scheduler="nonsense://1", out=tmp_path / "out", function=sweep_cases.empty
        )
    assert raised.value.code == ExitCode.INVALID_INPUT


def test_a_sweep_of_evaluations(scheduler: str, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    """The same numbers as `evaluate` gives; `runs show` takes the directory."""
    out, coarse = tmp_path / "out", ["--element-size-mm", "14"]
    words = ["sweep", "--vary", f"{WIDTH}=52", *coarse, "--out", str(out), "--scheduler", scheduler, "--json"]
    assert main(words) == 0
    data = json.loads(capfd.readouterr().out)
    (point,) = data["points"]
    assert data["picks"]["lightest that is no softer"] == point["id"]
    assert main(["evaluate", str(out / point["run"] / point["target"]), *coarse, "--json"]) == 0
    (entry,) = json.loads(capfd.readouterr().out)["evaluations"]
    assert entry["mass_kg"]["throw"] == point["mass_kg"]
    assert entry["torsion"]["free_Nm_per_rad"] == point["torsion_Nm_per_rad"]
    assert entry["bending"]["pinned_N_per_mm"] == point["bending_N_per_mm"]
    assert main(["runs", "show", str(out)]) == 0
    assert "1 points: 1 done" in capfd.readouterr().out
