"""Throws of any size are fitted at a usual one: lengths are scaled there and back, nothing else."""

from __future__ import annotations

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.halves import usual_scale
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.fit import scaled_lengths, scaled_region, scaled_throw, usual_limits
from cranktopo.tasks.refit.select import ResidualRegion
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from tests.unit.refit.remodel_cases import WHOLE, known_scene


def test_usual_throws_are_left_alone(mikron: Scene) -> None:
    assert usual_scale(mikron) == 1
    assert usual_limits(mikron) == ManufacturingLimits()


@pytest.mark.parametrize(("factor", "scale"), [(1 / 7, 7.0), (10.0, 0.2)])
def test_small_and_large_throws_come_to_a_usual_size(mikron: Scene, factor: float, scale: float) -> None:
    assert usual_scale(scaled_throw(mikron, factor)) == pytest.approx(scale, rel=1e-5)


def test_limits_follow_the_throw_and_what_is_given_stays(mikron: Scene) -> None:
    small = scaled_throw(mikron, 1 / 7)
    found = usual_limits(small, min_wall_mm=0.9, cell_mm=None)
    assert found.min_wall_mm == 0.9
    assert found.min_radius_mm == pytest.approx(6 / 7, rel=1e-4)
    assert found.cell_mm == pytest.approx(1 / 7, rel=1e-4)
    assert (found.min_draft_deg, found.max_stations) == (3.0, 10)


def test_a_throw_scaled_there_and_back_is_itself(mikron: Scene) -> None:
    scene = known_scene(mikron, WHOLE)
    back = scaled_throw(scaled_throw(scene, 1 / 7), 7.0)
    for one, other in ((back.throw, scene.throw), (back.web, scene.web)):
        first, second = one.model_dump(), other.model_dump()
        assert first.keys() == second.keys()
        assert flat(first) == pytest.approx(flat(second), rel=1e-4)


def test_least_shoulder_follows_small_throws(mikron: Scene) -> None:
    """A fillet that leaves 0.1 mm of the web's face: the largest one at 42 mm, and of a seventh at 6 mm."""
    for factor in (1.0, 1 / 7):
        room = factor * (mikron.web.largest_half_width_mm - mikron.throw.crankpin.radius_mm)
        with_fillet(scaled_throw(mikron, factor), 0.99999 * (room - factor * 0.1))
        with pytest.raises(CranktopoError, match="larger than the shoulder"):
            with_fillet(scaled_throw(mikron, factor), room - factor * 0.09)


def with_fillet(scene: Scene, fillet_mm: float) -> Scene:
    """The scene with a fillet at its crankpin, checked."""
    data = scene.model_dump(exclude_none=True)
    data["throw"]["crankpin"]["fillet_mm"] = fillet_mm
    return scene_from_dict(data)


def flat(data: object) -> list[float]:
    if isinstance(data, dict):
        return [number for value in data.values() for number in flat(value)]
    if isinstance(data, (list, tuple)):
        return [number for value in data for number in flat(value)]
    return [data] if isinstance(data, float) else []


def test_angles_and_names_are_no_lengths() -> None:
    data = {"name": "a_mm", "draft_deg": 3.0, "depth_mm": 2.0, "stations_mm": [1.0, 2.5], "n": 3}
    scaled = {"name": "a_mm", "draft_deg": 3.0, "depth_mm": 4.0, "stations_mm": [2.0, 5.0], "n": 3}
    assert scaled_lengths(data, 2.0) == scaled


def test_volumes_of_regions_go_with_the_cube() -> None:
    region = ResidualRegion("window", 8.0, (1.0, 2.0, 3.0), (0.0, 0.0, 0.0), (1.0, 1.0, 1.0), True, None)
    assert scaled_region(region, 0.5).volume_mm3 == 1.0
    assert scaled_region(region, 0.5).centre_mm == (0.5, 1.0, 1.5)
