"""Flying web by elements: bars of closed form, CalculiX, the whole bay between two bearings, convergence."""

from __future__ import annotations

import json
import shutil
from math import pi, radians
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from scipy.spatial import cKDTree

from cranktopo.app.main import main
from cranktopo.base.frames import about_z_deg
from cranktopo.bodies.mesh.flying_mesh import mesh_flying_web
from cranktopo.bodies.solid.crankshaft import add_crankshaft
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.flying_web import FlyingWeb, flying_webs, web_at_a_bearing
from cranktopo.design.loading import load_scene, one_web, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.writing import save_scene
from cranktopo.engine.one_throw import one_throw
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.numerics.tetrahedra.cad_mesh import extract_mesh
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, assemble
from cranktopo.numerics.tetrahedra.mesh import TetMesh
from cranktopo.tasks.throw_fea.condense import torsional_stiffness_Nm_per_rad
from cranktopo.tasks.throw_fea.flying_web import condensed, evaluate_flying_web, principal_bending
from cranktopo.tasks.throw_fea.stage import MeshRequest, evaluate_target
from tests.physics.engine.test_crank_bearings import FLYING, mikron
from tests.physics.fea import calculix

YOUNGS = 2e5
LENGTH = 60.0


def bar(add: Any, size: float) -> TetMesh:
    """Mesh of a bar from z = 0 to LENGTH."""
    with cad_session("bar") as gmsh:
        gmsh.model.occ.rotate([(3, add(gmsh.model.occ))], 0, 0, 0, 0, 0, 1, radians(about_z_deg(30.0)))
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", size)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        return extract_mesh(gmsh, mirrored=False)


def test_a_round_bar_beside_the_axis() -> None:
    """G J / L under a free torque; guided, the same and the bar clamped at both ends, carried around."""
    radius, offset = 6.0, 30.0
    mesh = bar(lambda occ: occ.addCylinder(0, offset, 0, 0, 0, LENGTH, radius), 4.0)
    block = condensed(assemble(mesh, YOUNGS, 0.0), LENGTH)
    polar = pi * radius**4 / 2
    twist = YOUNGS / 2 * polar / LENGTH
    assert torsional_stiffness_Nm_per_rad(block, "free") == pytest.approx(twist / 1e3, rel=2e-3)
    bend, area = YOUNGS * polar / 2, pi * radius**2
    shear = 12 * bend / (6 / 7 * YOUNGS / 2 * area * LENGTH**2)
    guided = twist + offset**2 * 12 * bend / (LENGTH**3 * (1 + shear))
    assert torsional_stiffness_Nm_per_rad(block, "held") == pytest.approx(guided / 1e3, rel=5e-3)
    assert [one.stiffness_Nm_per_rad for one in principal_bending(block)] == pytest.approx(
        [bend / LENGTH / 1e3] * 2, rel=2e-3
    )


def test_a_flat_bar_has_its_principal_axes() -> None:
    """Turned by 30 deg in the sense of rotation: soft about the axis across its thinner side."""
    wide, thin = 16.0, 8.0
    mesh = bar(lambda occ: occ.addBox(-wide / 2, 20.0 - thin / 2, 0, wide, thin, LENGTH), 5.0)
    soft, stiff = principal_bending(condensed(assemble(mesh, YOUNGS, 0.0), LENGTH))
    assert soft.stiffness_Nm_per_rad == pytest.approx(YOUNGS * wide * thin**3 / 12 / LENGTH / 1e3, rel=1e-6)
    assert stiff.stiffness_Nm_per_rad == pytest.approx(YOUNGS * thin * wide**3 / 12 / LENGTH / 1e3, rel=1e-6)
    assert (soft.axis_deg, stiff.axis_deg) == pytest.approx((120.0, 30.0), abs=1e-3)


def crank(turn_deg: float = 180.0, **web: Any) -> Scene:
    """Two throws between two bearings, joined by a flying web."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    data["web"] |= web
    data["engine"] |= {"cylinders": 2, "firing_order": [1, 2]}
    data["engine"]["arrangement"] = {"throw_angles_deg": [0.0, turn_deg]}
    journals = [{"number": 1, "length_mm": 0.0}]
    return scene_from_dict({**data, "crank": {"bearings": [0, 2], "main_journal": journals}}, "two")


def test_flying_webs_of_a_crank() -> None:
    four = mikron(bearings=[0, 2, 4], main_journal=FLYING)
    (one,) = flying_webs(four)
    assert (one.turn_deg, one.length_mm) == (180.0, 74.0)
    assert one.name.endswith("flying web between throws 1 and 2")
    assert [web_at_a_bearing(throw) for throw in throw_scenes(four)] == ["first", "second"] * 2
    assert flying_webs(mikron(bearings=[0, 2, 4])) == ()
    assert web_at_a_bearing(mikron()) is None
    (turned,) = flying_webs(crank(120.0))
    assert turned.turn_deg == 120.0


def test_every_command_tells_that_its_stress_is_not_judged(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level("INFO")
    one_throw(crank(), 1)
    assert (
        "flying web between throws 1 and 2: `evaluate` tells its stiffness; no command judges" in caplog.text
    )


@pytest.mark.parametrize("turn", [120.0, 240.0])
def test_round_ends_that_go_on_in_each_other(turn: float) -> None:
    """The kernel joined them to one cylinder whose seam is in steps, and never came back."""
    (web,) = flying_webs(crank(turn))
    meshed = mesh_flying_web(web, 15.0)
    volume = half_throw_volume_mm3(web.near) + half_throw_volume_mm3(web.far)
    assert meshed.body.volume_mm3 == pytest.approx(volume, rel=1e-6)
    both = np.array([np.sin(radians(turn)), 1 + np.cos(radians(turn))])
    centre = np.array(meshed.body.centre_mm[:2])
    assert centre / np.linalg.norm(centre) == pytest.approx(both / np.linalg.norm(both), abs=1e-6)


def of_web(web: FlyingWeb, size: float) -> tuple[TetMesh, Elasticity]:
    mesh = mesh_flying_web(web, size).mesh
    return mesh, assemble(mesh, web.near.material.E_GPa * 1e3, web.near.material.poisson)


@pytest.mark.slow
@pytest.mark.skipif(shutil.which("ccx") is None, reason="CalculiX (ccx) is not installed")
@pytest.mark.parametrize("motion", ["torque", "couple"])
def test_against_calculix(motion: str, tmp_path: Path) -> None:
    """The near section clamped, a couple on the far one: rotation, and the field of all nodes."""
    (web,) = flying_webs(crank(120.0))
    mesh, model = of_web(web, 12.0)
    block = condensed(model, web.length_mm)
    body = cast(Any, SimpleNamespace(material=web.near.material, pitch_mm=web.length_mm))
    (near, near_turn), (_, far_turn) = calculix.handles(mesh), calculix.handles(mesh, 1)
    fixed = [(node, axis, 0.0) for node in (near, near_turn) for axis in range(3)]
    soft, _ = principal_bending(block)
    way = np.array([0.0, 0.0, 1.0])
    if motion == "couple":
        way = np.array([np.sin(radians(soft.axis_deg)), np.cos(radians(soft.axis_deg)), 0.0])
    forces = [(far_turn, axis, 1e6 * float(way[axis])) for axis in range(3) if way[axis]]
    found = calculix.displacements(tmp_path, mesh, body, "whole", fixed=fixed, forces=forces)
    expected = (
        soft.stiffness_Nm_per_rad if motion == "couple" else torsional_stiffness_Nm_per_rad(block, "free")
    )
    assert 1e3 / float(found[far_turn] @ way) == pytest.approx(expected, rel=2e-5)
    assert cKDTree(model.nodes_mm.T).query(mesh.points_mm.T)[0].max() == 0.0


@pytest.mark.slow
def test_the_parts_of_a_bay_add_up() -> None:
    """Twist of both throws between two bearings, one body, against that of a throw and of the flying web.

    Under a torque alone each part twists on its own; rigid middle sections of the pins are a little stiffer.
    """
    scene = crank()
    (web,) = flying_webs(scene)
    with cad_session("bay") as gmsh:
        add_crankshaft(gmsh.model.occ, scene)
        gmsh.model.occ.synchronize()
        gmsh.option.setNumber("Mesh.MeshSizeMax", 6.0)
        gmsh.model.mesh.generate(3)
        gmsh.model.mesh.setOrder(2)
        mesh = extract_mesh(gmsh, mirrored=False)
    length = sum(throw.pitch_mm for throw in throw_scenes(scene))
    model = assemble(mesh, scene.material.E_GPa * 1e3, scene.material.poisson)
    bay = torsional_stiffness_Nm_per_rad(condensed(model, length), "free")
    flying = evaluate_flying_web(web, 6.0).torsion["free_Nm_per_rad"]
    at_bearing = evaluate_target(one_web(throw_scenes(scene)[0], "first"), MeshRequest(6.0))
    throw = at_bearing.fine.torsion["free"]
    assert throw is not None
    assert 1 / (1 / throw + 1 / flying) == pytest.approx(bay, rel=0.005)


@pytest.mark.slow
def test_the_bounds_cover_what_a_finer_mesh_changes() -> None:
    (web,) = flying_webs(crank(120.0))
    coarse, fine = (evaluate_flying_web(web, size) for size in (12.0, 6.0))
    changes = {
        "torsion": [coarse.torsion[key] / value - 1 for key, value in fine.torsion.items()],
        "bending": [
            coarse.bending.softest_Nm_per_rad / fine.bending.softest_Nm_per_rad - 1,
            coarse.bending.stiffest_Nm_per_rad / fine.bending.stiffest_Nm_per_rad - 1,
        ],
    }
    for name, found in changes.items():
        assert 0 < max(found) * 100 < coarse.error_estimate_percent[name]
        assert fine.error_estimate_percent[name] < 0.6 * coarse.error_estimate_percent[name]


@pytest.mark.slow
def test_evaluate_tells_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    """It refused the design: "a web beside it is a flying one, which is not modelled"."""
    save_scene(crank(), tmp_path / "two.toml")
    arguments = ["evaluate", str(tmp_path / "two.toml"), "--throw", "1", "--element-size-mm", "12"]
    assert main([*arguments, "--json"]) == 0
    told = capsys.readouterr()
    (entry,) = json.loads(told.out)["evaluations"]
    assert entry["target"] == "mikron-iiic-plain-throw-1-first-web"
    (web,) = entry["flying_webs"]
    expected = evaluate_flying_web(flying_webs(crank())[0], 12.0)
    assert web["torsion"] == pytest.approx(expected.torsion)
    assert "evaluated is a throw with its first web twice" in " ".join(told.err.split())
    assert main(arguments) == 0
    assert "flying web between throws 1 and 2, turned by 180 deg: 1.167 kg; torsion 21" in " ".join(
        capsys.readouterr().out.split()
    )
