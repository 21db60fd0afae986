"""The page of `cranktopo vibration`: Campbell diagram, critical speeds, torque and stress of the sections."""

from __future__ import annotations

from cranktopo.base.units import frequency_text
from cranktopo.design.misfire import misfire_words
from cranktopo.engine.vibration.disk_error import FEW_THROWS_ERROR, few_throws
from cranktopo.engine.vibration.study import VibrationStudy
from cranktopo.engine.vibration.telling import WEAK
from cranktopo.report.page import Fact, Page, Section
from cranktopo.report.result_table import ResultTable
from cranktopo.tasks.vibration.barred import barred_fact, barred_sentence, passed_sentence
from cranktopo.tasks.vibration.plots import vibration_pictures
from cranktopo.tasks.vibration.text import (
    JOINED,
    NONE_FELT,
    ORDER_AND_SUM,
    cancelled_sentence,
    critical_table,
    disks_sentence,
    joined_misfire_sentence,
    joined_misfire_table,
    left_out_sentence,
    misfire_sentence,
    misfire_table,
    modes_table,
    own_speed_sentence,
    pressure_sentence,
    run_up_sentence,
    sections_table,
    varying_sentence,
    worst_sentence,
)


def vibration_page(study: VibrationStudy, written: str) -> Page:
    """Return the vibration of a shaft as content; `written` is a date."""
    campbell, torque, modes = vibration_pictures(study)
    critical = _critical(study)
    return Page(
        title=f"Torsional vibration: {study.scene.name}",
        subtitle=f"stiffness of the throws: {study.stiffness_source}; {written}",
        headline=f"{worst_sentence(study)} {misfire_words(study.scene)}".rstrip(),
        facts=_facts(study),
        sections=(
            Section(
                "critical-speeds",
                "Critical speeds",
                "Lines are orders, multiples of the speed of the shaft: blue where all cylinders have the "
                "same phase, dashed a half order. Where one meets a natural frequency, in red, the shaft "
                "resonates; dots are the critical speeds of the table, their orders beside them where "
                "there is room. "
                f"{ORDER_AND_SUM if critical else NONE_FELT} {left_out_sentence(study)}".rstrip(),
                (*critical, *_misfires(study)),
                (campbell, torque),
                more=(
                    f"{cancelled_sentence(study)} "
                    f"{own_speed_sentence(study)} {pressure_sentence(study)} {passed_sentence(study)} "
                    f"{barred_sentence(study)} {run_up_sentence(study)}".strip(),
                    f"{misfire_sentence(study)} {joined_misfire_sentence(study)}".strip(),
                ),
            ),
            Section(
                "sections",
                "Torque of every section",
                "Half the range over the cycle, at the speed where it is largest; the stress is nominal, "
                "in the weaker of main journal and crankpin.",
                (("Sections from the free end to the takeoff", sections_table(study)),),
            ),
            Section(
                "natural-vibrations",
                "Natural vibrations",
                f"{varying_sentence(study)} {disks_sentence(study)}",
                (("Natural frequencies", modes_table(study)),),
                (modes,),
            ),
        ),
    )


def _critical(study: VibrationStudy) -> tuple[tuple[str, ResultTable], ...]:
    table = critical_table(study)
    return (("Critical speeds at which the cylinders help each other", table),) if table.rows else ()


def _misfires(study: VibrationStudy) -> tuple[tuple[str, ResultTable], ...]:
    if not study.misfires:
        return ()
    own = ("One cylinder that does not fire", misfire_table(study))
    return (own, (JOINED, joined_misfire_table(study))) if study.joined_sections else (own,)


def _facts(study: VibrationStudy) -> tuple[Fact, ...]:
    response = study.response
    facts = [Fact("Warning", *_warned(line), "bad") for line in study.warnings]
    facts += [
        _first_frequency(study),
        Fact(
            "Free end swings by",
            f"+-{response.free_end_deg.max():.3g} deg",
            f"at {response.speeds_rpm[int(response.free_end_deg.argmax())]:.0f} rpm, the uneven rotation of "
            "the whole shaft included",
            "neutral",
        ),
    ]
    barred = barred_fact(study)
    return tuple(facts) if barred is None else (*facts, barred)


def _warned(line: str) -> tuple[str, str]:
    """Return what is warned of, and what it means."""
    about, _, meaning = line.removeprefix("shaft: ").partition(": ")
    return about, f"{meaning[:1].upper()}{meaning[1:]}"


def _first_frequency(study: VibrationStudy) -> Fact:
    """Return the lowest mode with what meets it, and the lowest critical speed where that is of another."""
    critical = [found for found in study.critical if found.share >= WEAK]
    own = [found.speed_rpm for found in critical if found.mode == 1]
    low, high = study.response.speeds_rpm[[0, -1]]
    felt = " and that is felt" if study.left_out[0] else ""
    no_order = f"met by no order that the cylinders excite together{felt} from {low:.0f} to {high:.0f} rpm"
    met = f"first met at {min(own):.0f} rpm" if own else no_order
    weak = [found for found in study.critical if found.mode == 1 and found.share < WEAK]
    if weak and not own:
        each = sorted(weak, key=lambda found: found.speed_rpm)
        orders = [f"{one.speed_rpm:.0f} rpm by order {one.order:g}" for one in each]
        met += f", but at {' and '.join(orders)} where one misfires"
    if critical and critical[0].mode != 1:
        met += f"; the lowest critical speed, {critical[0].speed_rpm:.0f} rpm, is of mode {critical[0].mode}"
    if few_throws(study.scene):
        met += f"; of disks, {FEW_THROWS_ERROR} for so few throws"
    return Fact("First natural frequency", frequency_text(study.modes[0].frequency_Hz), met, "neutral")
