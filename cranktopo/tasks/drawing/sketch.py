"""Sketches of the keys of a scene: a throw of the model itself, every dimension under the name of its key."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from cranktopo.base.files import replacing
from cranktopo.bodies.solid.files import surface_of
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.report.drafting import INK, THIN
from cranktopo.report.plot import save_figure
from cranktopo.tasks.drawing.crank_sketch import CRANK_PANELS
from cranktopo.tasks.drawing.sketch_marks import (
    Panel,
    mark_angle,
    mark_leader,
    mark_radius,
    mark_size,
    mark_word,
)
from cranktopo.tasks.drawing.views import Sheet, cross_body, front_body, lengthwise_body

_GAP = 10.0
"""From the body to a dimension line, mm."""
_MARGIN = (30.0, 26.0)
"""Room for names beside and above what is drawn, mm."""
_JOURNALS = {"outer_diameter_mm": 40.0, "bore_diameter_mm": 14.0, "length_mm": 36.0, "fillet_mm": 4.0}
_OBROUND = {"thickness_mm": 22.0, "outline": "obround", "width_mm": 64.0}
_RADIUS, _END = 62.0, 58.0
"""Throw radius and half the pitch of the throw that is drawn, mm."""
_START, _STOP = 18.0, 40.0
"""Faces of its web."""


def _scene(tables: Mapping[str, Any]) -> Scene:
    journals = {"main_journal": _JOURNALS, "crankpin": {**_JOURNALS, "outer_diameter_mm": 36.0}}
    throw = {"radius_mm": _RADIUS, **journals, **tables.get("throw", {})}
    web = tables.get("outline", _OBROUND) | tables.get("web", {})
    return scene_from_dict({"name": "sketch", "throw": throw, "web": web, "material": {"name": "42CrMo4"}})


def _front(axes: Any, scene: Scene) -> None:
    from manifold3d import Manifold

    front_body(axes, Sheet(scene, Manifold()))  # the view from the front needs no solid


def _lengthwise(axes: Any, scene: Scene) -> None:
    lengthwise_body(axes, _sheet(scene), 4.0)


def _across(axes: Any, scene: Scene) -> None:
    cross_body(axes, _sheet(scene), _MIDDLE)


def _across_edge(axes: Any, scene: Scene) -> None:
    cross_body(axes, _sheet(scene), _ON_EDGE)


def _across_bevel(axes: Any, scene: Scene) -> None:
    cross_body(axes, _sheet(scene), _ON_BEVEL)


def _sheet(scene: Scene) -> Sheet:
    return Sheet(scene, solid_of(surface_of(scene, "half"), "half throw"))


def _throw_names(axes: Any) -> None:
    mark_size(axes, (0, 0), (0, _RADIUS), (-3 * _GAP, 0), "radius_mm")
    for y, name, z, side in ((0.0, "main_journal", 0.0, -1), (_RADIUS, "crankpin", _END, 1)):
        outer, inner = (20.0, 7.0) if side < 0 else (18.0, 7.0)
        mark_size(axes, (z, y - outer), (z, y + outer), (side * 2 * _GAP, 0), f"{name}.outer_diameter_mm")
        mark_size(axes, (z, y - inner), (z, y + inner), (side * _GAP, 0), "bore_diameter_mm")
    low, high = -32.0, _RADIUS + 32.0
    mark_size(axes, (0, low), (_START, low), (0, -_GAP), "length_mm / 2")
    mark_size(axes, (_START, low), (_STOP, low), (0, -2 * _GAP), "web.thickness_mm")
    mark_size(axes, (_STOP, high), (_END, high), (0, _GAP), "length_mm / 2")
    mark_leader(axes, (_START - 1.2, 21.2), (6, 34), "fillet_mm")
    round_or_not = "fillet_mm, fillet_axial_mm along z,\nrecess_mm into the web"
    mark_leader(axes, (_STOP + 1.2, _RADIUS - 19.2), (_END + 16, _RADIUS - 34), round_or_not)


def _obround_names(axes: Any) -> None:
    mark_size(axes, (-32, _RADIUS / 2), (32, _RADIUS / 2), (0, 0), "width_mm")


def _rectangle_names(axes: Any) -> None:
    mark_size(axes, (-32, -30), (32, -30), (0, -_GAP), "width_mm")
    mark_size(axes, (32, -30), (32, 0), (_GAP, 0), "overhang_mm")
    mark_size(axes, (32, _RADIUS), (32, _RADIUS + 30), (_GAP, 0), "overhang_mm")
    mark_leader(axes, (-28.5, _RADIUS + 26.5), (-10, _RADIUS + 38), "corner_radius_mm")


def _ellipse_names(axes: Any) -> None:
    middle = _RADIUS / 2
    mark_size(axes, (0, middle), (0, middle + 64), (-40 - _GAP, 0), "semi_axis_throw_mm")
    mark_size(axes, (0, middle), (40, middle), (0, 0), "semi_axis_lateral_mm")


def _tapered_names(axes: Any) -> None:
    mark_radius(axes, (0, 0), 36.0, -60, "main_radius_mm")
    mark_radius(axes, (0, _RADIUS), 28.0, 60, "pin_radius_mm")


def _profile_names(axes: Any) -> None:
    axes.plot(_HALF_WIDTHS, _STATIONS, "o", ms=3, color=INK)
    mark_size(axes, (0, _STATIONS[4]), (_HALF_WIDTHS[4], _STATIONS[4]), (0, 0), "half_widths_mm[4]")
    mark_size(axes, (40, 0), (40, _STATIONS[4]), (_GAP, 0), "stations_mm[4]")


def _bevel_names(axes: Any) -> None:
    top = _RADIUS + 32
    mark_size(axes, (_START, 0), (_START, 72), (-_START - _GAP, 0), "y_mm")
    mark_size(axes, (_START, top), (_START + 10, top), (0, _GAP), "depth_mm")
    mark_leader(axes, (_START + 6.4, 83), (-20, 88), "crown_mm off the chord")
    mark_word(axes, (_START - 12, -24), 'face = "journal"')


def _bevel_across_names(axes: Any) -> None:
    mark_size(axes, (0, _START), (0, _STOP), (46, 0), "web.thickness_mm")
    mark_leader(axes, (14, _START + 5.4), (20, _START - 10), "draft_deg to both sides of x = 0")


def _cylinder_names(axes: Any) -> None:
    mark_size(axes, (0, _MIDDLE), (14, _MIDDLE), (0, -12), "x_mm")
    mark_size(axes, (14, 0), (14, _MIDDLE), (32, 0), "y_mm")
    mark_leader(axes, (9, _MIDDLE + 3), (-18, _MIDDLE + 24), "diameter_mm")


def _box_names(axes: Any) -> None:
    mark_size(axes, (0, _MIDDLE), (14, _MIDDLE), (0, -12), "x_mm")
    mark_size(axes, (14, 0), (14, _MIDDLE), (32, 0), "y_mm")
    mark_size(axes, (6, _MIDDLE), (22, _MIDDLE), (0, 13), "size_x_mm")
    mark_size(axes, (6, _MIDDLE - 8), (6, _MIDDLE + 8), (-10, 0), "size_y_mm")
    mark_leader(axes, (20.8, _MIDDLE - 6.8), (14, _MIDDLE - 34), "corner_radius_mm")


def _depth_names(axes: Any) -> None:
    mark_size(axes, (_STOP - 9, 24), (_STOP, 24), (0, -56 - _GAP), "depth_mm")
    mark_word(axes, (_END + 8, _MIDDLE), 'face = "pin"')
    mark_leader(axes, (_STOP - 8.1, _MIDDLE + 6.1), (_START - 16, _MIDDLE + 22), "floor_radius_mm")


def _side_front_names(axes: Any) -> None:
    mark_size(axes, (20, _MIDDLE - 12), (20, _MIDDLE + 12), (-10, 0), "length_mm")
    mark_size(axes, (20, _MIDDLE), (32, _MIDDLE), (0, 26), "depth_mm")
    mark_size(axes, (-32, 0), (-32, _MIDDLE), (-_GAP, 0), "y_mm")


def _side_across_names(axes: Any) -> None:
    middle = (_START + _STOP) / 2
    mark_size(axes, (20, middle - 2), (20, middle + 6), (-10, 0), "height_mm")
    mark_size(axes, (20, middle), (20, middle + 2), (32, 0), "offset_mm")
    mark_leader(axes, (27, middle - 3.2), (24, _START - 12), "draft_deg")
    mark_leader(axes, (20.6, middle - 1.7), (-4, _START - 12), "floor_radius_mm")


def _counterweight_names(axes: Any) -> None:
    mark_radius(axes, (0, 0), 62.0, 240, "outer_radius_mm")
    mark_angle(axes, 40.0, 120.0, 180.0, "half_angle_deg")
    mark_leader(axes, (34, -14), (48, 8), "fillet_mm")
    mark_leader(axes, (50.2, -32.5), (62, -12), "corner_mm")


def _counterweight_section_names(axes: Any) -> None:
    mark_size(axes, (_START, -62), (_START + 14, -62), (0, -_GAP), "thickness_mm")
    mark_word(axes, (_START - 6, -46), 'face = "journal"')


def _edge_names(axes: Any) -> None:
    mark_size(axes, (-62, 0), (-38, 0), (0, _GAP), "length_mm")
    mark_size(axes, (-62, 0), (-62, -10), (-_GAP, 0), "width_mm")
    mark_word(axes, (-66, 27), "the crank turns clockwise,\nso this flank leads")


def _edge_section_names(axes: Any) -> None:
    x = _ON_EDGE * math.tan(math.radians(60.0))
    mark_size(axes, (x, _START), (x, _START + 7), (-_GAP, 0), "depth_mm")


def _drilling_names(axes: Any) -> None:
    mark_size(axes, (0, -20), (7, -20), (0, -2 * _GAP), "from: place_mm")
    mark_size(axes, (_END - 5, _RADIUS + 18), (_END, _RADIUS + 18), (0, 2 * _GAP), "to: place_mm")
    mark_leader(axes, (30, 22), (-4, 44), "diameter_mm")
    mark_leader(axes, (_END - 2.2, _RADIUS + 17.6), (_END + 16, _RADIUS + 30), "outlet_radius_mm")


def _drilling_front_names(axes: Any) -> None:
    mark_angle(axes, 26.0, 0.0, 150.0, "from: angle_deg")


_MIDDLE = 31.0
"""Place along the throw of the pockets that are drawn."""
_ON_EDGE = -25.0
"""Place along the throw of the section through a bevelled edge."""
_ON_BEVEL = 80.0
"""Place along the throw of the section through a bevel with draft."""
_STATIONS = (-34.0, -20.0, 5.0, 31.0, 60.0, 82.0, 92.0)
_HALF_WIDTHS = (0.0, 24.0, 36.0, 40.0, 32.0, 18.0, 0.0)
_SOLID = {"bore_diameter_mm": 0.0}
_BOX = {
    "shape": "box",
    "face": "pin",
    "x_mm": 14.0,
    "y_mm": _MIDDLE,
    "size_x_mm": 16.0,
    "size_y_mm": 16.0,
    "corner_radius_mm": 4.0,
}
_ROUND = {"shape": "cylinder", "face": "pin", "x_mm": 14.0, "y_mm": _MIDDLE, "diameter_mm": 14.0}
_SIDE = {"shape": "side", "y_mm": _MIDDLE, "length_mm": 24.0, "height_mm": 8.0, "depth_mm": 12.0}
_HEAVY = {
    "outer_radius_mm": 62.0,
    "half_angle_deg": 60.0,
    "thickness_mm": 14.0,
    "fillet_mm": 8.0,
    "corner_mm": 8.0,
}
_EDGE = {"width_mm": 10.0, "depth_mm": 7.0, "length_mm": 24.0}
_FROM = {"on": "main_journal", "angle_deg": 180.0, "place_mm": 7.0}
_TO = {"on": "crankpin", "angle_deg": 0.0, "place_mm": 5.0}
_OIL = {"diameter_mm": 5.0, "outlet_radius_mm": 1.5, "from": _FROM, "to": _TO}


def _outline(name: str, names: Callable[[Any], None], **keys: Any) -> Panel:
    return Panel(
        f'outline = "{name}"', {"outline": {"thickness_mm": 22.0, "outline": name, **keys}}, _front, names
    )


def _edged(title: str, body: Callable[[Any, Scene], None], names: Callable[[Any], None], deg: float) -> Panel:
    weight = {"outer_radius_mm": 62.0, "half_angle_deg": deg, "edge": _EDGE}
    return Panel(title, {"web": {"counterweight": weight}}, body, names)


def _pocket(
    title: str, body: Callable[[Any, Scene], None], names: Callable[[Any], None], **keys: Any
) -> Panel:
    return Panel(title, {"web": {"pocket": [keys]}}, body, names)


def _drilled(
    title: str, body: Callable[[Any, Scene], None], names: Callable[[Any], None], deg: float
) -> Panel:
    solid = {**_JOURNALS, **_SOLID}
    journals = {"main_journal": solid, "crankpin": {**solid, "outer_diameter_mm": 36.0}}
    drilling = {**_OIL, "from": {**_FROM, "angle_deg": deg}}
    return Panel(title, {"throw": {**journals, "drilling": [drilling]}}, body, names)


PARTS: Mapping[str, Sequence[Panel]] = {
    "throw": (Panel("[throw], section x = 0", {}, _lengthwise, _throw_names),),
    "web": (
        _outline("obround", _obround_names, width_mm=64.0),
        _outline("rectangle", _rectangle_names, width_mm=64.0, overhang_mm=30.0, corner_radius_mm=12.0),
        _outline("ellipse", _ellipse_names, semi_axis_throw_mm=64.0, semi_axis_lateral_mm=40.0),
        _outline("tapered", _tapered_names, main_radius_mm=36.0, pin_radius_mm=28.0),
        _outline("profile", _profile_names, stations_mm=list(_STATIONS), half_widths_mm=list(_HALF_WIDTHS)),
    ),
    "bevel": (
        Panel(
            "[[web.bevel]], section x = 0",
            {"web": {"bevel": [{"face": "journal", "y_mm": 72.0, "depth_mm": 10.0, "crown_mm": 1.5}]}},
            _lengthwise,
            _bevel_names,
        ),
        Panel(
            f"its draft, section y = {_ON_BEVEL:g}",
            {"web": {"bevel": [{"face": "journal", "y_mm": 72.0, "depth_mm": 7.0, "draft_deg": 12.0}]}},
            _across_bevel,
            _bevel_across_names,
        ),
    ),
    "pocket": (
        _pocket('shape = "cylinder"', _front, _cylinder_names, **_ROUND, depth_mm=9.0),
        _pocket('shape = "box"', _front, _box_names, **_BOX, depth_mm=9.0),
        _pocket(
            "their depth, section x = 0",
            _lengthwise,
            _depth_names,
            **{**_ROUND, "x_mm": 0.0},
            depth_mm=9.0,
            floor_radius_mm=3.0,
        ),
        _pocket('shape = "side"', _front, _side_front_names, **_SIDE),
        _pocket(
            "its height, section",
            _across,
            _side_across_names,
            **_SIDE,
            offset_mm=2.0,
            draft_deg=10.0,
            corner_radius_mm=3.0,
            floor_radius_mm=2.0,
        ),
    ),
    "counterweight": (
        Panel("[web.counterweight]", {"web": {"counterweight": _HEAVY}}, _front, _counterweight_names),
        Panel("section x = 0", {"web": {"counterweight": _HEAVY}}, _lengthwise, _counterweight_section_names),
        _edged("[web.counterweight.edge]", _front, _edge_names, 90.0),
        _edged(f"its depth, section y = {_ON_EDGE:g}", _across_edge, _edge_section_names, 60.0),
    ),
    "drilling": (
        _drilled("[[throw.drilling]], section x = 0", _lengthwise, _drilling_names, 180.0),
        _drilled("seen along the crank", _front, _drilling_front_names, 150.0),
    ),
    "crank": CRANK_PANELS,
}
"""Panels of each part, by the name of its sketch."""


def write_sketch(part: str, path: Path) -> None:
    """Draw the keys of a part of a throw (`PARTS`) into a file in the format of its ending."""
    import matplotlib as mpl

    # texts stay texts: they can be searched, and the same sketch has the same bytes
    with mpl.rc_context({"svg.hashsalt": part, "svg.fonttype": "none"}), replacing(path) as temporary:
        dates = {".svg": {"Date": None}, ".pdf": {"CreationDate": None}}
        metadata = dates.get(path.suffix.lower())
        save_figure(_figure(PARTS[part]), temporary, bbox_inches="tight", metadata=metadata)


def _figure(panels: Sequence[Panel]) -> Any:
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    figure = Figure(figsize=(5.2 * len(panels), 6.0), layout="constrained")
    FigureCanvasAgg(figure)
    for axes, panel in zip(figure.subplots(1, len(panels), squeeze=False)[0], panels, strict=True):
        panel.body(axes, _scene(panel.tables))
        panel.names(axes)
        axes.set_aspect("equal")
        axes.set_title(panel.title, fontsize=10, color=THIN)
        axes.margins(*(room / 200 for room in _MARGIN))
        axes.axis("off")
    return figure
