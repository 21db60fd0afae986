"""The table that `evaluate` prints, and what other commands say of error estimates."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from cranktopo.report.result_table import Column, ResultTable, tabulate
from cranktopo.tasks.fea.evaluation import Evaluation
from cranktopo.tasks.fea.quantities import INERTIA, MASS, UNBALANCE

_COLUMNS: tuple[Column[Evaluation], ...] = (
    Column("target", 0, lambda e: e.target),
    Column("throw_kg", MASS.digits, lambda e: e.throw_kg),
    Column("web_kg", MASS.digits, lambda e: e.web_kg),
    Column(INERTIA.column, INERTIA.digits, lambda e: e.inertia_kg_mm2),
    Column(UNBALANCE.column, UNBALANCE.digits, lambda e: e.unbalance_kg_mm),
    Column("torsion_free_kNm_per_rad", 2, lambda e: _kilo(e.fine.torsion["free"])),
    Column("held_kNm_per_rad", 2, lambda e: _kilo(e.fine.torsion["held"])),
    Column("bending_pinned_kN_per_mm", 2, lambda e: _kilo(e.fine.bending["pinned"])),
    Column("clamped_kN_per_mm", 1, lambda e: _kilo(e.fine.bending["clamped"])),
    Column("torsion_error_percent", 2, lambda e: e.torsion_error_percent),
    Column("bending_error_percent", 2, lambda e: e.bending_error_percent),
    Column("size_mm", 2, lambda e: e.fine.element_size_mm),
    Column("nodes", 0, lambda e: float(e.fine.nodes)),
    Column("time_s", 1, lambda e: e.total_seconds),
)


_SECOND_WEB: Column[Evaluation] = Column("second_web_kg", MASS.digits, lambda e: e.second_web_kg)


def evaluation_table(evaluations: Sequence[Evaluation]) -> ResultTable:
    """Return one row per evaluation: mass, inertia, unbalance, stiffnesses, error estimates, mesh, seconds.

    Where the webs of a throw differ, both have a column.
    """
    different = any(e.second_web_kg is not None for e in evaluations)
    columns = (*_COLUMNS[:3], *((_SECOND_WEB,) if different else ()), *_COLUMNS[3:])
    return tabulate(columns, evaluations)


def result_line(e: Evaluation) -> str:
    """Return both stiffnesses of the design's supports, each with its estimate, and what they took."""
    return (
        f"{e.target}: torsion {e.torsion_Nm_per_rad / 1000:.2f} kN m/rad, "
        f"+-{e.torsion_error_percent:.2g} %; bending {e.bending_N_per_mm / 1000:.2f} kN/mm, "
        f"+-{e.bending_error_percent:.2g} %; {e.total_seconds:.1f} s"
    )


def estimate_line(torsion_percent: Iterable[float], bending_percent: Iterable[float]) -> str:
    """Return the largest error estimates of several evaluations, for below a table of their stiffnesses."""
    torsion, bending = max(torsion_percent), max(bending_percent)
    return f"stiffnesses +-{torsion:.2g} % in torsion, +-{bending:.2g} % in bending at most"


def _kilo(value: float | None) -> float | None:
    return None if value is None else value / 1000
