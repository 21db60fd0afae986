"""Stresses of one or more bodies under their load cases, as a part of a report."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.report.page import Picture, Section
from cranktopo.report.picture import JOURNAL_SIDE, PIN_SIDE, gallery
from cranktopo.report.shading import STRESS_COLOURS, ShadedMesh, shaded
from cranktopo.report.stress_scale import SHARE, StressScale, quantiles_MPa
from cranktopo.report.tables import Table
from cranktopo.report.viewer import Body, Scenery

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_TITLE = "Stress"
_TEXT = (
    "Von Mises stress of each load case alone on the judge's body-fitted quadratic tetrahedra. The colours "
    f"end at the stress that {100 * SHARE:g} % of every surface stays below: at sharp edges stress has no "
    "limit, and fillets need a finer mesh, which 'cranktopo fatigue' makes."
)


def stress_section(scenery: Scenery | None, command: str) -> Section:
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
        most, middle = (quantiles_MPa(body.mesh, body.stress, share) for share in (SHARE, 0.5))
        for scale, high, low in zip(scenery.stress_scales, most, middle, strict=True):
            rows.append((body.name, scale.label, float(high), float(low), body.stress.element_size_mm))
    columns = ("design", "load_case", "99_percent_below_MPa", "half_below_MPa", "element_size_mm")
    table = Table(columns, tuple(rows), (0, 0, 1, 1, 2))
    pictures = tuple(
        _picture(scenery.bodies, number, scale) for number, scale in enumerate(scenery.stress_scales)
    )
    return Section("stress", _TITLE, _TEXT, (("Von Mises stress on the surface", table),), pictures)


def _picture(bodies: Sequence[Body], number: int, scale: StressScale) -> Picture:
    names = ", ".join(body.name for body in bodies)
    alt = f"Von Mises stress of {names} under {scale.label}; colours from 0 to {scale.top_MPa:.3g} MPa"
    return Picture(f"stress-{scale.case.name}", _figure(bodies, number, scale), alt, raster=True)


def _figure(bodies: Sequence[Body], number: int, scale: StressScale) -> Figure:
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import LinearSegmentedColormap, Normalize

    colours = LinearSegmentedColormap.from_list("stress", STRESS_COLOURS)
    norm = Normalize(0.0, scale.top_MPa)
    skins = [(body.name, _coloured(body, number, norm, colours), PIN_SIDE) for body in bodies]
    if len(bodies) == 1:
        skins = [
            ("from the journal side", skins[0][1], JOURNAL_SIDE),
            ("from the crankpin side", *skins[0][1:]),
        ]
    figure, axes = gallery(skins)
    bar = figure.colorbar(ScalarMappable(norm, colours), ax=axes, shrink=0.7, extend="max", pad=0.01)
    bar.set_label(f"von Mises stress, MPa; {scale.label}")
    return figure


def _coloured(body: Body, number: int, norm: Any, colours: Any) -> ShadedMesh:
    """A body with the stress of one load case on its faces."""
    assert body.stress is not None
    skin = shaded(body.mesh, body.web_z_mm)
    values = body.stress.at(skin.vertices_mm)[number][skin.faces].mean(axis=1)
    return replace(skin, colours=np.asarray(colours(norm(values)))[:, :3])
