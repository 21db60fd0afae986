"""Bolts of a counterweight: their holes in web and counterweight, what they weigh, and what refuses them."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import gmsh
import numpy as np
import pytest
from scipy.integrate import quad

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.bolt_masses import holes_in_web
from cranktopo.bodies.prisms import bolted_counterweight, thread_holes
from cranktopo.bodies.solid.bolted import add_bolted
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.volume import bolted_mass, bolted_volume_mm3, throw_volume_mm3
from cranktopo.design.bolt_holes import BoltHole, bolt_holes
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from tests.unit.bodies.test_seat import HEAVY, WEIGHT, with_weight

JOINT: dict[str, Any] = {"thread": "M6", "grip_mm": 15.0, "holds": "web.counterweight"}
PAIR = JOINT | {"places_mm": [[-12.0, 1.0], [12.0, 1.0]]}
ROWS = JOINT | {"bolts": 3, "thread": "M5", "grip_mm": 16.0}
ROWS |= {"places_mm": [[-16.0, -1.5], [16.0, -1.5], [0.0, 2.0]]}
"""Not symmetric along the crank axis."""
CORE_M6, CORE_M5 = 4.917, 4.134
"""Core diameters of nuts, ISO 724, table 1."""
WEB_MM, RIM_MM = 30.0, 62.0


def column(x0: float, radius: float, low: Any, high: Any, arm: Any = lambda x, y: 1.0) -> float:
    """Integral over a cylinder along y at x0, between two heights over x."""

    def strip(x: float) -> float:
        inner, _ = quad(lambda y: arm(x, y), low(x), high(x))
        return 2 * math.sqrt(max(radius**2 - (x - x0) ** 2, 0.0)) * inner

    return quad(strip, x0 - radius, x0 + radius, epsabs=1e-9, epsrel=1e-10, limit=200)[0]


def web_edge(x: float) -> float:
    """Lower end of the obround's outline."""
    return -math.sqrt(WEB_MM**2 - x**2)


def rim(x: float) -> float:
    return -math.sqrt(RIM_MM**2 - x**2)


def lost_mm3(x: float, grip: float, hole: float, head: float) -> float:
    """Volume of hole and hole of the head, by their radii."""
    seat = web_edge(x) - grip
    return column(x, hole, lambda _: seat, web_edge) + column(x, head, rim, lambda _: seat)


HOLES = {"pair": (PAIR, [-12.0, 12.0], 3.3, 6.0), "rows": (ROWS, [-16.0, 16.0, 0.0], 2.75, 5.0)}


@pytest.mark.parametrize("name", HOLES)
def test_the_kernel_s_counterweight_has_the_volume_of_the_closed_form(name: str) -> None:
    joint, places, hole, wide = HOLES[name]
    scene = with_weight(WEIGHT, bolted_joint=[joint])
    ring = 19.0 * math.pi / 3 * (RIM_MM**2 - WEB_MM**2)
    expected = ring - sum(lost_mm3(x, joint["grip_mm"], hole, 1.2 * 1.46 * wide / 2) for x in places)
    assert bolted_volume_mm3(scene) == pytest.approx(expected, rel=1e-9)
    assert bolted_counterweight(scene).volume() == pytest.approx(expected, rel=1e-3)
    with cad_session("test"):
        first, second = add_bolted(gmsh.model.occ, scene)
        for body in (first, second):
            assert gmsh.model.occ.getMass(*body) == pytest.approx(expected, rel=2e-5)


@pytest.mark.parametrize(("joint", "core", "deep"), [(PAIR, CORE_M6, 13.0), (ROWS, CORE_M5, 10.7)])
def test_thread_holes_take_cores_from_the_joint_on(joint: Any, core: float, deep: float) -> None:
    """1.5 diameters of thread, 4 pitches of run-out (1 mm at M6, 0.8 mm at M5)."""
    scene = with_weight(WEIGHT, bolted_joint=[joint])
    expected = 0.0
    for x, _ in joint["places_mm"]:
        floor = web_edge(x) + deep
        expected += column(x, core / 2, web_edge, lambda _, floor=floor: floor)
    assert holes_in_web(scene).volume == pytest.approx(expected, rel=2e-4)


def test_bolts_weigh_and_their_holes_do_not() -> None:
    """Mass, unbalance, inertia and height by integrals over every part of three bolts in two rows."""
    scene = with_weight({**WEIGHT, "thickness_mm": 16.0, "face": "pin"}, bolted_joint=[ROWS])
    bare = with_weight({**WEIGHT, "thickness_mm": 16.0, "face": "pin"})
    steel, heavy, web = 7850e-9, HEAVY * 1e-9, scene.material.density_kg_m3 * 1e-9
    middle = scene.web_z_mm[1] - 8.0
    arms = (lambda x, y: 1.0), (lambda x, y: y), (lambda x, y: x**2 + y**2)
    expected, weighted = np.zeros(3), 0.0
    for x, z in ROWS["places_mm"]:
        joint = web_edge(x)
        seat = joint - 16.0
        parts = (
            (-heavy, 2.75, lambda _, s=seat: s, web_edge),
            (-heavy, 1.2 * 1.46 * 2.5, rim, lambda _, s=seat: s),
            (steel, 1.46 * 2.5, lambda _, s=seat: s - 5.0, lambda _, s=seat: s),
            (steel, 2.5, lambda _, s=seat: s, lambda _, j=joint: j),
            (-web, CORE_M5 / 2, lambda _, j=joint: j + 7.5, lambda _, j=joint: j + 10.7),
        )
        for density, radius, low, high in parts:
            found = [density * column(x, radius, low, high, arm) for arm in arms]
            expected += found
            weighted += found[0] * (middle + z)
    with_bolts, without = bolted_mass(scene), bolted_mass(bare)
    change = [a - b for a, b in zip(_numbers(with_bolts), _numbers(without), strict=True)]
    assert change == pytest.approx(expected.tolist(), rel=1e-4)
    height = bolted_mass(bare, 0.0).volume - bolted_mass(scene, 0.0).volume
    assert height == pytest.approx(weighted, rel=1e-4)


def _numbers(moments: Any) -> list[float]:
    return [moments.volume, moments.first_y, moments.polar]


def _holds(tags: list[int], at: tuple[float, float, float]) -> list[int]:
    """Solids that hold a point."""
    return [tag for tag in tags if gmsh.model.isInside(3, tag, list(at))]


def _solids(path: Path) -> Iterator[list[int]]:
    with cad_session("test"):
        gmsh.model.occ.importShapes(str(path))
        gmsh.model.occ.synchronize()
        yield [tag for _, tag in gmsh.model.getEntities(3)]


def _check_axes(bolt: BoltHole, tags: list[int]) -> None:
    """On the axis both bodies are empty, a little beside each hole there is the one that it is in."""
    x, z, joint, seat = bolt.x_mm, bolt.z_mm, bolt.joint_mm, bolt.seat_mm
    for y in (bolt.floor_mm - 0.1, joint + 0.5, joint - 0.5, seat + 0.1, seat - 3.0):
        assert not _holds(tags, (x, y, z)), y
    own, beside = tags
    for y, radius, tag in (
        (joint + 5.0, bolt.core_radius_mm, own),
        (joint - 5.0, bolt.hole_radius_mm, beside),
        (seat - 3.0, bolt.head_radius_mm, beside),
    ):
        for angle in np.linspace(0, 2 * math.pi, 8, endpoint=False):
            for share, found in ((0.97, []), (1.03, [tag])):
                off = share * radius
                assert _holds(tags, (x + off * math.cos(angle), y, z + off * math.sin(angle))) == found
    assert _holds(tags, (x, bolt.floor_mm + 0.1, z)) == [own]


@pytest.mark.parametrize("joint", [PAIR, pytest.param(ROWS, marks=pytest.mark.slow)], ids=["pair", "rows"])
def test_holes_lie_in_both_bodies_of_a_step_file_on_the_same_axes(joint: Any, tmp_path: Path) -> None:
    scene = with_weight(WEIGHT, bolted_joint=[joint])
    volume = export_solid(scene, "throw", tmp_path / "throw.step")
    assert volume == pytest.approx(throw_volume_mm3(scene) - 2 * holes_in_web(scene).volume, rel=2e-5)
    text = (tmp_path / "throw.step").read_text()
    for web in (1, 2):
        assert f"counterweight of web {web}, 17000 kg/m3" in text
    for tags in _solids(tmp_path / "throw.step"):
        crank, first, second = sorted(tags, key=lambda tag: -gmsh.model.occ.getMass(3, tag))
        if gmsh.model.occ.getCenterOfMass(3, first)[2] > scene.pitch_mm / 2:
            first, second = second, first
        assert len(bolt_holes(scene)) == len(joint["places_mm"])
        for bolt in bolt_holes(scene):
            _check_axes(bolt, [crank, first])
            mirrored = (bolt.x_mm, bolt.joint_mm + 2.0, scene.pitch_mm - bolt.z_mm)
            assert not _holds([crank, second], mirrored)


def crank_with(joint: Any) -> Scene:
    data = load_scene("mikron-iiic-crank").model_dump(mode="json", exclude_none=True)
    data["web"] = {"thickness_mm": 19.0, "outline": "obround", "width_mm": 60.0, "counterweight": WEIGHT}
    data.pop("envelope", None)
    return scene_from_dict({**data, "bolted_joint": [joint]}, "crank", whole=True)


@pytest.mark.slow
def test_the_whole_crank_has_a_body_for_each_counterweight_in_its_place(tmp_path: Path) -> None:
    """Opposite the pins, each half a turn from those of its neighbour where the pins are."""
    scene = crank_with(PAIR)
    export_solid(scene, "crankshaft", tmp_path / "crank.step")
    for tags in _solids(tmp_path / "crank.step"):
        volumes = {tag: gmsh.model.occ.getMass(3, tag) for tag in tags}
        crank = max(tags, key=lambda tag: volumes[tag])
        beside = sorted(set(tags) - {crank}, key=lambda tag: gmsh.model.occ.getCenterOfMass(3, tag)[2])
        assert len(beside) == 8
        for tag, angle in zip(beside, np.repeat(scene.shaft_angles_deg, 2), strict=True):
            x, y, _ = gmsh.model.occ.getCenterOfMass(3, tag)
            assert volumes[tag] == pytest.approx(bolted_volume_mm3(scene), rel=2e-5)
            assert y * math.cos(math.radians(angle)) < -35.0
            assert abs(x) < 0.01


def test_the_boolean_engine_s_thread_holes_are_those_of_the_closed_form() -> None:
    """What they take out of a block about the obround's lower end."""
    scene = with_weight(WEIGHT, bolted_joint=[PAIR])
    tools, (start, end) = thread_holes(scene), scene.web_z_mm
    from manifold3d import Manifold

    web = Manifold.cylinder(end - start, WEB_MM, WEB_MM, 2048).translate((0.0, 0.0, start))
    assert (tools ^ web).volume() == pytest.approx(holes_in_web(scene).volume, rel=2e-3)


def test_places_left_out_leave_masses_and_bodies_as_they_were() -> None:
    scene, bare = with_weight(WEIGHT, bolted_joint=[JOINT]), with_weight(WEIGHT)
    assert not bolt_holes(scene)
    assert bolted_mass(scene) == bolted_mass(bare)
    assert thread_holes(scene).is_empty()


REFUSED = {
    "not held": ({"holds": None, "max_force_N": 100.0}, r"places_mm.*no meaning without"),
    "a nut": ({"held_in": "nut"}, r"held_in.*must be tapped_hole"),
    "too many": ({"bolts": 4}, r"bolts.*must be 2, the number of its places_mm"),
    "one side": ({"places_mm": [[12.0, 1.0], [-11.0, 1.0]]}, r"mirror image"),
    "aside": ({"places_mm": [[-40.0, 1.0], [40.0, 1.0]]}, r"misses the outline"),
    "a face": ({"places_mm": [[-12.0, 5.0], [12.0, 5.0]]}, r"leaves web.counterweight"),
    "a flank": (
        {"places_mm": [[-26.0, 1.0], [26.0, 1.0]], "grip_mm": 20.0},
        r"leaves web.counterweight through a flank",
    ),
    "long": ({"grip_mm": 30.0}, r"grip_mm = 30.0: must be from 1.86 to 26.03 mm"),
    "short": ({"grip_mm": 0.5}, r"grip_mm = 0.5: must be from 1.86"),
    "too deep": ({"engagement_mm": 18.0}, r"meets throw.main_journal.bore"),
    "too near": ({"places_mm": [[-4.0, 1.0], [4.0, 1.0]]}, r"meets the one at \(-4"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_bolts_that_cannot_be_are_refused(name: str) -> None:
    change, message = REFUSED[name]
    with pytest.raises(CranktopoError, match=message):
        with_weight(WEIGHT, bolted_joint=[{**PAIR, **change}])


def test_a_thread_that_a_pocket_meets_is_refused() -> None:
    data = with_weight(WEIGHT, bolted_joint=[PAIR]).model_dump(mode="json", exclude_none=True)
    pocket = {"shape": "cylinder", "face": "journal", "x_mm": 12.0, "y_mm": -22.0}
    data["web"]["pocket"] = [pocket | {"diameter_mm": 5.0, "depth_mm": 12.0}]
    with pytest.raises(CranktopoError, match=r"x 12, z 1 mm meets web.pocket\[0\]"):
        scene_from_dict(data, "met")
