"""Stresses of one or more bodies under their load cases, as a part of a report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from cranktopo.report.page import Picture, Section
from cranktopo.report.picture import JOURNAL_SIDE, PIN_SIDE, gallery
from cranktopo.report.shading import STRESS_COLOURS, ShadedMesh, shaded
from cranktopo.report.stress_scale import SHARE, StressScale, quantiles_MPa
from cranktopo.report.tables import ResultTable
from cranktopo.report.viewer import Body, Scene3D

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Name of a body, what to draw of it, and the stress on its faces (cases, faces), MPa.
_Solved = tuple[str, ShadedMesh, NDArray[np.float64]]
_TITLE = "Stress"
_TEXT = (
    "Von Mises stress of each load case alone on the judge's body-fitted quadratic tetrahedra. The colours "
    f"end at the stress that {100 * SHARE:g} % of every surface stays below: at sharp edges stress has no "
    "limit, and fillets need a finer mesh, which 'cranktopo fatigue' makes."
)


def stress_section(scenery: Scene3D | None, command: str) -> Section:
    """Quantiles and pictures of the stresses, or how to get them.

    Args:
        scenery: bodies with their stresses.
        command: what would solve for them where there are none.
    """
    if scenery is None or not scenery.stress_scales:
        return Section("stress", _TITLE, f"Not solved: '{command}' adds the judge's stresses to this page.")
    rows = []
    for body in scenery.bodies:
        assert body.stress is not None
        most, middle = quantiles_MPa(body.mesh, body.stress, SHARE, 0.5)
        for scale, high, low in zip(scenery.stress_scales, most, middle, strict=True):
            rows.append((body.name, scale.label, float(high), float(low), body.stress.element_size_mm))
    columns = ("design", "load_case", "99_percent_below_MPa", "half_below_MPa", "element_size_mm")
    table = ResultTable(columns, tuple(rows), (0, 0, 1, 1, 2))
    solved = [_solved(body) for body in scenery.bodies]
    pictures = tuple(_picture(solved, number, scale) for number, scale in enumerate(scenery.stress_scales))
    return Section("stress", _TITLE, _TEXT, (("Von Mises stress on the surface", table),), pictures)


def _solved(body: Body) -> _Solved:
    assert body.stress is not None
    skin = shaded(body.mesh, body.web_z_mm)
    return body.name, skin, body.stress.at(skin.vertices_mm)[:, skin.faces].mean(axis=2)


def _picture(solved: Sequence[_Solved], number: int, scale: StressScale) -> Picture:
    names = ", ".join(name for name, _, _ in solved)
    alt = f"Von Mises stress of {names} under {scale.label}; colours from 0 to {scale.top_MPa:.3g} MPa"
    return Picture(f"stress-{scale.case.name}", _figure(solved, number, scale), alt, raster=True)


def _figure(solved: Sequence[_Solved], number: int, scale: StressScale) -> Figure:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    colours = LinearSegmentedColormap.from_list("stress", STRESS_COLOURS)
    norm = Normalize(0.0, scale.top_MPa)
    skins = [
        (name, replace(skin, colours=np.asarray(colours(norm(stress[number])))[:, :3]), PIN_SIDE)
        for name, skin, stress in solved
    ]
    if len(skins) == 1:
        skins = [
            ("from the journal side", skins[0][1], JOURNAL_SIDE),
            ("from the crankpin side", *skins[0][1:]),
        ]
    figure, axes = gallery(skins)
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=axes, shrink=0.7, extend="max", pad=0.01)
    bar.set_label(f"von Mises stress, MPa; {scale.label}")
    return figure
