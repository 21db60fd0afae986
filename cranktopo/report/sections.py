"""Sections that reports share."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

from cranktopo.report.page import Section
from cranktopo.report.result_table import ResultTable


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
