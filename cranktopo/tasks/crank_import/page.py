"""The page of an import: body and design over each other, dimensions, and what was not read."""

from __future__ import annotations

import re
from collections.abc import Sequence
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.report.page import Fact, Page, Section, counted, pairs
from cranktopo.report.plot import Picture, plain, save_figure
from cranktopo.report.result_table import ResultTable
from cranktopo.tasks.crank_import import text
from cranktopo.tasks.crank_import.result import CrankImport, ImportedHalf
from cranktopo.tasks.crank_import.web_reading import ImportedWeb

if TYPE_CHECKING:
    from manifold3d import Manifold
    from matplotlib.figure import FigureBase

_BODY, _DESIGN = "0.78", "#d1632a"
_LAST_INDEX = re.compile(r"\[\d+\]$")
_GOOD_PERCENT = 0.1
_GOOD_MM = 0.02


def import_page(result: CrankImport, webs: Sequence[ImportedWeb]) -> Page:
    """Return what was recognised as a page."""
    first = result.halves[0]
    return Page(
        title=f"Crank from {result.file}",
        subtitle=f"{counted(len(result.throws), 'throw')}, "
        f"{counted(len(result.main_journals), 'main journal')}, "
        f"{counted(len(result.halves), 'distinct half throw')}",
        headline=_headline(first),
        facts=tuple(_facts(result)),
        sections=(
            Section(
                "unread",
                "What was not read, and what was assumed",
                "",
                (
                    (
                        "",
                        pairs(
                            [
                                *_numbered("not read", text.unread_lines(result)),
                                *_numbered("assumed", result.assumed),
                            ]
                        ),
                    ),
                ),
            ),
            *(_half(half, web) for half, web in zip(result.halves, webs, strict=True)),
            _dimensions(result),
            Section(
                "crank",
                "The crank",
                "Places along the crank axis from the point of the axis nearest to the file's origin.",
                (("Throws", text.throw_table(result)), ("Main journals", text.journal_table(result))),
            ),
        ),
    )


def _numbered(word: str, lines: Sequence[str]) -> list[tuple[str, str]]:
    return [(word, line) for line in lines]


def _headline(half: ImportedHalf) -> str:
    share = 100 * (half.design_volume_mm3 / half.volume_mm3 - 1)
    return (
        f"The design differs by {share:+z.2f} % from the body's volume; its outline ({half.outline}) lies "
        f"within {half.outline_deviation_mm:.3g} mm. Gains are measured against the body itself."
    )


def _facts(result: CrankImport) -> list[Fact]:
    facts = []
    for half in result.halves:
        share = 100 * (half.missing_mm3 + half.extra_mm3) / half.volume_mm3
        facts.append(
            Fact(
                f"Half {half.number}: outline",
                f"{half.outline_deviation_mm:.3g} mm",
                half.outline,
                "good" if half.outline_deviation_mm < _GOOD_MM else "bad",
            )
        )
        facts.append(
            Fact(
                f"Half {half.number}: volume that differs",
                f"{share:.2f} %",
                f"{half.missing_mm3:.0f} mm3 missing, {half.extra_mm3:.0f} mm3 too much",
                "good" if share < _GOOD_PERCENT else "bad",
            )
        )
    if result.source.triangles:
        facts.append(
            Fact(
                "Mass within",
                text.within_words(result),
                "scatter of the triangles' corners over the whole surface",
                "good" if 100 * result.volume_within < _GOOD_PERCENT else "bad",
            )
        )
    return facts


def import_picture(halves: Sequence[ImportedHalf], webs: Sequence[ImportedWeb], path: Path) -> None:
    """Write the silhouettes of bodies and designs over each other, a row for each half throw."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.2, 4.6 * len(webs)), layout="constrained")
    parts = figure.subfigures(len(webs), 1, squeeze=False).ravel()
    for part, half, web in zip(parts, halves, webs, strict=True):
        _draw_both(part, web)
        part.suptitle(f"Half {half.number}: {half.outline}. Grey: the body. Line: the design.", fontsize=10)
    save_figure(figure, path, dpi=120)


def _half(half: ImportedHalf, web: ImportedWeb) -> Section:
    return Section(
        f"half-{half.number}",
        f"Half {half.number}: {'; '.join(half.webs)}",
        f"Body {half.body}, design {half.design}. Grey: the body. Line: the design.",
        pictures=(_over_each_other(half, web),),
    )


def _dimensions(result: CrankImport) -> Section:
    return Section(
        "dimensions",
        "Dimensions in the designs, mm and deg",
        "Deviation: root of the mean square distance of a dimension's faces from the corners of their "
        "triangles, at least the rounding in the design, which of exact faces is all. Dimensions of an "
        "outline have the largest distance of both outlines.",
        tuple((f"Half {half.number}", _dimension_table(half)) for half in result.halves),
    )


def _dimension_table(half: ImportedHalf) -> ResultTable:
    """Return dimensions by key with their deviations, those of a list in one row."""
    rows = []
    for key, group in groupby(half.dimensions_mm.items(), lambda item: _LAST_INDEX.sub("", item[0])):
        own = list(group)
        off = half.deviations_mm[own[0][0]]
        value = ", ".join(f"{number:.9g}" for _, number in own)
        said = "no face tells it" if off is None else f"{off:.1g}"
        rows.append({"what": key, "value": value, "deviation_mm": said})
    return ResultTable({"what": 0, "value": 0, "deviation_mm": 0}, tuple(rows))


def _over_each_other(half: ImportedHalf, web: ImportedWeb) -> Picture:
    """Draw front and side silhouettes of body and design over each other."""
    from matplotlib.figure import Figure

    figure = Figure(figsize=(9.2, 4.6), layout="constrained")
    _draw_both(figure, web)
    return Picture(f"half-{half.number}", figure, "silhouettes of body and design over each other")


def _draw_both(figure: FigureBase, web: ImportedWeb) -> None:
    front, side = figure.subplots(1, 2)
    for solid, filled in ((web.read.compared.solid, True), (web.read.compared.scene_solid, False)):
        _draw(front, solid, filled)
        _draw(side, solid.rotate((0.0, 90.0, 0.0)), filled)
    front.set_title("Along the crank", fontsize=10)
    side.set_title("From the side", fontsize=10)
    front.set_xlabel("x (mm)")
    front.set_ylabel("y (mm)")
    side.set_xlabel("along the crank (mm)")
    for axes in (front, side):
        axes.set_aspect("equal")
        plain(axes)


def _draw(axes: Any, solid: Manifold, filled: bool) -> None:
    for contour in solid.project().to_polygons():
        points = np.vstack([contour, contour[:1]])
        if filled:
            axes.fill(points[:, 0], points[:, 1], color=_BODY)
        else:
            axes.plot(points[:, 0], points[:, 1], color=_DESIGN, linewidth=1.2)
