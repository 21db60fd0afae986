"""A balancer shaft as tables and text."""

from __future__ import annotations

from cranktopo.base.units import N_PER_KN, change_text
from cranktopo.report.result_table import Column, labelled, tabulate, terminal
from cranktopo.tasks.balancer.result import (
    BalancerStrength,
    KeptLimit,
    NotchCheck,
    ProbeDeflection,
    Redesign,
    ShaftBearingLoad,
    ShaftDimension,
    WeightForce,
)
from cranktopo.tasks.bolts.result import BoltChecks
from cranktopo.tasks.bolts.text import bolts_text

_WEIGHTS: tuple[Column[WeightForce], ...] = (
    Column("mass_at_mm", 1, lambda w: w.z_mm),
    Column("force_N", 1, lambda w: w.force_N),
    Column("direction_deg", 1, lambda w: w.deg),
)
_BEARINGS: tuple[Column[ShaftBearingLoad], ...] = (
    Column("bearing", 0, lambda b: b.bearing),
    Column("place_mm", 1, lambda b: b.z_mm),
    Column("stiffness_kN_per_mm", 0, lambda b: b.spring_N_per_mm and b.spring_N_per_mm / N_PER_KN),
    Column("masses_N", 1, lambda b: b.weights_N),
    Column("gear_N", 1, lambda b: b.gear_N),
    Column("largest_N", 1, lambda b: b.max_N),
    Column("equivalent_N", 1, lambda b: b.equivalent_N),
    Column("tilt_mrad", 3, lambda b: b.tilt_mrad),
    Column("life_h", 0, lambda b: b.life_h),
)
_PROBES: tuple[Column[ProbeDeflection], ...] = (
    Column("place", 0, lambda p: p.name),
    Column("at_mm", 1, lambda p: p.z_mm),
    Column("deflection_mm", 4, lambda p: p.deflection_mm),
    Column("permitted_mm", 4, lambda p: p.permitted_mm),
)
_NOTCHES: tuple[Column[NotchCheck], ...] = (
    Column("notch", 0, lambda n: n.name),
    Column("at_mm", 1, lambda n: n.z_mm),
    Column("moment_Nm", 1, lambda n: n.moment_Nm),
    Column("concentration", 2, lambda n: n.concentration),
    Column("stress_MPa", 1, lambda n: n.stress_MPa),
    Column("size_factor", 3, lambda n: n.size_factor),
    Column("running", 2, lambda n: n.running_safety),
    Column("starting", 2, lambda n: n.starting_safety),
    Column("reversed", 2, lambda n: n.reversed_safety),
)
_LIMITS: tuple[Column[KeptLimit], ...] = (
    Column("quantity", 0, lambda k: k.quantity),
    Column("unit", 0, lambda k: k.unit),
    Column("before", 0, lambda k: _digits(k.before)),
    Column("after", 0, lambda k: _digits(k.after)),
    Column("limit", 0, lambda k: f"{k.sense} {_digits(k.limit)}"),
)
_DIMENSIONS: tuple[Column[ShaftDimension], ...] = (
    Column("dimension", 0, lambda d: d.key.removeprefix("balancer.")),
    Column("start_mm", 2, lambda d: d.start_mm),
    Column("found_mm", 2, lambda d: d.value_mm),
    Column("low_mm", 2, lambda d: d.low_mm),
    Column("high_mm", 2, lambda d: d.high_mm),
)


def _digits(value: float) -> str:
    """Return a number with four digits at least."""
    return f"{value:.0f}" if value >= 1000 else f"{value:.4g}"


def balancer_text(shaft: BalancerStrength) -> str:
    """Return what `cranktopo balancer` prints."""
    rows = [("mass of the shaft", f"{shaft.mass_kg:.3f} kg")]
    if shaft.gear is not None:
        gear = shaft.gear
        across = f"{gear.tangential_N:.1f} N around, {gear.radial_N:.1f} N toward the axis"
        rows.append(("gear", f"{across}, {gear.axial_N:.1f} N along"))
    rows.append(("largest deflection", f"{shaft.largest_deflection_mm:.4f} mm"))
    parts = [_redesign(shaft.redesign)] if shaft.redesign else []
    parts += [f"{shaft.design}: balancer shaft at {shaft.speed_rpm:g} rpm", labelled(rows)]
    parts += [terminal(tabulate(_WEIGHTS, shaft.weights))] if shaft.weights else []
    parts.append(terminal(tabulate(_BEARINGS, shaft.bearings)))
    parts += [terminal(tabulate(_PROBES, shaft.probes)), places_beyond(shaft)] if shaft.probes else []
    if shaft.notches:
        parts += [
            "Fatigue of notches by local stress analysis",
            terminal(tabulate(_NOTCHES, shaft.notches)),
        ]
    if shaft.joints:
        parts.append(bolts_text(BoltChecks(design=shaft.design, joints=shaft.joints, assumed=())))
    return "\n\n".join(filter(None, parts))


def _redesign(redesign: Redesign) -> str:
    change = 100 * (redesign.result_kg / redesign.start_kg - 1)
    mass = f"{redesign.start_kg:.3f} -> {redesign.result_kg:.3f} kg ({change_text(change)})"
    line = f"Every limit holds: mass of the shaft {mass}"
    tables = [terminal(tabulate(_LIMITS, redesign.limits))]
    tables += [terminal(tabulate(_DIMENSIONS, redesign.dimensions))] if redesign.dimensions else []
    return "\n\n".join([line, *tables])


def places_beyond(shaft: BalancerStrength) -> str:
    """Return the places that bend more than permitted; empty where there is none."""
    beyond = [p.name for p in shaft.probes if p.permitted_mm and p.deflection_mm > p.permitted_mm]
    return f"More than permitted: {', '.join(beyond)}." if beyond else ""
