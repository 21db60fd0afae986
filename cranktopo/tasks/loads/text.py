"""The loads as text for the terminal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from cranktopo.base.units import enough_decimals
from cranktopo.engine.balance.crank import CrankMass
from cranktopo.engine.balance.throw import is_as_needed
from cranktopo.engine.load_case import LoadCase
from cranktopo.report.result_table import text_table
from cranktopo.tasks.loads.result import Loads, LoadState, PistonExtremes, Range, ThrowMassProperties

_LABELS = {"inertia_force": "inertia force of piston"}
"""Beside the names of the keys: the rod's oscillating part is in the rod force."""
_WHOLE = 10_000
"""Numbers from which on are told without decimals."""


def loads_text(loads: Loads) -> str:
    """Return the tables of one speed: extremes, engine torque, balance, load cases."""
    parts = [_heading(loads)]
    if loads.points:
        parts += [
            _extremes(loads.extremes),
            _rods_together(loads.rods_per_pin),
            _silent(loads),
            _torque(loads),
        ]
    parts += [_piston(loads.piston)]
    clearance = loads.clearance.told
    parts += [_balance(loads.balance), crank_words(loads.crank)]
    parts += [clearance and f"room of web and counterweight: {clearance}"]
    parts += [_cases(loads.load_cases), _redundant(loads.extreme_states)]
    return "\n\n".join(part for part in parts if part)


def sweep_text(sweep: Sequence[Loads]) -> str:
    """Return one row per speed; the pull of the masses, which grows with it, is the least web force."""
    header = [
        "speed\nrpm",
        "small end\nN",
        "piston inertia\nN",
        "web max\nN",
        "web min\nN",
        "tangential\nN",
        "main journal\nN",
    ]
    header += ["engine mean\nN m", "max\nN m", "min\nN m"]
    values = []
    for loads in sweep:
        extremes, torque = loads.extremes, loads.engine_torque_Nm
        forces = [extremes["small_end_force_N"].max.value, extremes["inertia_force_N"].min.value]
        forces += [extremes["web_force_N"].max.value, extremes["web_force_N"].min.value]
        forces += [extremes[name].max.value for name in ("tangential_force_N", "main_journal_force_N")]
        values.append([*forces, torque.mean, torque.max, torque.min])
    columns = [[f"{loads.speed_rpm:g}" for loads in sweep], *map(_numbers, zip(*values, strict=True))]
    table = text_table("r" * len(header), header, list(zip(*columns, strict=True)))
    return f"{sweep[0].pressure}\n\n{table}".lstrip()


def _heading(loads: Loads) -> str:
    if loads.speed_rpm is None:
        return f"{loads.design}: no engine, unit loads"
    heading = f"{loads.design} at {loads.speed_rpm:g} rpm"
    if not loads.points:
        return f"{heading}: the scene gives only peak loads, no curves"
    pressure = f"\n{loads.pressure}" if loads.pressure else ""
    return f"{heading}, cycle {loads.cycle_deg:g} deg\npressure: {loads.pressure_source}{pressure}"


def _extremes(extremes: Mapping[str, Range]) -> str:
    rows = []
    for name, pair in extremes.items():
        label, unit = name.rsplit("_", 1)
        high, low = _numbers((pair.max.value, pair.min.value))
        cells = [high, f"{pair.max.deg:g}", low, f"{pair.min.deg:g}"]
        rows.append([_LABELS.get(label, label.replace("_", " ")), {"Nm": "N m"}.get(unit, unit), *cells])
    return text_table("llrrrr", ("extremes of one throw", "unit", "max", "at deg", "min", "at deg"), rows)


def _rods_together(rods: int | None) -> str:
    if rods is None or rods == 1:
        return ""
    number, every = ("Two", "both") if rods == 2 else (str(rods), "all")
    return (
        f"{number} rods on each pin: the torque is that of {every}; radial, tangential, web and main journal "
        f"force are those of {every} on the web that carries most, by the lever rule; the rest is of one "
        "cylinder.\n"
        "Degrees count from firing of the first cylinder of the throw, by number."
    )


def _silent(loads: Loads) -> str:
    if not loads.silent:
        return ""
    return (
        f"{loads.silent}\nTorque and power of the engine are without them; forces of one throw, its work and "
        "its load cases are those of a cylinder that fires."
    )


def _torque(loads: Loads) -> str:
    torque, difference = loads.engine_torque_Nm, loads.series_difference_percent
    if difference is None:
        return ""
    mean, high, low = _numbers((torque.mean, torque.max, torque.min))
    (work,) = _numbers((loads.indicated_work_per_cylinder_J,))
    (power,) = _numbers((loads.indicated_power_kW,))
    rated = f"{loads.rated_power}\n" if loads.rated_power else ""
    return (
        f"engine torque: mean {mean} N m, max {high} at "
        f"{torque.max_deg:g} deg, min {low} at {torque.min_deg:g} deg\n"
        f"indicated work per cylinder and cycle: {work} J\n"
        f"indicated mean pressure {loads.indicated_mean_pressure_MPa:.3f} MPa, power of the engine "
        f"{power} kW, without friction\n{rated}"
        f"textbook series off the exact motion: displacement {difference.displacement:.2f} %, "
        f"velocity {difference.velocity:.2f} %, acceleration {difference.acceleration:.2f} %"
    )


def _piston(piston: PistonExtremes | None) -> str:
    if piston is None:
        return ""
    speed, (away, back) = (
        piston.speed_m_per_s.max,
        (piston.acceleration_m_per_s2.max, piston.acceleration_m_per_s2.min),
    )
    return (
        f"piston: stroke {piston.stroke_mm:g} mm, mean speed {piston.mean_speed_m_per_s:.2f} m/s, largest "
        f"{speed.value:.2f} m/s at {speed.deg:g} deg\n"
        f"its acceleration: {away.value:.0f} m/s2 at {away.deg:g} deg, {back.value:.0f} at {back.deg:g} deg"
    )


def _balance(balance: ThrowMassProperties) -> str:
    one, other = balance.own_counterweight_kg, balance.own_second_counterweight_kg
    whole, alone, own, needed = _alike(
        (
            balance.rotating_unbalance_kg_mm,
            balance.throw_unbalance_kg_mm,
            balance.own_counterweight_kg_mm,
            abs(balance.counterweight_kg_mm),
        ),
        2,
    )
    first, second = _alike((one, other), 3)
    masses = f"2 x {first}" if one == other else f"{first} and {second}"
    weights = f"\nits counterweights: {masses} kg take {own} kg mm"
    factor = balance.balance_factor_percent
    weights += "" if factor is None else f",\nbalance factor {factor:z.1f} % of the oscillating mass"
    (inertia,), (mass,) = _alike((balance.inertia_kg_mm2,), 0), _alike((balance.throw_mass_kg,), 3)
    return (
        f"balance of the throw: rotating unbalance {whole} kg mm (throw alone {alone}),\ncounterweights "
        f"{_needed_words(balance, needed)}, inertia {inertia} kg mm2, mass {mass} kg"
        f"{weights if one or other else ''}"
    )


def _needed_words(balance: ThrowMassProperties, kg_mm: str) -> str:
    """Return what counterweights are needed beside the throw's own."""
    needed = balance.counterweight_kg_mm
    if is_as_needed(needed, balance.own_counterweight_kg_mm):
        return "as needed"
    return f"{'needed' if needed >= 0 else 'too heavy by'} {kg_mm} kg mm"


def crank_words(crank: CrankMass | None) -> str:
    """Return the mass properties of the whole crank in a sentence; empty for a design without one."""
    if crank is None:
        return ""
    ends = f"{crank.free_end_kg:.3f} kg at the free end, {crank.output_end_kg:.3f} kg at the output"
    return (
        f"whole crank: mass {crank.mass_kg:.3f} kg ({ends}), inertia {crank.inertia_kg_mm2:.0f} kg mm2, "
        f"unbalance {crank.unbalance_kg_mm:.3f} kg mm at {crank.unbalance_deg:.1f} deg from throw 1, couple "
        f"{crank.couple_kg_mm2:.1f} kg mm2 at {crank.couple_deg:.1f} deg"
    )


def _cases(cases: Sequence[LoadCase]) -> str:
    header = ("load case", "radial\nN", "tangential\nN", "torque\nN m", "body\nrpm", "from")
    loads = [(case.radial_N, case.tangential_N, case.torque_Nm, case.speed_rpm) for case in cases]
    columns = [_numbers(values) for values in zip(*loads, strict=True)]
    names, sources = [case.name for case in cases], [case.source for case in cases]
    return text_table("lrrrrl", header, list(zip(names, *columns, sources, strict=True)))


def _redundant(states: Sequence[LoadState]) -> str:
    lines = [f"  {s.name}: {s.redundant_because}" for s in states if s.redundant_because]
    return "\n".join(["states that need no load case of their own:", *lines]) if lines else ""


def _alike(values: Sequence[float], usual: int) -> list[str]:
    """Return values of one kind, with decimals that suit the largest."""
    digits = enough_decimals(max(map(abs, values)), usual)
    return [f"{value:.{digits}f}" for value in values]


def _numbers(values: Sequence[float | None]) -> list[str]:
    """Return values of one kind as `_alike` with a decimal, those from ten thousand on without."""
    digits = enough_decimals(max((abs(value) for value in values if value is not None), default=0.0), 1)
    return [
        "-" if value is None else f"{value:z.{0 if abs(value) >= _WHOLE else digits}f}" for value in values
    ]
