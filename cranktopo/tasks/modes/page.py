"""The page of `cranktopo modes`: frequencies and kinds, Campbell diagrams, shapes."""

from __future__ import annotations

from cranktopo.base.units import frequency_text
from cranktopo.report.page import Fact, Page, Section
from cranktopo.report.result_table import ResultTable
from cranktopo.tasks.modes.plots import modes_pictures
from cranktopo.tasks.modes.result import ShaftMode, ShaftModes
from cranktopo.tasks.modes.text import (
    PLANES,
    critical_sentence,
    critical_table,
    error_sentence,
    fluid_sentence,
    modes_table,
    shared_sentence,
    speed_table,
    torsion_only_sentence,
)

_OVER_SPEED = (
    "On the left in the frame that turns with the crankshaft, where forces on the pins repeat with multiples "
    "of the speed: grey lines are whole orders, dots where an order meets a mode. On the right as the "
    "bearings have it: a bending mode is faster by the speed of the shaft where it circles forward (full "
    "lines), slower where it circles backward (dashed), and both where it stays in a plane of the shaft. An "
    "order of the turning frame differs by one from that of a force that has its direction in space."
)


def modes_page(modal: ShaftModes, written: str) -> Page:
    """Return the natural vibrations of a shaft as content; `written` is a date."""
    turning, bearings, *shapes = modes_pictures(modal)
    high = modal.speeds_rpm[-1]
    return Page(
        title=f"Natural vibrations of the crankshaft: {modal.design}",
        subtitle=f"{modal.bearings} bearings, {modal.speeds_rpm[0]:,.0f} to {high:,.0f} rpm; {written}",
        headline=critical_sentence(modal),
        facts=_facts(modal),
        sections=(
            Section(
                "frequencies",
                "Frequencies at rest",
                f"{_shared(modal)}{PLANES} {_fluid(modal)}{error_sentence(modal)}".replace("\n", " "),
                (("By mode", modes_table(modal)),),
            ),
            Section(
                "over-speed",
                "Over speed",
                _OVER_SPEED,
                ((f"At {high:,.0f} rpm", speed_table(modal)), *_critical(modal)),
                (turning, bearings),
            ),
            Section(
                "shapes",
                "Shapes",
                "Motion of mid-journal sections, half throws and what the ends carry, from the free end; the "
                "largest is 1.",
                (),
                tuple(shapes),
            ),
        ),
    )


def _shared(modal: ShaftModes) -> str:
    return f"{shared_sentence(modal)} " if modal.disks_shared else ""


def _fluid(modal: ShaftModes) -> str:
    return f"{fluid_sentence(modal)} " if modal.disks_with_fluid_Hz else ""


def _critical(modal: ShaftModes) -> tuple[tuple[str, ResultTable], ...]:
    table = critical_table(modal)
    return (("Lowest orders that meet each mode", table),) if table.rows else ()


def _facts(modal: ShaftModes) -> tuple[Fact, ...]:
    first: dict[str, ShaftMode] = {}
    for mode in modal.modes:
        first.setdefault(mode.kind.split()[0], mode)
    parts = " and ".join(modal.torsion_only)
    missing = (Fact("Mass not given", parts, torsion_only_sentence(modal), "bad"),) if parts else ()
    return missing + tuple(
        Fact(f"First {kind}", frequency_text(mode.frequency_Hz), f"mode {mode.mode}, {mode.kind}", "neutral")
        for kind, mode in first.items()
    )
