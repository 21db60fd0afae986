"""`cranktopo iterate` as a user runs it, every stage real: two steps on coarse cells, then the shape."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import pytest
import trimesh

from cranktopo.app.main import main
from tests.step_volume import step_volume_mm3

KG_PER_MM3 = 7850e-9
"""Of steel, as the design has it."""


@pytest.mark.slow
def test_two_steps(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """Solids that are closed and weigh what the table says, and a last web that is evaluated alike alone."""
    out = tmp_path / "loop"
    arguments = ["mikron-iiic-plain", "--steps", "2", "--resolution-mm", "4.5", "--out", str(out)]
    assert main(["iterate", *arguments, "--json"]) == 0
    data: dict[str, Any] = json.loads(capsys.readouterr().out)
    assert json.loads((out / "iterate.json").read_text(encoding="utf-8"))["steps"] == data["steps"]
    with (out / "steps.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert [row["step"] for row in rows] == ["original", "1", "2", "shape"]
    for row, name in zip(rows[:3], ("original", "step-01", "step-02"), strict=True):
        check_mass(row, out / name)
    original, first, last, _ = (float(row["throw_kg"]) for row in rows)
    assert last < first
    assert original < first, "the envelope is larger than the original web"
    for folder, step in (("step-02", data["steps"][2]), ("shape", data["steps"][3])):
        assert main(["evaluate", str(out / folder / "web.toml"), "--json"]) == 0
        (alone,) = json.loads(capsys.readouterr().out)["evaluations"]
        for case, unit in (("torsion", "Nm_per_rad"), ("bending", "N_per_mm")):
            stiffness = alone[case][f"{alone['supports'][case]}_{unit}"]
            assert stiffness == pytest.approx(step[f"{case}_{unit}"], rel=1e-6)
    shape = json.loads((out / "shape" / "shape.json").read_text(encoding="utf-8"))
    assert shape["values"]["original"]["torsion"] == pytest.approx(data["steps"][0]["torsion_Nm_per_rad"])
    assert data["shape"]["better_than_best_step"]
    assert data["steps"][3]["percent_of_original"]["torsion_per_mass"] > 115.0
    assert main(["runs", "show", str(out)]) == 0
    assert f"ended: {data['stop_reason']}" in capsys.readouterr().out


def check_mass(row: dict[str, str], folder: Path) -> None:
    """Masses of a row against the volume of the STEP and of the closed STLs, whose facets are 2 mm long."""
    half, web = (trimesh.load_mesh(folder / name) for name in ("web.stl", "web_only.stl"))
    for mesh in (half, web):
        assert mesh.is_watertight
        assert mesh.is_winding_consistent
        assert len(mesh.split()) == 1
    throw_kg, web_kg = float(row["throw_kg"]), float(row["web_kg"])
    assert 2 * KG_PER_MM3 * step_volume_mm3(folder / "web.step") == pytest.approx(throw_kg, rel=1e-6)
    assert 2 * KG_PER_MM3 * half.volume == pytest.approx(throw_kg, rel=3e-3)
    assert KG_PER_MM3 * web.volume == pytest.approx(web_kg, rel=3e-3)
