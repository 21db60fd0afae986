"""Load cases and the curves over the cycle, as a section of a report."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.engine.analysis import LoadAnalysis
from cranktopo.engine.load_case import LoadCase
from cranktopo.report.page import Section
from cranktopo.report.plot import Picture, picture
from cranktopo.report.result_table import Column, tabulate
from cranktopo.tasks.loads.plot import PANELS, torque_words

_LOAD_COLUMNS: tuple[Column[LoadCase], ...] = (
    Column("load_case", 0, lambda case: case.name),
    Column("radial_N", 0, lambda case: case.radial_N or None),
    Column("tangential_N", 0, lambda case: case.tangential_N or None),
    Column("torque_Nm", 1, lambda case: case.torque_Nm or None),
    Column("from", 0, lambda case: case.source),
)
_OF_STRESSES = (
    "A load counts here by the stress that it makes; cranktopo loads and plan list the cases of the "
    "optimiser, which count by their weights in [optimise.weights]."
)
_LOAD_ALT = (
    "Gas force, inertia force of the piston and their sum over the crank angle",
    "Radial and tangential force on the crankpin over the crank angle",
)


def loads_section(
    analysis: LoadAnalysis | None, cases: Sequence[LoadCase], *, of_stresses: bool = False
) -> Section:
    """Return the section of load cases and the curves over the cycle of an engine with gas data.

    Args:
        of_stresses: the cases are those of a plan for stress and fatigue.
    """
    table = tabulate(_LOAD_COLUMNS, cases)
    text = "The scene names no engine: unit loads, so that stiffnesses are what counts."
    if analysis is not None:
        count = analysis.engine.cylinders
        text = f"{count} cylinder{'s' * (count > 1)} at {analysis.engine.speed_rpm:g} rpm."
        text += f" {_OF_STRESSES}" if of_stresses else ""
    return Section("loads", "Loads", text, (("Load cases", table),), loads_pictures(analysis))


def loads_pictures(analysis: LoadAnalysis | None) -> tuple[Picture, ...]:
    """Return the curves over the cycle; none without an engine with gas data."""
    if analysis is None or analysis.cycle is None:
        return ()
    return tuple(
        picture(f"loads-{number}", alt, panel, analysis)
        for number, (panel, alt) in enumerate(zip(PANELS, _alts(analysis), strict=True), start=1)
    )


def _alts(analysis: LoadAnalysis) -> tuple[str, ...]:
    return (*_LOAD_ALT, f"Torque of one throw, and {torque_words(analysis)}, over the crank angle")
