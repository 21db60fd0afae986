"""`cranktopo extract`: every iteration of a run, every format, bad input."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest
import trimesh

from cranktopo.app.main import main
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.runs.checkpoint import load_checkpoint, load_iteration
from tests.plain_runs import plain_runs

Capture = pytest.CaptureFixture[str]
ITERATIONS = 3


@pytest.fixture(scope="module")
def run(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A free topology, whose first design is uniform; a die with draft bounds even that one."""
    out = tmp_path_factory.mktemp("runs") / "short"
    arguments = ["--resolution-mm", "4.5", "--max-iterations", str(ITERATIONS), "--out", str(out)]
    with plain_runs():
        assert main(["optimise", "--volume-fraction", "0.3", "--process", "free", *arguments]) == 5
    return out


def extract(capsys: Capture, *arguments: str) -> dict:
    capsys.readouterr()
    assert main(["extract", *arguments, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.slow
def test_the_last_design_is_the_run_s_surface_bit_for_bit(run: Path, capsys: Capture) -> None:
    found = extract(capsys, str(run))
    path = Path(found["files"]["stl"])
    assert path == run / "surface" / f"iteration-{ITERATIONS:04d}.stl"
    assert path.read_bytes() == (run / "web.stl").read_bytes()
    metrics = json.loads((run / "metrics.json").read_text())
    assert found["iteration"] == metrics["iterations"]
    assert found["mass_kg"]["web"] == pytest.approx(metrics["mass_kg"]["web"], rel=1e-3)
    surface = found["surface"]
    assert surface["iso_value"] == metrics["surface"]["iso_value"]
    assert abs(surface["web_volume_error_percent"]) < 0.5
    assert 0 <= surface["distance_to_iso_surface_mm"]["mean"] < 0.1 * 4.5
    assert surface["minimum_member_mm"] > 0
    assert 0 < surface["minimum_member_cells"] < surface["minimum_member_mm"]


@pytest.mark.slow
def test_stored_designs_are_small_and_true(run: Path) -> None:
    x, beta = load_iteration(run, ITERATIONS)
    saved = load_checkpoint(run / "checkpoint" / "state.npz")
    assert beta == saved.state["history"][-1]["beta"]
    assert np.abs(x - saved.arrays["evaluated"]).max() <= 2.5e-4
    assert (run / "density" / f"iteration-{ITERATIONS:04d}.npz").stat().st_size < 2 * x.size + 1000


@pytest.mark.parametrize(
    "iteration", [2, *(pytest.param(later, marks=pytest.mark.slow) for later in range(3, ITERATIONS + 1))]
)
def test_every_design_has_a_surface(run: Path, iteration: int, tmp_path: Path, capsys: Capture) -> None:
    out = tmp_path / "web.stl"
    found = extract(capsys, str(run), "--iteration", str(iteration), "--out", str(out))
    mesh = trimesh.load_mesh(out)
    assert mesh.is_watertight
    assert 2 * mesh.volume * 7850e-9 == pytest.approx(found["mass_kg"]["throw"], rel=1e-6)
    np.testing.assert_allclose(mesh.bounds[:, 2], [0.0, 57.0], atol=1e-4)
    journal = mesh.vertices[mesh.vertices[:, 2] < 20 - 1e-3]
    radius = np.hypot(journal[:, 0], journal[:, 1])
    assert np.minimum(np.abs(radius - 21), np.abs(radius - 12)).max() < 1e-3


@pytest.mark.slow
def test_stored_design_gives_the_surface_of_the_exact_one(run: Path, tmp_path: Path, capsys: Capture) -> None:
    found = extract(capsys, str(run), "--iteration", str(ITERATIONS), "--out", str(tmp_path / "half.stl"))
    exact = extract(capsys, str(run))
    assert found["mass_kg"]["web"] == pytest.approx(exact["mass_kg"]["web"], rel=2e-4)
    iso = (found["surface"]["iso_value"], exact["surface"]["iso_value"])
    assert iso[0] == pytest.approx(iso[1], abs=2e-3)


def test_gmsh_reads_the_surface(run: Path) -> None:
    with cad_session("web") as gmsh:
        gmsh.merge(str(run / "web.stl"))
        triangles = len(gmsh.model.mesh.getElements(2)[1][0])
    assert triangles == len(trimesh.load_mesh(run / "web.stl").faces)


def test_formats(run: Path, tmp_path: Path, capsys: Capture) -> None:
    glb = trimesh.load_mesh(extract(capsys, str(run), "--out", str(tmp_path / "web.glb"))["files"]["glb"])
    stl = trimesh.load_mesh(run / "web.stl")
    np.testing.assert_allclose(1000 * glb.bounds, stl.bounds, rtol=1e-5, atol=1e-3)


@pytest.mark.slow
def test_a_format_beside_the_run(run: Path, capsys: Capture) -> None:
    found = extract(capsys, str(run), "--format", "3mf")
    assert Path(found["files"]["3mf"]).read_bytes().startswith(b"PK")


def test_bad_use(run: Path, tmp_path: Path, capsys: Capture) -> None:
    def fails(code: int, *arguments: str) -> str:
        capsys.readouterr()
        assert main(["extract", *arguments]) == code
        captured = capsys.readouterr()
        assert captured.out == ""
        assert len(captured.err.splitlines()) == 1
        return captured.err

    taken = tmp_path / "taken.stl"
    taken.write_text("kept")
    assert "exists" in fails(2, str(run), "--out", str(taken))
    assert taken.read_text() == "kept"
    assert "must end in .stl, .3mf or .glb" in fails(2, str(run), "--out", str(tmp_path / "web.obj"))
    assert "must end in .3mf" in fails(2, str(run), "--format", "3mf", "--out", str(tmp_path / "web.stl"))
    assert "folder does not exist" in fails(2, str(run), "--out", str(tmp_path / "no" / "web.stl"))
    assert f"holds iterations 1 to {ITERATIONS}" in fails(3, str(run), "--iteration", "99")
    assert "not a run directory" in fails(3, str(tmp_path))
    assert "too grey" in fails(6, str(run), "--iteration", "1")  # the uniform start has no surface


def test_a_run_without_density(run: Path, tmp_path: Path, capsys: Capture) -> None:
    bare = tmp_path / "bare"
    shutil.copytree(run, bare, ignore=shutil.ignore_patterns("checkpoint", "density", ".lock"))
    assert main(["extract", str(bare)]) == 3
    assert "holds no density (checkpoint missing)" in capsys.readouterr().err
    assert main(["extract", str(bare), "--iteration", "2"]) == 3
    assert "holds no density of any iteration" in capsys.readouterr().err
    damaged = tmp_path / "damaged"
    shutil.copytree(run, damaged)
    (damaged / "density" / "iteration-0003.npz").write_bytes(b"PK rubbish")
    assert main(["extract", str(damaged), "--iteration", "3"]) == 3
    assert "corrupted" in capsys.readouterr().err
