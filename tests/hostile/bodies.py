"""Bodies that are no crank, or none that can be read: each family drawn at random by a seed."""

from __future__ import annotations

import random
from collections.abc import Callable
from pathlib import Path

import numpy as np
import trimesh
from manifold3d import CrossSection, Manifold

COUNT = 200


def hostile_body(seed: int, folder: Path) -> Path:
    """Write the body of a seed; return its file."""
    families = (*_MESHES, *_FILES, *_STEPS)
    family = families[seed % len(families)]
    return family(random.Random(seed), folder)


def _bar(radius: float, length: float, x: float = 0.0, z: float = 0.0) -> Manifold:
    return Manifold.cylinder(length, radius, radius, 48).translate((x, 0.0, z))


def _box(x: float, y: float, z: float) -> Manifold:
    return Manifold.cube((x, y, z), True)


def crank(r: random.Random) -> Manifold:
    """A plain throw of two webs that could be read."""
    arm = _box(50, 110, 18).translate((0, 30, 0))
    main, pin = r.uniform(18, 22), r.uniform(16, 20)
    webs = arm.translate((0, 0, 40)) + arm.translate((0, 0, 80))
    pins = _bar(pin, 40).translate((0, 60, 40))
    return webs + pins + _bar(main, 32) + _bar(main, 40, z=85)


def _stl(body: Manifold, folder: Path) -> Path:
    mesh = body.to_mesh()
    points, faces = np.asarray(mesh.vert_properties)[:, :3], np.asarray(mesh.tri_verts)
    return _written(points, faces, folder)


def _written(points: np.ndarray, faces: np.ndarray, folder: Path, suffix: str = ".stl") -> Path:
    path = folder / f"body{suffix}"
    with np.errstate(all="ignore"):  # coordinates that are no numbers
        trimesh.Trimesh(points, faces, process=False).export(path)
    return path


def _parts(body: Manifold) -> tuple[np.ndarray, np.ndarray]:
    mesh = body.to_mesh()
    return np.asarray(mesh.vert_properties)[:, :3].copy(), np.asarray(mesh.tri_verts).copy()


def _open(r: random.Random, folder: Path) -> Path:
    points, faces = _parts(crank(r))
    return _written(points, np.delete(faces, r.sample(range(len(faces)), r.randint(1, 40)), axis=0), folder)


def _inverted(r: random.Random, folder: Path) -> Path:
    points, faces = _parts(crank(r))
    return _written(points * r.choice([(-1, 1, 1), (1, -1, 1), (-1, -1, -1)]), faces, folder)


def _half_turned(r: random.Random, folder: Path) -> Path:
    points, faces = _parts(crank(r))
    some = r.sample(range(len(faces)), len(faces) // 3)
    faces[some] = faces[some][:, ::-1]
    return _written(points, faces, folder)


def _sheet(r: random.Random, folder: Path) -> Path:
    side = r.uniform(50, 300)
    points = np.array([(0, 0, 0), (side, 0, 0), (side, side, 0), (0, side, 0)], float)
    return _written(points, np.array([(0, 1, 2), (0, 2, 3), (0, 2, 1), (0, 3, 2)]), folder)


def _flattened(r: random.Random, folder: Path) -> Path:
    points, faces = _parts(crank(r))
    points[:, r.randrange(3)] = 0
    return _written(points, faces, folder)


def _gear(r: random.Random, folder: Path) -> Path:
    teeth, radius = r.randint(12, 60), r.uniform(30, 120)
    angles = np.linspace(0, 2 * np.pi, 4 * teeth, endpoint=False)
    out = radius * np.where(np.arange(4 * teeth) % 4 < 2, 1.0, 0.88)
    profile = CrossSection([np.column_stack([out * np.cos(angles), out * np.sin(angles)])])
    gear = Manifold.extrude(profile, r.uniform(10, 40)) - _bar(0.3 * radius, 99, z=-1)
    return _stl(gear + (_bar(0.5 * radius, 60, z=5) - _bar(0.3 * radius, 99)), folder)


def _rod(r: random.Random, folder: Path) -> Path:
    """A connecting rod; some have bosses on one side or on both, which are full cylinders."""
    length, boss = r.uniform(100, 200), r.choice([0, 0, 3, 5])
    big, small = _bar(38, 24 + 2 * boss, z=-12 - boss), _bar(20, 24 + 2 * boss, length, -12 - boss)
    body = big + small + _box(length, 24, 14).translate((length / 2, 0, 0))
    bores = _bar(26, 99, z=-40) + _bar(11, 99, length, -40)
    return _stl(body - bores, folder)


def _camshaft(r: random.Random, folder: Path) -> Path:
    body = _bar(12, 400)
    for number in range(r.randint(2, 8)):
        nose = CrossSection.circle(6, 48).translate((0, r.uniform(14, 18)))
        cam = CrossSection.batch_hull([CrossSection.circle(16, 48), nose]).rotate(r.uniform(0, 360))
        body += Manifold.extrude(cam, 12).translate((0, 0, 40 + 42 * number))
    return _stl(body, folder)


def _eccentrics(r: random.Random, folder: Path) -> Path:
    """Discs off the axis that swallow it: no pin lies beside a web."""
    body = _bar(12, 300)
    for number in range(r.randint(1, 4)):
        body += _bar(30, 20, r.uniform(4, 10), 40 + 60 * number)
    return _stl(body, folder)


def _shaft(r: random.Random, folder: Path) -> Path:
    body = _bar(20, 60)
    for number in range(r.randint(1, 5)):
        body += _bar(r.uniform(10, 50), 50, z=40 * (number + 1))
    return _stl(body, folder)


def _plain(r: random.Random, folder: Path) -> Path:
    size = r.uniform(40, 200)
    bodies = (
        lambda: _box(size, size, size / 3),
        lambda: Manifold.sphere(size, 48),
        lambda: Manifold.revolve(CrossSection.circle(size / 4, 24).translate((size, 0)), 48),
        lambda: Manifold.cylinder(size, size / 2, 1.0, 48),
        lambda: _bar(size, 90) - _bar(size / 2, 190, z=-9),
        lambda: Manifold.tetrahedron().scale((size, size, size)),
    )
    return _stl(r.choice(bodies)(), folder)


def _plate(r: random.Random, folder: Path) -> Path:
    """A plate with studs on one side, or with holes."""
    body = _box(200, 120, 15)
    for number in range(r.randint(2, 5)):
        stud = _bar(r.uniform(8, 15), 40, -80 + 40 * number, 0 if r.random() < 0.9 else -20)
        body = body + stud if seed_even(r) else body - stud
    return _stl(body, folder)


def seed_even(r: random.Random) -> bool:
    """Return a fair coin's side."""
    return r.random() < 0.5


def _loose(r: random.Random, folder: Path) -> Path:
    """Several solids, none of which is a crank, or two that are."""
    if seed_even(r):
        return _stl(crank(r) + crank(r).translate((400, 0, 0)), folder)
    return _stl(_box(50, 50, 50) + _bar(20, 99, 100) + Manifold.sphere(20, 24).translate((300, 0, 0)), folder)


def _apart(r: random.Random, folder: Path) -> Path:
    """A crank whose pin or webs are loose parts."""
    gap = r.uniform(1, 5)
    arm = _box(50, 110, 18).translate((0, 30, 0))
    return _stl(arm + _bar(20, 40, z=9 + gap) + _bar(18, 40).translate((0, 60, -49 - gap)), folder)


def _crossing(r: random.Random, folder: Path) -> Path:
    """Two bodies through each other, not joined."""
    (a, first), (b, second) = _parts(_box(80, 80, 20)), _parts(_bar(20, 90, z=-40))
    return _written(np.vstack([a, b]), np.vstack([first, second + len(a)]), folder)


def _noise(r: random.Random, folder: Path) -> Path:
    points, faces = _parts(crank(r))
    points += np.random.default_rng(r.randrange(99)).normal(scale=r.uniform(0.8, 5), size=points.shape)
    return _written(points, faces, folder)


def _sheared(r: random.Random, folder: Path) -> Path:
    points, faces = _parts(crank(r))
    points[:, 0] += r.uniform(0.4, 1.5) * points[:, 1]
    return _written(points, faces, folder)


def _other_unit(r: random.Random, folder: Path) -> Path:
    points, faces = _parts(crank(r))
    return _written(points * r.choice([1e-3, 1 / 25.4, 1e-6, 1e4]), faces, folder)


def _far_away(r: random.Random, folder: Path) -> Path:
    points, faces = _parts(crank(r))
    return _written(points + r.choice([1e7, 1e30, float("nan"), float("inf")]), faces, folder)


def _many_triangles(r: random.Random, folder: Path) -> Path:
    return _stl(Manifold.sphere(r.uniform(50, 300), r.choice([64, 200, 400])), folder)


_MESHES: tuple[Callable[[random.Random, Path], Path], ...] = (
    _open, _inverted, _half_turned, _sheet, _flattened, _gear, _rod, _camshaft, _eccentrics, _shaft, _plain,
    _plate, _loose, _apart, _crossing, _noise, _sheared, _other_unit, _far_away, _many_triangles,
)  # fmt: skip


def _raw(r: random.Random, folder: Path) -> Path:
    """An empty file, or bytes of no kind, under any name that is read."""
    path = folder / f"body{r.choice(['.stl', '.3mf', '.obj', '.step', '.stp', '.brep', '.BREP'])}"
    path.write_bytes(r.choice([b"", b"solid x\nendsolid x\n", r.randbytes(400), b"PK\x03\x04", b"v 1 2 3\n"]))
    return path


def _cut_short(r: random.Random, folder: Path) -> Path:
    suffix = r.choice([".stl", ".obj", ".3mf"])
    from cranktopo.numerics.surfaces.files import write_surface
    from cranktopo.numerics.surfaces.mesh import mesh_of

    path = folder / f"body{suffix}"
    if suffix == ".3mf":
        write_surface(path, mesh_of(crank(r)), "3mf")
    else:
        _written(*_parts(crank(r)), folder, suffix)
    path.write_bytes(path.read_bytes()[: r.randrange(90, path.stat().st_size // 2)])
    return path


_FILES = (_raw, _cut_short)


def _step(r: random.Random, folder: Path) -> Path:
    """Exact bodies that are no crank: boxes, bars, sheets, a rod, a plate with studs, a sheared shaft."""
    from cranktopo.numerics.gmsh_session import cad_session, quiet_stdout

    path = folder / f"body{r.choice(['.step', '.brep'])}"
    with cad_session("hostile") as gmsh:
        occ = gmsh.model.occ
        kind = r.randrange(6)
        if kind == 0:
            occ.addBox(0, 0, 0, 10, r.uniform(10, 90), 50)
        elif kind == 1:
            occ.addRectangle(0, 0, 0, 50, r.uniform(10, 90))
        elif kind == 2:
            occ.addSphere(0, 0, 0, r.uniform(10, 90))
        elif kind == 3:
            eyes = [(3, occ.addCylinder(x, 0, -12, 0, 0, 24, radius)) for x, radius in ((0, 38), (150, 20))]
            beam = [(3, occ.addBox(0, -10, -6, 150, 20, 12))]
            occ.fuse(beam, eyes)
        elif kind == 4:
            studs = [(3, occ.addCylinder(x, 0, 0, 0, 0, 40, r.uniform(8, 15))) for x in (20, 60, 100)]
            occ.fuse([(3, occ.addBox(0, -40, -10, 150, 80, 20))], studs)
        else:
            for number in range(r.randint(2, 4)):
                occ.addCylinder(0, 0, 60 * number, 0, 0, 50, 10 + number)
        occ.synchronize()
        with quiet_stdout():
            gmsh.write(str(path))
    return path


_STEPS = (_step, _step)
