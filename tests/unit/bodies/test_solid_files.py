"""Files of exact solids: what is written reads back with the same volume."""

from __future__ import annotations

import math
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
import trimesh

from cranktopo.base.errors import CranktopoError
from cranktopo.base.formats import SolidPart
from cranktopo.bodies.solid.files import export_solid, surface_of
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import solid_of
from tests.physics.fea.evaluation_cases import LOPSIDED, mikron_with
from tests.random_engines import random_engine
from tests.step_volume import step_volume_mm3

SHARP_WEB_MM3 = 19.0 * (50 * 48 + math.pi * 25**2 - 2 * math.pi * 12**2)


@pytest.mark.parametrize("part", ["web", "half", "throw", "crankshaft"])
def test_step_keeps_the_volume(part: SolidPart, mikron: Scene, tmp_path: Path) -> None:
    path = tmp_path / f"{part}.step"
    volume = export_solid(mikron, part, path)
    assert step_volume_mm3(path) == pytest.approx(volume, rel=1e-6)
    assert [p.name for p in tmp_path.iterdir()] == [path.name]


@pytest.mark.slow
def test_throws_of_a_shaft_are_turned_in_the_sense_of_rotation(mikron: Scene) -> None:
    """In line, three cylinders, firing 1-2-3: throw 2 fires next but one third of two turns later.

    It is 240 deg short of its dead centre, so 120 deg ahead from +y towards +x.
    """
    data = mikron.model_dump(mode="json", exclude_none=True)
    data["engine"] |= {"cylinders": 3, "firing_order": [1, 2, 3]}
    scene = scene_from_dict(data)
    x, y, z = surface_of(scene, "crankshaft").vertices_mm.T
    radius, pin = scene.throw.radius_mm, scene.throw.crankpin
    middle = np.abs(z - 1.5 * scene.pitch_mm) < pin.length_mm / 2 - pin.fillet_mm
    distance = np.hypot(x[middle] - radius * math.sin(math.radians(120)), y[middle] + radius / 2)
    assert middle.any()
    assert distance.max() < pin.radius_mm + 1e-6


def test_parts_add_up(mikron: Scene, tmp_path: Path) -> None:
    parts: tuple[SolidPart, ...] = ("web", "half", "throw")
    volumes = {part: export_solid(mikron, part, tmp_path / f"{part}.step") for part in parts}
    assert volumes["web"] == pytest.approx(SHARP_WEB_MM3, rel=1e-6)
    assert volumes["throw"] == pytest.approx(2 * volumes["half"], rel=1e-6)


def test_lopsided_throw_survives(tmp_path: Path) -> None:
    scene = mikron_with(0.0, pocket=[LOPSIDED])
    volume = export_solid(scene, "half", tmp_path / "half.step")
    whole = export_solid(mikron_with(0.0), "half", tmp_path / "whole.step")
    assert whole - volume == pytest.approx(19.0 * math.pi * 7.0**2, rel=1e-6)
    assert step_volume_mm3(tmp_path / "half.step") == pytest.approx(volume, rel=1e-6)


def test_crowned_bevel_through_a_spline_outline_is_written(mikron: Scene, tmp_path: Path) -> None:
    """The kernel's own volume errs by 3e-6 here: no reason to refuse what is right."""
    half_widths = [0.0, 12.59, 23.56, 33.51, 35.66, 33.74, 23.92, 12.48, 0.0]
    stations = [-23.66, -20.03, -9.69, 5.78, 24.03, 42.28, 57.75, 68.09, 71.73]
    bevel = {"face": "journal", "y_mm": 35.24, "depth_mm": 15.82, "crown_mm": 3.92}
    web = {"thickness_mm": 19.0, "outline": "profile", "stations_mm": stations, "half_widths_mm": half_widths}
    data = mikron.model_dump(mode="json", exclude={"web"}, exclude_none=True)
    volume = export_solid(
        scene_from_dict({**data, "web": {**web, "bevel": [bevel]}}), "web", tmp_path / "w.step"
    )
    plain = export_solid(scene_from_dict({**data, "web": web}), "web", tmp_path / "plain.step")
    assert 0.05 < 1 - volume / plain < 0.08


def test_stl_is_closed_and_near(mikron: Scene, tmp_path: Path) -> None:
    """Facets of 1 mm chords cut at most a thousandth off."""
    volume = export_solid(mikron, "web", tmp_path / "web.stl", facet_mm=1.0)
    surface = trimesh.load_mesh(tmp_path / "web.stl")
    assert surface.is_watertight
    assert surface.is_winding_consistent
    assert surface.volume == pytest.approx(volume, rel=1e-3)


def test_a_pocket_at_the_start_of_a_bevel_has_outward_normals_too(tmp_path: Path) -> None:
    """gmsh's own rule turns the floor of this pocket inward."""
    data = random_engine(0)
    pocket = {"shape": "cylinder", "face": "journal", "y_mm": 133.55, "diameter_mm": 8.09, "depth_mm": 18.05}
    web = {
        "outline": "profile",
        "thickness_mm": data["web"]["thickness_mm"],
        "stations_mm": [-57.52, -43.05, -3.52, 50.49, 104.5, 144.03, 158.5],
        "half_widths_mm": [0.0, 38.49, 60.65, 70.52, 56.97, 33.2, 0.0],
        "bevel": [{"face": "journal", "y_mm": 135.5, "depth_mm": 40.16}],
        "pocket": [{**pocket, "x_mm": 34.13}, {**pocket, "x_mm": -34.13}],
    }
    scene = scene_from_dict({**data, "web": web})
    export_solid(scene, "half", tmp_path / "half.stl", 8.0)
    surface = trimesh.load_mesh(tmp_path / "half.stl")
    assert surface.is_winding_consistent
    assert surface.volume == pytest.approx(half_throw_volume_mm3(scene), rel=1e-2)
    solid_of(surface_of(scene, "half", 8.0), "half throw")


def test_facets_of_a_throw_whose_bore_is_of_two_halves_come_to_an_end(tmp_path: Path) -> None:
    """In a process of its own, to be stopped: the frontal method refines this bore without end."""
    path = tmp_path / "throw.stl"
    code = (
        "import sys; from pathlib import Path; from cranktopo.bodies.solid.files import export_solid; "
        "from cranktopo.design.loading import scene_from_dict; "
        "from tests.random_engines import random_engine; "
        f"print(export_solid(scene_from_dict(random_engine(16)), 'throw', Path({str(path)!r}), 5.0))"
    )
    done = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, timeout=600, check=True
    )
    mesh = trimesh.load_mesh(path)
    assert mesh.is_watertight
    assert mesh.volume == pytest.approx(float(done.stdout), rel=5e-3)


def test_unknown_suffix_leaves_nothing(mikron: Scene, tmp_path: Path) -> None:
    with pytest.raises(CranktopoError, match=r"must end in \.step, \.stp or \.stl"):
        export_solid(mikron, "web", tmp_path / "web.obj")
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("name", ["web.STL", "web.Step"])
def test_suffix_in_capitals(name: str, mikron: Scene, tmp_path: Path) -> None:
    export_solid(mikron, "web", tmp_path / name, facet_mm=4.0)
    assert [path.name for path in tmp_path.iterdir()] == [name]
    assert (tmp_path / name).stat().st_size > 10_000


def test_unwritable_target_is_named_with_its_reason(mikron: Scene, tmp_path: Path) -> None:
    """No folder, and a folder in its place: not a failure of gmsh, and nothing about dimensions."""
    (tmp_path / "taken.step").mkdir()
    for path, reason in (
        (tmp_path / "absent" / "web.step", "its folder does not exist"),
        (tmp_path / "taken.step", "is a folder"),
    ):
        with pytest.raises(CranktopoError, match=reason) as caught:
            export_solid(mikron, "web", path)
        assert caught.value.code == 2
    assert [path.name for path in tmp_path.rglob("*")] == ["taken.step"]
