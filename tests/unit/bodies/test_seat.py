"""The density optimisation keeps the seat of a bolted counterweight, and its space free of the web."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.prisms import feature_holes, kept_solid
from cranktopo.bodies.seat import seat_solid
from cranktopo.bodies.volume import counterweight_mass
from cranktopo.bodies.zones import zone_solids
from cranktopo.design.assumed import ENVELOPE, SEAT, assumptions
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.seat import seat_mm
from cranktopo.tasks.optimise.stage import RUN_TABLES

pytestmark = pytest.mark.usefixtures("fine_triangles")

HEAVY = 17000.0
WEIGHT = {"outer_radius_mm": 62.0, "half_angle_deg": 60.0, "density_kg_m3": HEAVY}
JOINT = {"thread": "M8", "grip_mm": 25.0, "holds": "web.counterweight"}


def with_weight(weight: dict[str, Any] | None, **tables: Any) -> Scene:
    """The plain Mikron with an obround web of 60 mm, and a counterweight."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["web"] = {"thickness_mm": 19.0, "outline": "obround", "width_mm": 60.0}
    if weight:
        data["web"]["counterweight"] = weight
    data["envelope"] = {"shape": "box", "half_width_mm": 64.0, "y_min_mm": -66.0, "y_max_mm": 75.0}
    return scene_from_dict({**data, **tables}, "seat")


def test_a_seat_takes_the_threads_that_hold_it_and_is_a_wall_without_bolts() -> None:
    assert seat_mm(with_weight(WEIGHT)) == pytest.approx(19.0 / 8)
    assert seat_mm(with_weight(WEIGHT, bolted_joint=[JOINT])) == pytest.approx(12.0)
    other = {**JOINT, "holds": None, "max_force_N": 100.0}
    assert seat_mm(with_weight(WEIGHT, bolted_joint=[other])) == pytest.approx(19.0 / 8)
    assert seat_mm(with_weight({**WEIGHT, "density_kg_m3": None})) is None


def test_the_seat_is_kept_and_the_counterweight_s_space_is_not_designed() -> None:
    """Polar oracle: below the crank axis the obround is a half disc of 30 mm, its seat a ring of a sector."""
    scene = with_weight(WEIGHT, bolted_joint=[JOINT])
    kept, empty = zone_solids(scene)
    ring, _ = quad(lambda r: 2 * np.pi / 3 * r, 30.0 - 12.0, 30.0)
    assert kept.volume() == pytest.approx(19.0 * ring, rel=1e-3)
    weight_mm3 = counterweight_mass(scene).volume / density_kg_per_mm3(HEAVY)
    assert empty.volume() == pytest.approx(weight_mm3, rel=1e-3)
    assert (kept_solid(scene) ^ kept).volume() == pytest.approx(kept.volume(), rel=1e-9)
    assert (feature_holes(scene) ^ empty).volume() == pytest.approx(empty.volume(), rel=1e-9)


def test_cells_of_the_seat_are_solid_and_those_of_the_counterweight_are_no_design_space() -> None:
    scene = with_weight(WEIGHT, bolted_joint=[JOINT])
    domain = build_domain(scene, 3.0, extent="half")
    grid = domain.grid
    x, y, _ = np.meshgrid(*((n[1:] + n[:-1]) / 2 for n in (grid.x_mm, grid.y_mm, grid.z_mm)), indexing="ij")
    first, last = domain.web_layers
    web = np.zeros(grid.cells, bool)
    web[..., first:last] = True
    r, off_axis = np.hypot(x, y), np.degrees(np.arctan2(np.abs(x), -y))
    seat = web & (r > 21.0) & (r < 27.0) & (off_axis < 50.0)
    space = web & (r > 33.0) & (r < 59.0) & (off_axis < 50.0)
    assert seat.sum() > 100
    assert space.sum() > 1000
    np.testing.assert_allclose(domain.passive_fraction[seat], 1.0, atol=1e-6)
    assert not domain.design_fraction[seat].any()
    assert not (domain.design_fraction + domain.passive_fraction)[space].any()
    beside = web & (r > 33.0) & (r < 55.0) & (off_axis > 75.0) & (off_axis < 85.0)
    assert (domain.design_fraction[beside] > 0.99).all()


def test_a_thin_counterweight_takes_its_own_heights_alone() -> None:
    scene = with_weight({**WEIGHT, "thickness_mm": 8.0, "face": "pin"}, bolted_joint=[JOINT])
    start, end = scene.web_z_mm
    *_, low, _, _, high = seat_solid(scene).bounding_box()
    assert (low, high) == pytest.approx((end - 8.0, end))
    domain = build_domain(scene, 3.0, extent="half")
    free = build_domain(with_weight(None), 3.0, extent="half", grid=domain.grid)
    below = domain.grid.z_mm[1:] <= end - 8.0 + 1e-9
    below &= domain.grid.z_mm[:-1] >= start - 1e-9
    assert below.any()
    assert (domain.design_fraction[..., below] == free.design_fraction[..., below]).all()


@pytest.mark.parametrize("weight", [None, {**WEIGHT, "density_kg_m3": None}], ids=["none", "one piece"])
def test_without_a_bolted_counterweight_nothing_is_added(weight: dict[str, Any] | None) -> None:
    scene = with_weight(weight, bolted_joint=[])
    assert seat_solid(scene).is_empty()
    assert all(solid.is_empty() for solid in zone_solids(scene))
    assert "envelope.frozen" not in [item.key for item in assumptions(scene, (ENVELOPE, SEAT))]


def test_the_seat_is_told_among_what_is_assumed() -> None:
    scene = with_weight(WEIGHT, bolted_joint=[JOINT])
    assert SEAT in RUN_TABLES
    (told,) = assumptions(scene, (SEAT,))
    assert "seat of web.counterweight" in str(told)
    assert "12 mm" in str(told)
