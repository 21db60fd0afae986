"""Bolted joints as tables for the terminal."""

from __future__ import annotations

from typing import Any

from cranktopo.base.units import N_PER_KN
from cranktopo.report.result_table import Column, tabulate, terminal
from cranktopo.tasks.bolts.result import BoltChecks, JointCheck

_FORCES_CAPTION = (
    "VDI 2230: forces of one bolt. `preload` is the largest of the scatter, "
    "`preload needed` what it must be for load, scatter and settling; `least` is the "
    "smallest preload, after settling."
)
_FORCES: tuple[Column[JointCheck], ...] = (
    Column("joint", 0, lambda j: j.name),
    Column("bolt", 0, lambda j: f"{j.thread} {j.strength_class}"),
    Column("load_kN", 2, lambda j: j.max_force_N / N_PER_KN),
    Column("preload_kN", 1, lambda j: j.vdi_2230.preload_N / N_PER_KN),
    Column("preload_needed_kN", 1, lambda j: j.vdi_2230.needed_preload_N / N_PER_KN),
    Column("least_kN", 1, lambda j: j.vdi_2230.least_preload_N / N_PER_KN),
    Column("torque_Nm", 1, lambda j: j.vdi_2230.torque_Nm),
    Column("left_on_split_kN", 1, lambda j: j.vdi_2230.residual_clamp_N / N_PER_KN),
)
_SAFETIES: tuple[Column[JointCheck], ...] = (
    Column("joint", 0, lambda j: j.name),
    Column("load_factor", 3, lambda j: j.vdi_2230.load_factor),
    Column("clamp", 2, lambda j: j.vdi_2230.clamp_safety),
    Column("yield", 2, lambda j: j.vdi_2230.yield_safety),
    Column("amplitude_MPa", 1, lambda j: j.vdi_2230.amplitude_MPa),
    Column("fatigue", 2, lambda j: j.vdi_2230.fatigue_safety),
    Column("below_head_MPa", 0, lambda j: j.vdi_2230.head_pressure_MPa),
    Column("head", 2, lambda j: j.vdi_2230.head_pressure_safety),
    Column("thread", 2, lambda j: j.vdi_2230.thread_safety),
)
_SHIGLEY: tuple[Column[JointCheck], ...] = (
    Column("joint", 0, lambda j: j.name),
    Column("load_share", 3, lambda j: j.shigley.stiffness_share),
    Column("preload_kN", 1, lambda j: j.shigley.preload_N / N_PER_KN),
    Column("torque_Nm", 1, lambda j: j.shigley.torque_Nm),
    Column("proof", 2, lambda j: j.shigley.proof_safety),
    Column("load", 2, lambda j: j.shigley.load_safety),
    Column("separation", 2, lambda j: j.shigley.separation_safety),
    Column("fatigue", 2, lambda j: j.shigley.fatigue_safety),
)


def bolts_text(checks: BoltChecks) -> str:
    """Return what `cranktopo bolts` prints."""
    parts = [
        smallest_safety(checks),
        _FORCES_CAPTION,
        _table(_FORCES, checks),
        "VDI 2230: safeties",
        _table(_SAFETIES, checks),
        "Shigley: safeties",
        _table(_SHIGLEY, checks),
    ]
    return "\n\n".join(parts)


def smallest_safety(checks: BoltChecks) -> str:
    """Return the smallest safety with its reason and joint; NOT SAFE below 1."""
    worst = min(checks.joints, key=lambda joint: joint.smallest_safety)
    words = f"{worst.smallest_safety:.2f}, {worst.governing} of {worst.name}"
    return f"{'' if worst.smallest_safety >= 1 else 'NOT SAFE: '}smallest safety by VDI 2230: {words}."


def _table(columns: tuple[Column[Any], ...], checks: BoltChecks) -> str:
    return terminal(tabulate(columns, checks.joints))
