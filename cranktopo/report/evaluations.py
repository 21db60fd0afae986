"""The table that `evaluate` prints, and what other commands say of error estimates."""

from __future__ import annotations

from collections.abc import Iterable

from cranktopo.evaluate.evaluation import Evaluation
from cranktopo.report.tables import ResultTable

_COLUMNS: tuple[tuple[str, int], ...] = (
    ("target", 0),
    ("throw_kg", 3),
    ("web_kg", 3),
    ("inertia_kg_mm2", 0),
    ("unbalance_kg_mm", 2),
    ("torsion_free_kNm_per_rad", 2),
    ("held_kNm_per_rad", 2),
    ("bending_pinned_kN_per_mm", 2),
    ("clamped_kN_per_mm", 1),
    ("torsion_error_percent", 2),
    ("bending_error_percent", 2),
    ("size_mm", 2),
    ("nodes", 0),
    ("time_s", 1),
)


def evaluation_table(evaluations: list[Evaluation]) -> ResultTable:
    """One row per evaluation: mass, inertia, unbalance, stiffnesses, error estimates, mesh, seconds."""
    return ResultTable(
        columns=tuple(name for name, _ in _COLUMNS),
        rows=tuple(_row(e) for e in evaluations),
        digits=tuple(digits for _, digits in _COLUMNS),
    )


def result_line(e: Evaluation) -> str:
    """Both stiffnesses of the design's supports, each with its estimate, and what they took."""
    return (
        f"{e.target}: torsion {e.torsion_Nm_per_rad / 1000:.2f} kN m/rad, "
        f"+-{e.torsion_error_percent:.2g} %; bending {e.bending_N_per_mm / 1000:.2f} kN/mm, "
        f"+-{e.bending_error_percent:.2g} %; {e.total_seconds:.1f} s"
    )


def estimate_line(torsion_percent: Iterable[float], bending_percent: Iterable[float]) -> str:
    """The largest error estimates of several evaluations, for below a table of their stiffnesses.

    Args:
        torsion_percent, bending_percent: error estimates, one per evaluation.
    """
    torsion, bending = max(torsion_percent), max(bending_percent)
    return f"stiffnesses +-{torsion:.2g} % in torsion, +-{bending:.2g} % in bending at most"


def _row(e: Evaluation) -> tuple[str | float | None, ...]:
    torsion, bending = e.fine.torsion, e.fine.bending
    return (
        e.target,
        e.throw_kg,
        e.web_kg,
        e.inertia_kg_mm2,
        e.unbalance_kg_mm,
        _kilo(torsion["free"]),
        _kilo(torsion["held"]),
        _kilo(bending["pinned"]),
        _kilo(bending["clamped"]),
        e.torsion_error_percent,
        e.bending_error_percent,
        e.fine.element_size_mm,
        float(e.fine.nodes),
        e.total_seconds,
    )


def _kilo(value: float | None) -> float | None:
    return None if value is None else value / 1000
