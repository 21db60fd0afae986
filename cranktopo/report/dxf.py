"""A drawing as DXF: what stands on the axes of its figure, as entities of CAD in layers.

Views of the drawing's scale are in true millimetres; others, and the sheet around them, in proportion.
Dimensions stay dimensions, hatches stay hatches.
"""

from __future__ import annotations

import io
from datetime import datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import packages_of
from cranktopo.base.units import MM_PER_INCH
from cranktopo.report.drafting import Measured

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_LAYERS = {"EDGES": ("CONTINUOUS", 35), "HIDDEN": ("DASHED", 18), "CENTRE": ("CENTER", 13)}
_LAYERS |= {"THIN": ("CONTINUOUS", 13), "TEXT": ("CONTINUOUS", 18), "DIMENSIONS": ("CONTINUOUS", 13)}
_LAYERS |= {"HATCH": ("CONTINUOUS", 13)}
"""Line type and width, 1/100 mm, of each layer."""
_BY_STYLE = {"--": "HIDDEN", "-.": "CENTRE"}
_POINT_MM = MM_PER_INCH / 72
_CAP_SHARE, _LINE_SHARE = 0.73, 1.45
"""Height of a capital and distance of two lines over the size of the font."""
_FONT = "CRANKTOPO"
_RISE = {"center": 0.5, "center_baseline": 0.5, "bottom": 1.0, "baseline": 1.0}
"""Share of the lines of a text that stand above its place."""
_PLACES = {"left": "LEFT", "center": "CENTER", "right": "RIGHT"}


def check_dxf(path: Path) -> None:
    """Check that the packages for a file are there, where it is a DXF file."""
    if path.suffix.lower() == ".dxf":
        with packages_of("dxf"):
            import ezdxf  # noqa: F401


def write_dxf(figure: Figure, scale: float, path: Path, written: datetime) -> None:
    """Write a figure at the scale of its main views as DXF R2010, mm; needs ezdxf."""
    with packages_of("dxf"):
        import ezdxf
        from ezdxf import units

    document = ezdxf.new("R2010", setup=True, units=units.MM)
    document.header["$TDCREATE"] = document.header["$TDUPDATE"] = ezdxf.tools.juliandate(written)
    for name, (line, width) in _LAYERS.items():
        document.layers.add(name, linetype=line, lineweight=width)
    document.styles.add(_FONT, font="DejaVuSans.ttf")  # has the signs of tolerances
    document.header["$LTSCALE"] = 5 / scale
    sheet = _Sheet(document, scale)
    for axes in figure.axes:
        sheet.add(axes)
    stream = io.StringIO()
    document.write(stream)
    path.write_text(stream.getvalue(), encoding="utf-8")


class _Sheet:
    def __init__(self, document: Any, scale: float) -> None:
        self._space, self._scale = document.modelspace(), scale

    def add(self, axes: Any) -> None:
        """Add all that axes show."""
        for patch in axes.patches:
            self._patch(axes, patch)
        for line in axes.lines:
            if not hasattr(line, "of_dimension"):
                self._line(axes, line)
        for collection in axes.collections:
            for chain in collection.get_segments():
                self._space.add_lwpolyline(self._points(axes, chain), dxfattribs={"layer": "EDGES"})
        for text in axes.texts:
            if hasattr(text, "measured"):
                self._dimension(axes, text.measured)
            elif not hasattr(text, "of_dimension"):
                self._text(axes, text)
        if axes.get_title(loc="left"):
            self._text(axes, axes._left_title, above=axes)

    def _points(self, axes: Any, points: Any, transform: Any = None) -> Array:
        """Points of axes, in mm of the drawing."""
        figure = axes.get_figure(root=True)
        pixels = (transform or axes.transData).transform(np.asarray(points, dtype=float))
        return np.asarray(pixels / figure.dpi * MM_PER_INCH / self._scale)

    def _patch(self, axes: Any, patch: Any) -> None:
        layer = _layer(patch.get_linestyle(), patch.get_linewidth())
        path = patch.get_path().interpolated(1)
        closed = [patch.get_patch_transform().transform(p) for p in path.to_polygons(closed_only=True)]
        polygons = [self._points(axes, polygon) for polygon in closed]
        centre = getattr(patch, "center", None)
        if centre is not None and hasattr(patch, "radius"):
            (x, y), (rim, _) = self._points(axes, [centre, (centre[0] + patch.radius, centre[1])])
            self._space.add_circle((x, y), abs(rim - x), dxfattribs={"layer": layer})
            return
        for polygon in polygons:
            self._space.add_lwpolyline(polygon, close=True, dxfattribs={"layer": layer})
        if patch.get_hatch() and polygons:
            hatch = self._space.add_hatch(dxfattribs={"layer": "HATCH"})
            hatch.set_pattern_fill("ANSI31", scale=1 / self._scale)
            for polygon in polygons:
                hatch.paths.add_polyline_path(polygon, is_closed=True)

    def _line(self, axes: Any, line: Any) -> None:
        points = self._points(axes, line.get_xydata())
        if len(points) == 1:
            self._space.add_circle(points[0], 0.5 / self._scale, dxfattribs={"layer": "THIN"})
        else:
            layer = _layer(line.get_linestyle(), line.get_linewidth())
            self._space.add_lwpolyline(points, dxfattribs={"layer": layer})

    def _dimension(self, axes: Any, measured: Measured) -> None:
        start, end, on_line = self._points(axes, [measured.start, measured.end, measured.on_line])
        upright = abs(measured.on_line[0] - measured.start[0]) > abs(measured.on_line[1] - measured.start[1])
        mm = 1 / self._scale
        style = {
            "dimtxsty": _FONT,
            "dimtxt": 2.5 * mm,
            "dimasz": 2.5 * mm,
            "dimexo": 0.6 * mm,
            "dimexe": 1.2 * mm,
            "dimgap": 0.6 * mm,
        }
        self._space.add_linear_dim(
            on_line,
            start,
            end,
            angle=90 if upright else 0,
            text=_coded(measured.text),
            override=style
            | {"dimtad": 1, "dimtsz": 0, "dimblk": "", "dimlwd": 13, "dimlwe": 13, "dimtih": 0},
            dxfattribs={"layer": "DIMENSIONS"},
        ).render()

    def _text(self, axes: Any, text: Any, above: Any = None) -> None:
        if above is not None:
            (place,) = self._points(axes, [(0.0, 1.0)], axes.transAxes)
        else:
            (place,) = self._points(axes, [text.get_position()], text.get_transform())
        if getattr(text, "arrow_patch", None) is not None:
            (tip,) = self._points(axes, [text.xy])
            (place,) = self._points(axes, [text.xyann])
            self._space.add_line(tip, place, dxfattribs={"layer": "THIN"})
        lines, height = (
            text.get_text().split("\n"),
            text.get_fontsize() * _POINT_MM * _CAP_SHARE / self._scale,
        )
        step = text.get_fontsize() * _POINT_MM * _LINE_SHARE / self._scale
        down = {"top": height, "center": height / 2, "center_baseline": height / 2}.get(text.get_va(), 0.0)
        down -= step * (len(lines) - 1) * _RISE.get(text.get_va(), 0.0)
        self._lines(text, lines, place - (0.0, down) if not text.get_rotation() else place, height, step)

    def _lines(self, text: Any, lines: list[str], place: Array, height: float, step: float) -> None:
        from ezdxf.enums import TextEntityAlignment

        upright = text.get_rotation() == 90
        align = "MIDDLE_CENTER" if upright else _PLACES[text.get_ha()]
        for number, line in enumerate(lines):
            if line.strip():
                style = {"layer": "TEXT", "rotation": text.get_rotation(), "style": _FONT}
                added = self._space.add_text(_coded(line), height=height, dxfattribs=style)
                added.set_placement(place - (0.0, number * step), align=TextEntityAlignment[align])


def _layer(style: str, width: float) -> str:
    plain = {"dashed": "--", "dashdot": "-."}.get(style, style)
    return _BY_STYLE.get(plain, "EDGES" if width >= 0.9 else "THIN")


def _coded(text: str) -> str:
    """Signs by the codes that every CAD system has."""
    return text.replace("⌀", "%%c").replace("°", "%%d").replace("±", "%%p")
