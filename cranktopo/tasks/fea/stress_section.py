"""Stresses of one or more bodies under their load cases, as a part of a report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cranktopo.report.page import Section
from cranktopo.report.plot import Picture
from cranktopo.report.result_table import ResultTable, Row
from cranktopo.report.shading import STRESS_COLOURS, ShadedMesh, shaded
from cranktopo.report.viewer.scene3d import (
    JOURNAL_SIDE,
    PIN_SIDE,
    SHARE,
    Scene3D,
    ShownBody,
    StressScale,
    gallery,
    quantiles_MPa,
)

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Name of a body, what to draw of it, and the stress on its faces (cases, faces), MPa.
_Solved = tuple[str, ShadedMesh, NDArray[np.float64]]
_COLUMNS = {
    "design": 0,
    "load_case": 0,
    "99_percent_below_MPa": 1,
    "half_below_MPa": 1,
    "element_size_mm": 2,
}
_TITLE = "Stress"
_TEXT = (
    "Von Mises stress of each load case alone on body-fitted quadratic tetrahedra. The colours "
    f"end at the stress that {100 * SHARE:g} % of every surface stays below: at sharp edges stress has no "
    "limit, and fillets need a finer mesh, which 'cranktopo fatigue' makes."
)


def stress_section(scene3d: Scene3D | None, command: str) -> Section:
    """Quantiles and pictures of the stresses, or the `command` that would solve for them."""
    if scene3d is None or not scene3d.stress_scales:
        return Section("stress", _TITLE, f"Not solved: '{command}' adds them to this page.")
    rows: list[Row] = []
    for body in scene3d.bodies:
        assert body.stress is not None
        most, middle = quantiles_MPa(body.mesh, body.stress, SHARE, 0.5)
        for scale, high, low in zip(scene3d.stress_scales, most, middle, strict=True):
            cells = (body.name, scale.label, float(high), float(low), body.stress.element_size_mm)
            rows.append(dict(zip(_COLUMNS, cells, strict=True)))
    table = ResultTable(_COLUMNS, tuple(rows))
    solved = [_solved(body) for body in scene3d.bodies]
    pictures = tuple(_picture(solved, number, scale) for number, scale in enumerate(scene3d.stress_scales))
    return Section("stress", _TITLE, _TEXT, (("Von Mises stress on the surface", table),), pictures)


def _solved(body: ShownBody) -> _Solved:
    assert body.stress is not None
    mesh = shaded(body.mesh, body.web_z_mm)
    return body.name, mesh, body.stress.at(mesh.vertices_mm)[:, mesh.faces].mean(axis=2)


def _picture(solved: Sequence[_Solved], number: int, scale: StressScale) -> Picture:
    names = ", ".join(name for name, _, _ in solved)
    alt = f"Von Mises stress of {names} under {scale.label}; colours from 0 to {scale.top_MPa:.3g} MPa"
    return Picture(f"stress-{scale.case}", _figure(solved, number, scale), alt, raster=True)


def _figure(solved: Sequence[_Solved], number: int, scale: StressScale) -> Figure:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    colours = LinearSegmentedColormap.from_list("stress", STRESS_COLOURS)
    norm = Normalize(0.0, scale.top_MPa)
    panels = [
        (name, replace(mesh, colours=np.asarray(colours(norm(stress[number])))[:, :3]), PIN_SIDE)
        for name, mesh, stress in solved
    ]
    if len(panels) == 1:
        panels = [
            ("from the journal side", panels[0][1], JOURNAL_SIDE),
            ("from the crankpin side", *panels[0][1:]),
        ]
    figure, axes = gallery(panels)
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=axes, shrink=0.7, extend="max", pad=0.01)
    bar.set_label(f"von Mises stress, MPa; {scale.label}")
    return figure
