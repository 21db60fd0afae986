"""Consistency of the shaft table, and what it leaves out that nobody should overlook."""

from __future__ import annotations

import math

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.design.engine import Engine
from cranktopo.design.schema import Scene
from cranktopo.design.shaft import Damper, ShaftTable

_SLOWEST = 1 / 3
"""Share of the engine's speed from which speeds are looked at by default."""
_NEEDED = {"rubber": ("stiffness_Nm_per_rad", "loss_factor"), "viscous": ("damping_Nms_per_rad",)}
_REFUSED = {"rubber": ("damping_Nms_per_rad",), "viscous": ("loss_factor",)}


def check_shaft(scene: Scene) -> None:
    """Check that the parts of the shaft fit together.

    Raises:
        CranktopoError: first inconsistency found.
    """
    shaft = scene.shaft
    if shaft is None:
        return
    if shaft.damper is not None:
        _check_damper(shaft.damper)
    if shaft.propeller is not None and shaft.driven is not None:
        raise CranktopoError(
            "shaft: driven and propeller are both given; the shaft ends at one of them.",
            hint="Keep [shaft.driven] or [shaft.propeller].",
        )
    _check_speeds(shaft, scene.engine)


def speed_range_rpm(scene: Scene) -> tuple[float, float]:
    """Lowest and highest speed at which the vibration of a scene is looked at, rpm."""
    return _range(scene.shaft or ShaftTable(), scene.engine)


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
    coupling, propeller, damper = shaft.coupling, shaft.propeller, shaft.damper
    joined = (
        coupling.loss_factor if coupling else 0.0,
        propeller.damping_Nms_per_rad if propeller else 0.0,
        (damper.damping_Nms_per_rad or damper.loss_factor or 0.0) if damper else 0.0,
    )
    return any((*own, *joined))


def _check_damper(damper: Damper) -> None:
    for key in _NEEDED[damper.kind]:
        if getattr(damper, key) is None:
            raise CranktopoError(
                f"shaft.damper.{key} is missing for kind = '{damper.kind}'.",
                hint=f"Give {' and '.join(_NEEDED[damper.kind])}.",
            )
    for key in _REFUSED[damper.kind]:
        if getattr(damper, key) is not None:
            raise invalid(
                f"shaft.damper.{key}",
                getattr(damper, key),
                f"belongs to no damper of kind = '{damper.kind}'",
                f"Take it out; such a damper needs {' and '.join(_NEEDED[damper.kind])}.",
            )


def _check_speeds(shaft: ShaftTable, engine: Engine | None) -> None:
    low, high = _range(shaft, engine)
    if low < high:
        return
    key = "speed_max_rpm" if shaft.speed_min_rpm is None else "speed_min_rpm"
    word = "above" if key == "speed_max_rpm" else "below"
    raise invalid(
        f"shaft.{key}",
        getattr(shaft, key),
        f"speeds from {low:g} to {high:g} rpm are no range",
        f"Give a value {word} {low if key == 'speed_max_rpm' else high:g} rpm.",
    )


def _range(shaft: ShaftTable, engine: Engine | None) -> tuple[float, float]:
    rated = engine.speed_rpm if engine else 0.0
    highest = max(engine.overspeed_rpm or 0.0, rated) if engine else math.inf
    return shaft.speed_min_rpm or max(1.0, _SLOWEST * rated), shaft.speed_max_rpm or highest
