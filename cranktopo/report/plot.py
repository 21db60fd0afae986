"""A plot with its text for readers who cannot see it, the look that all axes share, figures as PNG."""

from __future__ import annotations

import io
import textwrap
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array, Complex
from cranktopo.base.units import number_text, plain_number

if TYPE_CHECKING:
    from matplotlib.figure import Figure


GREY = "0.35"
_Place = tuple[float, float]


def plain(axes: Any) -> None:
    """Give the axes small tick labels, and lines only at the left and below."""
    axes.tick_params(labelsize=8)
    for side in ("top", "right"):
        axes.spines[side].set_visible(False)


def curve_style(number: int) -> dict[str, Any]:
    """Return colour and dashes of one of many curves, from 0; no two of forty are alike."""
    turn, colour = divmod(number, _COLOURS)
    return {"color": f"C{colour}", "ls": _DASHES[turn % len(_DASHES)]}


_COLOURS, _DASHES = 10, ("-", "--", ":", "-.")


def plain_decades(axis: Any) -> None:
    """Number a logarithmic axis by 1, 2 and 5 as plain numbers; below a decade no power of ten is on it."""
    from matplotlib.ticker import FuncFormatter, LogLocator, NullFormatter

    axis.set_major_locator(LogLocator(subs=(1, 2, 5)))
    axis.set_major_formatter(FuncFormatter(lambda value, _: plain_number(value)))
    axis.set_minor_formatter(NullFormatter())


def name_above(axes: Any, inches: float, size: float = 9) -> None:
    """Name the curves above the axes, in as many columns as so much width holds."""
    labels = axes.get_legend_handles_labels()[1]
    place = {"loc": "lower left", "bbox_to_anchor": (0, 1), "borderaxespad": 0.2}
    axes.legend(fontsize=size, ncols=_columns(labels, inches, size), frameon=False, **place)


_OUTERMOST = 0.85
"""Of the radius of a polar plot what its circles may have: the number of a larger one lies on the edge."""


def polar_frame(axes: Any, points: Complex, largest: float, circles: int) -> None:
    """Have polar axes begin at the top and turn clockwise, and number their circles where no curve goes.

    Args:
        points: of all curves, in the plane whose real axis is up.
        largest: radius that is shown.
        circles: most of them, the edge among these.
    """
    from matplotlib.ticker import FixedLocator, FuncFormatter, MaxNLocator

    axes.set_theta_zero_location("N")
    axes.set_theta_direction(-1)
    axes.set_rlim(0.0, 1.05 * largest)
    axes.set_rlabel_position(emptiest_deg(points))
    places = MaxNLocator(circles).tick_values(0.0, 1.05 * largest)
    axes.yaxis.set_major_locator(FixedLocator([at for at in places if 0 < at < _OUTERMOST * 1.05 * largest]))
    axes.yaxis.set_major_formatter(FuncFormatter(lambda size, _: number_text(size)))
    axes.tick_params(labelsize=7, colors=GREY)
    for name in axes.get_yticklabels():  # over the curves, readable where one passes all the same
        name.set(zorder=5, bbox={"facecolor": "white", "edgecolor": "none", "pad": 0.3, "alpha": 0.8})
    axes.grid(color="0.9", linewidth=0.8)


def emptiest_deg(points: Complex) -> float:
    """Return the direction, between those that are named, from which the points keep farthest away."""
    places = np.arange(22.5, 360.0, 45.0)
    along = np.real(points.reshape(-1, 1) * np.exp(-1j * np.deg2rad(places)))
    return float(places[along.max(axis=0).argmin()])


_SIDES = (
    (-5, -1, "right", "top"),
    (5, 1, "left", "bottom"),
    (5, -1, "left", "top"),
    (-5, 1, "right", "bottom"),
)
"""Places of a name beside its point: shift in points of the font, and its corner that is there."""
_POINT_PIXELS = 5.0


def name_points(
    axes: Any,
    names: Sequence[str],
    places: Sequence[_Place],
    others: Sequence[_Place],
    *,
    leave_out: bool = False,
) -> list[Any]:
    """Name points where no point and no other name is, as far as there is such a place; return the names.

    Args:
        others: further points that no name may cover.
        leave_out: leaves a name out that has no such place inside the axes, of later points rather than of
            earlier ones.
    """
    from matplotlib.transforms import Bbox

    if not places:
        return []

    axes.figure.draw_without_rendering()
    pixels = axes.transData.transform([*places, *others])
    taken = [Bbox.from_extents(*(at - _POINT_PIXELS), *(at + _POINT_PIXELS)) for at in pixels]
    found: list[Any] = []
    inner = axes.get_window_extent()
    for name, place in zip(names, places, strict=True):
        tried = [_beside(axes, name, place, side) for side in _SIDES]
        boxes = [text.get_window_extent().padded(1) for text in tried]
        free = [
            n
            for n, box in enumerate(boxes)
            if not any(box.overlaps(other) for other in taken)
            and (not leave_out or ((box.min >= inner.min).all() and (box.max <= inner.max).all()))
        ]
        kept = None if leave_out and not free else tried[free[0] if free else 0]
        for text, box in zip(tried, boxes, strict=True):
            if text is kept:
                taken.append(box)
                found.append(text)
            else:
                text.remove()
    return found


def _beside(axes: Any, name: str, place: _Place, side: tuple[int, int, str, str]) -> Any:
    right, up, ha, va = side
    style = {"textcoords": "offset points", "ha": ha, "va": va, "fontsize": 6, "color": GREY}
    return axes.annotate(name, place, xytext=(right, up), **style)


def name_orders(axes: Any, orders: Sequence[float], speeds_rpm: Array, top_Hz: float) -> None:
    """Number the lines of orders where they leave the axes, those that are apart from the ones before."""
    axes.figure.draw_without_rendering()
    last = None
    for order in orders:
        at = min(speeds_rpm[-1], 60 * top_Hz / order)
        above = at < speeds_rpm[-1]
        style = {"va": "bottom" if above else "center", "ha": "center" if above else "left"}
        shift = (0, 1) if above else (2, 0)
        text = axes.annotate(
            f"{order:g}",
            (at, order * at / 60),
            shift,
            fontsize=6,
            color=GREY,
            annotation_clip=False,
            **style,
            textcoords="offset points",
        )
        box = text.get_window_extent().padded(1)
        if last is not None and box.overlaps(last):
            text.remove()
        else:
            last = box


def save_figure(figure: Figure, target: Any, **options: Any) -> None:
    """Save a figure as `savefig` does, with names as they are: a `$` in them begins no formula.

    It is made in memory first: on a full disk the writers of matplotlib fail in ways of their own.
    """
    _names_as_they_are(figure)
    _laid_out(figure)
    if not isinstance(target, Path):
        figure.savefig(target, **options)
        return
    buffer = io.BytesIO()
    figure.savefig(buffer, format=target.suffix.removeprefix("."), **options)
    target.write_bytes(buffer.getvalue())


def _laid_out(figure: Figure) -> None:
    """Place the axes once: to write a figure that has a layout of its own, matplotlib draws it twice."""
    layout = figure.get_layout_engine()
    if layout is not None:
        layout.execute(figure)
        figure.set_layout_engine(None)


def save_pages(figures: Sequence[Figure], path: Path, metadata: dict[str, Any]) -> None:
    """Save figures as the pages of a PDF, as `save_figure` does one."""
    from matplotlib.backends.backend_pdf import PdfPages

    buffer = io.BytesIO()
    with PdfPages(buffer, metadata=metadata) as pdf:
        for figure in figures:
            _names_as_they_are(figure)
            pdf.savefig(figure)
    path.write_bytes(buffer.getvalue())


def _names_as_they_are(figure: Figure) -> None:
    for text in _texts(figure):
        if "$" in text.get_text() and _OF_TICKS not in text.get_text():
            text.set_parse_math(False)


def _texts(artist: Any) -> Iterator[Any]:
    """Yield the texts of a figure; of ticks those that have names, since asking for ticks makes them all."""
    from matplotlib.axis import Axis
    from matplotlib.category import StrCategoryFormatter
    from matplotlib.text import Text
    from matplotlib.ticker import FixedFormatter

    if isinstance(artist, Text):
        yield artist
    if isinstance(artist, Axis):
        named = isinstance(artist.get_major_formatter(), FixedFormatter | StrCategoryFormatter)
        children = [artist.label, *(artist.get_majorticklabels() if named else ())]
    else:
        children = artist.get_children()
    for child in children:
        yield from _texts(child)


_OF_TICKS = r"\mathdefault"
"""Word of matplotlib in the labels of logarithmic axes, which are formulas."""


def png(figure: Figure, dpi: float | str = "figure", facecolor: str = "auto") -> bytes:
    """Return a figure as PNG."""
    stream = io.BytesIO()
    save_figure(figure, stream, format="png", dpi=dpi, facecolor=facecolor)
    return stream.getvalue()


_WIDE_INCHES = 9.0
_PANEL_INCHES, _POLAR_AXES = (4.4, 3.0), (0.07, 0.09, 0.5, 0.72)


@dataclass(frozen=True)
class Undrawn:
    """One pair of axes that are still to be drawn, in any process that is sent them.

    Attributes:
        draw: is called with the axes and the arguments; a function of a module where it is sent.
        polar: leaves room for a legend beside them.
    """

    draw: Callable[..., None]
    arguments: tuple[Any, ...]
    polar: bool = False

    def figure(self) -> Figure:
        """Draw them; labelled curves are named below."""
        from matplotlib.backends.backend_agg import FigureCanvasAgg
        from matplotlib.figure import Figure

        figure = Figure(figsize=_PANEL_INCHES, facecolor="none", layout=None if self.polar else "constrained")
        FigureCanvasAgg(figure)
        axes = figure.add_axes(_POLAR_AXES, projection="polar") if self.polar else figure.add_subplot()
        axes.set_facecolor("none")
        self.draw(axes, *self.arguments)
        for text, letters in ((axes.yaxis.label, _UPRIGHT_LETTERS), (axes.title, _TITLE_LETTERS)):
            text.set_text(textwrap.fill(text.get_text(), letters, break_on_hyphens=False))
        if axes.get_legend() is None:
            _name_below(axes)
        return figure


@dataclass(frozen=True)
class Picture:
    """A plot and its text for a reader who cannot see it; as pixels where it has thousands of faces.

    Attributes:
        drawn: what is undrawn is drawn when somebody looks at it.
        sheet: a drawing on its own sheet, which on paper takes a whole page, turned.
    """

    name: str
    drawn: Figure | Undrawn
    alt: str
    raster: bool = False
    sheet: bool = False

    @cached_property
    def figure(self) -> Figure:
        """The plot, drawn once."""
        return self.drawn.figure() if isinstance(self.drawn, Undrawn) else self.drawn

    @property
    def wide(self) -> bool:
        """True if it takes the whole width of a page."""
        return not isinstance(self.drawn, Undrawn) and bool(self.drawn.get_size_inches()[0] > _WIDE_INCHES)


@dataclass(frozen=True)
class DrawnPicture:
    """A picture that is a PNG already, and its text for a reader who cannot see it."""

    name: str
    png: bytes
    alt: str


def picture(name: str, alt: str, draw: Callable[..., None], *arguments: Any, polar: bool = False) -> Picture:
    """Return a plot with one pair of axes; `draw` is called with them and the arguments."""
    return Picture(name, Undrawn(draw, arguments, polar), alt)


_UPRIGHT_LETTERS, _TITLE_LETTERS = 32, 52
"""As many as stand beside the axes, and above them, in one line."""
_LETTER_INCHES, _HANDLE_INCHES, _ROW_INCHES, _NAME_SIZE = 0.065, 0.55, 0.17, 8.0
"""Of a name of this size in points: its letter, what stands before it, its line."""


def _columns(labels: Sequence[str], inches: float, size: float) -> int:
    """Return how many names fit side by side."""
    widest = (_HANDLE_INCHES + _LETTER_INCHES * max(map(len, labels), default=0)) * size / _NAME_SIZE
    return max(1, min(len(labels), int(inches / widest)))


def _name_below(axes: Any) -> None:
    """Name the curves below the axes, where the names cover none of them; the figure grows by their rows."""
    labels = axes.get_legend_handles_labels()[1]
    if labels:
        width, height = _PANEL_INCHES
        columns = _columns(labels, width, _NAME_SIZE)
        axes.figure.set_size_inches(width, height + _ROW_INCHES * -(-len(labels) // columns))
        axes.figure.legend(fontsize=_NAME_SIZE, ncols=columns, loc="outside lower center", frameon=False)
