"""Stresses in a report: how far the colours reach, and what a run keeps."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import trimesh

from cranktopo.base.errors import CranktopoError
from cranktopo.design.schema import Scene
from cranktopo.engine.load_case import LoadCase
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.report.page import Section
from cranktopo.report.viewer.scene3d import Scene3D, ShownBody, quantiles_MPa, stress_scales
from cranktopo.runs.directories import RunStore
from cranktopo.tasks.optimise.run_record import read_run_stress, solve_run_stress
from cranktopo.tasks.throw_fea.section import stress_section
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.unit_fields import CaseStress

TORSION = LoadCase(name="torsion", kind="torsion", torque_Nm=685.7, source="by hand")
BENDING = LoadCase(name="bending", kind="bending", radial_N=32377.0, source="by hand")


def box() -> SurfaceMesh:
    body = trimesh.creation.box(bounds=[[0, 0, 0], [20, 30, 30]])
    return SurfaceMesh(np.asarray(body.vertices, np.float64), np.asarray(body.faces, np.int64))


def along_x(top_MPa: float = 100.0) -> CaseStress:
    """Stress from 0 at x = 0 to the top at x = 20 mm, and half of it in the second case."""
    axes = [np.linspace(0, 20, 41), np.linspace(0, 30, 31), np.linspace(0, 30, 31)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    stress = top_MPa * points[:, 0] / 20
    return CaseStress((TORSION, BENDING), points, np.stack([stress, stress / 2]), False, 1.0)


@pytest.mark.parametrize(("share", "expected"), [(0.5, 50.0), (0.7, 85.0), (0.99, 100.0)])
def test_quantile_counts_area(share: float, expected: float) -> None:
    """Ends of 900 mm2 at 0 and at the top, 2400 mm2 of sides between them."""
    found = quantiles_MPa(box(), along_x(), share)[0]
    assert found == pytest.approx([expected, expected / 2], abs=2.0)


def test_scale_is_that_of_the_most_stressed_body() -> None:
    scales = stress_scales([(box(), along_x(40.0)), (box(), along_x(80.0))])
    assert [scale.top_MPa for scale in scales] == pytest.approx([80.0, 40.0], rel=0.02)
    assert [scale.label for scale in scales] == ["torsion, 685.7 N m", "bending, 32,377 N"]
    assert stress_scales([]) == ()


def section(bodies: int) -> Section:
    bodies_ = tuple(ShownBody(f"box {n}", box(), (10.0, 20.0), 30.0, along_x()) for n in range(bodies))
    stressed = [(body.mesh, body.stress) for body in bodies_ if body.stress]
    return stress_section(Scene3D(bodies_, stress_scales=stress_scales(stressed)), "")


@pytest.mark.parametrize("bodies", [1, 3])
def test_section_has_a_row_and_a_picture_per_case(bodies: int) -> None:
    found = section(bodies)
    assert len(found.tables[0][1].rows) == 2 * bodies
    assert [picture.name for picture in found.pictures] == ["stress-torsion", "stress-bending"]
    assert all(picture.raster and picture.wide == (bodies > 2) for picture in found.pictures)


def test_section_without_stresses_says_how_to_get_them() -> None:
    assert "'cranktopo report RUN --stress'" in stress_section(None, "cranktopo report RUN --stress").text


def test_run_keeps_stresses_of_its_surface_alone(
    tmp_path: Path, mikron: Scene, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked = []

    def solved(target: Target, cases: tuple[LoadCase, ...], **_: object) -> CaseStress:
        asked.append((target.file, [case.kind for case in cases]))
        return along_x()

    monkeypatch.setattr("cranktopo.tasks.optimise.run_record.case_stress", solved)
    run = RunStore(tmp_path)
    (tmp_path / "web.stl").write_bytes(b"one surface")
    assert read_run_stress(run, "web.stl") is None
    solve_run_stress(run, mikron, "web.stl")
    assert asked == [(tmp_path / "web.stl", ["bending", "torsion"])]
    found, expected = read_run_stress(run, "web.stl"), along_x()
    assert found is not None
    assert found.cases == expected.cases
    np.testing.assert_allclose(found.von_mises_MPa, expected.von_mises_MPa, rtol=1e-6)
    (tmp_path / "web.stl").write_bytes(b"another surface")
    assert read_run_stress(run, "web.stl") is None
    (tmp_path / "stress.npz").write_bytes(json.dumps({"no": "zip"}).encode())
    with pytest.raises(CranktopoError, match="corrupted"):
        read_run_stress(run, "web.stl")
