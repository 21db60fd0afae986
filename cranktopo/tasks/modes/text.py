"""Natural vibrations of a whole crankshaft as tables and text."""

from __future__ import annotations

from cranktopo.report.result_table import Cell, ResultTable, Row, terminal
from cranktopo.tasks.modes.result import ShaftMode, ShaftModes, SharedDisks

_SHARES = ("torsion", "in_plane", "across", "axial")
_ORDERS_SHOWN = 3
"""Of each mode, the lowest first."""
_PLANE = "in a plane"
_CIRCLING = 0.2
"""Whirl from which a motion is said to circle."""


def modes_text(modal: ShaftModes) -> str:
    """Return what `cranktopo modes` prints."""
    return "\n\n".join(
        (
            f"{modal.design}: natural vibrations of the whole crankshaft, {modal.bearings} bearings",
            terminal(modes_table(modal)),
            *([shared_sentence(modal)] if modal.disks_shared else []),
            PLANES,
            f"At {modal.speeds_rpm[-1]:,.0f} rpm, in the frame that turns with the shaft and as bearings "
            "have it:",
            terminal(speed_table(modal)),
            critical_sentence(modal),
            *([terminal(critical_table(modal))] if critical_table(modal).rows else []),
            *([torsion_only_sentence(modal)] if modal.torsion_only else []),
            *([fluid_sentence(modal)] if modal.disks_with_fluid_Hz else []),
            error_sentence(modal),
        )
    )


PLANES = (
    "In plane and across: of throw 1. Shares are those of the kinetic energy, each half throw taken as the "
    "rigid body whose motion is nearest to its own."
)


def modes_table(modal: ShaftModes) -> ResultTable:
    """Return frequency and kind of every mode at rest."""
    rows: tuple[Row, ...] = tuple(
        {
            "mode": str(mode.mode),
            "frequency_Hz": mode.frequency_Hz,
            "kind": mode.kind,
            **{f"{name}_percent": _share(getattr(mode.shares_percent, name)) for name in _SHARES},
            "disks_Hz": mode.disks_Hz,
        }
        for mode in modal.modes
    )
    shares = {f"{name}_percent": 0 for name in _SHARES}
    return ResultTable({"mode": 0, "frequency_Hz": 1, "kind": 0, **shares, "disks_Hz": 1}, rows)


def _share(percent: float) -> float:
    """Return a share as a table has it: half a common mass may bring one below 0 or beyond 100."""
    return min(max(percent, 0.0), 100.0)


def speed_table(modal: ShaftModes) -> ResultTable:
    """Return the modes at the highest speed: frequency, whirl, and what bearings see of it."""
    turn = modal.speeds_rpm[-1] / 60
    rows: list[Row] = []
    for mode in modal.modes:
        frequency = mode.frequencies_Hz[-1]
        word = whirl_word(mode)
        row: dict[str, Cell] = {"mode": str(mode.mode), "turning_Hz": frequency, "whirl": word}
        row["forward_Hz"] = frequency + turn if word in ("forward", _PLANE) else None
        row["backward_Hz"] = abs(frequency - turn) if word in ("backward", _PLANE) else None
        rows.append(row)
    return ResultTable(
        {"mode": 0, "turning_Hz": 1, "whirl": 0, "forward_Hz": 1, "backward_Hz": 1}, tuple(rows)
    )


def whirl_word(mode: ShaftMode, index: int = -1) -> str:
    """Return how the motion of a mode across the axis circles at a speed."""
    if not mode.kind.startswith("bending"):
        return "none"
    whirl = mode.whirl[index]
    if abs(whirl) < _CIRCLING:
        return _PLANE
    return "forward" if whirl > 0 else "backward"


def critical_table(modal: ShaftModes) -> ResultTable:
    """Return where the lowest orders of the forces meet each mode within the range of speeds."""
    rows: list[Row] = []
    for mode in modal.modes:
        lowest = sorted(mode.critical_speeds, key=lambda at: at.order)[:_ORDERS_SHOWN]
        for at in lowest:
            row: dict[str, Cell] = {"mode": str(mode.mode), "kind": mode.kind, "order": at.order}
            rows.append({**row, "speed_rpm": at.speed_rpm})
    return ResultTable({"mode": 0, "kind": 0, "order": 1, "speed_rpm": 0}, tuple(rows))


def critical_sentence(modal: ShaftModes) -> str:
    """Return whether orders of the forces meet modes within the range of speeds."""
    over = f"from {modal.speeds_rpm[0]:,.0f} to {modal.speeds_rpm[-1]:,.0f} rpm"
    met = [(at.order, at.speed_rpm, mode) for mode in modal.modes for at in mode.critical_speeds]
    if not met:
        return f"No order up to {modal.highest_order:g} meets a mode {over}."
    order, speed, mode = min(met, key=lambda one: one[:2])
    return (
        f"The lowest order that meets a mode {over} is {order:g}: mode {mode.mode} ({mode.kind}) at "
        f"{speed:,.0f} rpm."
    )


def shared_sentence(modal: ShaftModes) -> str:
    """Return which modes of disks no mode of the body has alone, and which modes share them."""
    return " ".join(map(_shared, modal.disks_shared))


def _shared(shared: SharedDisks) -> str:
    parts = zip(shared.modes, shared.shares_percent, strict=True)
    among = ", ".join(f"mode {mode} {percent:.0f} %" for mode, percent in parts)
    return (
        f"Disks swing at {shared.disks_Hz:.1f} Hz; no mode of the body is that alone, they share it: {among}."
    )


def torsion_only_sentence(modal: ShaftModes) -> str:
    """Return which parts bend no mode, as their mass is not given."""
    parts = ", ".join(f"shaft.{name}.mass_kg" for name in modal.torsion_only)
    verb = "is" if len(modal.torsion_only) == 1 else "are"
    return f"{parts} {verb} not given: in bending and along the axis the shaft swings without it."


def fluid_sentence(modal: ShaftModes) -> str:
    """Return that the fluid of a viscous damper holds nothing here, and what it would change."""
    with_it = ", ".join(f"{frequency:.1f}" for frequency in modal.disks_with_fluid_Hz)
    return (
        "The fluid of shaft.damper is left out, as all damping is: a ring without springs turns loose.\n"
        f"`cranktopo vibration` has the fluid: torsion by disks is at {with_it} Hz with it."
    )


def error_sentence(modal: ShaftModes) -> str:
    """Return how far the frequencies are off, as far as it is told."""
    worst = max(modal.modes, key=lambda mode: abs(mode.last_step_percent))
    mesh = modal.stiffness_error_percent / 2
    return (
        f"{modal.unknowns} unknowns. The last of {modal.steps} steps of the reduction changed a frequency "
        f"by at most {abs(worst.last_step_percent):.2g} % (mode {worst.mode}). Mesh: frequencies of torsion "
        f"are at most {mesh:.2g} % too high."
    )
