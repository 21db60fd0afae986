"""Cranks drawn at random, exported, turned by a random attitude, imported and compared: one line each.

`python -m tests.studies.crank_round_trips [--engines A:B] [--kinds plain ...] [--as step stl]`. Kinds:

- plain: `random_engine`; featured: with drillings, counterweights, second webs, two banks; ends: with ends
  and a main journal of its own. Each crank must come back, or a line must say what did not.
- noise (corners of triangles 0.05 mm beside the body) and sheared (by 0.5 %), both of triangles alone, boss
  (on a web), sharp (no fillets): damage to the plain ones, which a line must tell.

A verdict is `back`, `told` (a line says what differs, or the body is refused) or `SILENT`, which is a fault;
`refused by export` where no body was made. The exit code is 1 if one is a fault.
"""

from __future__ import annotations

import argparse
import math
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal
from unittest import mock

import numpy as np
from manifold3d import Manifold
from scipy.spatial.transform import Rotation

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.solid import step
from cranktopo.bodies.solid.files import export_solid, kernel_surface_of
from cranktopo.bodies.solid.step import step_solid
from cranktopo.design.crank_throws import throw_count, throw_scenes
from cranktopo.design.halves import halves
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.crank import drawn_crank_mass
from cranktopo.numerics.gmsh_session import cad_session, quiet_stdout
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of
from cranktopo.tasks.crank_import.result import CrankImport
from cranktopo.tasks.crank_import.stage import import_crank
from cranktopo.tasks.importing.cad_body import moved_rigidly
from tests.hostile.featured_engines import featured_engine
from tests.hostile.test_bodies import processor_s
from tests.random_cranks import random_crank
from tests.random_engines import random_engine

ENGINES = 60
Kind = Literal["plain", "featured", "ends", "noise", "sheared", "boss", "sharp"]
Format = Literal["step", "stl"]
SOUND: tuple[Kind, ...] = ("plain", "featured", "ends")
DAMAGED: tuple[Kind, ...] = ("noise", "sheared", "boss", "sharp")
FACET_MM, NOISE_MM, SHEAR, BOSS = 0.02, 0.05, 0.005, 0.25
"""Largest distance of triangles; scatter; slope; side of a boss over the web's thickness."""
EXACT, ROUNDED = 1e-6, 1e-5
"""Share of a dimension and of the mass; of the mass with rounded outlets, which the kernel approximates."""
LENGTH_MM, ANGLE_DEG = 0.02, 0.05
OUTLETS = 0.01
"""Share within which the radius of outlets comes back, whose surfaces the kernel approximates."""
OUTLET = "outlet_radius_mm"
ALWAYS = "check it against the drawing", "bspline surface"
"""Ends of the lines that every crank with rounded outlets has, right or wrong."""
HEAD = "engine", "kind", "file", "verdict", "dimensions over what is allowed", "mass", "CPU s", "told"


@dataclass(frozen=True)
class Trip:
    """What became of one crank.

    Attributes:
        off: largest deviation of a dimension over what is allowed: 1e-6 of it for exact faces, 0.02 mm and
            0.05 deg for triangles, 1 % of the radius of outlets; infinite where it is missing, NaN where
            none came back.
        mass: share by which the mass of the crank's design differs.
        words: what was told, or which dimension is off.
    """

    seed: int
    kind: Kind
    format: Format
    verdict: str
    off: float
    mass: float
    seconds: float
    words: str

    @property
    def faulty(self) -> bool:
        """Tell whether the crank came back otherwise without a word."""
        return self.verdict == "SILENT"

    @property
    def row(self) -> str:
        """The trip as a row of a table."""
        numbers = (f"{value:.1e}" for value in (self.off, self.mass))
        return (
            f"| {self.seed} | {self.kind} | {self.format} | {self.verdict} | {' | '.join(numbers)} | "
            f"{self.seconds:.0f} | {self.words[:300]} |"
        )


def forms_of(kind: Kind, forms: Sequence[Format] = ("step", "stl")) -> tuple[Format, ...]:
    """Return the formats of a kind: noise and shear are done to triangles."""
    return tuple(form for form in forms if form == "stl" or kind not in ("noise", "sheared"))


def scene_of(seed: int, kind: Kind) -> Scene:
    """Return the design of an engine."""
    if kind == "ends":
        return random_crank(seed)
    data = featured_engine(seed) if kind == "featured" else random_engine(seed)
    if kind == "sharp":
        for name in ("main_journal", "crankpin"):
            data["throw"][name]["fillet_mm"] = 0.0
    return scene_from_dict(data, f"engine-{seed}", whole=True)


def attitude(seed: int) -> tuple[Array, Array]:
    """Return a random rotation, and a shift in mm, that leave the free end at the lower end of the axis.

    The end with the lower coordinate counts as the free one, whatever the body was.
    """
    draw = np.random.default_rng((seed, 7))
    while True:
        matrix = Rotation.random(random_state=int(draw.integers(2**31))).as_matrix()
        if matrix[np.abs(matrix[:, 2]).argmax(), 2] > 0:
            return matrix, 100 * draw.normal(size=3)


def written(scene: Scene, kind: Kind, form: Format, folder: Path, seed: int) -> Path:
    """Write the crank, turned and damaged as its kind says, and return its file."""
    matrix, shift = attitude(seed)
    path = folder / f"turned.{form}"
    if form == "step":
        export_solid(scene, "crankshaft", folder / "body.step")
        with cad_session("turned body") as gmsh, quiet_stdout():
            occ, body = gmsh.model.occ, [step_solid(gmsh, folder / "body.step", "body")]
            if kind == "boss":
                body = occ.fuse(body, [(3, occ.addBox(*_boss(scene)[0], *_boss(scene)[1]))])[0]
            moved_rigidly(occ, body, matrix, shift)
            occ.synchronize()
            gmsh.write(str(path))
        return path
    coarse = {"StlLinearDeflection": FACET_MM, "StlAngularDeflection": 0.5}
    with mock.patch.dict(step._TRIANGULATION, coarse):
        mesh = kernel_surface_of(scene, "crankshaft")
    write_stl(path, _moved(_damaged(mesh, scene, kind, seed), matrix, shift))
    return path


def _moved(mesh: SurfaceMesh, matrix: Array, shift: Array) -> SurfaceMesh:
    return SurfaceMesh(mesh.vertices_mm @ matrix.T + shift, mesh.faces)


def _boss(scene: Scene) -> tuple[list[float], list[float]]:
    """Return corner and size of a box half sunk into a side of the first web, in its middle."""
    half = halves(scene)[0]
    thick, y = half.web.thickness_mm, half.throw.radius_mm / 2
    side, width = BOSS * thick, (half.web.width_mm or 0.0) / 2
    start = half.throw.main_journal.length_mm / 2 + (thick - side) / 2
    return [width - side / 2, y - side / 2, start], [side] * 3


def _damaged(mesh: SurfaceMesh, scene: Scene, kind: Kind, seed: int) -> SurfaceMesh:
    points = mesh.vertices_mm
    if kind == "noise":
        noise = np.random.default_rng(seed).normal(scale=NOISE_MM, size=points.shape)
        return SurfaceMesh(points + noise, mesh.faces)
    if kind == "sheared":
        slopes = np.eye(3)
        slopes[seed % 3, (seed + 1) % 3] = SHEAR
        return _moved(mesh, slopes, np.zeros(3))
    if kind == "boss":
        corner, size = _boss(scene)
        return mesh_of(solid_of(mesh, scene.name) + Manifold.cube(size).translate(corner))
    return mesh


def numbers(data: Any, key: str = "") -> Iterator[tuple[str, float]]:
    """Yield all numbers of nested tables by their keys, in millimetres and degrees."""
    items: Iterable[tuple[str, Any]] = ()
    if isinstance(data, dict):
        items = ((f"{key}.{name}", value) for name, value in data.items())
    elif isinstance(data, list):
        items = ((f"{key}[{index}]", value) for index, value in enumerate(data))
    elif isinstance(data, int | float) and not isinstance(data, bool):
        yield key, float(data)
    for name, value in items:
        yield from numbers(value, name)


def dimensions(scene: Scene, count: int) -> dict[str, float]:
    """Return every dimension of the half throws of a crank and of its ends; bolts as the first of them."""
    throws = throw_scenes(scene) if throw_count(scene) == count else throw_scenes(scene) * count
    found = {}
    for number, throw in enumerate(throws, 1):
        for side, half in zip(("first", "second"), halves(throw), strict=True):
            data = half.model_dump(mode="json", include={"throw", "web"}, exclude_none=True)
            found |= dict(numbers(_sorted(data), f"throw {number} {side}"))
    ends = scene.crank.model_dump(mode="json", include={"end"}, exclude_none=True) if scene.crank else {}
    for end in ends.get("end", ()):
        for one in end["step"]:
            if one.get("bolts"):
                one["first_bolt_deg"] %= 360 / one["bolts"]
        found |= dict(numbers(end["step"], f"{end['side']} end"))
    return found


def _sorted(data: dict[str, Any]) -> dict[str, Any]:
    """Drillings in the order of their numbers, without what says in which web they are."""
    for drilling in data["throw"].get("drilling", ()):
        drilling.pop("web", None)
    for table, key in (("throw", "drilling"), ("web", "pocket")):
        if key in data[table]:
            data[table][key].sort(key=str)
    return data


def deviation(key: str, found: float, wanted: float, form: Format) -> float:
    """Return how far a dimension is off over what is allowed."""
    off = abs(found - wanted)
    off = min(off, abs(360.0 - off)) if key.endswith("_deg") else off
    if key.endswith(OUTLET):
        return off / (OUTLETS * wanted) if wanted else math.inf * off
    if form == "step":
        return off / (EXACT * max(abs(wanted), 1.0))
    return off / (ANGLE_DEG if key.endswith("_deg") else LENGTH_MM)


def differences(scene: Scene, result: CrankImport, form: Format) -> dict[str, float]:
    """Return of each dimension how far it is off over what is allowed; infinite where one lacks it."""
    count = throw_count(scene)
    found, wanted = (dimensions(one, count) for one in (load_scene(result.files.design, whole=True), scene))
    for number, (throw, angle) in enumerate(zip(result.throws, scene.shaft_angles_deg, strict=True), 1):
        turn = (throw.angle_deg - angle + 180) % 360 - 180
        found[f"throw {number}.angle_deg"], wanted[f"throw {number}.angle_deg"] = turn, 0.0
    keys = {**wanted, **found}
    return {
        key: deviation(key, found[key], wanted[key], form) if key in found and key in wanted else math.inf
        for key in keys
    }


def trip(seed: int, kind: Kind, form: Format, folder: Path) -> Trip:
    """Take one crank there and back."""
    began = processor_s()

    def ended(verdict: str, words: str, off: float = math.nan, mass: float = math.nan) -> Trip:
        return Trip(seed, kind, form, verdict, off, mass, processor_s() - began, words)

    try:
        scene = scene_of(seed, kind)
        body = written(scene, kind, form, folder, seed)
    except CranktopoError as error:
        return ended("refused by export", error.message)
    try:
        result = import_crank(body, f"engine-{seed}", folder / "out", unit="mm" if form == "stl" else None)
    except CranktopoError as error:
        return ended("told" if kind in DAMAGED else "told: refused", error.message)
    told = [lack.what for lack in result.unread if not lack.what.endswith(ALWAYS)]
    if len(result.throws) != throw_count(scene):
        return ended("told" if told else "SILENT", "; ".join((f"{len(result.throws)} throws", *told)))
    off = differences(scene, result, form)
    worst = max(off, key=lambda key: off[key])
    volume = drawn_crank_mass(scene).mass_kg / density_kg_per_mm3(scene.material.density_kg_m3)
    mass = abs((result.design_volume_mm3 or math.nan) / volume - 1)
    rounded = any(one.outlet_radius_mm for one in scene.throw.drilling)
    back = off[worst] <= 1 and mass <= (ROUNDED if rounded else EXACT)
    if kind in DAMAGED:
        return ended("told" if told else "SILENT", "; ".join(told), off[worst], mass)
    words = "; ".join(told) if off[worst] <= 1 else "; ".join((f"{worst} x {off[worst]:.3g}", *told))
    return ended("back" if back else "told" if told else "SILENT", words, off[worst], mass)


def trips(seeds: Sequence[int], kinds: Sequence[Kind], forms: Sequence[Format]) -> Iterator[Trip]:
    """Yield the trips of all engines."""
    for kind in kinds:
        for form in forms_of(kind, forms):
            for seed in seeds:
                with tempfile.TemporaryDirectory() as folder:
                    yield trip(seed, kind, form, Path(folder))


def main(tell: Callable[[str], None] = print) -> int:
    """Print the table, then how many have which verdict."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--engines", default=f"0:{ENGINES}", help="first and end, or numbers with commas")
    parser.add_argument("--kinds", nargs="+", choices=(*SOUND, *DAMAGED), default=["plain"])
    parser.add_argument("--as", nargs="+", choices=("step", "stl"), default=["step", "stl"], dest="forms")
    given = parser.parse_args()
    numbers = [int(part) for part in given.engines.replace(":", ",").split(",")]
    seeds = range(*numbers) if ":" in given.engines else numbers
    tell(f"| {' | '.join(HEAD)} |\n|{'---|' * len(HEAD)}")
    count: dict[tuple[str, str, str], int] = {}
    faulty = 0
    for one in trips(seeds, given.kinds, given.forms):
        tell(one.row)
        sys.stdout.flush()
        count[one.kind, one.format, one.verdict] = count.get((one.kind, one.format, one.verdict), 0) + 1
        faulty += one.faulty
    for key, value in count.items():
        tell(f"{' '.join(key)}: {value}")
    return int(faulty > 0)


if __name__ == "__main__":
    sys.exit(main())
