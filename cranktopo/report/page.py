"""A report as content, whatever it is printed on, and the sections that reports share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

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


def origin_rows(manifest: Mapping[str, Any]) -> list[tuple[str, Any]]:
    """Return where a run comes from, for `pairs`: its command, start, settings and input files."""
    inputs = manifest.get("inputs", {}).items()
    return [
        ("command", " ".join(manifest["command"])),
        ("started", manifest["started"]),
        ("settings, SHA-256", manifest["settings_sha256"]),
        *((f"{role}, SHA-256", entry["sha256"]) for role, entry in inputs),
    ]


def assumed_tables(entries: Sequence[Mapping[str, Any]]) -> list[tuple[str, ResultTable]]:
    """Return what the design does not say, as one table with its caption; none where it says all.

    Args:
        entries: `assumed` of metrics.json.
    """
    rows = [(entry["key"], f"{entry['value']} {entry['meaning']}".strip()) for entry in entries]
    return [("Assumed, because the design does not say it", pairs(rows))] if rows else []


def versions_section(versions: Mapping[str, str | None], files: Mapping[str, str] | None = None) -> Section:
    """Versions of what took part, and the files beside the page; left out on paper."""
    found = pairs([(name, text or "not installed") for name, text in versions.items()])
    tables = [("Versions", found)]
    if files:
        tables.append(("Files beside this page", pairs(list(files.items()))))
    title = "Software and files" if files else "Software"
    return Section("software", title, tables=tuple(tables), on_paper=False)


def pairs(rows: Sequence[tuple[str, Any]]) -> ResultTable:
    """Return a table of names and values as text."""
    cells = tuple({"what": name, "value": str(value)} for name, value in rows)
    return ResultTable({"what": 0, "value": 0}, cells)
