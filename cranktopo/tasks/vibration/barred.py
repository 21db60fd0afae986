"""Barred ranges of speed in words: with all cylinders firing, and with one that does not fire."""

from __future__ import annotations

from collections.abc import Iterable

from cranktopo.engine.vibration.barred import MisfireRange
from cranktopo.engine.vibration.study import VibrationStudy
from cranktopo.report.page import Fact


def barred_sentence(study: VibrationStudy) -> str:
    """Return the barred ranges of speed in one sentence, with those of single misfires if asked for."""
    permitted = study.scene.shaft.permitted_shear_MPa if study.scene.shaft else None
    if study.barred_rpm is None:
        return "No range of speed is barred: shaft.permitted_shear_MPa is not given."
    firing, silent = _ranges(study.barred_rpm), _misfire_ranges(study.misfire_barred)
    if not firing and not silent:
        also = ", with one cylinder misfiring too" if study.misfires else ""
        return f"No range of speed is barred: the stress stays below {permitted:g} MPa{also}."
    if not study.misfires:
        return f"Barred, above {permitted:g} MPa: {firing}."
    return (
        f"Barred, above {permitted:g} MPa: with all cylinders firing {firing or 'none'}; "
        f"with one misfiring {silent or 'none'}."
    )


def barred_fact(study: VibrationStudy) -> Fact | None:
    """Return the barred ranges as a fact of the page; None where no stress is given."""
    if study.barred_rpm is None:
        return None
    ranges = [_ranges(study.barred_rpm, ", ")]
    if study.misfire_barred:
        ranges = [ranges[0] or "none", f"with one misfiring {_misfire_ranges(study.misfire_barred)}"]
    value = "; ".join(filter(None, ranges))
    return Fact("Barred", value or "none", barred_sentence(study), "bad" if value else "good")


def _ranges(barred_rpm: Iterable[tuple[float, float]], between: str = " and ") -> str:
    return between.join(f"{low:.0f} to {high:.0f} rpm" for low, high in barred_rpm)


def _misfire_ranges(misfire_ranges: Iterable[MisfireRange]) -> str:
    return " and ".join(
        f"{_ranges([(one.low_rpm, one.high_rpm)])} ({_cylinders(one)})" for one in misfire_ranges
    )


def _cylinders(misfire_range: MisfireRange) -> str:
    *most, last = map(str, misfire_range.cylinders)
    return f"cylinder {', '.join(most)} or {last}" if most else f"cylinder {last}"
