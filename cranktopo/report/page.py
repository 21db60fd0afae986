"""A report as content, whatever it is printed on, and the sections that reports share."""

from __future__ import annotations

import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

from cranktopo.base.units import plain_number, stem_and_unit
from cranktopo.report.plot import DrawnPicture, Picture
from cranktopo.report.result_table import ResultTable

if TYPE_CHECKING:
    from cranktopo.design.assumed import Assumption
    from cranktopo.report.viewer.scene3d import Scene3D
    from cranktopo.runs.manifest import Manifest


FactStatus = Literal["good", "bad", "neutral", "unknown"]


@dataclass(frozen=True)
class Fact:
    """One answer of the verdict; the note tells what it is measured against, or what would answer it."""

    label: str
    value: str
    note: str
    status: FactStatus


@dataclass(frozen=True)
class Section:
    """A part of the report: text, `more` text, tables by caption, pictures; `anchor` is its name for links.

    Details that only help beside the files are not printed on paper.
    """

    anchor: str
    title: str
    text: str = ""
    tables: tuple[tuple[str, ResultTable], ...] = ()
    pictures: tuple[Picture, ...] = ()
    on_paper: bool = True
    more: tuple[str, ...] = ()

    @property
    def paragraphs(self) -> tuple[str, ...]:
        """The text and what follows it, each a paragraph, as far as they say something."""
        return tuple(text for text in (self.text, *self.more) if text)


@dataclass(frozen=True)
class Page:
    """A whole report: title, verdict in one sentence, its answers, and the rest in order.

    Attributes:
        scene3d: contents of the 3D view; None where there is no surface.
        picture: still picture of it, for paper and for browsers without 3D.
    """

    title: str
    subtitle: str
    headline: str
    facts: tuple[Fact, ...]
    sections: tuple[Section, ...]
    scene3d: Scene3D | None = None
    picture: Picture | DrawnPicture | None = None

    @property
    def verdict(self) -> tuple[Fact, ...]:
        """The answers, what is bad first."""
        return tuple(sorted(self.facts, key=lambda fact: fact.status != "bad"))


def left_off_first(left_off: str | None, headline: str) -> str:
    """Return a headline with the effects that are left out in front of it, if there are any."""
    return f"{sentence(left_off)} {headline}" if left_off else headline


def sentence(words: str) -> str:
    """Return words that stand behind a colon elsewhere as a sentence of their own."""
    return f"{words[0].upper()}{words[1:]}."


def origin_rows(manifest: Manifest) -> list[tuple[str, Any]]:
    """Return where a run comes from, for `pairs`: its command, start, settings and input files."""
    return [
        ("command", shlex.join(manifest.command)),
        ("started", clock_words(manifest.started)),
        ("settings, SHA-256", manifest.settings_sha256),
        *((f"{role}, SHA-256", file.sha256) for role, file in manifest.inputs.items()),
    ]


def counted(number: int, thing: str) -> str:
    """Return a number of things in words: `1 throw`, `4 throws`."""
    return f"{number} {thing}{'s' * (number != 1)}"


def clock_words(written: str) -> str:
    """Return an ISO 8601 time as `2026-11-26, 09:08 UTC+02:00`."""
    day, _, time = written.partition("T")
    return f"{day}, {time[:5]} UTC{time[8:].removesuffix('+00:00')}" if time else written


def assumed_tables(entries: Sequence[Assumption]) -> list[tuple[str, ResultTable]]:
    """Return `assumed` of metrics.json as one table with its caption; none where the design says all."""
    rows = [(entry.key, assumed_words(entry)) for entry in entries]
    return [("Assumed, because the design does not say it", pairs(rows))] if rows else []


def assumed_words(entry: Assumption) -> str:
    """Return the value of an entry of `assumed` with the unit that its key ends in, and what it means."""
    return f"{with_unit(entry.key, entry.value)} {entry.meaning}".strip()


def quantity_words(key: str, value: Any) -> str:
    """Return a key of a scene and its value in words: `inertia 0.1 kg m²`."""
    return f"{stem_and_unit(key)[0].replace('_', ' ')} {with_unit(key, value)}"


def with_unit(key: str, value: Any) -> str:
    """Return a value of a key as text: a number with the unit that the key ends in."""
    if isinstance(value, bool) or not isinstance(value, int | float):
        return str(value)
    return f"{plain_number(value, _DIGITS)} {stem_and_unit(key)[1]}".rstrip()


_DIGITS = 6
"""Of a value that a design would hold."""


def versions_section(versions: Mapping[str, str | None], files: Mapping[str, str] | None = None) -> Section:
    """Return the versions of what took part, and the files beside the page; left out on paper."""
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
