"""Clearances of piston and crankcase: what they leave, against a web turned step by step; refusals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from matplotlib.figure import Figure

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.bodies.prisms import envelope_solid
from cranktopo.bodies.solid.files import surface_of
from cranktopo.design.clearance import CRANKCASE, PISTON, ClearanceLimit, clearance_limit, clearances_mm
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.report.viewer.scene3d import ShownBody
from cranktopo.tasks.loads.stage import loads_at_speeds
from cranktopo.tasks.loads.text import loads_text
from cranktopo.tasks.throw_fea.section import _draw_clearance, clearance_sections
from tests.unit.throw.counterweight_cases import PLAIN, roomy_scene, weighted

SKIRT_MM, GAP_MM = 52.0, 1.5
CLEARANCE = {"piston_skirt_mm": SKIRT_MM, "crankcase_radius_mm": 76.0, "least_gap_mm": GAP_MM}


def cleared(scene: Scene, clearance: dict[str, Any], **changes: Any) -> Scene:
    """The scene with clearances."""
    data = scene.model_dump(mode="json", exclude_none=True) | changes
    data["envelope"] = {**data["envelope"], "clearance": clearance}
    return scene_from_dict({key: value for key, value in data.items() if value is not None}, "cleared")


@pytest.fixture(scope="module")
def clear(mikron: Scene) -> Scene:
    return cleared(weighted(roomy_scene(mikron), PLAIN), CLEARANCE)


def meets_the_piston(scene: Scene, x: float, y: float, skirt_mm: float) -> bool:
    """Turn the point with the crank, 0.1 deg at a time, and look whether it gets above the skirt's edge."""
    engine, r = scene.engine, scene.throw.radius_mm
    assert engine is not None
    beside = scene.throw.crankpin.length_mm / 2
    half = math.sqrt((engine.bore_mm / 2) ** 2 - beside**2)
    for a in np.radians(np.arange(0.0, 360.0, 0.1)):
        across, along = x * math.cos(a) + y * math.sin(a), y * math.cos(a) - x * math.sin(a)
        pin = r * math.cos(a) + math.sqrt(engine.rod_length_mm**2 - (r * math.sin(a)) ** 2)
        if abs(across) <= half and along >= pin - skirt_mm:
            return True
    return False


def test_the_limit_is_where_a_turning_web_meets_the_piston(mikron: Scene) -> None:
    """Points just within the limit never meet it, points just beyond do; by step-by-step kinematics."""
    scene = cleared(mikron, {"piston_skirt_mm": 40.0, "least_gap_mm": 2.0})
    limit = clearance_limit(scene)
    assert limit is not None
    for degrees in (0.0, 35.0, 90.0, 140.0, 180.0):
        angle = math.radians(degrees)
        radius = float(np.interp(angle, limit.angle_rad, limit.radius_mm))
        direction = math.sin(angle), math.cos(angle)
        within, beyond = ((radius + shift) * np.array(direction) for shift in (-0.05, 0.05))
        assert not meets_the_piston(scene, *within, 42.0), degrees
        assert meets_the_piston(scene, *beyond, 42.0), degrees
    assert limit.radius_mm[-1] == pytest.approx(166.0 - 48.0 - 42.0)  # opposite the pin: bottom dead centre


def test_slopes_of_the_limit(clear: Scene) -> None:
    limit = clearance_limit(clear)
    assert limit is not None
    x, y = np.array([20.0, 55.0, 40.0]), np.array([-40.0, -20.0, 60.0])
    slopes = limit.gradients(x, y)
    for axis in range(2):
        step = 1e-3 * np.eye(2)[axis]
        change = limit.outside_mm(x + step[0], y + step[1]) - limit.outside_mm(x - step[0], y - step[1])
        np.testing.assert_allclose(slopes[:, axis], change / 2e-3, atol=2e-3)


def test_rooms_are_told(clear: Scene) -> None:
    """At bottom dead centre the counterweight's rim is nearest the piston, the pin's end to the crankcase."""
    rooms = clearances_mm(clear)
    assert rooms[PISTON] == pytest.approx(166.0 - 48.0 - SKIRT_MM - 62.0, abs=1e-3)
    assert rooms[CRANKCASE] == pytest.approx(76.0 - 73.0, abs=1e-3)
    (loads,) = loads_at_speeds(clear)
    assert loads.clearance.room_mm == rooms
    told = "counterweight: 4.00 mm to the piston skirt, 3.00 mm to the crankcase; at least 1.5 mm stay"
    assert told in " ".join(loads_text(loads).split())


@pytest.mark.slow
def test_the_page_tells_the_room(clear: Scene) -> None:
    """Silhouettes of surfaces against the closed form of outline and counterweight."""
    smaller = weighted(clear, {**PLAIN, "outer_radius_mm": 55.0})
    bodies = tuple(
        ShownBody(name, surface_of(scene, "half"), scene.web_z_mm, scene.pitch_mm / 2)
        for name, scene in (("result", smaller), ("original web", clear))
    )
    (section,) = clearance_sections(clear, bodies)
    ((_, table),) = section.tables
    for row, scene in zip(table.rows, (smaller, clear), strict=True):
        rooms = clearances_mm(scene)
        assert row["to_the_piston_skirt_mm"] == pytest.approx(rooms[PISTON], abs=0.05)
        assert row["to_the_crankcase_mm"] == pytest.approx(rooms[CRANKCASE], abs=0.05)
    assert "at least 1.5 mm stay" in section.text
    bolted = weighted(clear, {**PLAIN, "density_kg_m3": 9000.0})
    ((_, table),) = clearance_sections(bolted, bodies[:1])[0].tables
    assert table.rows[0]["to_the_piston_skirt_mm"] == pytest.approx(clearances_mm(clear)[PISTON], abs=0.05)
    assert section.text.startswith("The result leaves ")
    assert not clearance_sections(roomy_scene(clear).model_copy(update={"envelope": None}), bodies)


@pytest.mark.parametrize(("radius_mm", "whole"), [(85.0, True), (140.0, True), (170.0, False)])
def test_a_crankcase_is_drawn_whole_unless_it_is_far_away(radius_mm: float, whole: bool) -> None:
    """Of a web that reaches 74 mm; a circle beyond twice that would make it small."""
    angle = np.linspace(0.0, np.pi, 181)
    limits = {CRANKCASE: ClearanceLimit(angle, np.full(181, radius_mm))}
    limits[PISTON] = ClearanceLimit(angle, 90.0 / np.maximum(np.cos(angle), 1e-9))
    axes = Figure().add_subplot()
    _draw_clearance(axes, {"web": [np.array([[-74.0, -20.0], [74.0, -20.0], [0.0, 60.0]])]}, limits, None)
    ends = *axes.get_xlim(), *axes.get_ylim()
    assert all(abs(end) > radius_mm for end in ends) == whole
    assert ends == pytest.approx((-ends[1], ends[1], -ends[1], ends[1]))


def test_the_design_space_ends_there(clear: Scene) -> None:
    """Cells and surface of the design space: nothing beyond, all within as it was."""
    domain, whole = (build_domain(scene, 4.0) for scene in (clear, cleared(clear, {})))
    limit = clearance_limit(clear)
    assert limit is not None
    x, y = (0.5 * (edges[1:] + edges[:-1]) for edges in (domain.grid.x_mm, domain.grid.y_mm))
    outside = limit.outside_mm(x[:, None], y[None, :])
    assert not domain.design_fraction[outside > 3.0].any()
    np.testing.assert_allclose(
        domain.design_fraction[outside < -3.0], whole.design_fraction[outside < -3.0], atol=1e-5
    )
    grid = DensityGrid(np.array([-76.0, -76.0, 20.0]), np.array([4.0, 4.0, 19.0]), np.ones((38, 40, 1)))
    solid = envelope_solid(clear, grid)
    points = np.asarray(solid.to_mesh().vert_properties)[:, :2]
    assert limit.outside_mm(*points.T).max() < 1e-3


REFUSED = {
    "piston": ({"piston_skirt_mm": 56.0}, {}, r"counterweight.*reaches 62 mm.*the piston skirt leaves 61 mm"),
    "crankcase": (
        {"crankcase_radius_mm": 73.5},
        {},
        r"web.outline.*reaches 73 mm.*crankcase leaves 72.5 mm",
    ),
    "no engine": ({"piston_skirt_mm": 40.0}, {"engine": None}, r"piston_skirt_mm.*Add \[engine\]"),
    "skirt too long": ({"piston_skirt_mm": 97.5}, {}, r"piston_skirt_mm = 97.5.*smaller than 97 mm"),
    "negative": ({"piston_skirt_mm": -1.0}, {}, r"clearance.piston_skirt_mm"),
    "unknown": ({"piston_mm": 40.0}, {}, r"unknown key envelope.clearance.piston_mm"),
    "gap": ({"least_gap_mm": -2.0}, {}, r"clearance.least_gap_mm"),
    "crankcase too small": ({"crankcase_radius_mm": 0.0}, {}, r"clearance.crankcase_radius_mm"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str, mikron: Scene) -> None:
    clearance, changes, message = REFUSED[name]
    with pytest.raises(CranktopoError, match=message):
        cleared(weighted(roomy_scene(mikron), PLAIN), clearance, **changes)
