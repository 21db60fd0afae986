"""A report as content: what it says, whatever it is printed on."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from cranktopo.report.plot import Picture
from cranktopo.report.result_table import ResultTable

if TYPE_CHECKING:
    from cranktopo.report.viewer.scene3d import Scene3D

FactStatus = Literal["good", "bad", "neutral", "unknown"]


@dataclass(frozen=True)
class Fact:
    """One answer of the verdict.

    Attributes:
        value: the answer, with its unit.
        note: what it is measured against, or what would answer it.
        status: whether the answer is welcome.
    """

    label: str
    value: str
    note: str
    status: FactStatus


@dataclass(frozen=True)
class Section:
    """A part of the report.

    Attributes:
        anchor: its name for links.
        text: one paragraph.
        tables: by caption.
        on_paper: whether it is printed; details that only help beside the files are not.
    """

    anchor: str
    title: str
    text: str = ""
    tables: tuple[tuple[str, ResultTable], ...] = ()
    pictures: tuple[Picture, ...] = ()
    on_paper: bool = True


@dataclass(frozen=True)
class Page:
    """A whole report.

    Attributes:
        title, subtitle: heading; run, design and date.
        headline: the verdict in one sentence.
        facts: the verdict, one answer each.
        sections: the rest, in order.
        scene3d: what the 3D view shows; None where there is no surface.
        picture: still picture of it, for paper and for browsers without 3D.
    """

    title: str
    subtitle: str
    headline: str
    facts: tuple[Fact, ...]
    sections: tuple[Section, ...]
    scene3d: Scene3D | None = None
    picture: Picture | None = None
