"""Tables of an imported crank: throws, main journals, and each distinct half throw beside its body."""

from __future__ import annotations

from cranktopo.report.result_table import Column, ResultTable, tabulate, terminal
from cranktopo.tasks.crank_import.result import CrankImport, ImportedHalf, ImportedJournal, ImportedThrow

_THROWS: tuple[Column[ImportedThrow], ...] = (
    Column("throw", 0, lambda t: t.number),
    Column("angle_deg", 2, lambda t: t.angle_deg),
    Column("radius_mm", 3, lambda t: t.radius_mm),
    Column("pin_diameter_mm", 3, lambda t: t.diameter_mm),
    Column("bore_mm", 3, lambda t: t.bore_mm),
    Column("pin_length_mm", 3, lambda t: t.length_mm),
    Column("middle_mm", 3, lambda t: t.middle_mm),
)
_JOURNALS: tuple[Column[ImportedJournal], ...] = (
    Column("main_journal", 0, lambda j: j.number),
    Column("diameter_mm", 3, lambda j: j.diameter_mm),
    Column("bore_mm", 3, lambda j: j.bore_mm),
    Column("length_mm", 3, lambda j: j.length_mm),
    Column("middle_mm", 3, lambda j: j.middle_mm),
)
_HALVES: tuple[Column[ImportedHalf], ...] = (
    Column("half", 0, lambda h: h.number),
    Column("webs", 0, lambda h: float(len(h.webs))),
    Column("outline", 0, lambda h: h.outline),
    Column("off_by_mm", 3, lambda h: h.outline_deviation_mm),
    Column("body_mm3", 0, lambda h: h.volume_mm3),
    Column("volume_percent", 2, lambda h: 100 * (h.design_volume_mm3 / h.volume_mm3 - 1)),
    Column("missing_mm3", 0, lambda h: h.missing_mm3),
    Column("extra_mm3", 0, lambda h: h.extra_mm3),
)


def throw_table(result: CrankImport) -> ResultTable:
    """Return one row per crankpin."""
    return tabulate(_THROWS, result.throws)


def journal_table(result: CrankImport) -> ResultTable:
    """Return one row per main journal."""
    return tabulate(_JOURNALS, result.main_journals)


def half_table(result: CrankImport) -> ResultTable:
    """Return one row per distinct half throw: how near its design is to its body."""
    return tabulate(_HALVES, result.halves)


def unread_lines(result: CrankImport) -> list[str]:
    """Return everything that no design says, the crank's first."""
    return [f"{lack.where}: {lack.what}" for lack in result.unread]


def within_words(result: CrankImport) -> str:
    """Return within which share the volume of the designs is told."""
    return f"{100 * result.volume_within:.2g} %"


def import_text(result: CrankImport) -> str:
    """Return what the command prints: what is missing first, then tables, then what to do next."""
    lines = [f"not read: {line}" for line in unread_lines(result)]
    lines += [f"assumed: {line}" for line in result.assumed]
    tables = [terminal(table(result)) for table in (throw_table, journal_table, half_table)]
    design = result.files.design
    files = [f"{half.design}: {', '.join(half.webs)}" for half in result.halves]
    if design != result.halves[0].design:
        files = [", ".join((design, *result.files.throws)) + ": the whole crank", *files]
    if result.source.triangles:
        files += [f"mass: corners of the triangles tell it within {within_words(result)}"]
    after = [*files, f"page: {result.page}", f"next: cranktopo evaluate {design}"]
    return "\n\n".join(["\n".join(lines), *tables, "\n".join(after)])
