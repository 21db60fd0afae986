"""`cranktopo evaluate --sensitivities` on a coarse mesh: what it prints, and what it refuses."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import ExitCode
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.writing import toml_text
from cranktopo.tasks.refit.family import web_of
from tests.cli.test_shape_target import run_of
from tests.physics.shape.shape_cases import solid_web


@pytest.fixture(scope="module")
def file(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A parametric web without an engine, and with a tolerance of its own."""
    scene, layout, values = solid_web()
    data = scene.model_dump(mode="json", exclude={"published", "engine"}, exclude_none=True)
    web = web_of(layout, values, scene)
    data |= {"web": web, "name": "fitted", "shape": {"tolerance_mm": 0.3}}
    path = tmp_path_factory.mktemp("scene") / "fitted.toml"
    path.write_text(toml_text(scene_from_dict(data), "web"))
    return path


def test_the_table_and_its_json(file: Path, capsys: Any) -> None:
    arguments = ["evaluate", str(file), "--sensitivities", "--element-size-mm", "16"]
    assert main([*arguments, "--json"]) == ExitCode.DONE
    out, err = capsys.readouterr()
    (entry,) = json.loads(out)["evaluations"]
    told = entry["sensitivities"]
    names = [row["name"] for row in told["parameters"]]
    assert names[:3] == ["y_low", "y_high", "half_width_1"]
    first = told["parameters"][0]
    assert (first["unit"], first["at_bound"], first["held_by"]) == ("mm", None, [])
    assert first["value"] == pytest.approx(-42.0, abs=5e-3)
    assert first["per_unit"]["mass_percent"] < 0  # the lower end moved up is less mass
    assert "fatigue_safety_percent" not in first["per_unit"]
    assert "no fatigue safety in the table" in err
    assert told["worst_case_percent"]["tolerance"] == 0.3
    total = sum(abs(row["per_unit"]["torsion_percent"]) for row in told["parameters"])
    assert told["worst_case_percent"]["torsion"] == pytest.approx(0.3 * total)


def test_a_web_that_is_not_parametric_is_refused(capsys: Any) -> None:
    assert main(["evaluate", "mikron-iiic-plain", "--sensitivities"]) == ExitCode.INVALID_INPUT
    error = capsys.readouterr().err
    assert "web.outline = 'obround'" in error
    assert "cranktopo shape mikron-iiic-plain" in error


def test_a_run_without_a_remodel_is_refused(tmp_path: Path, capsys: Any) -> None:
    run = run_of("optimise", tmp_path / "run", solid_web()[0])
    assert main(["evaluate", str(run.path), "--sensitivities"]) == ExitCode.INVALID_INPUT
    assert f"cranktopo remodel {run.path}" in capsys.readouterr().err
