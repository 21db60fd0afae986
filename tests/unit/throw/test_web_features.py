"""End bevels and sloped side pockets: volumes by formula, by the CAD kernel and by cells; refusals."""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.table import Length
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.prisms import kept_solid
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.checks.scene import check_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.drawing.views import Sheet
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.throw.feature import Body, Feature, MirroredPrism, ThrowView
from cranktopo.throw.outline import ObroundWeb
from cranktopo.throw.primitives import Box, FeatureDrawing, Solid, number_lines
from tests.step_volume import step_volume_mm3
from tests.unit.refit.remodel_cases import WHOLE, known_scene, table

RECTANGLE = {"thickness_mm": 19.0, "outline": "rectangle", "width_mm": 60.0, "overhang_mm": 30.0}
PLANE = {"face": "journal", "y_mm": 66.0, "depth_mm": 8.0}
ARC = {"face": "pin", "y_mm": -6.0, "depth_mm": 12.0, "crown_mm": 2.5}
SLOPED = {"shape": "side", "y_mm": 27.0, "length_mm": 16.0, "height_mm": 5.0, "depth_mm": 6.0}
SLOPED |= {"offset_mm": -1.5, "draft_deg": 15.0}
GROOVE = {**SLOPED, "y_mm": 24.5, "length_mm": 103.0, "height_mm": 4.0, "depth_mm": 11.0}
"""Runs out through both ends and through the bevels there."""


def removed_mm3(scene: Scene, **features: Any) -> float:
    """Volume that features take from a plain rectangle with bores."""
    whole, cut = (scene_with_web(scene, {**RECTANGLE, **extra}) for extra in ({}, features))
    return web_volume_mm3(whole) - web_volume_mm3(cut)


def test_plane_bevel_takes_a_triangle(mikron: Scene) -> None:
    assert removed_mm3(mikron, bevel=[PLANE]) == pytest.approx(60 * 12 * 8 / 2, rel=1e-9)


def test_a_rectangle_may_end_in_half_circles_over_its_length(mikron: Scene, tmp_path: Path) -> None:
    """Corners of half the length leave no straight side: two halves of a disc and what is between them."""
    web = {"thickness_mm": 10.0, "outline": "rectangle", "overhang_mm": 26.0, "width_mm": 108.0}
    radius = mikron.throw.radius_mm / 2 + 26.0
    scene = scene_with_web(mikron, web | {"corner_radius_mm": radius})
    bores = 2 * math.pi * mikron.throw.main_journal.bore_radius_mm**2
    area = math.pi * radius**2 + (108.0 - 2 * radius) * 2 * radius - bores
    assert export_solid(scene, "web", tmp_path / "web.step") == pytest.approx(10.0 * area, rel=1e-9)


@pytest.mark.parametrize("crown_mm", [1.0, -1.0])
def test_crowned_bevel_takes_a_triangle_less_a_circle_segment(mikron: Scene, crown_mm: float) -> None:
    """A bevel short of the bore: its cross-section is a triangle less its arc's segment, or with it."""
    bevel = {"face": "pin", "y_mm": -24.0, "depth_mm": 9.0, "crown_mm": crown_mm}
    chord = math.hypot(6, 9)
    radius = (chord**2 / 4 + 1) / 2
    half_angle = math.asin(chord / 2 / radius)
    segment = radius**2 * (half_angle - math.sin(half_angle) * math.cos(half_angle))
    found = removed_mm3(mikron.model_copy(update={"throw": sharp(mikron)}), bevel=[bevel])
    assert found == pytest.approx(60 * (6 * 9 / 2 - crown_mm * segment), rel=1e-9)


def test_sloped_pocket_takes_two_frusta(mikron: Scene) -> None:
    slope = math.tan(math.radians(15.0))
    floor, mouth = 16.0 * 5.0, (16 + 12 * slope) * (5 + 12 * slope)
    middle = (16 + 6 * slope) * (5 + 6 * slope)
    prismoid = 6 / 6 * (floor + 4 * middle + mouth)
    assert removed_mm3(mikron, pocket=[SLOPED]) == pytest.approx(2 * prismoid, rel=1e-9)


@pytest.mark.parametrize(
    "features",
    [
        {"bevel": [{**PLANE, "y_mm": 50.0}]},
        pytest.param({"bevel": [ARC, {**PLANE, "y_mm": 52.0, "crown_mm": 1.0}]}, marks=pytest.mark.slow),
        pytest.param(
            {"bevel": [{**ARC, "crown_mm": -2.5}, {**PLANE, "y_mm": 52.0, "crown_mm": -1.0}]},
            marks=pytest.mark.slow,
        ),
        {"pocket": [{**SLOPED, "draft_deg": 0.0, "depth_mm": 9.0}]},
        pytest.param({"bevel": [ARC], "pocket": [SLOPED]}, marks=pytest.mark.slow),
        pytest.param({"bevel": [ARC, {**PLANE, "y_mm": 52.0}], "pocket": [GROOVE]}, marks=pytest.mark.slow),
    ],
    ids=[
        "plane",
        "two arcs",
        "two hollow arcs",
        "straight slot",
        "arc and slopes",
        "groove through arc and plane",
    ],
)
def test_solid_cells_and_sections_agree(mikron: Scene, features: dict[str, Any], tmp_path: Any) -> None:
    """The CAD kernel, its STEP file, sections and cells to 1e-6."""
    scene = scene_with_web(mikron, table(**features))
    volume = export_solid(scene, "web", tmp_path / "web.step")
    assert volume == pytest.approx(web_volume_mm3(scene), rel=1e-6)
    assert step_volume_mm3(tmp_path / "web.step") == pytest.approx(volume, rel=1e-6)
    domain = build_domain(scene, 4.0, "web", extent="quarter")
    assert 2 * float((domain.web * domain.volume_mm3).sum()) == pytest.approx(volume, rel=1e-6)


@pytest.mark.slow
def test_cells_put_the_bevel_on_its_own_face(mikron: Scene) -> None:
    """A bevel on the journal face at the pin's end: cells there are empty near that face only."""
    scene = scene_with_web(mikron, table(bevel=[{**PLANE, "y_mm": 50.0, "depth_mm": 14.0}]))
    domain = build_domain(scene, 2.0, "web", extent="half")
    x, y = (
        np.searchsorted(edges, at) - 1 for edges, at in ((domain.grid.x_mm, 16.0), (domain.grid.y_mm, 62.0))
    )
    first, past = domain.web_layers
    column = domain.web[x, y, first:past]
    assert column[0] == 0
    assert column[-1] == 1
    depth = float((1 - column).sum() * np.diff(domain.grid.z_mm)[first])
    arc = scene.web.bevel[0].arc(scene)
    middle = (domain.grid.y_mm[y] + domain.grid.y_mm[y + 1]) / 2
    assert depth == pytest.approx(float(arc.depth_at_mm(np.array([middle]))[0]), abs=0.05)


def test_whole_family_is_one_checked_solid(mikron: Scene, tmp_path: Any) -> None:
    scene = known_scene(mikron, WHOLE)
    volume = export_solid(scene, "half", tmp_path / "half.step")
    assert step_volume_mm3(tmp_path / "half.step") == pytest.approx(volume, rel=1e-6)


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "bevel over the fillet": ({"bevel": [{**PLANE, "y_mm": 22.0}]}, r"bevel\[0\].y_mm.*fillet"),
    "bevel too deep": ({"bevel": [{**PLANE, "depth_mm": 19.0}]}, r"depth_mm.*smaller than.*19 mm"),
    "bevel beyond the end": ({"bevel": [{**PLANE, "y_mm": 80.0}]}, r"y_mm.*beyond the end.*75 mm"),
    "arc turns back": ({"bevel": [{**PLANE, "crown_mm": 5.0}]}, r"crown_mm.*at most"),
    "hollow arc turns back": ({"bevel": [{**PLANE, "crown_mm": -5.0}]}, r"crown_mm.*at least -"),
    "two on a face": ({"bevel": [PLANE, PLANE]}, "one bevel per face"),
    "pocket into the bevel": (
        {"bevel": [{**PLANE, "y_mm": 24.0, "depth_mm": 15.0}], "pocket": [{**SLOPED, "length_mm": 34.0}]},
        "run into a bevel",
    ),
    "pocket through a face": ({"pocket": [{**SLOPED, "height_mm": 15.0}]}, r"height_mm.*smaller than"),
    "pockets meet": (
        {"pocket": [SLOPED, {"shape": "cylinder", "x_mm": 33.0, "y_mm": 27.0, "diameter_mm": 6.0}]},
        r"pocket\[0\].*meets web.pocket\[1\]",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str, mikron: Scene) -> None:
    features, message = REFUSED[name]
    with pytest.raises(CranktopoError, match=message):
        scene_with_web(mikron, table(**features))


def sharp(scene: Scene) -> Any:
    """The throw without fillets and with small journals, so that a bevel may start near them."""
    throw = scene.throw
    small = throw.crankpin.model_copy(update={"fillet_mm": 0.0, "outer_diameter_mm": 30.0})
    return throw.model_copy(update={"crankpin": small})


@dataclass(frozen=True)
class LugBody(MirroredPrism):
    """A block across the main journal's end of the web that no optimiser takes away."""

    half_mm: float
    end_mm: float
    kept: ClassVar[bool] = True

    @property
    def y_range_mm(self) -> tuple[float, float]:
        return -self.end_mm, -20.0

    def half_width_mm(self, y_mm: Array) -> Array:
        low, high = self.y_range_mm
        return np.where((y_mm >= low) & (y_mm <= high), self.half_mm, 0.0)

    @property
    def x_range_mm(self) -> tuple[float, float]:
        return -self.half_mm, self.half_mm

    def solids(self) -> tuple[Solid, ...]:
        (y0, y1), (z0, z1) = self.y_range_mm, self.z_mm
        return (Box((-self.half_mm, y0, z0), (2 * self.half_mm, y1 - y0, z1 - z0)),)


class Lug(Feature):
    """A lug away from the crankpin, flush with the journal face."""

    width_mm: Length
    end_mm: Length
    thickness_mm: Length

    def bodies(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        start = scene.web_z_mm[0]
        return (LugBody(key, (start, start + self.thickness_mm), self.width_mm / 2, self.end_mm),)

    def check_alone(self, scene: ThrowView, key: str) -> None:
        if self.thickness_mm > scene.web.thickness_mm:
            raise invalid(f"{key}.thickness_mm", self.thickness_mm, "thicker than the web")

    def check_in_web(self, scene: ThrowView, key: str) -> None:
        if scene.web.counterweight is not None:
            raise CranktopoError(f"{key}: lies in web.counterweight.")

    def drawing(self, scene: ThrowView) -> FeatureDrawing:
        half, end = self.width_mm / 2, -self.end_mm
        corners = ((-half, end), (half, end), (half, -20.0), (-half, -20.0))
        return FeatureDrawing(added=corners, lines=number_lines("LUG", self.model_dump()))


class LuggedWeb(ObroundWeb):
    """Registered as the documentation says: a field of the web, and its name among the keys."""

    lug: Lug | None = None
    single_keys: ClassVar[tuple[str, ...]] = (*ObroundWeb.single_keys, "lug")


LUG_MM3 = 20 * (32 - 20) * 12.0


def lugged(scene: Scene, **changes: Any) -> Scene:
    lug = {"width_mm": 20.0, "end_mm": 32.0, "thickness_mm": 12.0, **changes}
    web = {"outline": "obround", "width_mm": 50.0, "thickness_mm": 19.0, "lug": lug}
    assert scene.envelope is not None
    free = {"bearing_clearance_mm": 0.0, "rod_clearance_mm": 0.0}
    envelope = scene.envelope.model_copy(update=free)
    return scene.model_copy(update={"web": LuggedWeb.model_validate(web), "envelope": envelope})


def without_lug(scene: Scene) -> Scene:
    return scene.model_copy(update={"web": scene.web.model_copy(update={"lug": None})})


def test_a_new_kept_body_has_mass_solid_and_drawing(mikron: Scene, tmp_path: Path) -> None:
    """What of it lies beyond the round end of the outline is added."""
    scene = lugged(mikron)
    check_scene(scene)
    below_arc = 10 * math.sqrt(25**2 - 10**2) + 25**2 * math.asin(10 / 25)
    added = (20 * 32 - below_arc) * 12.0
    assert web_volume_mm3(scene) - web_volume_mm3(without_lug(scene)) == pytest.approx(added, rel=1e-9)
    assert export_solid(scene, "web", tmp_path / "web.step") == pytest.approx(web_volume_mm3(scene), rel=1e-6)
    sheet = Sheet(scene, Manifold())
    assert sheet.y_range_mm[0] == -32.0
    assert "LUG" in sheet.features[-1].lines


def test_no_optimiser_takes_a_new_kept_body_away(mikron: Scene) -> None:
    scene = lugged(mikron)
    plain, found = (build_domain(one, 3.0) for one in (without_lug(scene), scene))
    volumes = plain.volume_mm3 / plain.symmetry_fraction / 2
    kept = (found.passive_fraction - plain.passive_fraction) * volumes
    assert float(kept.sum()) == pytest.approx(LUG_MM3, rel=1e-6)
    whole = plain.passive_fraction + plain.design_fraction
    np.testing.assert_allclose(found.passive_fraction + found.design_fraction, whole, atol=1e-5)
    assert kept_solid(scene).volume() == pytest.approx(LUG_MM3, rel=1e-6)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"thickness_mm": 20.0}, r"web.lug.thickness_mm = 20.0: thicker than the web"),
        ({"end_mm": 36.0}, r"web.lug.*beyond the design space \[envelope\] at x = 10, y = -36 mm"),
    ],
    ids=["its own check", "outside the design space"],
)
def test_a_new_kept_body_is_checked(changes: dict[str, float], message: str, mikron: Scene) -> None:
    with pytest.raises(CranktopoError, match=message):
        check_scene(lugged(mikron, **changes))
