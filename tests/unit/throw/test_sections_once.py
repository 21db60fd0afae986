"""Integrals over webs ask for no more sections than they need."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo import load_scene
from cranktopo.bodies import envelope_file
from cranktopo.design.loading import design_text, scene_from_dict
from cranktopo.design.toml_text import parse_toml
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of
from cranktopo.throw.drilling import moments
from cranktopo.throw.drilling.moments import drilled
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.moments import body_moments, integrate
from cranktopo.throw.web import web_bodies


def _plate(**web: Any) -> list[Any]:
    data = parse_toml(design_text("mikron-iiic-plain"), "own")
    data["throw"]["main_journal"]["bore_diameter_mm"] = data["throw"]["crankpin"]["bore_diameter_mm"] = 0.0
    data["web"] = {"outline": "rectangle", "thickness_mm": 20.0, "width_mm": 90.0, **web}
    return web_bodies(scene_from_dict(data))


def test_moments_of_a_plate_are_those_of_a_block() -> None:
    """Of prisms one height is enough, also for moments times the height."""
    bodies = _plate(overhang_mm=40.0)
    low, high = bodies[0].y_range_mm
    area, thick, (bottom, top) = 90.0 * (high - low), 20.0, bodies[0].z_mm
    found, weighted = body_moments(bodies), body_moments(bodies, before_z_mm=100.0)
    assert found.volume == pytest.approx(area * thick, rel=1e-13)
    assert found.first_y == pytest.approx(area * thick * (low + high) / 2, rel=1e-12)
    assert weighted.volume == pytest.approx(area * thick * (100.0 - (bottom + top) / 2), rel=1e-12)


def test_features_leave_the_outline_as_it_is() -> None:
    """What a counterweight adds was integrated over the same web twice: its outline named its features."""
    scene = load_scene("industrial-gas")
    bare = scene.model_copy(update={"web": scene.web.model_copy(update={"counterweight": None})})
    assert web_bodies(scene)[0] == web_bodies(bare)[0]
    assert len(web_bodies(scene)) > len(web_bodies(bare))


def test_both_halves_of_intervals_are_asked_for_at_once() -> None:
    asked: list[int] = []

    def kinked(y: Any) -> Any:
        asked.append(len(y))
        return np.stack([np.abs(y - 0.3)] * 4, axis=-1)

    found = integrate(kinked, np.array([-1.0, 0.0, 1.0]))
    assert found[0] == pytest.approx((1.3**2 + 0.7**2) / 2, rel=1e-10)
    assert asked[:2] == [24, 48], "12 places each: both intervals, then their four halves in one call"
    assert len(asked) < 45


def test_points_of_a_drilling_are_rings_about_its_axis() -> None:
    bore = drill_bores(load_scene("industrial-gas"))[0]
    rings = bore.surface_mm(3.0).reshape(len(bore.places_mm), -1, 3)
    start = np.array(bore.outlets[0].point_mm)
    along = (rings - start) @ bore.direction
    np.testing.assert_allclose(along, np.broadcast_to(bore.places_mm[:, None], along.shape), atol=1e-9)
    away = np.linalg.norm(rings - start - along[..., None] * bore.direction, axis=-1)
    np.testing.assert_allclose(away, 3.0, rtol=1e-9)


def test_the_range_of_a_body_is_found_once(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A plan of a crank from CAD made the solid of its original seven times, a third of a move."""
    made: list[str] = []

    def counted(mesh: SurfaceMesh, name: str = "surface") -> Any:
        made.append(name)
        return solid_of(mesh, name)

    write_stl(tmp_path / "body.stl", mesh_of(Manifold.cube((30.0, 20.0, 10.0), True)))
    monkeypatch.setattr(envelope_file, "solid_of", counted)
    for _ in range(3):
        found = envelope_file.bounds_mm(tmp_path / "body.stl")
    assert found == pytest.approx((-15.0, 15.0, -10.0, 10.0))
    assert len(made) == 1


def test_rounded_edges_of_a_floor_are_integrated_as_circles() -> None:
    """A groove through both ends of a plate: quarters of circles stay in its corners."""
    length, depth, height, radius = 300.0, 12.0, 10.0, 4.0
    groove = {"shape": "side", "y_mm": 20.0, "length_mm": length, "depth_mm": depth, "height_mm": height}
    whole = _plate(overhang_mm=40.0)
    bodies = _plate(overhang_mm=40.0, pocket=[groove | {"floor_radius_mm": radius}])
    low, high = whole[0].y_range_mm
    section = 2 * (depth * height - 2 * (1 - math.pi / 4) * radius**2)
    taken = body_moments(whole).volume - body_moments(bodies).volume
    assert taken == pytest.approx(section * (high - low), rel=1e-11)


def test_heights_are_asked_for_where_the_section_changes_alone() -> None:
    """Beyond a bevel at one end there were as many as in it, and some between breaks that are one."""
    asked: list[int] = []

    def points(**web: Any) -> int:
        plain, *others = _plate(overhang_mm=40.0, **web)

        class Counted(type(plain)):  # type: ignore[misc]
            def spans(self, y_mm: Any, z_mm: Any) -> Any:
                asked.append(np.broadcast(y_mm, z_mm).size)
                return super().spans(y_mm, z_mm)

        asked.clear()
        body_moments([Counted(*vars(plain).values()), *others])
        return sum(asked)

    bevel = {"face": "journal", "y_mm": 65.0, "depth_mm": 6.0}
    added = points(bevel=[bevel | {"draft_deg": 5.0}]) - points()
    assert added < 2000, "2628 where every interval had as many"


def test_a_web_with_and_without_its_bores_is_integrated_once() -> None:
    """The plan asks for both at each move of a drag: of the second, what the bores take alone is new."""
    asked: list[int] = []
    solid, hollow, wider = (_bored(diameter) for diameter in (0.0, 20.0, 21.0))
    body_moments(solid)
    outline = type(solid[0])
    spans = outline.spans
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(outline, "spans", lambda *at: asked.append(len(at[1])) or spans(*at))
        found, further = body_moments(hollow), body_moments(wider)
    places = sum(asked)
    assert places < 2 * 400, "of the bores; the whole web took thousands"
    taken = solid_less_bores = math.pi * 20.0**2 / 4 * 20.0
    assert found.volume == pytest.approx(body_moments(solid).volume - taken, rel=1e-11)
    assert further.volume < found.volume < solid_less_bores * 100


def _bored(diameter_mm: float) -> list[Any]:
    data = parse_toml(design_text("mikron-iiic-plain"), "own")
    data["throw"]["main_journal"]["bore_diameter_mm"] = diameter_mm
    data["throw"]["crankpin"]["bore_diameter_mm"] = 0.0
    stations = [-40.0, -20.0, 0.0, 30.0, 60.0, 85.0]
    half = [0.0, 35.0, 42.0, 40.0, 30.0, 0.0]
    web = {"outline": "profile", "thickness_mm": 20.0, "stations_mm": stations, "half_widths_mm": half}
    data["web"] = web | {"bevel": [{"face": "journal", "y_mm": 68.0, "depth_mm": 6.0, "draft_deg": 5.0}]}
    return web_bodies(scene_from_dict(data))


def test_a_drilling_within_the_pin_is_the_same_in_a_thicker_web(monkeypatch: pytest.MonkeyPatch) -> None:
    """Its mass was computed anew at each move of a dimension that moves it along the crank."""
    data = parse_toml(design_text("mikron-iiic-plain"), "own")
    ends = [{"on": "crankpin", "angle_deg": angle, "place_mm": 7.0} for angle in (90.0, 270.0)]
    drilling = {"diameter_mm": 4.0, "outlet_radius_mm": 0.5, "from": ends[0], "to": ends[1]}
    data["throw"]["drilling"] = [drilling]
    data["throw"]["crankpin"]["bore_diameter_mm"] = 0.0
    scene = scene_from_dict(data)
    web = scene.web.model_copy(update={"thickness_mm": scene.web.thickness_mm + 3.0})
    thicker = scene.model_copy(update={"web": web})
    one = drilled(scene, "crankpin")
    monkeypatch.setattr(moments, "ring_points", None)
    monkeypatch.setattr(moments, "integrate", None)
    other = drilled(thicker, "crankpin")
    assert (other.volume, other.polar) == pytest.approx((one.volume, one.polar), rel=1e-14)
