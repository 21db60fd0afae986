"""Consistency of the engine of a scene."""

from __future__ import annotations

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.design.checks.arrangement import check_arrangement
from cranktopo.design.engine import Engine, Gas
from cranktopo.design.schema import Scene


def check_engine(scene: Scene) -> None:
    """Check that rod, speeds, firing order and gas fit together.

    Raises:
        CranktopoError: first inconsistency found.
    """
    engine = scene.engine
    if engine is None:
        return
    radius = scene.throw.radius_mm
    if engine.rod_length_mm <= radius:
        raise invalid(
            "engine.rod_length_mm",
            engine.rod_length_mm,
            f"must be longer than throw.radius_mm = {radius:g} mm",
        )
    if engine.overspeed_rpm is not None and engine.overspeed_rpm < engine.speed_rpm:
        raise invalid(
            "engine.overspeed_rpm",
            engine.overspeed_rpm,
            f"must be at least engine.speed_rpm = {engine.speed_rpm:g} rpm",
        )
    _check_firing_order(engine)
    check_arrangement(scene)
    _check_rod(engine)
    if engine.gas is not None:
        _check_gas(engine, engine.gas)


def _check_firing_order(engine: Engine) -> None:
    numbers = tuple(range(1, engine.cylinders + 1))
    if tuple(sorted(engine.order)) == numbers:
        return
    raise invalid(
        "engine.firing_order",
        list(engine.firing_order),
        f"must name each of the {engine.cylinders} cylinders once (1 to {engine.cylinders})",
        "Give engine.firing_order = [...] or correct engine.cylinders.",
    )


def _check_rod(engine: Engine) -> None:
    """The whole rod is given with its centre of mass, and not beside its parts."""
    masses = engine.masses
    whole = {"rod_kg": masses.rod_kg, "rod_centre_from_big_end_mm": masses.rod_centre_from_big_end_mm}
    given = [key for key, value in whole.items() if value is not None]
    if not given:
        return
    if len(given) == 1:
        (missing,) = whole.keys() - set(given)
        raise CranktopoError(
            f"engine.masses.{missing} is missing beside {given[0]}.",
            hint="Give rod_kg with rod_centre_from_big_end_mm, or rod_reciprocating_kg and rod_rotating_kg.",
        )
    if masses.rod_reciprocating_kg or masses.rod_rotating_kg:
        raise CranktopoError(
            "engine.masses: the whole rod and its parts are both given.",
            hint="Keep rod_kg with rod_centre_from_big_end_mm, or rod_reciprocating_kg and rod_rotating_kg.",
        )
    centre = masses.rod_centre_from_big_end_mm
    if centre is not None and centre >= engine.rod_length_mm:
        raise invalid(
            "engine.masses.rod_centre_from_big_end_mm",
            centre,
            f"must be smaller than engine.rod_length_mm = {engine.rod_length_mm:g} mm",
        )


def _check_gas(engine: Engine, gas: Gas) -> None:
    peak = (gas.peak_pressure_MPa, gas.peak_angle_deg)
    if gas.indicator_csv is not None:
        if peak != (None, None):
            raise CranktopoError(
                "engine.gas: indicator_csv and a peak are both given.",
                hint="Keep either indicator_csv or peak_pressure_MPa with peak_angle_deg.",
            )
        return
    if gas.peak_pressure_MPa is None or gas.peak_angle_deg is None:
        raise CranktopoError(
            "engine.gas: neither an indicator diagram nor a peak is given.",
            hint="Give indicator_csv, or peak_pressure_MPa and peak_angle_deg.",
        )
    if not 0 < gas.peak_angle_deg < 60:
        raise invalid(
            "engine.gas.peak_angle_deg",
            gas.peak_angle_deg,
            "must be > 0 and < 60 deg after firing top dead centre",
        )
    if engine.strokes == 2 and gas.exhaust_pressure_MPa is not None:
        raise invalid(
            "engine.gas.exhaust_pressure_MPa",
            gas.exhaust_pressure_MPa,
            "a two-stroke engine has no exhaust stroke",
            "Give the scavenging pressure as engine.gas.intake_pressure_MPa.",
        )
