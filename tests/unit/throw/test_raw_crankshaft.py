"""The raw part of the whole crank: closed forms of its ends, sums, parting planes, refusals, words."""

from __future__ import annotations

import math
import re
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.raw_crankshaft import (
    end_steps,
    machined_out_of_crank,
    parting_planes_deg,
    parting_text,
    raw_crank_end,
    raw_crank_mass_kg,
    raw_crank_volume_mm3,
)
from cranktopo.bodies.raw_part import raw_mass_kg
from cranktopo.bodies.solid.files import export_solid, surface_of
from cranktopo.bodies.solid.raw_crankshaft import add_raw_end
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.crank import drawn_crank_mass
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.throw.crank_end import BodyStep
from cranktopo.throw.moments import body_moments
from cranktopo.throw.raw_part.end import raw_end
from cranktopo.throw.raw_part.table import Forging
from tests.random_cranks import random_crank
from tests.step_volume import step_volume_mm3
from tests.unit.throw.test_raw_part import FLUSH, USUAL, sampled

CYLINDER = {"kind": "cylinder", "diameter_mm": 30.0, "length_mm": 20.0}
FLANGE = {
    "kind": "flange",
    "diameter_mm": 60.0,
    "length_mm": 12.0,
    "bolts": 6,
    "bolt_circle_mm": 44.0,
    "bolt_diameter_mm": 6.0,
    "bore_diameter_mm": 10.0,
}
CONE = {"kind": "cone", "diameter_mm": 30.0, "outer_end_diameter_mm": 24.0, "length_mm": 40.0}
WIDENING = {"kind": "cone", "diameter_mm": 24.0, "outer_end_diameter_mm": 30.0, "length_mm": 40.0}
TAPER = {
    "narrows": [CYLINDER, CONE, {**CYLINDER, "diameter_mm": 20.0}],
    "widens": [{**CYLINDER, "diameter_mm": 24.0}, WIDENING, CYLINDER],
    "open": [WIDENING],
    "flat": [{**CONE, "length_mm": 1.0}],
}


def forged(forging: dict[str, float] = USUAL, /, **tables: Any) -> Scene:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    return scene_from_dict({**data, **tables, "forging": forging}, "forged")


def with_end(steps: list[dict[str, Any]], forging: dict[str, float] = USUAL, side: str = "output") -> Scene:
    return forged(forging, crank={"end": [{"side": side, "step": steps}]})


def drafted_volume_mm3(radius: float, length: float, faces: int, forging: dict[str, float]) -> float:
    """A cylinder with two tangents at each end of its section, and so many faces that rise toward x = 0."""
    draft, land = math.radians(forging["draft_deg"]), forging["flash_mm"] / 2
    x = np.linspace(0.0, radius, 400_001)
    at = np.maximum(x, land)
    arc = np.sqrt(radius**2 - at**2)
    reach = np.where(at < radius * math.sin(draft), radius / math.cos(draft) - at * math.tan(draft), arc)
    tall = length + faces * math.tan(draft) * (radius - at)
    return float(4 * np.trapezoid(reach * tall, x))


@pytest.mark.parametrize("forging", [USUAL, FLUSH], ids=["land", "flush"])
def test_a_flange_has_allowance_and_draft_on_both_faces(forging: dict[str, float]) -> None:
    """By a section of its own: what the half journal alone has not is the flange beyond it and its face."""
    scene, more = with_end([FLANGE], forging), forging["allowance_mm"]
    end = raw_crank_end(scene, "output")
    assert end is not None
    journal, flange = end.journals
    alone = body_moments([type(end)("one", flange.z_mm, (), (), (flange,))]).volume
    expected = drafted_volume_mm3(30.0 + more, 12.0 + 2 * more, 2, forging)
    assert alone == pytest.approx(expected, rel=1e-6)
    half = scene.throw.main_journal.length_mm / 2
    assert journal.z_mm == (0.0, half)
    bare = body_moments([type(end)("one", journal.z_mm, (), (), (journal,))]).volume
    radius = scene.throw.main_journal.radius_mm + more
    assert bare == pytest.approx(drafted_volume_mm3(radius, half, 0, forging), rel=1e-6)
    assert max(bare, alone) < body_moments([end]).volume < bare + alone


@pytest.mark.parametrize(
    "case", [pytest.param(case, marks=[pytest.mark.slow] if case == "widens" else []) for case in TAPER]
)
def test_raw_ends_by_the_kernel(case: str) -> None:
    """Its volume is that of the quadrature; no face has less than the draft; the finished end lies in it."""
    scene = with_end(TAPER[case])
    end, least = raw_crank_end(scene, "output"), math.sin(math.radians(5.0))
    assert end is not None
    at = 4 * scene.pitch_mm
    with cad_session(case) as gmsh:
        body = add_raw_end(gmsh.model.occ, scene, "output", end)
        gmsh.model.occ.synchronize()
        assert gmsh.model.occ.getMass(*body[0]) == pytest.approx(body_moments([end]).volume, rel=1e-6)
        points, normals = sampled(gmsh, body[0][1])
        walls = (np.abs(points[:, 0]) > 1.0 + 1e-6) & (points[:, 2] > at + 1e-6)
        assert walls.sum() > 60
        assert np.abs(normals[walls, 0]).min() >= least - 1e-6
        inside = allowance_points(scene, at)
        assert gmsh.model.isInside(3, body[0][1], inside.ravel().tolist()) == len(inside)


def allowance_points(scene: Scene, at_mm: float) -> np.ndarray:
    """Points of the steps' surfaces moved out by 2 mm, on radius and open faces, just within."""
    found, turn = [], np.linspace(0, 2 * np.pi, 24, endpoint=False)
    z, end = at_mm + scene.throw.main_journal.length_mm / 2, end_steps(scene, "output")
    for step in end.values():
        for share in (0.02, 0.5, 0.98):
            radius = step.radii_mm[0] + share * (step.radii_mm[1] - step.radii_mm[0]) + 2.0 - 1e-4
            height = np.full(turn.shape, z + share * step.length_mm)
            found.append(np.stack([radius * np.cos(turn), radius * np.sin(turn), height], axis=1))
        z += step.length_mm
    last = np.stack([5.0 * np.cos(turn), 5.0 * np.sin(turn), np.full(turn.shape, z + 2.0 - 1e-4)], axis=1)
    return np.concatenate([*found, last])


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(12))
def test_random_raw_ends(seed: int) -> None:
    draw, data = np.random.default_rng(seed), random_crank(seed).model_dump(mode="json", exclude_none=True)
    size = data["throw"]["main_journal"]["outer_diameter_mm"]
    forging = {
        "allowance_mm": float(size * draw.choice([0, 0.01, 0.04])),
        "draft_deg": float(draw.choice([1, 5, 7, 12])),
        "flash_mm": float(size * draw.choice([0, 0.01, 0.04])),
    }
    scene = scene_from_dict({**data, "forging": forging}, "random")
    for side in ("free", "output"):
        end = raw_crank_end(scene, side)
        if end is not None:
            with cad_session(side) as gmsh:
                body = add_raw_end(gmsh.model.occ, scene, side, end)
                assert gmsh.model.occ.getMass(*body[0]) == pytest.approx(body_moments([end]).volume, rel=1e-6)


def test_the_mass_is_that_of_throws_and_ends() -> None:
    scene = with_end([CYLINDER])
    end = raw_crank_end(scene, "output")
    assert end is not None
    assert raw_crank_end(scene, "free") is None
    density = scene.material.density_kg_m3 * 1e-9
    expected = 4 * raw_mass_kg(scene) + density * body_moments([end]).volume
    assert raw_crank_mass_kg(scene) == pytest.approx(expected, rel=1e-12)
    assert raw_crank_mass_kg(scene) > drawn_crank_mass(scene).mass_kg


def test_planes_that_dies_part_in() -> None:
    assert parting_planes_deg((0.0, 180.0, 180.0, 360.0)) == (0.0,)
    assert parting_planes_deg((0.0, 120.0, 240.0)) == (0.0, 120.0, 60.0)
    assert parting_planes_deg((0.0, 180.0 - 1e-9)) == (0.0,)
    assert parting_text((0.0, 180.0)) == "all throws lie in one parting plane"
    told = parting_text((0.0, 120.0, 240.0))
    assert "3 planes (0, 120, 60 deg)" in told
    assert "twisted into place after forging" in told


@pytest.mark.slow
def test_a_twisted_crank_is_one_closed_body(tmp_path: Path) -> None:
    """Three throws by 120 deg with both ends: its STEP file read back, and its facets."""
    engine = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)["engine"]
    engine |= {"cylinders": 3, "firing_order": [1, 3, 2]}
    ends = [{"side": "free", "step": [CYLINDER]}, {"side": "output", "step": [FLANGE]}]
    scene = forged(engine=engine, crank={"end": ends})
    assert len(parting_planes_deg(scene.shaft_angles_deg)) == 3
    volume = export_solid(scene, "raw_crankshaft", tmp_path / "raw.step")
    assert volume == pytest.approx(raw_crank_volume_mm3(scene), rel=1e-6)
    assert step_volume_mm3(tmp_path / "raw.step") == pytest.approx(volume, rel=1e-6)
    mesh = surface_of(scene, "raw_crankshaft", 3.0).as_trimesh()
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(volume, rel=3e-3)
    assert mesh.bounds[1, 2] - mesh.bounds[0, 2] > 3 * scene.pitch_mm + 40.0 + 20.0 + 12.0 + 4.0


def test_what_is_machined_out_of_it() -> None:
    keyway = {**CYLINDER, "kind": "keyway", "width_mm": 8.0, "depth_mm": 4.0}
    scene = with_end([keyway, FLANGE])
    assert machined_out_of_crank(scene) == (
        "throw.main_journal.bore_diameter_mm",
        "throw.crankpin.bore_diameter_mm",
        "crank.end[0].step[0].depth_mm",
        "crank.end[0].step[1].bore_diameter_mm",
        "crank.end[0].step[1].bolts",
    )


def test_what_has_no_raw_crank_is_refused() -> None:
    wide = with_end([{**FLANGE, "diameter_mm": 420.0}])
    words = "forging.allowance_mm = 2.0: with the draft of 5 deg crank.end[0].step[0] reaches"
    with pytest.raises(CranktopoError, match=re.escape(words)):
        raw_crank_volume_mm3(wide)
    none = {"number": 1, "length_mm": 0.0}
    with pytest.raises(CranktopoError, match="a flying web is forged as one with its neighbour"):
        forged(crank={"main_journal": [none], "bearings": [0, 2, 3, 4]})


def test_an_end_from_cad_has_no_raw_part() -> None:
    step = BodyStep.model_construct(kind="body", length_mm=20.0, file="flange.step")
    with pytest.raises(CranktopoError, match=r"crank\.end\[0\]\.step\[0\]\.kind = 'body': a body from CAD"):
        raw_end(21.0, 20.0, {"crank.end[0].step[0]": step}, Forging(**USUAL))


def test_the_command_refuses_a_throw_and_tells_the_missing_table(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    raw = ["export", "mikron-iiic-plain", str(tmp_path / "a.step"), "--part", "raw_crankshaft"]
    assert main([*raw, "--throw", "1"]) == 2
    assert "--part raw_crankshaft is all throws" in capsys.readouterr().err
    assert main(raw) == 3
    assert "[forging] is missing" in capsys.readouterr().err
    assert not (tmp_path / "a.step").exists()


@pytest.mark.slow
def test_the_command_tells_masses_and_planes(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    text = (Path(__file__).parents[3] / "designs" / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
    (tmp_path / "raw.toml").write_text(f"{text}\n[forging]\nallowance_mm = 2.0\n", encoding="utf-8")
    found = str(tmp_path / "raw.step")
    assert main(["export", str(tmp_path / "raw.toml"), found, "--part", "raw_crankshaft"]) == 0
    told = capsys.readouterr().out
    kg = raw_crank_mass_kg(forged({**USUAL, "flash_mm": 0.0}))
    assert "raw_crankshaft, " in told
    assert f"{kg:.3f} kg; finished " in told
    assert "all throws lie in one parting plane" in told
