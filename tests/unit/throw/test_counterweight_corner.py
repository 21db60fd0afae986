"""Round corners between rim and flanks of a counterweight: area by formula, kernel, cells, shape, import."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.prisms import kept_solid
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.volume import web_moments, web_volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.web_shape.web_faces import web_faces
from tests.unit.throw.counterweight_cases import DISC, PLAIN, roomy_scene, weighted

ROUND = {**PLAIN, "corner_mm": 8.0}
HALF_DISC = {**DISC, "outer_radius_mm": 62.0, "corner_mm": 10.0, "fillet_mm": 10.0}


@pytest.fixture(scope="module")
def roomy(mikron: Scene) -> Scene:
    return roomy_scene(mikron)


def both_tips_mm2(outer: float, corner: float) -> float:
    """Area that two round corners take: a sector's tip less a triangle and the sector of the corner."""
    inner = outer - corner
    seen = math.asin(corner / inner)
    along = math.sqrt(inner**2 - corner**2)
    return outer**2 * seen - along * corner - corner**2 * (math.pi / 2 + seen)


@pytest.mark.parametrize("angle", [35.0, 60.0, 90.0])
@pytest.mark.parametrize("corner", [4.0, 8.0])
def test_corners_take_their_tips(roomy: Scene, angle: float, corner: float) -> None:
    sharp, rounded = (
        weighted(roomy, {**PLAIN, "half_angle_deg": angle, **more}) for more in ({}, {"corner_mm": corner})
    )
    taken = web_volume_mm3(sharp) - web_volume_mm3(rounded)
    assert taken == pytest.approx(19.0 * both_tips_mm2(62.0, corner), rel=1e-8)


@pytest.mark.parametrize("counterweight", [ROUND, HALF_DISC], ids=["round", "half disc"])
def test_solid_and_kept_body_agree(roomy: Scene, counterweight: dict[str, Any], tmp_path: Path) -> None:
    scene = weighted(roomy, counterweight)
    assert export_solid(scene, "web", tmp_path / "web.step") == pytest.approx(web_volume_mm3(scene), rel=1e-9)
    corner = counterweight["corner_mm"]
    area = math.radians(counterweight["half_angle_deg"]) * 62.0**2 - both_tips_mm2(62.0, corner)
    assert kept_solid(scene).volume() == pytest.approx(19.0 * area, rel=1e-4)


def test_cells_and_signed_distances_agree(roomy: Scene) -> None:
    scene = weighted(roomy, ROUND)
    domain = build_domain(scene, 6.0, "web", extent="quarter")
    assert 2 * float((domain.web * domain.volume_mm3).sum()) == pytest.approx(web_volume_mm3(scene), rel=1e-6)
    assert scene.web.counterweight is not None
    sector = scene.web.counterweight.sector(scene)
    x, y = np.meshgrid(np.linspace(-65, 65, 90), np.linspace(-65, -1, 60))
    half = sector.half_width_mm(y)
    inside = sector.inside_mm(x, y)
    assert ((inside > 0) == (np.abs(x) < half))[np.abs(inside) > 1e-6].all()
    rim = np.stack(sector.rim_mm(41))
    assert np.abs(sector.inside_mm(*rim)).max() < 1e-9


def test_shape_knows_the_corner(roomy: Scene) -> None:
    scene = weighted(roomy, ROUND)
    plain, found = (web_faces(one, Layout(3), mirrored=True) for one in (weighted(roomy, PLAIN), scene))
    assert len(found) == len(plain) + 1
    assert web_moments(scene).first_y > web_moments(weighted(roomy, PLAIN)).first_y


@pytest.mark.parametrize(
    ("counterweight", "message"),
    [
        ({**PLAIN, "corner_mm": 29.0}, r"corner_mm.*smaller than 2\d"),
        ({**HALF_DISC, "fillet_mm": 40.0}, r"fillet_mm.*there the flank ends"),
    ],
    ids=["no flank left", "fillet into the corner"],
)
def test_refused(roomy: Scene, counterweight: dict[str, Any], message: str) -> None:
    with pytest.raises(CranktopoError, match=message):
        weighted(roomy, counterweight)
