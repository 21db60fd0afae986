"""Other ways to a sound surface: each keeps volume and place, and one that does not is passed over."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.design.loading import load_scene
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from cranktopo.tasks.extraction import half_throw
from cranktopo.tasks.extraction.checked_surface import check_surface
from cranktopo.tasks.extraction.cutter import Cutter, build_cutter, fine_field, iso_surface_distances_mm
from cranktopo.tasks.extraction.half_throw import (
    DISTANCE_CELLS,
    VOLUME_SHARE,
    WAYS,
    ExtractionMethod,
    WebSurface,
    extract_half_throw,
    slivers_mm,
)
from cranktopo.tasks.extraction.isosurface import FineField
from tests.unit.extraction.surface_cases import ball, grid_of, obround, scene_with, without

TRIES = 2
"""Surfaces that are looked at on each way, the first of those that the program looks at."""
CELL_MM = 4.0
QUICK = "iso-value lowered by 0.001"


@pytest.fixture(autouse=True)
def few_tries(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(half_throw, "slivers_mm", lambda scene: slivers_mm(scene)[:TRIES])


@pytest.fixture(scope="module")
def grid() -> DensityGrid:
    """A slot with a dent, which smoothing and blurring round."""
    return grid_of(scene_with(), without(obround(), ball(0, 24, 41, 9)), cell_mm=CELL_MM)


@pytest.fixture
def faults(monkeypatch: pytest.MonkeyPatch) -> Iterator[list[str]]:
    """What the checks of the next surfaces find; nothing once the list is empty."""
    found: list[str] = []
    monkeypatch.setattr(half_throw, "manifold_fault", lambda mesh: found.pop(0) if found else "")
    yield found
    assert not found


def take(monkeypatch: pytest.MonkeyPatch, ways: Iterable[ExtractionMethod]) -> None:
    monkeypatch.setattr(half_throw, "WAYS", tuple(ways))


def farthest_mm(grid: DensityGrid, surface: WebSurface) -> float:
    scene = scene_with()
    cutter = build_cutter(grid, scene, None, None)
    usual = extract_half_throw(grid, scene)
    field = fine_field(cutter, grid, scene, None, None)
    return float(iso_surface_distances_mm(cutter, field, usual.iso_value, surface.web).max())


@pytest.mark.parametrize(
    "way",
    [
        pytest.param(way, id=way.name, marks=() if way.name == QUICK else pytest.mark.slow)
        for way in WAYS
        if not way.spared
    ],
)
def test_every_way_keeps_volume_and_place(
    way: ExtractionMethod, grid: DensityGrid, faults: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    take(monkeypatch, [way])
    faults += TRIES * ["crack"]
    surface = extract_half_throw(grid, scene_with())
    assert surface.fallback == way.name
    assert surface.x_symmetric
    assert check_surface(surface).bodies == 1
    assert surface.volume_mm3 == pytest.approx(surface.target_volume_mm3, rel=VOLUME_SHARE)
    monkeypatch.undo()
    assert 0 < farthest_mm(grid, surface) < DISTANCE_CELLS * CELL_MM


def test_ways_are_tried_in_their_order(grid: DensityGrid, faults: list[str]) -> None:
    """Without a place where the surface passes through itself, none stays unsmoothed."""
    open_ways = [way for way in WAYS if not way.spared]
    faults += 3 * TRIES * ["crack"]
    assert extract_half_throw(grid, scene_with()).fallback == open_ways[2].name


def test_slivers_go_within_less_before_another_way_is_taken(grid: DensityGrid, faults: list[str]) -> None:
    faults += (TRIES - 1) * ["crack"]
    assert extract_half_throw(grid, scene_with()).fallback == ""


def test_a_large_throw_may_lose_larger_slivers() -> None:
    """Beside the outlet in a journal of 487 mm a surface intersected itself at 1 um and less, not at 4 um."""
    large = load_scene("industrial-gas")
    thinner = min(journal.outer_diameter_mm for journal, _ in large.throw.journals)
    assert thinner > 84, "above the usual sizes"
    assert slivers_mm(large)[:4] == slivers_mm(scene_with())[:4]
    assert slivers_mm(large)[4:] == pytest.approx([4e-3 * thinner / 84, 1.6e-2 * thinner / 84])


@pytest.mark.parametrize(
    "wrong",
    [
        pytest.param(ExtractionMethod(name, **how), id=name, marks=marks)
        for name, how, marks in (
            ("other volume", {"shift": 0.05}, pytest.mark.slow),
            ("far away", {"blur": 5.0}, ()),
            ("nothing left", {"shift": 0.49}, pytest.mark.slow),
        )
    ],
)
def test_a_way_that_misses_volume_or_place_is_passed_over(
    wrong: ExtractionMethod, grid: DensityGrid, faults: list[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    take(monkeypatch, [wrong, ExtractionMethod("right", shift=1e-3)])
    faults += TRIES * ["crack"]
    assert extract_half_throw(grid, scene_with()).fallback == "right"


def test_where_no_way_helps_the_checks_refuse(grid: DensityGrid, monkeypatch: pytest.MonkeyPatch) -> None:
    take(monkeypatch, [])
    monkeypatch.setattr(half_throw, "self_intersections_mm", lambda mesh: np.zeros((1, 3)))
    surface = extract_half_throw(grid, scene_with())
    assert surface.fallback == ""
    lowered = surface.half_throw.vertices_mm.copy()
    lowered[0] += 50.0
    with pytest.raises(CranktopoError, match="intersects itself"):
        check_surface(
            WebSurface(**{**vars(surface), "half_throw": SurfaceMesh(lowered, surface.half_throw.faces)})
        )


def test_smoothing_is_left_out_around_the_places(grid: DensityGrid, monkeypatch: pytest.MonkeyPatch) -> None:
    """Two webs report a place however few slivers go; the third is taken, rough around both, volume kept."""
    take(monkeypatch, [way for way in WAYS if way.spared])
    places = [np.array([[25.0, 20.0, 30.0]]), np.array([[-25.0, 20.0, 30.0]])]
    found = [place for place in places for _ in range(TRIES)] + [np.zeros((0, 3))]
    rough: list[int] = []
    cut = Cutter.web

    def watched(
        cutter: Cutter, field: FineField, iso: float, rough_mm: np.ndarray | None = None, *more: bool | float
    ) -> Manifold:
        if rough_mm is not None:
            rough.append(len(rough_mm))
        return cut(cutter, field, iso, rough_mm, *more)

    monkeypatch.setattr(Cutter, "web", watched)
    monkeypatch.setattr(half_throw, "self_intersections_mm", lambda mesh: found.pop(0))
    surface = extract_half_throw(grid, scene_with())
    assert rough == [1, 2]
    assert surface.fallback == "more places unsmoothed"
    assert check_surface(surface).bodies == 1
