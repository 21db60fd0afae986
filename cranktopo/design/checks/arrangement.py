"""Consistency of the engine's arrangement: banks, throws, balancer shafts."""

from __future__ import annotations

from cranktopo.base.errors import invalid
from cranktopo.design.arrangement import Arrangement, BalancerShaft
from cranktopo.design.engine import Engine
from cranktopo.design.schema import Scene

_PATH = "engine.arrangement"


def check_arrangement(scene: Scene) -> None:
    """Check that layout, banks, throws and balancer shafts fit together.

    Raises:
        CranktopoError: first inconsistency found.
    """
    engine = scene.engine
    if engine is None or engine.arrangement is None:
        return
    _check_layout(engine, engine.arrangement)
    _check_lengths(scene, engine.arrangement)
    _check_throws(engine, engine.arrangement)
    for number, shaft in enumerate(engine.arrangement.balancer_shaft):
        _check_shaft(f"{_PATH}.balancer_shaft[{number}]", shaft, engine.arrangement.balancer_shaft[:number])


def _check_layout(engine: Engine, arranged: Arrangement) -> None:
    bank, layout = arranged.bank_angle_deg, arranged.layout
    if layout == "V" and bank is None:
        raise invalid(f"{_PATH}.bank_angle_deg", None, "must be given for a V, >= 1 and <= 180 deg")
    if layout == "in-line" and bank is not None:
        raise invalid(
            f"{_PATH}.bank_angle_deg", bank, "an in-line engine has one bank", f"Give {_PATH}.layout = 'V'."
        )
    if layout == "boxer" and bank not in (None, 180.0):
        raise invalid(f"{_PATH}.bank_angle_deg", bank, "must be 180 deg for a boxer", "Leave it out.")
    if layout != "in-line" and engine.cylinders % 2:
        raise invalid("engine.cylinders", engine.cylinders, f"must be even for {_PATH}.layout = '{layout}'")


def _check_lengths(scene: Scene, arranged: Arrangement) -> None:
    pin, offset, pitch = scene.throw.crankpin.length_mm, arranged.rod_offset_mm, arranged.cylinder_pitch_mm
    if offset is not None and arranged.layout != "V":
        raise invalid(f"{_PATH}.rod_offset_mm", offset, "only a V has two rods on a pin", "Leave it out.")
    for key, value, fits in (
        ("rod_offset_mm", offset, offset is None or offset < pin),
        ("cylinder_pitch_mm", pitch, pitch is None or pitch > pin),
    ):
        if not fits:
            than = "smaller" if key == "rod_offset_mm" else "larger"
            raise invalid(
                f"{_PATH}.{key}", value, f"must be {than} than throw.crankpin.length_mm = {pin:g} mm"
            )


def _check_throws(engine: Engine, arranged: Arrangement) -> None:
    key, angles = f"{_PATH}.throw_angles_deg", arranged.throw_angles_deg
    if not angles:
        _check_even_firing(engine)
        return
    if len(angles) != engine.throws:
        raise invalid(key, list(angles), f"must have one angle per throw ({engine.throws})")
    if angles[0]:
        raise invalid(key, list(angles), "must begin with 0: angles count from the first throw")
    _ = engine.firing_angles_deg  # refuses throws that contradict the firing order


def _check_even_firing(engine: Engine) -> None:
    """Even firing is possible only where both rods of a pin ask for the same angle of it."""
    for cylinder in range(1, engine.cylinders + 1):
        first = engine.throw_of(cylinder) + 1
        gap = (engine.even_angle_deg(cylinder) - engine.even_angle_deg(first) + 180.0) % 360.0 - 180.0
        if abs(gap) > 1e-6:
            raise invalid(
                "engine.firing_order",
                list(engine.order),
                f"cannot be even: cylinders {first} and {cylinder} on one pin would need throws "
                f"{abs(gap):g} deg apart, and split pins (two pins with a web between them) are not modelled",
                f"Give {_PATH}.throw_angles_deg, or another order or bank angle.",
            )


def _check_shaft(path: str, shaft: BalancerShaft, before: tuple[BalancerShaft, ...]) -> None:
    moment = shaft.balances == "moment"
    if moment and shaft.distance_mm is None:
        raise invalid(f"{path}.distance_mm", None, "must be given where balances = 'moment'")
    if not moment and shaft.distance_mm is not None:
        raise invalid(
            f"{path}.distance_mm",
            shaft.distance_mm,
            "a shaft that balances a force has one mass",
            "Leave it out, or give balances = 'moment'.",
        )
    if moment and shaft.z_mm is not None:
        raise invalid(
            f"{path}.z_mm", shaft.z_mm, "two opposite masses act alike wherever they are", "Leave it out."
        )
    free = shaft.unbalance_kg_mm is None or shaft.phase_deg is None
    alike = [
        s for s in before if (s.order, s.turns, s.balances) == (shaft.order, shaft.turns, shaft.balances)
    ]
    if alike and (free or any(s.unbalance_kg_mm is None or s.phase_deg is None for s in alike)):
        raise invalid(
            path,
            f"order {shaft.order}, {shaft.turns} the crank, {shaft.balances}",
            "is there twice and cannot be found from the engine's needs",
            "Give unbalance_kg_mm and phase_deg of both, or leave one out.",
        )
