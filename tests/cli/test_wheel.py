"""The wheel: what is in it, and the main job run from it in a fresh environment, far from the checkout."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import zipfile
from pathlib import Path

import pytest

CHECKOUT = Path(__file__).resolve().parents[2]
CONSTRAINTS = CHECKOUT / ".ci" / "lock.txt"


def call(*command: str | Path, folder: Path) -> str:
    """Standard output of a command that must end well, without a variable that leads to the checkout."""
    environment = {key: value for key, value in os.environ.items() if not key.startswith("PYTHON")}
    done = subprocess.run(
        [str(part) for part in command],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == 0, f"{command}\n{done.stdout}\n{done.stderr}"
    return done.stdout


@pytest.fixture(scope="module")
def wheel(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("wheel")
    call(sys.executable, "-m", "pip", "wheel", "-q", "--no-deps", "-w", folder, CHECKOUT, folder=folder)
    (built,) = folder.glob("cranktopo-*.whl")
    return built


@pytest.mark.slow
def test_wheel_holds_code_designs_and_data(wheel: Path) -> None:
    with zipfile.ZipFile(wheel) as archive:
        packed = {name for name in archive.namelist() if ".dist-info/" not in name}
    kept = [CHECKOUT / "cranktopo", CHECKOUT / "designs"]
    wanted = {
        str(path.relative_to(CHECKOUT)).replace(
            "designs/", "cranktopo/designs/", path.is_relative_to(kept[1])
        )
        for folder in kept
        for path in folder.rglob("*")
        if path.is_file() and "__pycache__" not in path.parts
    }
    assert packed == wanted
    assert {"cranktopo/designs/mikron-iiic-plain.toml", "cranktopo/design/materials.toml"} <= packed
    assert "cranktopo/report/viewer/viewer.js" in packed


@pytest.mark.slow
def test_main_job_runs_from_an_installed_wheel(wheel: Path, tmp_path: Path) -> None:
    """With the declared dependencies alone, in an empty folder: optimise, report, built-in designs, STEP."""
    call(sys.executable, "-m", "venv", tmp_path / "venv", folder=tmp_path)
    python, here = tmp_path / "venv" / "bin" / "python", tmp_path / "empty"
    here.mkdir()
    call(python, "-m", "pip", "install", "-q", "-c", CONSTRAINTS, wheel, folder=here)
    program = python.with_name("cranktopo")
    where = call(python, "-c", "import cranktopo; print(cranktopo.__file__)", folder=here)
    assert Path(where.strip()).is_relative_to(tmp_path / "venv")
    text = call(program, "optimise", "--resolution-mm", "4", "--json", folder=here)
    metrics = json.loads(text)
    assert metrics["status"] == "converged"
    run = here / "runs" / metrics["run"]
    assert (run / "web.stl").stat().st_size > 10_000
    assert "data:image/png" in (run / "report.html").read_text(encoding="utf-8")
    assert metrics["original_web"]["gain_of_stiffness_per_mass_percent"]["torsion"] > 5
    call(program, "designs", "copy", "mikron-iiic-plain", "mine.toml", folder=here)
    assert call(program, "export", "mine.toml", "throw.step", folder=here).startswith("throw.step: throw, ")
    assert (here / "throw.step").read_text(encoding="utf-8").startswith("ISO-10303-21;")
    assert sorted(path.name for path in here.iterdir()) == ["mine.toml", "runs", "throw.step"]
