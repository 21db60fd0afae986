"""Barred ranges of speed in words: with all cylinders firing, and with one that does not fire."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from cranktopo.base.units import number_text
from cranktopo.engine.vibration.barred import MisfireRange, barred_key, ranges_words
from cranktopo.engine.vibration.study import VibrationStudy, largest_swing
from cranktopo.report.page import Fact


def barred_sentence(study: VibrationStudy) -> str:
    """Return the barred ranges of speed in one sentence, with those of single misfires if asked for."""
    permitted = study.scene.shaft.permitted_shear_MPa if study.scene.shaft else None
    if study.barred_rpm is None:
        return "No range of speed is barred: shaft.permitted_shear_MPa is not given."
    firing, silent = ranges_words(study.barred_rpm), _misfire_ranges(study.misfire_barred)
    if not firing and not silent:
        also = ", with one cylinder misfiring too" if study.misfires else ""
        return f"No range of speed is barred: the stress stays below {permitted:g} MPa{also}.{_line(study)}"
    ranges = f"Barred, above {permitted:g} MPa: {firing}."
    if study.misfires:
        ranges = (
            f"Barred, above {permitted:g} MPa: with all cylinders firing {firing or 'none'}; "
            f"with one misfiring {silent or 'none'}."
        )
    return f"{ranges}{_counted(study)}{_line(study)}"


def passed_sentence(study: VibrationStudy) -> str:
    """Return the torque at the speeds that the engine only passes through; empty where there are none."""
    response = study.response
    if response.running.all():
        return ""
    torque = np.where(response.running, -1.0, response.crankshaft_amplitude_Nm)
    rpm, most = response.speeds_rpm[int(torque.argmax())], float(torque.max())
    return (
        f"The engine only passes through {ranges_words(response.barred_rpm)} (shaft.barred_rpm): what is "
        f"told here is of other speeds; there the crankshaft has up to +-{number_text(most)} N m, at "
        f"{rpm:.0f} rpm."
    )


def _counted(study: VibrationStudy) -> str:
    """Return what leaves computed ranges out of torques and safeties, unless the design has that."""
    if study.response.barred_rpm or not study.barred_rpm:
        return ""
    key = barred_key(study.scene, study.barred_rpm)
    unless = f" unless the design has {key}" if key else ""
    return f" They count in all torques and safeties{unless}."


def _line(study: VibrationStudy) -> str:
    """Return what the permitted stress does not judge: the largest torque outside the crankshaft."""
    joined = study.joined_sections
    if not joined:
        return ""
    found = [largest_swing(study.response, section) for section in joined]
    found += [one for misfire in study.misfires for one in misfire.joined]
    worst = max(found, key=lambda one: one.torque_amplitude_Nm)
    ends = study.shaft.sections[worst.section].replace(" - ", " and ")
    return (
        " The permitted stress is that of journals and pins alone: nothing here judges the "
        f"+-{number_text(worst.torque_amplitude_Nm)} N m between {ends} at {worst.speed_rpm:.0f} rpm."
    )


def barred_fact(study: VibrationStudy) -> Fact | None:
    """Return the barred ranges as a fact of the page; None where no stress is given."""
    if study.barred_rpm is None:
        return None
    ranges = [ranges_words(study.barred_rpm, ", ")]
    if study.misfire_barred:
        ranges = [ranges[0] or "none", f"with one misfiring {_misfire_ranges(study.misfire_barred)}"]
    value = "; ".join(filter(None, ranges))
    return Fact("Barred", value or "none", barred_sentence(study), "bad" if value else "good")


def _misfire_ranges(misfire_ranges: Iterable[MisfireRange]) -> str:
    return " and ".join(
        f"{ranges_words([(one.low_rpm, one.high_rpm)])} ({_cylinders(one)})" for one in misfire_ranges
    )


def _cylinders(misfire_range: MisfireRange) -> str:
    *most, last = map(str, misfire_range.cylinders)
    return f"cylinder {', '.join(most)} or {last}" if most else f"cylinder {last}"
