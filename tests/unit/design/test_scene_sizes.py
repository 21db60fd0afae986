"""Dimensions far from all others, design spaces in another unit, polygons that cross themselves."""

from __future__ import annotations

import time
from pathlib import Path

import numpy as np
import pytest
import trimesh

from cranktopo.base.errors import CranktopoError
from cranktopo.base.spans import self_intersection
from cranktopo.bodies.cells.domain import throw_ranges_mm
from cranktopo.bodies.envelope_file import envelope_from_file
from cranktopo.bodies.solid.step import step_surface
from cranktopo.bodies.volume import web_moments
from cranktopo.design.loading import designs_folder, parse_scene, scene_from_dict
from cranktopo.design.schema import Scene, ThrowTable
from cranktopo.numerics.surfaces.files import read_stl

MIKRON = (designs_folder() / "mikron-iiic-plain.toml").read_text(encoding="utf-8")
BARE = MIKRON[: MIKRON.index("[envelope]")]


def scene(old: str = "", new: str = "", envelope: str = "") -> Scene:
    assert old in BARE
    return parse_scene(BARE.replace(old, new, 1) + (f"[envelope]\n{envelope}\n" if envelope else ""))


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (
            "thickness_mm = 19.0",
            "thickness_mm = 0.1",
            r"web.thickness_mm = 0.1: must be >= 0.138 and",
        ),
        ("length_mm = 40.0", "length_mm = 5000.0", "throw.main_journal.length_mm = 5000.0: must be"),
        ("width_mm = 50.0", "width_mm = 9000.0", r"web \(its length along the throw\) = 9048.0"),
        ("fillet_mm = 2.5", "fillet_mm = 1e-5", "throw.main_journal.fillet_mm = 1e-05: must be >= 0.0138"),
        ("bore_diameter_mm = 24.0", "bore_diameter_mm = 1e-9", "bore_diameter_mm = 1e-09: must be"),
    ],
)
def test_a_dimension_far_from_all_others(old: str, new: str, message: str) -> None:
    with pytest.raises(CranktopoError, match=message):
        scene(old, new)


@pytest.mark.parametrize(
    ("envelope", "unit"),
    [
        (
            'shape = "box"\nhalf_width_mm = 1219.2\ny_min_mm = -863.6\ny_max_mm = 2082.8',
            "inches (25.4 times)",
        ),
        ('shape = "cylinder"\nradius_mm = 2082.8', "inches (25.4 times)"),
        ('shape = "cylinder"\nradius_mm = 820.0', "centimetres (10 times)"),
        ('shape = "outline"\npoints_mm = [[-2000, -900], [2000, -900], [0, 4000]]', "inches"),
    ],
)
def test_a_design_space_in_another_unit(envelope: str, unit: str) -> None:
    with pytest.raises(CranktopoError) as caught:
        scene(envelope=envelope)
    assert "times the throw (69 mm)" in caught.value.message
    assert unit in caught.value.hint


def test_a_surface_in_another_unit(tmp_path: Path) -> None:
    box = trimesh.creation.box(extents=(96.0, 116.0, 60.0))
    box.apply_translation((0, 24, 30))
    for factor in (1.0, 25.4):
        box.copy().apply_scale(factor).export(tmp_path / f"{factor}.stl")
        found = scene(envelope=f'shape = "stl"\nfile = "{tmp_path}/{factor}.stl"')
        if factor == 1.0:
            assert throw_ranges_mm(found, "envelope")[0] == (-48.0, 48.0)
            continue
        with pytest.raises(CranktopoError, match=r"30.2 times the throw.*inches"):
            throw_ranges_mm(found, "envelope")


SQUARE = [(0, 0), (4, 0), (4, 4), (0, 4)]


@pytest.mark.parametrize(
    ("points", "expected"),
    [
        (SQUARE, None),
        (SQUARE[::-1], None),
        ([(0, 0), (2, 0), (4, 0), (4, 4), (0, 4)], None),
        ([(0, 0), (4, 4), (4, 0), (0, 4)], (2, 2)),
        ([(0, 0), (4, 0), (4, 4), (2, 0), (0, 4)], (2, 0)),
        ([(0, 0), (4, 0), (2, 0), (2, 4)], (4, 0)),
        ([*SQUARE[:2], SQUARE[1], *SQUARE[2:]], (4, 0)),
        ([*SQUARE, (0, 2), (4, 2)], (4, 2)),
        ([*SQUARE, *SQUARE], (0, 0)),
        ([(0, 0), (1, 0), (2, 0)], (2, 0)),
    ],
)
def test_where_a_polygon_crosses_itself(
    points: list[tuple[float, float]], expected: tuple[float, float] | None
) -> None:
    assert self_intersection(np.array(points, float)) == expected


def test_random_polygons() -> None:
    """Star-shaped ones are simple; two corners of one exchanged, they cross."""
    rng = np.random.default_rng(1)
    for n in rng.integers(6, 40, 50):
        angle = np.sort(rng.choice(360, n, replace=False)) * np.pi / 180
        if np.diff(np.append(angle, angle[0] + 2 * np.pi)).max() > 3:
            continue
        points = (rng.uniform(1, 2, n) * np.array([np.cos(angle), np.sin(angle)])).T
        assert self_intersection(points) is None
        swapped = points.copy()
        swapped[[0, n // 2]] = points[[n // 2, 0]]
        assert self_intersection(swapped) is not None


def test_a_bow_tie_is_refused() -> None:
    bow = "points_mm = [[-40, -30], [40, 80], [40, -30], [-40, 80]]"
    with pytest.raises(CranktopoError, match=r"envelope.points_mm = .*touches itself at \(0, 25\) mm"):
        scene(envelope=f'shape = "outline"\n{bow}')
    closed = "points_mm = [[-40, -30], [40, -30], [40, 80], [-40, 80], [-40, -30]]"
    assert scene(envelope=f'shape = "outline"\n{closed}').envelope is not None


@pytest.mark.parametrize(
    "content",
    [
        b"",
        b"solid x\nfacet normal 0 0 1\nouter loop\nvertex nan 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\n"
        b"endfacet\nendsolid x\n",
        b"\0" * 80 + (2**31).to_bytes(4, "little") + b"\0" * 100,
        b"PK\x03\x04" + b"x" * 200,
    ],
    ids=["empty", "nan", "counts too many", "zip"],
)
def test_files_that_are_no_stl(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "x.stl").write_bytes(content)
    with pytest.raises(CranktopoError, match=r"cannot be read as STL|holds no triangles"):
        envelope_from_file(tmp_path / "x.stl")


def test_coordinates_beyond_any_part(tmp_path: Path) -> None:
    trimesh.creation.box(extents=(1e7, 1, 1)).export(tmp_path / "x.stl")
    with pytest.raises(CranktopoError, match="no numbers or beyond"):
        read_stl(tmp_path / "x.stl")


@pytest.mark.parametrize("content", [b"", b"\0" * 5000, b"<html>", b"ISO-10303-21;\ngarbage"], ids=repr)
def test_files_that_are_no_step(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "x.step").write_bytes(content)
    with pytest.raises(CranktopoError, match=r"x: (is no STEP file|cannot be read as STEP|holds 0 solids)"):
        step_surface(tmp_path / "x.step", "x")


def test_a_web_balanced_about_the_crank_axis_has_moments_at_once() -> None:
    """Its first moment is zero but for rounding, which no halving of intervals removes."""
    disc = 'outline = "tapered"\nmain_radius_mm = 80.0\npin_radius_mm = 30.0'
    solid = scene('outline = "obround"\nwidth_mm = 50.0', disc)
    bore = np.pi * 12.0**2 * 19.0
    began = time.process_time()
    found = web_moments(solid)
    assert time.process_time() - began < 5
    assert found.volume == pytest.approx(np.pi * 80.0**2 * 19.0 - 2 * bore, rel=1e-9)
    assert found.first_y == pytest.approx(-bore * 48.0, rel=1e-6)
    closed = scene('outline = "obround"\nwidth_mm = 50.0', disc).model_copy(update={"throw": _solid(solid)})
    assert abs(web_moments(closed).first_y) < 1e-6 * found.volume
    assert time.process_time() - began < 5


def _solid(hollow: Scene) -> ThrowTable:
    throw = hollow.throw
    main, pin = (j.model_copy(update={"bore_diameter_mm": 0.0}) for j in (throw.main_journal, throw.crankpin))
    return throw.model_copy(update={"main_journal": main, "crankpin": pin})


@pytest.mark.parametrize(("diameter_mm", "cell_mm"), [(290.0, 5.18), (84.0, 1.5), (42.0, 1.5), (21.0, 0.75)])
def test_cells_are_in_proportion_to_the_journals(diameter_mm: float, cell_mm: float) -> None:
    """Those of a design that does not say how large: 1.5 mm were 12 million cells for a journal of 290 mm."""
    factor = diameter_mm / 42.0
    journal = {"outer_diameter_mm": diameter_mm, "bore_diameter_mm": 0.0, "fillet_mm": 2.5 * factor}
    throw = {
        "radius_mm": 48.0 * factor,
        "main_journal": {**journal, "length_mm": 40.0 * factor},
        "crankpin": {**journal, "length_mm": 36.0 * factor},
    }
    web = {"thickness_mm": 19.0 * factor, "outline": "obround", "width_mm": 50.0 * factor}
    data = {
        "schema_version": 1,
        "name": "large",
        "throw": throw,
        "web": web,
        "material": {"name": "31CrMoV9"},
    }
    assert scene_from_dict(data).optimise.resolution_mm == cell_mm
    assert scene_from_dict({**data, "optimise": {"resolution_mm": 2.0}}).optimise.resolution_mm == 2.0
