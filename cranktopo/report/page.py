"""A report as content: what it says, whatever it is printed on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from cranktopo.report.tables import ResultTable

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from cranktopo.report.viewer import Scene3D

_WIDE_INCHES = 9.0
Status = Literal["good", "bad", "neutral", "unknown"]


@dataclass(frozen=True)
class Fact:
    """One answer of the verdict.

    Attributes:
        label: what is answered.
        value: the answer, with its unit.
        note: what it is measured against, or what would answer it.
        mood: whether the answer is welcome.
    """

    label: str
    value: str
    note: str
    mood: Status


@dataclass(frozen=True)
class Picture:
    """A plot.

    Attributes:
        name: file name without ending.
        figure: the plot.
        alt: what a reader who cannot see it needs to know.
        raster: drawn as pixels where it would otherwise be drawn as lines: thousands of faces.
    """

    name: str
    figure: Figure
    alt: str
    raster: bool = False

    @property
    def wide(self) -> bool:
        """Whether it takes the whole width of a page."""
        return bool(self.figure.get_size_inches()[0] > _WIDE_INCHES)


@dataclass(frozen=True)
class Section:
    """A part of the report.

    Attributes:
        anchor: name for links.
        title: heading.
        text: introduction, one paragraph; may be empty.
        tables: tables by caption.
        pictures: plots.
    """

    anchor: str
    title: str
    text: str = ""
    tables: tuple[tuple[str, ResultTable], ...] = ()
    pictures: tuple[Picture, ...] = ()


@dataclass(frozen=True)
class Page:
    """A whole report.

    Attributes:
        title: heading.
        subtitle: run, design and date.
        headline: the verdict in one sentence.
        facts: the verdict, one answer each.
        sections: the rest, in order.
        scenery: what the 3D view shows; None where there is no surface.
        picture: still picture of it, for paper and for browsers without 3D.
    """

    title: str
    subtitle: str
    headline: str
    facts: tuple[Fact, ...]
    sections: tuple[Section, ...]
    scenery: Scene3D | None = None
    picture: Picture | None = None
