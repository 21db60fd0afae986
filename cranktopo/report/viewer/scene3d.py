"""What the 3D view of a report shows, packed for the browser."""

from __future__ import annotations

import base64
import json
import struct
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of
from cranktopo.report.shading import JOURNAL_COLOUR, STRESS_COLOURS, ShadedMesh, shaded
from cranktopo.report.viewer.stress_scale import FACES_ALONG, StressedBody, StressScale

SCRIPT = Path(__file__).with_name("viewer.js")
"""The browser's part: draws what `packed` holds."""
PARTNERS: Mapping[int, tuple[int, ...]] = {1: (0,), 2: (1, -1)}
"""`ShownBody.partner` of one half throw for both halves, and of two that differ."""
MOST_FACES = 120_000
"""Of all bodies together; finer surfaces are simplified."""
_SIMPLER_MM = (0.0, 0.02, 0.05, 0.1, 0.2, 0.4, 0.8)
_ALIGNMENT = 4


@dataclass(frozen=True)
class ShownBody:
    """A surface to look at.

    Attributes:
        mesh: half throw, mm.
        web_z_mm: axial range of the web; what lies outside is journal.
        half_pitch_mm: the mid-pin plane, beyond which is the mirror image of the partner.
        partner: how many bodies further its other half is: 0 where it is like this one.
        stress: stresses of the load cases, where they were solved.
    """

    name: str
    mesh: SurfaceMesh
    web_z_mm: tuple[float, float]
    half_pitch_mm: float
    stress: StressedBody | None = None
    partner: int = 0


@dataclass(frozen=True)
class DesignSnapshot:
    """An intermediate design: number of its iteration, physical density of the web's cells."""

    iteration: int
    cells: DensityGrid


@dataclass(frozen=True)
class Scene3D:
    """Everything that the 3D view shows.

    Attributes:
        bodies: surfaces, one of them at a time.
        steps: designs of the optimisation, on one grid.
        notes: line shown with each step.
        stress_scales: what the colours of each load case mean, where every body has stresses.
        first: number of the body that is shown at the start.
    """

    bodies: tuple[ShownBody, ...]
    steps: tuple[DesignSnapshot, ...] = ()
    notes: tuple[str, ...] = ()
    stress_scales: tuple[StressScale, ...] = ()
    first: int = 0


def packed(scene3d: Scene3D) -> str:
    """Return the scene3d as base64 text: a compressed block of a JSON header and the arrays it names.

    Positions are rounded to 1/65535 of the size, normals to 1/127, densities to 1/255.
    """
    arrays = Arrays()
    most = MOST_FACES // len(scene3d.bodies)
    header = {
        "bodies": [_body(arrays, body, most, scene3d.stress_scales) for body in scene3d.bodies],
        "first": scene3d.first,
        "stress": _stress(scene3d.stress_scales),
        "steps": _steps(arrays, scene3d.steps, scene3d.notes),
    }
    return arrays.packed_with(header)


class Arrays:
    """Arrays one behind the other, each at a multiple of four bytes."""

    def __init__(self) -> None:
        self.parts: list[bytes] = []
        self.index: list[dict[str, Any]] = []
        self._end = 0

    def packed_with(self, header: Mapping[str, Any]) -> str:
        """Base64 text of a compressed block: the JSON header, and the arrays that it names by number."""
        text = json.dumps({**header, "arrays": self.index}, separators=(",", ":")).encode()
        text += b" " * (-len(text) % _ALIGNMENT)
        block = struct.pack("<I", len(text)) + text + b"".join(self.parts)
        return base64.b64encode(zlib.compress(block)).decode("ascii")

    def add(self, array: NDArray[Any]) -> int:
        """Add an array and return its number."""
        content = array.tobytes()
        self.index.append({"type": array.dtype.name, "offset": self._end, "length": array.size})
        self.parts.append(content + b"\0" * (-len(content) % _ALIGNMENT))
        self._end += len(self.parts[-1])
        return len(self.index) - 1


def _stress(scales: Sequence[StressScale]) -> dict[str, Any] | None:
    if not scales:
        return None
    cases = [{"label": scale.label, "top_MPa": scale.top_MPa} for scale in scales]
    return {"ramp": STRESS_COLOURS, "cases": cases}


def _body(arrays: Arrays, body: ShownBody, most: int, scales: Sequence[StressScale]) -> dict[str, Any]:
    shading = shaded(simplified(body.mesh, most), body.web_z_mm, FACES_ALONG if scales else None)
    low, high = shading.vertices_mm.min(axis=0), shading.vertices_mm.max(axis=0)
    journal = np.zeros(len(shading.vertices_mm), np.uint8)
    journal[shading.faces] = (shading.colours == JOURNAL_COLOUR).all(axis=1)[:, None]
    return {
        "name": body.name,
        "half_pitch_mm": body.half_pitch_mm,
        "partner": body.partner,
        "low_mm": low.tolist(),
        "size_mm": (high - low).tolist(),
        "positions": arrays.add(scaled((shading.vertices_mm - low) / (high - low), 65535, np.uint16)),
        "normals": arrays.add(scaled(shading.normals, 127, np.int8)),
        "journal": arrays.add(journal),
        "faces": arrays.add(shading.faces.astype(np.uint32)),
        "stress": [arrays.add(share) for share in _shares(shading, body.stress, scales)],
    }


def _shares(
    mesh: ShadedMesh, stress: StressedBody | None, scales: Sequence[StressScale]
) -> list[NDArray[Any]]:
    """Stress at the corners of a body over the top of its scale, one array per load case."""
    if stress is None or not scales:
        return []
    found = zip(stress.at(mesh.vertices_mm), scales, strict=True)
    return [scaled(np.minimum(values / scale.top_MPa, 1.0), 255, np.uint8) for values, scale in found]


def simplified(mesh: SurfaceMesh, most: int) -> SurfaceMesh:
    """Return the mesh with at most so many faces, or as few as a tolerance of 0.8 mm gives."""
    if len(mesh.faces) <= most:
        return mesh
    solid = solid_of(mesh)
    for tolerance in _SIMPLER_MM:
        found = mesh_of(solid.simplify(tolerance))
        if len(found.faces) <= most:
            break
    return found


def _steps(arrays: Arrays, steps: Sequence[DesignSnapshot], notes: Sequence[str]) -> dict[str, Any] | None:
    if not steps:
        return None
    first = steps[0].cells
    return {
        "shape": list(first.density.shape),
        "origin_mm": first.origin_mm.tolist(),
        "cell_mm": first.cell_mm.tolist(),
        "iterations": [step.iteration for step in steps],
        "notes": list(notes),
        "densities": [arrays.add(scaled(step.cells.density, 255, np.uint8)) for step in steps],
    }


def scaled(values: NDArray[np.float64], most: int, kind: type[np.integer[Any]]) -> NDArray[Any]:
    """Shares of 1 as integers up to `most`."""
    return np.rint(values * most).astype(kind)
