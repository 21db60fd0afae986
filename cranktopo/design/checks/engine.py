"""Consistency of engine and shaft table, and what the latter should not leave out."""

from __future__ import annotations

import math

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.design.checks.arrangement import check_arrangement
from cranktopo.design.checks.engine_size import check_engine_size
from cranktopo.design.engine import Engine, Gas
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import Damper, Rotor, ShaftTable

_SLOWEST = 1 / 3
"""Share of the engine's speed from which speeds are looked at by default."""
_FASTEST = 1.05
"""Share of the engine's speed up to which they are, where no overspeed is given: a resonance just above it
is felt at it (as IACS UR M68 limits vibration up to 105 % of the rated speed)."""
_NEEDED = {"rubber": ("stiffness_Nm_per_rad", "loss_factor"), "viscous": ("damping_Nms_per_rad",)}
_REFUSED = {"rubber": ("damping_Nms_per_rad",), "viscous": ("loss_factor",)}


def check_shaft(scene: Scene) -> None:
    """Check that the parts of the shaft fit together."""
    shaft = scene.shaft
    if shaft is None:
        return
    if shaft.damper is not None:
        _check_damper(scene, shaft.damper)
    if shaft.propeller is not None and shaft.driven is not None:
        raise CranktopoError(
            "shaft: driven and propeller are both given; the shaft ends at one of them.",
            hint="Keep [shaft.driven] or [shaft.propeller].",
        )
    _check_stiffnesses(scene, shaft)
    _check_losses(scene, shaft)
    _check_speeds(scene, shaft)


def _check_losses(scene: Scene, shaft: ShaftTable) -> None:
    """Refuse a loss factor of a part that turns rigidly with its neighbour."""
    for name, rotor in shaft:
        if isinstance(rotor, Rotor) and rotor.loss_factor and not rotor.is_elastic:
            raise scene.invalid(
                f"shaft.{name}.loss_factor",
                f"belongs to shaft.{name}.stiffness_Nm_per_rad, which is not given",
                "Give that stiffness, or take the loss factor out.",
            )


def _check_stiffnesses(scene: Scene, shaft: ShaftTable) -> None:
    stiffnesses = shaft.throw_stiffnesses_Nm_per_rad
    if stiffnesses is None:
        return
    if shaft.throw_stiffness_Nm_per_rad is not None:
        raise CranktopoError(
            "shaft: throw_stiffness_Nm_per_rad and throw_stiffnesses_Nm_per_rad are both given.",
            hint="Keep one of them.",
        )
    throws = len(scene.shaft_angles_deg) if scene.engine else len(stiffnesses)
    if len(stiffnesses) != throws:
        raise scene.invalid("shaft.throw_stiffnesses_Nm_per_rad", f"must have {throws} values, one a throw")


def speed_range_rpm(scene: Scene) -> tuple[float, float]:
    """Lowest and highest speed at which the vibration of a scene is looked at, rpm."""
    shaft, engine = scene.shaft or ShaftTable(), scene.engine
    rated = engine.speed_rpm if engine else 0.0
    highest = max(engine.overspeed_rpm or _FASTEST * rated, rated) if engine else math.inf
    return shaft.speed_min_rpm or max(1.0, _SLOWEST * rated), shaft.speed_max_rpm or highest


def shaft_warnings(scene: Scene) -> tuple[str, ...]:
    """Return what the shaft table leaves out and the vibration depends on, one line each."""
    shaft = scene.shaft
    if shaft is None:
        return ("[shaft] is missing: the crankshaft swings with both ends free, without its flywheel.",)
    found = []
    if shaft.flywheel is None and shaft.propeller is not None:
        found.append(
            "shaft.flywheel is missing: the propeller alone takes up the alternating torque; give the "
            "inertia of its hub, gear and starter ring as [shaft.flywheel] if it has any."
        )
    elif shaft.flywheel is None:
        found.append("shaft.flywheel is missing: little or nothing holds the takeoff against vibration.")
    if not is_damped(shaft):
        found.append("shaft: no damping is given: at a resonance nothing limits the torque.")
    return tuple(found)


def is_damped(shaft: ShaftTable) -> bool:
    """Tell whether anything takes energy from a vibration."""
    own = (shaft.cylinder_damping_Nms_per_rad, shaft.throw_damping_Nms_per_rad, shaft.throw_loss_factor)
    propeller, damper = shaft.propeller, shaft.damper
    joined = (
        *(rotor.loss_factor for rotor in shaft.elastic_rotors.values()),
        propeller.damping_Nms_per_rad if propeller else 0.0,
        (damper.damping_Nms_per_rad or damper.loss_factor or 0.0) if damper else 0.0,
    )
    return any((*own, *joined))


def _check_damper(scene: Scene, damper: Damper) -> None:
    for key in _NEEDED[damper.kind]:
        if getattr(damper, key) is None:
            raise CranktopoError(
                f"shaft.damper.{key} is missing for kind = '{damper.kind}'.",
                hint=f"Give {' and '.join(_NEEDED[damper.kind])}.",
            )
    for key in _REFUSED[damper.kind]:
        if getattr(damper, key) is not None:
            raise scene.invalid(
                f"shaft.damper.{key}",
                f"belongs to no damper of kind = '{damper.kind}'",
                f"Take it out; such a damper needs {' and '.join(_NEEDED[damper.kind])}.",
            )


def _check_speeds(scene: Scene, shaft: ShaftTable) -> None:
    low, high = speed_range_rpm(scene)
    if low < high:
        _check_barred(scene, shaft)
        return
    key = "speed_max_rpm" if shaft.speed_min_rpm is None else "speed_min_rpm"
    word = "above" if key == "speed_max_rpm" else "below"
    raise scene.invalid(
        f"shaft.{key}",
        f"speeds from {low:g} to {high:g} rpm are no range",
        f"Give a value {word} {low if key == 'speed_max_rpm' else high:g} rpm.",
    )


def _check_barred(scene: Scene, shaft: ShaftTable) -> None:
    """Check that barred ranges follow each other and leave the engine the speeds that it is given."""
    least = 0.0
    engine = scene.engine
    own = {} if engine is None else {"speed": engine.speed_rpm, "overspeed": engine.overspeed_rpm}
    for number, (low, high) in enumerate(shaft.barred_rpm or ()):
        key = f"shaft.barred_rpm[{number}]"
        if not least < low < high:
            what = "must go from its lower to its higher end, behind the range before it"
            raise invalid(key, [low, high], what, "Write [[LOW, HIGH], ...] from the slowest on, in rpm.")
        for name, rpm in own.items():
            if rpm is not None and low < rpm < high:
                what = f"holds engine.{name}_rpm = {rpm:g}, at which the engine runs"
                raise invalid(key, [low, high], what, "A barred range is passed through only: end it before.")
        least = high
    _check_running(scene, shaft)


def _check_running(scene: Scene, shaft: ShaftTable) -> None:
    """Refuse barred ranges that leave no speed to look at."""
    at, highest = speed_range_rpm(scene)
    for low, high in shaft.barred_rpm or ():
        if low >= at:
            return
        at = max(at, high)
    if at > highest:
        what = f"holds all speeds that are looked at, {speed_range_rpm(scene)[0]:g} to {highest:g} rpm"
        raise scene.invalid("shaft.barred_rpm", what, "Leave the speeds at which the engine runs.")


def check_engine(scene: Scene) -> None:
    """Check that rod, speeds, firing order and gas fit together."""
    engine = scene.engine
    if engine is None:
        return
    radius = scene.throw.radius_mm
    if engine.rod_length_mm <= radius:
        raise scene.invalid("engine.rod_length_mm", f"must be longer than throw.radius_mm = {radius:g} mm")
    if engine.overspeed_rpm is not None and engine.overspeed_rpm < engine.speed_rpm:
        raise scene.invalid(
            "engine.overspeed_rpm", f"must be at least engine.speed_rpm = {engine.speed_rpm:g} rpm"
        )
    check_engine_size(scene, engine)
    low, high = engine.min_torque_Nm, engine.max_torque_Nm
    if low is not None and high is not None and low > high:
        raise scene.invalid("engine.min_torque_Nm", f"must be at most engine.max_torque_Nm = {high:g} N m")
    _check_firing_order(scene, engine)
    check_misfire(engine)
    check_arrangement(scene)
    _check_opposed(scene, engine)
    _check_rod(scene, engine)
    if engine.gas is not None:
        _check_gas(scene, engine.strokes, engine.gas)


def check_misfire(engine: Engine, key: str = "engine.misfire") -> None:
    """Check the cylinders that do not fire; `key` is where they were given."""
    misfire, count = engine.misfire, engine.cylinders
    if not misfire:
        return
    if engine.gas is None:
        hint = "Add [engine.gas], or leave it out."
        raise invalid(
            key, list(misfire), "needs [engine.gas]: without pressures nothing is known of it", hint
        )
    if not all(1 <= cylinder <= count for cylinder in misfire):
        raise invalid(key, list(misfire), f"must be numbers of cylinders, 1 to {count}")
    if len(set(misfire)) < len(misfire):
        raise invalid(key, list(misfire), "names a cylinder twice", "Name each once.")
    if len(misfire) == count:
        raise invalid(key, list(misfire), "leaves no cylinder that fires", "Leave out at least one.")


def _check_firing_order(scene: Scene, engine: Engine) -> None:
    numbers = tuple(range(1, engine.cylinders + 1))
    if tuple(sorted(engine.order)) == numbers:
        return
    raise scene.invalid(
        "engine.firing_order",
        f"must name each of the {engine.cylinders} cylinders once (1 to {engine.cylinders})",
        "Give engine.firing_order = [...] or correct engine.cylinders.",
    )


def _check_opposed(scene: Scene, engine: Engine) -> None:
    """Check that the other crank of opposed pistons can turn, and that cylinders lie in one line."""
    other = engine.opposed
    if other is None:
        return
    if engine.arranged.layout != "in-line":
        hint = "Leave out [engine.opposed], or engine.arrangement.layout."
        raise scene.invalid("engine.arrangement.layout", "must be 'in-line' with [engine.opposed]", hint)
    radius = other.radius_mm or scene.throw.radius_mm
    if (other.rod_length_mm or engine.rod_length_mm) <= radius:
        key = "engine.opposed.rod_length_mm" if other.rod_length_mm else "engine.opposed.radius_mm"
        raise scene.invalid(key, f"gives the other crank no rod longer than its throw radius, {radius:g} mm")


def _check_rod(scene: Scene, engine: Engine) -> None:
    """The whole rod is given with its centre of mass, and not beside its parts."""
    masses = engine.masses
    whole = {"rod_kg": masses.rod_kg, "rod_centre_from_big_end_mm": masses.rod_centre_from_big_end_mm}
    whole_keys = [key for key, value in whole.items() if value is not None]
    if not whole_keys:
        return
    if len(whole_keys) == 1:
        (missing,) = whole.keys() - set(whole_keys)
        raise CranktopoError(
            f"engine.masses.{missing} is missing beside {whole_keys[0]}.",
            hint="Give rod_kg with rod_centre_from_big_end_mm, or rod_reciprocating_kg and rod_rotating_kg.",
        )
    if masses.rod_reciprocating_kg or masses.rod_rotating_kg:
        raise CranktopoError(
            "engine.masses: the whole rod and its parts are both given.",
            hint="Keep rod_kg with rod_centre_from_big_end_mm, or rod_reciprocating_kg and rod_rotating_kg.",
        )
    centre = masses.rod_centre_from_big_end_mm
    if centre is not None and centre >= engine.rod_length_mm:
        raise scene.invalid(
            "engine.masses.rod_centre_from_big_end_mm",
            f"must be smaller than engine.rod_length_mm = {engine.rod_length_mm:g} mm",
        )


_PEAK_RANGE = "must be > 0 and < 60 deg after firing top dead centre"


def _check_map(scene: Scene, gas: Gas) -> None:
    """Check that a map takes the place of a single curve, rises in speed, and gives each pressure once."""
    if (gas.indicator_csv, gas.peak_pressure_MPa, gas.peak_angle_deg) != (None, None, None):
        raise CranktopoError(
            "engine.gas: a map over speed and a single curve are both given.",
            hint="Keep [[engine.gas.map]], or indicator_csv, or the peak.",
        )
    before = 0.0
    for index, at in enumerate(gas.map):
        key = f"engine.gas.map[{index}]"
        if at.rpm <= before:
            raise scene.invalid(f"{key}.rpm", f"must be above the {before:g} rpm before it")
        before = at.rpm
        peak = at.peak_pressure_MPa, at.peak_angle_deg
        if peak != (None, None) if at.file is not None else None in peak:
            raise CranktopoError(
                f"{key}: give either file, or peak_pressure_MPa and peak_angle_deg.", hint="Give one of them."
            )
        if at.peak_angle_deg is not None and not 0 < at.peak_angle_deg < 60:
            raise scene.invalid(f"{key}.peak_angle_deg", _PEAK_RANGE)


def _check_firing(scene: Scene, gas: Gas) -> None:
    """Check that the angle of firing top dead centre belongs to a trace."""
    if gas.firing_deg and not gas.measured:  # stored scenes hold its default, 0
        raise scene.invalid(
            "engine.gas.firing_deg",
            "is for a measured trace; the combustion model counts from firing top dead centre",
            "Remove it, or give indicator_csv in place of the peak.",
        )


def _check_gas(scene: Scene, strokes: int, gas: Gas) -> None:
    _check_firing(scene, gas)
    peak = (gas.peak_pressure_MPa, gas.peak_angle_deg)
    if gas.map:
        _check_map(scene, gas)
    elif gas.indicator_csv is not None:
        if peak != (None, None):
            raise CranktopoError(
                "engine.gas: indicator_csv and a peak are both given.",
                hint="Keep either indicator_csv or peak_pressure_MPa with peak_angle_deg.",
            )
        return
    elif gas.peak_pressure_MPa is None or gas.peak_angle_deg is None:
        raise CranktopoError(
            "engine.gas: neither an indicator diagram nor a peak is given.",
            hint="Give indicator_csv, or peak_pressure_MPa and peak_angle_deg.",
        )
    elif not 0 < gas.peak_angle_deg < 60:
        raise scene.invalid("engine.gas.peak_angle_deg", _PEAK_RANGE)
    if strokes == 2 and gas.exhaust_pressure_MPa is not None:
        raise scene.invalid(
            "engine.gas.exhaust_pressure_MPa",
            "a two-stroke engine has no exhaust stroke",
            "Give the scavenging pressure as engine.gas.intake_pressure_MPa.",
        )
