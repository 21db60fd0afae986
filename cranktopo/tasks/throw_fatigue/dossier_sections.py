"""Sections of the dossier on what the rule's calculation rests on: engine, masses, shaft line, vibration."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

from cranktopo.base.units import number_text
from cranktopo.design.arrangement import banks_words
from cranktopo.design.engine import Engine, Gas
from cranktopo.design.halves import difference, halves
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import ROTORS, ShaftTable
from cranktopo.engine.analysis import Cycle
from cranktopo.engine.balance.throw import ThrowBalance, throw_balance
from cranktopo.engine.gas import mapped_curves, pressure_curve
from cranktopo.engine.performance import mean_pressure_MPa, power_kW
from cranktopo.engine.vibration.study import VibrationStudy
from cranktopo.report.page import Section, pairs, quantity_words, with_unit
from cranktopo.tasks.vibration.page import vibration_page
from cranktopo.tasks.vibration.text import ends_of

_UNKNOWN = "unknown"
_Rows = list[tuple[str, Any]]
_GAS = {
    "peak_angle_deg": "crank angle of the largest pressure after firing top dead centre",
    "ambient_pressure_MPa": "pressure below the piston (absolute)",
    "intake_pressure_MPa": "charge-air pressure (intake, absolute)",
    "exhaust_pressure_MPa": "pressure during exhaust (absolute)",
    "compression_ratio": "compression ratio",
    "burn_duration_deg": "burn duration",
    "wiebe_shape": "shape exponent of the Wiebe function",
    "polytropic_compression": "polytropic exponent of compression",
    "polytropic_expansion": "polytropic exponent of expansion",
    "exhaust_opening_deg": "crank angle at which the exhaust opens, after firing top dead centre",
}
"""Keys of the combustion model in words."""
_BESIDE_TRACE = ("intake_pressure_MPa", "compression_ratio")
"""Those that are asked for beside a measured pressure, too, which does not assume them."""
_DAMPING_KEYS = {"loss_factor", "damping_Nms_per_rad"}
"""Keys of the parts of the shaft line that stand in the table of damping."""


def engine_section(scene: Scene, cycle: Cycle | None) -> Section:
    """Return engine data and masses; what the design does not give is unknown."""
    engine = scene.engine
    data = _engine_rows(scene, engine, cycle) if engine else [("engine", _UNKNOWN)]
    tables = (("Engine", pairs(data)), ("Masses", pairs(_mass_rows(scene, engine))))
    return Section("engine", "Engine data and masses", tables=tables)


def _engine_rows(scene: Scene, engine: Engine, cycle: Cycle | None) -> _Rows:
    gas = engine.gas
    curve = pressure_curve(scene) if gas and (gas.map or gas.measured) else None
    peak = gas.peak_pressure_MPa if gas else None
    pressure = f"{peak:g} MPa" if peak else _UNKNOWN
    if curve is not None:
        pressure = f"{curve.pressure_MPa.max():.4g} MPa, {curve.source}"
    banks = banks_words(engine.arranged.layout, engine.directions_deg)
    return [
        ("cylinders", f"{engine.cylinders}, {engine.arranged.layout}{banks}; {engine.strokes}-stroke"),
        *_opposed_rows(engine),
        ("bore and stroke", f"{engine.bore_mm:g} mm, {2 * scene.throw.radius_mm:g} mm"),
        ("length of the connecting rod", f"{engine.rod_length_mm:g} mm"),
        ("rated speed", f"{engine.speed_rpm:g} rpm"),
        ("overspeed", f"{engine.overspeed_rpm:g} rpm" if engine.overspeed_rpm else _UNKNOWN),
        ("sense of rotation, seen from the output end", engine.rotation or _UNKNOWN),
        ("rated power", f"{engine.rated_power_kW:g} kW" if engine.rated_power_kW else _UNKNOWN),
        *_performance_rows(scene, engine, cycle),
        ("maximum cylinder pressure (absolute)", pressure),
        *_gas_rows(gas, cycle),
        *_map_rows(scene),
        ("firing order", "-".join(map(str, engine.order))),
        ("firing angles of the cylinders", _listed(engine.firing_angles_deg, "deg")),
        ("angles of the throws", _listed(engine.throw_angles_deg, "deg")),
    ]


def _opposed_rows(engine: Engine) -> _Rows:
    if engine.opposed is None:
        return []
    other = f"the other crank is {engine.opposed.lead_deg:g} deg ahead; loads and power are those of this one"
    return [("opposed pistons", other)]


def _performance_rows(scene: Scene, engine: Engine, cycle: Cycle | None) -> _Rows:
    """Return power and mean pressure that follow from the cylinder pressure."""
    power = mean = _UNKNOWN
    if cycle is not None:
        pressure_MPa = mean_pressure_MPa(cycle.indicated_work_J, engine, scene.throw.radius_mm)
        power, mean = f"{power_kW(cycle.mean_work_J, engine):.1f} kW", f"{pressure_MPa:.3f} MPa"
    return [
        ("indicated power at rated speed, friction not taken off", power),
        ("indicated mean pressure", mean),
    ]


def _gas_rows(gas: Gas | None, cycle: Cycle | None) -> _Rows:
    """Return every value of `[engine.gas]` that counts, given or assumed, and the source of the pressure.

    Beside a measured pressure, or none, what is not given of the engine is unknown.
    """
    source = ("cylinder pressure over crank angle", cycle.pressure.source if cycle else _UNKNOWN)
    if gas is not None and gas.modelled:
        return [*((words, _given_or_assumed(gas, name)) for name, words in _GAS.items()), source]
    given = {} if gas is None else gas.model_dump(include=gas.model_fields_set, exclude_none=True)
    rows = [
        (_GAS[name], f"{with_unit(name, given[name])} (given)" if name in given else _UNKNOWN)
        for name in _BESIDE_TRACE
    ]
    ambient = "ambient_pressure_MPa"
    return [*([] if gas is None else [(_GAS[ambient], _given_or_assumed(gas, ambient))]), *rows, source]


def _given_or_assumed(gas: Gas, name: str) -> str:
    """Return a value of the gas and where it comes from; of a pressure that is not given the ambient one."""
    value = getattr(gas, name)
    if value is None:
        return f"{with_unit(name, gas.ambient_pressure_MPa)} (assumed, ambient)"
    return f"{with_unit(name, value)} ({'given' if name in gas.model_fields_set else 'assumed'})"


def _map_rows(scene: Scene) -> _Rows:
    """Return every entry of a map over speed: its source and its peak."""
    return [
        (f"cylinder pressure at {rpm:g} rpm", f"{curve.source}; largest {curve.pressure_MPa.max():.4g} MPa")
        for rpm, curve in mapped_curves(scene)
    ]


def _mass_rows(scene: Scene, engine: Engine | None) -> _Rows:
    balance = throw_balance(scene)
    own: _Rows = [
        ("throw between its mid-journal planes", f"{balance.mass_kg:.3f} kg"),
        *_web_rows(scene, balance),
        ("inertia of a throw about the crank axis", f"{number_text(balance.inertia_kg_mm2)} kg mm2"),
        ("unbalance of a throw", f"{number_text(balance.throw_unbalance_kg_mm)} kg mm"),
    ]
    if engine is None:
        return own
    moving = (
        ("piston group", engine.masses.piston_group_kg),
        ("connecting rod, oscillating part", engine.rod_parts_kg[0]),
        ("connecting rod, rotating part", engine.rod_rotating_kg),
    )
    return [*((name, f"{mass:.3f} kg" if mass else _UNKNOWN) for name, mass in moving), *own]


def _web_rows(scene: Scene, balance: ThrowBalance) -> _Rows:
    """Return the mass of the web, or of each where the halves of the throw differ."""
    sides = ("first ", "second ") if difference(scene) else ("",)
    masses = balance.web_kg, balance.second_web_kg
    return [
        (f"{side}web{', with its counterweight' if half.web.counterweight else ''}", f"{mass:.3f} kg")
        for side, half, mass in zip(sides, halves(scene), masses, strict=False)
    ]


def shaft_section(scene: Scene) -> Section:
    """Return what turns with the crankshaft and what damps it, as the design gives it."""
    shaft = scene.shaft
    if shaft is None:
        return Section(
            "shaft-line",
            "Shaft line and damping",
            "The design has no [shaft]: shaft line and damping unknown.",
        )
    damping: _Rows = [
        ("absolute damping of a cylinder", f"{shaft.cylinder_damping_Nms_per_rad:g} N m s/rad"),
        ("relative damping between throws", f"{shaft.throw_damping_Nms_per_rad:g} N m s/rad"),
        ("loss factor of the crankshaft: throws and ends", f"{shaft.throw_loss_factor:g}"),
        *_joined_damping(shaft),
    ]
    tables = (("Shaft line, free end first", pairs(_rotor_rows(shaft))), ("Damping", pairs(damping)))
    return Section("shaft-line", "Shaft line and damping", tables=tables)


def _joined_damping(shaft: ShaftTable) -> _Rows:
    """Return what damps the parts that are joined to the crankshaft; a loss factor of 0 is none."""
    rows: _Rows = []
    for name, rotor in shaft.elastic_rotors.items():
        own = "coupling" if name == "coupling" else f"shaft between {name} and its neighbour"
        rows.append((f"loss factor of the {own}", f"{rotor.loss_factor:g}"))
    if shaft.propeller is not None:
        damping = f"{shaft.propeller.damping_Nms_per_rad:g} N m s/rad"
        rows.append(("absolute damping of the propeller", damping))
    return rows


def _rotor_rows(shaft: ShaftTable) -> _Rows:
    rows: _Rows = []
    for name in ("damper", *ROTORS):
        rotor = getattr(shaft, name)
        if rotor is not None:
            rotor_values = rotor.model_dump(
                exclude_none=True, exclude=set() if name == "damper" else _DAMPING_KEYS
            )
            rows.append((name, ", ".join(quantity_words(key, value) for key, value in rotor_values.items())))
    return rows or [("rotors", "none")]


def vibration_sections(study: VibrationStudy | None, judged_Nm: float) -> tuple[Section, ...]:
    """Return the calculation of torsional vibration, or why there is none.

    Args:
        judged_Nm: torque amplitude that the rule's check has.
    """
    title = "Torsional vibration"
    if study is None:
        text = (
            "Not calculated, nor what a misfire does: it takes [shaft] and the gas forces of [engine.gas] in "
            "the design."
        )
        return (Section("vibration", title, text),)
    page = vibration_page(study, "")
    warned = " ".join(f"{line.rstrip('.')}." for line in study.warnings)
    head = Section(
        "vibration",
        title,
        f"{page.headline} {_misfire(study, judged_Nm)}Stiffness of the throws: {study.stiffness_source}. "
        f"{warned}",
    )
    return (head, *(replace(one, anchor=f"vibration-{one.anchor}") for one in page.sections))


def _misfire(study: VibrationStudy, judged_Nm: float) -> str:
    """Return the largest torque with one cylinder that does not fire against that which is judged."""
    worst = study.worst_misfire
    if worst is None:
        return ""
    amplitude = worst.crankshaft.torque_amplitude_Nm
    return (
        "The check is of an engine that fires in all cylinders, with a torque amplitude of "
        f"{number_text(judged_Nm)} N m for every section of the crankshaft; where cylinder "
        f"{worst.cylinder} does not fire, the worst of all, the largest is {number_text(amplitude)} N m "
        f"between {ends_of(study, worst.crankshaft)} at {worst.crankshaft.speed_rpm:.0f} rpm, "
        f"{amplitude / judged_Nm:.2f} of what is checked. "
    )


def _listed(values: tuple[float, ...], unit: str) -> str:
    return f"{', '.join(f'{value:g}' for value in values)} {unit}"
