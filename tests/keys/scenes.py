"""Scenes that have the tables of the scene reference, as plain data."""

from __future__ import annotations

import copy
import tomllib
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from manifold3d import Manifold

from cranktopo.design.loading import designs_folder, key_parts, with_value
from cranktopo.design.scene_files import with_resolved_files
from cranktopo.numerics.surfaces.files import write_stl
from cranktopo.numerics.surfaces.mesh import SurfaceMesh
from tests.fast_twin import ENGINE as TWIN

Data = dict[str, Any]
MIKRON = "mikron-iiic-plain"


@cache
def _builtin(name: str) -> Data:
    return tomllib.loads((designs_folder() / f"{name}.toml").read_text(encoding="utf-8"))


def builtin(name: str, **tables: Any) -> Data:
    """A built-in design with other tables; None takes one out."""
    data = copy.deepcopy(_builtin(name)) | tables
    return {key: value for key, value in data.items() if value is not None}


def changed(data: Data, values: Data) -> Data:
    """The data with values at key paths; None takes a key out."""
    for key, value in values.items():
        data = _without(data, key) if value is None else with_value(data, key, value)
    return data


def _without(data: Data, key: str) -> Data:
    *path, name = key_parts(key)
    data = copy.deepcopy(data)
    table: Any = data
    for part in path:
        table = table[part] if isinstance(part, int) else table.get(part, {})
    table.pop(name, None)
    return data


def resolved(data: Data, folder: Path) -> Data:
    """The data with its files in a folder."""
    return with_resolved_files(data, folder)


def files(folder: Path) -> None:
    """Write the files that scenes name."""
    from tests.hostile.scenes import dumped

    for name, size in (("small.stl", 30.0), ("large.stl", 34.0)):
        _cube(folder / name, (-48.0, -34.0, 20.0), (96.0, 116.0 + size - 30.0, 19.0))
        _original(folder / f"original-{name}", size)
        _cube(folder / f"zone-{name}", (-5.0, 60.0, 22.0), (10.0, size - 20.0, 10.0))
        _cube(folder / f"end-{name}", (-size / 2, -size / 2, 0.0), (size, size, 20.0))
    for name, peak in (("a.csv", 50.0), ("b.csv", 55.0)):
        angle = np.arange(0.0, 720.0, 2.0)
        bar = 1.0 + peak * np.exp(-(((angle - 12.0) / 25.0) ** 2)) * (angle < 360)
        rows = "".join(f"{a:g},{p:.6f}\n" for a, p in zip(angle, bar, strict=True))
        (folder / name).write_text(f"crank_angle_deg,pressure_bar\n{rows}", encoding="utf-8")

    thick = changed(builtin("mikron-iiic-crank"), {"crank": None, "web.thickness_mm": 20.0})
    (folder / "thick.toml").write_text(dumped(thick), encoding="utf-8")


def _original(path: Path, width_mm: float) -> None:
    """A half throw with a web of this width more than 20 mm: journals of 42 mm, a box between them."""
    journals = [(0.0, 0.0, 20.0), (48.0, 39.0, 57.0)]
    body = Manifold.cube((20.0 + width_mm, 98.0, 19.0)).translate((-10.0 - width_mm / 2, -25.0, 20.0))
    for y, low, high in journals:
        body += Manifold.cylinder(high - low, 21.0, 21.0, 64).translate((0.0, y, low))
    _write(path, body)


def _cube(path: Path, corner: tuple[float, ...], size: tuple[float, ...]) -> None:
    _write(path, Manifold.cube(size).translate(corner))


def _write(path: Path, body: Manifold) -> None:
    mesh = body.to_mesh()
    write_stl(path, SurfaceMesh(mesh.vert_properties[:, :3].astype(float), mesh.tri_verts.astype(int)))


def throw(**tables: Any) -> Data:
    """The throw of mikron-iiic-plain by itself."""
    return builtin(MIKRON, engine=None, envelope=None, effects=None, optimise=None, **tables)


def web(outline: str, **more: Any) -> Data:
    """A throw whose web has another outline."""
    shapes: dict[str, Data] = {
        "obround": {"width_mm": 56.0},
        "rectangle": {"width_mm": 56.0, "overhang_mm": 28.0, "corner_radius_mm": 4.0},
        "ellipse": {"semi_axis_throw_mm": 60.0, "semi_axis_lateral_mm": 40.0},
        "tapered": {"main_radius_mm": 29.0, "pin_radius_mm": 28.0},
        "profile": {
            "stations_mm": [-30.0, -20.0, 0.0, 24.0, 48.0, 68.0, 78.0],
            "half_widths_mm": [10.0, 26.0, 32.0, 34.0, 32.0, 26.0, 10.0],
        },
    }
    return {"outline": outline, "thickness_mm": 19.0, **shapes[outline], **more}


def twin(**shaft: Any) -> Data:
    """A V-twin with a whole shaft of given stiffness."""
    parts: Data = {
        "speed_min_rpm": 4000.0,
        "speed_max_rpm": 4300.0,
        "throw_stiffness_Nm_per_rad": 297e3,
        "flywheel": {"inertia_kg_m2": 0.01, "mass_kg": 3.0, "stiffness_Nm_per_rad": 3e5},
    }
    return {
        "name": "twin",
        "throw": {
            "radius_mm": 33.75,
            "main_journal": {"outer_diameter_mm": 48.0, "length_mm": 30.0, "fillet_mm": 2.5},
            "crankpin": {"outer_diameter_mm": 44.0, "length_mm": 44.0, "fillet_mm": 2.5},
        },
        "web": {"thickness_mm": 22.0, "outline": "obround", "width_mm": 64.0},
        "material": {"name": "42CrMo4"},
        "engine": copy.deepcopy(TWIN),
        "effects": {"threshold": 0.5},
        "shaft": parts | shaft,
    }
