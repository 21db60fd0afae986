"""A crank as triangles, in a random attitude: dimensions come back within 0.02 mm and 0.05 deg."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh
from manifold3d import CrossSection, Manifold
from scipy.spatial.transform import Rotation

from cranktopo import load_scene
from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid import step
from cranktopo.bodies.solid.files import kernel_surface_of, surface_of
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.files import write_stl, write_surface
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of
from cranktopo.tasks.crank_import.compared import Compared
from cranktopo.tasks.crank_import.end_steps import EndFinder
from cranktopo.tasks.crank_import.half_body import EXACT, faceted
from cranktopo.tasks.crank_import.mesh_faces import mesh_faces
from cranktopo.tasks.crank_import.mesh_skin import Skin
from cranktopo.tasks.crank_import.mesh_walls import walls
from cranktopo.tasks.crank_import.meshes import mesh_solids
from cranktopo.tasks.crank_import.result import CrankImport
from cranktopo.tasks.crank_import.solids import parallel_axes
from cranktopo.tasks.crank_import.stage import import_crank
from cranktopo.tasks.crank_import.text import import_text
from cranktopo.tasks.importing.faces import CylinderFace, Faces
from tests.physics.crank_import.test_crank_import import built_in, run_out
from tests.random_engines import random_engine

LENGTH_MM, ANGLE_DEG = 0.02, 0.05


def turned(mesh: SurfaceMesh, seed: int) -> SurfaceMesh:
    place = 100 * np.random.default_rng(seed).normal(size=3)
    matrix = Rotation.random(random_state=seed).as_matrix()
    return SurfaceMesh(mesh.vertices_mm @ matrix.T + place, mesh.faces)


def coarse(scene: Scene, part: Any, monkeypatch: pytest.MonkeyPatch) -> SurfaceMesh:
    """Triangles that end up to 0.02 mm beside the body."""
    monkeypatch.setitem(step._TRIANGULATION, "StlLinearDeflection", 0.02)
    monkeypatch.setitem(step._TRIANGULATION, "StlAngularDeflection", 0.5)
    return kernel_surface_of(scene, part)


def imported(mesh: SurfaceMesh, name: str, folder: Path, seed: int = 3) -> CrankImport:
    write_stl(folder / "body.stl", turned(mesh, seed))
    return import_crank(folder / "body.stl", name, folder / "out", unit="mm")


def numbers(data: Any, key: str = "") -> dict[str, float]:
    if isinstance(data, dict):
        return {k: v for name, one in data.items() for k, v in numbers(one, f"{key}.{name}").items()}
    if isinstance(data, list):
        return {k: v for index, one in enumerate(data) for k, v in numbers(one, f"{key}[{index}]").items()}
    return {key: data} if isinstance(data, float) else {}


def check_near(scene: Scene, result: CrankImport, but: tuple[str, ...] = ()) -> None:
    found, wanted = (
        numbers(one.model_dump(mode="json", include={"throw", "web"}, exclude_none=True))
        for one in (load_scene(result.halves[0].design), scene)
    )
    assert found.keys() == wanted.keys()
    for key, value in wanted.items():
        if key in but:
            continue
        assert found[key] == pytest.approx(value, abs=ANGLE_DEG if key.endswith("_deg") else LENGTH_MM), key
    assert len(result.halves) == 1


@pytest.mark.slow
def test_a_half_throw_with_a_counterweight(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    scene = load_scene("car-diesel")
    result = imported(coarse(scene, "half", monkeypatch), "car", tmp_path)
    check_near(scene, result)
    assert Path(result.halves[0].body).suffix == ".stl"
    assert load_scene(result.halves[0].design).original is not None


def test_a_boss_and_a_lack_are_told() -> None:
    block, boss = Manifold.cube((40.0, 40.0, 20.0)), Manifold.cube((6.0, 6.0, 10.0)).translate((10, 10, 20))
    lacks = list(Compared(block + boss, block).differences)
    assert lacks == ["the design lacks 360 mm3, most of it near (13, 13, 25) mm"]
    adds = list(Compared(block, block + boss).differences)
    assert adds == ["the design adds 360 mm3, most of it near (13, 13, 25) mm"]
    assert not list(Compared(block, block).differences)
    sliver = Manifold.cube((40.0, 40.0, 2e-4)).translate((0, 0, 20))
    lacks = list(Compared(block + boss + sliver, block).differences)
    assert lacks == ["the design lacks 360.3 mm3, most of it near (13.01, 13.01, 25) mm"], "not its box"


def test_a_boss_among_slivers_is_told_soon() -> None:
    """The boolean engine parts 3600 of them in 10 s of a processor."""
    crumb, places = Manifold.cube((1.0, 1.0, 1.0)), range(0, 120, 2)
    crumbs = Manifold.compose([crumb.translate((x, y, 0.0)) for x in places for y in places])
    block = Manifold.cube((400.0, 400.0, 20.0)).translate((0.0, 0.0, 50.0))
    boss = Manifold.cube((6.0, 6.0, 10.0)).translate((-20.0, 0.0, 0.0))
    began = time.process_time()
    (told,) = Compared(block + boss + crumbs, block).differences
    assert told == "the design lacks 3960 mm3, most of it near (-17, 3, 5) mm"
    assert time.process_time() - began < 2.0


def test_a_small_boss_or_cut_is_told_facets_are_not() -> None:
    """Both 0.04 % of the volume, where the facets of a fine and a coarse cylinder differ by 0.06 %."""
    body, design = (Manifold.cylinder(60.0, 40.0, circular_segments=count) for count in (130, 300))
    small = Manifold.cube((5.0, 5.0, 10.0)).translate((10.0, 0.0, 55.0))
    assert list(Compared(body, design).differences_beyond_facets) == []
    assert list(Compared(body + small, design).differences_beyond_facets) == [
        "the design lacks at least 122.7 mm3, near (12.5, 2.5, 62.55) mm"
    ]
    assert list(Compared(body - small, design).differences_beyond_facets) == [
        "the design adds at least 122.7 mm3, near (12.5, 2.5, 57.45) mm"
    ]


def test_round_corners_are_no_shafts() -> None:
    """What looks like a crank has whole cylinders on two lines, not parts of them."""

    def faces(turn: float) -> Faces:
        along = np.array([0.0, 0.0, 1.0])
        places = [np.array([x, 0.0, 0.0]) for x in (0.0, 50.0)]
        return Faces(
            tuple(CylinderFace(p, along, 10.0, (0.0, 40.0), turn, True, p) for p in places), (), (), ()
        )

    assert parallel_axes(faces(np.pi)) == 0
    assert parallel_axes(faces(2 * np.pi)) == 2


def test_the_unit_is_asked_where_none_is_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = coarse(load_scene("mikron-iiic-plain"), "half", monkeypatch)
    metres = SurfaceMesh(mesh.vertices_mm / 1000, mesh.faces)
    write_stl(tmp_path / "metres.stl", metres)
    with pytest.raises(CranktopoError, match=r"tells no unit.*metres would give 98.* Give --unit m,"):
        mesh_solids(tmp_path / "metres.stl", None)
    write_stl(tmp_path / "inches.stl", SurfaceMesh(mesh.vertices_mm / 25.4, mesh.faces))
    with pytest.raises(CranktopoError, match=r"inches would give 98.* Give --unit in,"):
        mesh_solids(tmp_path / "inches.stl", None)
    found, assumed = mesh_solids(tmp_path / "metres.stl", "m")
    assert next(iter(found.values())).volume_mm3 == pytest.approx(mesh.volume_mm3, rel=1e-5)
    assert not assumed
    write_stl(tmp_path / "mm.stl", mesh)
    assert "unit = mm" in mesh_solids(tmp_path / "mm.stl", None)[1][0]


def test_3mf_and_obj(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    mesh = coarse(load_scene("mikron-iiic-plain"), "half", monkeypatch)
    write_surface(tmp_path / "body.3mf", mesh, "3mf")
    mesh.as_trimesh().export(tmp_path / "body.obj")
    for name, told in (("body.3mf", 0), ("body.obj", 1)):
        found, assumed = mesh_solids(tmp_path / name, None)
        (own,) = found.values()
        assert own.volume_mm3 == pytest.approx(mesh.volume_mm3, rel=1e-6)
        assert len(assumed) == told


def shaft(radius: float, low: float, high: float, y: float = 0.0) -> Manifold:
    return Manifold.cylinder(high - low, radius, circular_segments=64).translate((0.0, y, low))


def elliptic_web(low: float, high: float) -> Manifold:
    """An elliptic disc whose rims have unlike corners: a lean fitted to it is not zero."""
    rims = [(low, 40, 0.03), (high, 57, 0.4)]
    points = [
        (30 * np.cos(a), 26 * np.sin(a) + 8, z)
        for z, count, start in rims
        for a in start + 2 * np.pi * np.arange(count) / count
    ]
    return Manifold.hull_points(np.array(points))


def test_an_elliptic_web_turns_no_axis() -> None:
    """It goes all the way round as a journal does; both journals stay parallel and on their corners."""
    body = shaft(10.0, 0.0, 10.0) + elliptic_web(10.0, 18.0) + shaft(9.0, 18.0, 40.0, y=20.0)
    mesh = turned(mesh_of(body), 5)
    faces, journals = mesh_faces(mesh, 2e-3)
    whole = [face for face in faces.cylinders if face.full]
    assert sorted(face.radius_mm for face in whole) == pytest.approx([9.0, 10.0], abs=1e-5)
    assert all(journal.off_mm < 1e-5 for journal in journals)
    for face in whole:
        axis = Rotation.random(random_state=5).as_matrix()[:, 2]
        assert np.linalg.norm(np.cross(face.axis, axis)) < 1e-6


@pytest.mark.slow
def test_corners_beside_the_body_tell_how_sure_the_mass_is(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Triangles cut into four each have corners in the middle of chords, up to 0.02 mm inside the body."""
    scene = scene_from_dict(random_engine(12), "engine", whole=True)
    mesh, volume = coarse(scene, "half", monkeypatch), half_throw_volume_mm3(scene)
    for folder, body, low, high in (
        ("drawn", mesh, 0.0, 1e-6),
        ("again", SurfaceMesh(*trimesh.remesh.subdivide(mesh.vertices_mm, mesh.faces)), 1e-4, 2e-3),
    ):
        (tmp_path / folder).mkdir()
        result = imported(body, folder, tmp_path / folder)
        off = abs(result.halves[0].design_volume_mm3 / volume - 1)
        assert low <= off < high
        assert off < result.volume_within < max(20 * off, 1e-5)
        assert f"mass: corners of the triangles tell it within {100 * result.volume_within:.2g} %" in (
            import_text(result)
        )


def test_cylinders_end_in_the_planes_across_them() -> None:
    """Corners rounded as an STL file does lie up to 1.6e-5 mm beside a plane; their outermost are no end."""
    body = shaft(10.0, 0.0, 10.0) + shaft(14.0, 10.0, 18.0, y=9.0) + shaft(9.0, 18.0, 40.0, y=20.0)
    mesh = turned(mesh_of(body), 7)
    rounded = SurfaceMesh(mesh.vertices_mm.astype(np.float32).astype(float), mesh.faces)
    faces, _ = mesh_faces(rounded, 2e-3)
    lengths = sorted(float(np.ptp(face.span_mm)) for face in faces.cylinders if face.full)
    assert lengths == pytest.approx([8.0, 10.0, 22.0], abs=2e-6)


def frustum(low: float, high: float, radii: tuple[float, float]) -> Manifold:
    """A cone whose rims have unlike corners: its triangles are no strips."""
    points = [
        (radius * np.cos(a), radius * np.sin(a), z)
        for z, radius in ((low, radii[0]), (high, radii[1]))
        for a in 2 * np.pi * np.arange(round(50 + radius)) / round(50 + radius)
    ]
    return Manifold.hull_points(np.array(points))


def test_cones_of_an_end_are_found() -> None:
    """A slender one that a cylinder of its radius goes on in, two steep ones that meet, no chamfer."""
    cones = [(-60.0, -52.0, (4.0, 8.0)), (-52.0, -45.0, (8.0, 6.0)), (-45.0, -25.0, (9.0, 8.0))]
    seat, chamfer = frustum(-25.0, 0.0, (8.0, 8.0)), frustum(0.0, 1.0, (9.0, 10.0))
    body = seat + chamfer + frustum(1.0, 10.0, (10.0, 10.0))
    body += shaft(14.0, 10.0, 18.0, y=9.0) + shaft(9.0, 18.0, 40.0, y=20.0)
    mesh = turned(mesh_of(sum((frustum(*cone) for cone in cones), body)), 9)
    rounded = SurfaceMesh(mesh.vertices_mm.astype(np.float32).astype(float), mesh.faces)
    faces, _ = mesh_faces(rounded, 2e-3)
    axis = Rotation.random(random_state=9).as_matrix()[:, 2]
    place = 100 * np.random.default_rng(9).normal(size=3)
    assert all(cone.outward and cone.full for cone in faces.cones)
    found = [
        sorted(
            ((end - place) @ axis, radius) for end, radius in zip(cone.ends_mm, cone.radii_mm, strict=True)
        )
        for cone in faces.cones
    ]
    wanted = [[(low, radii[0]), (high, radii[1])] for low, high, radii in cones]
    assert np.array(sorted(found)) == pytest.approx(np.array(wanted), abs=1e-5)
    whole = sorted(face.radius_mm for face in faces.cylinders if face.full)
    assert whole == pytest.approx([8.0, 9.0, 10.0, 14.0], abs=1e-5)


@pytest.mark.parametrize("width", [4.0, 7.0])
def test_a_keyway_of_an_end_is_found(width: float) -> None:
    """Also one narrower than the facets that a whole cylinder may have (0.65 rad)."""
    edge = np.arcsin(width / 20)
    around = [10 * np.exp(1j * a) for a in np.linspace(edge, 2 * np.pi - edge, 64)]
    section = np.array([*around, 7 - 0.5j * width, 7 + 0.5j * width]) * np.exp(1j * np.pi / 6)
    keyed = CrossSection([np.column_stack([section.real, section.imag])]).extrude(20.0)
    body = keyed.translate((0.0, 0.0, -20.0)) + shaft(12.0, 0.0, 10.0)
    body += shaft(14.0, 10.0, 18.0, y=9.0) + shaft(9.0, 18.0, 40.0, y=20.0)
    faces, _ = mesh_faces(mesh_of(body), 2e-3)
    along = np.array([0.0, 0.0, 1.0])
    line = [face for face in faces.cylinders if face.full and np.linalg.norm(face.point_mm[:2]) < 1e-5]
    (step,) = EndFinder(faces, np.zeros(3), along).steps_beyond(line, 0.0, -1)
    assert (step.radius_mm, step.length_mm) == pytest.approx((10.0, 20.0), abs=1e-5)
    assert step.keyway is not None
    assert (step.keyway.width_mm, step.keyway.depth_mm) == pytest.approx((width, 3.0), abs=1e-5)
    assert step.keyway.direction == pytest.approx([np.sqrt(0.75), 0.5, 0.0], abs=1e-6)


def test_a_fillet_is_that_of_its_own_journal() -> None:
    """Not of a step of the shaft that is 0.003 mm thicker and larger: corners lie near that one as well."""
    arc = [(11 - np.cos(a), 9 + np.sin(a)) for a in np.linspace(0.0, np.pi / 2, 12)]
    profile = np.array([(0.0, 0.0), (10.0, 0.0), *arc, (12.0, 10.0), (12.0, 12.0), (0.0, 12.0)])
    end = CrossSection([profile]).revolve(64)
    body = shaft(10.003, -30.0, 0.0) + end + shaft(9.0, 12.0, 30.0, y=2.0)
    faces, _ = mesh_faces(mesh_of(body), 2e-3)
    assert [(t.ring_mm, t.tube_mm) for t in faces.tori] == [pytest.approx((11.0, 1.0), abs=1e-4)]


def test_dimensions_are_rounded_as_corners_scatter() -> None:
    """To what a drawing has where they are near to that; else to as many decimals as they tell."""
    fine, scan = faceted(4e-6), faceted(3e-3)
    table = {"sizes": [42.000009, 8.9012302], "angle_deg": 64.99999, "outline": "obround", "bolts": 6}
    assert fine.rounded(table) == {**table, "sizes": [42.0, 8.90123], "angle_deg": 65.0}
    assert scan.rounded(table) == {**table, "sizes": [42.0, 8.901], "angle_deg": 65.0}
    assert (fine.rounding_mm, scan.rounding_mm) == pytest.approx((1.2e-5, 5e-4))
    assert EXACT.rounded(42.000009) == 42.000009


def test_journals_that_a_drilling_joins_are_found_apart() -> None:
    """Both main journals lie on one cylinder; with rounded outlets all is one region of triangles."""
    body = shaft(10.0, 0.0, 10.0) + shaft(4.0, 10.0, 30.0, y=5.0) + shaft(10.0, 30.0, 45.0)
    skin = Skin(mesh_of(body), 2e-3)
    found = [wall for wall in walls(skin, np.flatnonzero(np.abs(skin.normals[:, 2]) < 0.1)) if wall.full]
    assert sorted(wall.span for wall in found) == [(0.0, 10.0), (10.0, 30.0), (30.0, 45.0)]


@pytest.mark.slow
@pytest.mark.parametrize("name", built_in())
def test_built_in_cranks(tmp_path: Path, name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Journals and webs; triangles do not tell a slot's length beyond the web."""
    scene = load_scene(name)
    mesh = coarse(scene, "crankshaft" if scene.engine else "throw", monkeypatch)
    check_near(scene, imported(mesh, name, tmp_path), tuple(run_out(scene)))


@pytest.mark.slow
def test_facets_of_one_size(tmp_path: Path) -> None:
    """Triangles that do not follow the cylinders."""
    scene = load_scene("car-diesel")
    check_near(scene, imported(surface_of(scene, "throw"), "car", tmp_path))


def test_corners_in_disorder_are_refused_at_once(tmp_path: Path) -> None:
    """Lines of a file that changed places: circles were looked for in its crumpled surface for an hour."""
    mesh = surface_of(load_scene("mikron-iiic-plain"), "half", 6.0)
    mixed = np.random.default_rng(1).permutation(len(mesh.vertices_mm))
    write_stl(tmp_path / "mixed.stl", SurfaceMesh(mesh.vertices_mm[mixed], mesh.faces))
    with pytest.raises(
        CranktopoError, match=r"no body of faces: \d+ % of its surface is triangles that fold"
    ):
        import_crank(tmp_path / "mixed.stl", "mixed", tmp_path / "out", unit="mm")
    sound = [mesh, surface_of(load_scene("car-diesel"), "web", 6.0)]
    assert [Skin(one, 0.01).lonely_share(0.8) < 1e-3 for one in sound] == [True, True]
