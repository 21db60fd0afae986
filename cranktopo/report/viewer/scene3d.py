"""Bodies as a report shows them: side by side in one picture, and packed for the browser's 3D view."""

from __future__ import annotations

import base64
import json
import struct
import zlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, Protocol

import numpy as np
from numpy.typing import NDArray

from cranktopo.bodies.cells.grid import DensityGrid
from cranktopo.numerics.surfaces.mesh import SurfaceMesh, mesh_of, solid_of
from cranktopo.report.plot import GREY, Picture
from cranktopo.report.shading import (
    JOURNAL_COLOUR,
    STRESS_COLOURS,
    ShadedMesh,
    draw,
    extent_mm,
    shaded,
    view_axes,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

SHARE = 0.99
"""Part of a surface that the colours tell apart: the rest lies at sharp edges, where stress has no limit."""
_FACES_ALONG = 48
"""Longest extent of a body over the longest edge of a face that one colour or one value stands for."""


class _LoadedCase(Protocol):
    """A load case under which a surface is stressed."""

    @property
    def name(self) -> str:
        """Name."""

    @property
    def label(self) -> str:
        """Name and load."""


class StressedBody(Protocol):
    """Stresses of load cases that can be told at any point of a surface."""

    @property
    def cases(self) -> Sequence[_LoadedCase]:
        """The load cases."""

    @property
    def element_size_mm(self) -> float:
        """General size of the elements that they were solved on."""

    def at(self, points_mm: NDArray[np.float64]) -> NDArray[np.float64]:
        """Return the stress at points (points, 3), MPa, shape (cases, points)."""


@dataclass(frozen=True)
class StressScale:
    """Colours of one load case, which stay the same from a von Mises stress on."""

    case: str
    label: str
    top_MPa: float


def stress_scales(bodies: Sequence[tuple[SurfaceMesh, StressedBody]]) -> tuple[StressScale, ...]:
    """Return one scale per load case for all bodies, so that a colour means the same on each."""
    if not bodies:
        return ()
    tops = np.max([quantiles_MPa(mesh, stress, SHARE)[0] for mesh, stress in bodies], axis=0)
    cases = zip(bodies[0][1].cases, tops, strict=True)
    return tuple(StressScale(case.name, case.label, float(top)) for case, top in cases)


def quantiles_MPa(mesh: SurfaceMesh, stress: StressedBody, *shares: float) -> NDArray[np.float64]:
    """Return the von Mises stress that shares of the surface's area stay below, MPa, (shares, load cases)."""
    fine = mesh_of(solid_of(mesh).refine_to_length(mesh.extent_mm / _FACES_ALONG))
    values = stress.at(fine.corners_mm.mean(axis=1))
    order = np.argsort(values, axis=1)
    below = np.cumsum(fine.areas_mm2[order], axis=1) / fine.areas_mm2.sum()
    least = np.array(shares)[:, None, None]
    at = np.minimum((below < least).sum(axis=2), values.shape[1] - 1)
    rising = np.take_along_axis(values, order, axis=1)
    return np.take_along_axis(rising, at.T, axis=1).T


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
    """A surface to look at: a half throw, mm.

    Attributes:
        web_z_mm: axial range of the web; what lies outside is journal.
        half_pitch_mm: the mid-pin plane, beyond which is the mirror image of the partner.
        partner: how many bodies further its other half is: 0 where it is like this one.
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
        bodies: surfaces, one of them at a time, `first` at the start.
        steps: designs of the optimisation, on one grid, each with a line of notes.
        stress_scales: meaning of the colours of each load case, where every body has stresses.
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

    def packed_with(self, header: Mapping[str, Any], *, quick: bool = False) -> str:
        """Base64 text of a compressed block: the JSON header, and the arrays that it names by number.

        `quick` does not compress, for a picture that stays on the machine; the text then begins with `=`.
        """
        text = json.dumps({**header, "arrays": self.index}, separators=(",", ":")).encode()
        text += b" " * (-len(text) % _ALIGNMENT)
        block = struct.pack("<I", len(text)) + text + b"".join(self.parts)
        if quick:
            return "=" + base64.b64encode(block).decode("ascii")
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
    shading = shaded(simplified(body.mesh, most), body.web_z_mm, _FACES_ALONG if scales else None)
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
    """Return shares of 1 as integers up to `most`."""
    return np.rint(values * most).astype(kind)


_GALLERY_COLUMNS = 4
UP = (0.0, 1.0, 0.0)
Direction = tuple[float, float, float]
JOURNAL_SIDE: Direction = (0.75, 0.45, -0.8)
PIN_SIDE: Direction = (0.75, 0.45, 0.8)


def gallery(bodies: Sequence[tuple[str, ShadedMesh, Direction]]) -> tuple[Figure, list[Axes]]:
    """Return a figure of bodies side by side, all to the same scale, on no background, and the axes of each.

    Each has a title and a direction to the viewer.
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    columns = min(len(bodies), _GALLERY_COLUMNS)
    rows = -(-len(bodies) // columns)
    figure = Figure(figsize=(3.75 * columns, 4.0 * rows), dpi=110, facecolor="none")
    figure.subplots_adjust(left=0.01, right=0.99, bottom=0.01, top=1 - 0.08 / rows, wspace=0.03, hspace=0.1)
    FigureCanvasAgg(figure)
    views = [view_axes(side, UP) for _, _, side in bodies]
    extents = [extent_mm(body, view) for (_, body, _), view in zip(bodies, views, strict=True)]
    half = 0.53 * max(np.ptp(extent, axis=0).max() for extent in extents)
    found = []
    for number, ((name, body, _), view, extent) in enumerate(
        zip(bodies, views, extents, strict=True), start=1
    ):
        axes = figure.add_subplot(rows, columns, number)
        draw(axes, body, view)
        right, up = extent.mean(axis=0)
        axes.set_xlim(right - half, right + half)
        axes.set_ylim(up - half, up + half)
        axes.set_title(name, fontsize=10, color=GREY)
        axes.set_axis_off()
        found.append(axes)
    return figure, found


def gallery_picture(bodies: Sequence[ShownBody]) -> Picture:
    """Return a still picture of half throws, side by side."""
    alt = f"Half throws of {', '.join(body.name for body in bodies)}; journals grey, webs blue"
    figure, _ = gallery([(body.name, shaded(body.mesh, body.web_z_mm), PIN_SIDE) for body in bodies])
    return Picture("gallery", figure, alt)
