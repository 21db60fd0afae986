"""Consistency of the arrangement of cylinders: layout, banks, throws, firing order, balancer shafts."""

from __future__ import annotations

from itertools import pairwise

from cranktopo.base.errors import invalid
from cranktopo.base.frames import shortest_turn_deg
from cranktopo.design.arrangement import Arrangement, BalancerShaft
from cranktopo.design.engine import Engine
from cranktopo.design.schema import Scene

_PATH = "engine.arrangement"


def check_arrangement(scene: Scene) -> None:
    """Check that layout, banks, throws and balancer shafts fit together."""
    engine = scene.engine
    if engine is None or engine.arrangement is None:
        return
    _check_layout(scene, engine, engine.arrangement)
    _check_lengths(scene, engine.arrangement)
    _check_throws(scene, engine, engine.arrangement)
    for number, shaft in enumerate(engine.arrangement.balancer_shaft):
        _check_balancer(
            scene, f"{_PATH}.balancer_shaft[{number}]", shaft, engine.arrangement.balancer_shaft[:number]
        )


def _check_layout(scene: Scene, engine: Engine, arranged: Arrangement) -> None:
    _check_bank_angle(scene, arranged)
    _check_banks_of_w(scene, arranged)
    layout, count = arranged.layout, "engine.cylinders"
    if layout in ("V", "boxer") and engine.cylinders % 2:
        raise scene.invalid(count, f"must be even for {_PATH}.layout = '{layout}'")
    if engine.cylinders % len(arranged.banks_deg):
        raise scene.invalid(count, f"must be a multiple of {len(arranged.banks_deg)}, one for each bank")
    if layout == "radial" and engine.cylinders % engine.throws:
        raise scene.invalid(count, f"must be a multiple of {engine.throws}, one for each throw angle's row")
    if layout == "radial" and engine.rods_per_pin == 1:
        hint = f"Give {_PATH}.layout = 'in-line'."
        raise scene.invalid(count, "leaves one cylinder a row of a radial engine", hint)


def _check_bank_angle(scene: Scene, arranged: Arrangement) -> None:
    key, bank, layout = f"{_PATH}.bank_angle_deg", arranged.bank_angle_deg, arranged.layout
    if layout == "V" and bank is None:
        raise scene.invalid(key, "must be given for a V, >= 1 and <= 180 deg")
    if layout == "boxer" and bank not in (None, 180.0):
        raise scene.invalid(key, "must be 180 deg for a boxer", "Leave it out.")
    if layout in _NO_BANK_ANGLE and bank is not None:
        raise scene.invalid(key, *_NO_BANK_ANGLE[layout])


_NO_BANK_ANGLE = {
    "in-line": ("an in-line engine has one bank", f"Give {_PATH}.layout = 'V'."),
    "radial": ("the cylinders of a radial engine are evenly spaced", "Leave it out."),
    "W": ("a W has three or more banks", f"Give {_PATH}.bank_angles_deg in its place."),
}


def _check_banks_of_w(scene: Scene, arranged: Arrangement) -> None:
    key, banks = f"{_PATH}.bank_angles_deg", arranged.bank_angles_deg
    if arranged.layout != "W":
        if banks:
            raise scene.invalid(key, "belongs to layout = 'W' alone", "Leave it out.")
        return
    if len(banks) < 3:
        raise scene.invalid(key, "must have three or more angles for a W, such as [0, 60, 120]")
    if banks[0] or any(b <= a for a, b in pairwise(banks)):
        raise scene.invalid(key, "must begin with 0 and rise: angles count from the first bank")


def _check_lengths(scene: Scene, arranged: Arrangement) -> None:
    pin, offset, pitch = scene.throw.crankpin.length_mm, arranged.rod_offset_mm, arranged.cylinder_pitch_mm
    key = f"{_PATH}.rod_offset_mm"
    if offset is not None and arranged.layout not in ("V", "W"):
        raise scene.invalid(key, "only a V or a W has rods side by side on a pin", "Leave it out.")
    if offset is not None and offset * (len(arranged.banks_deg) - 1) >= pin:
        most = f"{pin / (len(arranged.banks_deg) - 1):g} mm"
        raise scene.invalid(key, f"must be smaller than {most}: all rods are on throw.crankpin.length_mm")
    _check_splay(scene, arranged)
    if pitch is not None and pitch <= pin:
        allowed = f"must be larger than throw.crankpin.length_mm = {pin:g} mm"
        raise scene.invalid(f"{_PATH}.cylinder_pitch_mm", allowed)


def _check_splay(scene: Scene, arranged: Arrangement) -> None:
    """Split pins belong to a V, and a half pin to one rod."""
    key = f"{_PATH}.pin_splay_deg"
    if arranged.pin_splay_deg and arranged.layout != "V":
        raise scene.invalid(key, "only a V has split pins", "Leave it out.")
    if arranged.pin_splay_deg and not scene.rod_offset_mm:
        raise scene.invalid(
            f"{_PATH}.rod_offset_mm", "must be > 0 mm with split pins: each half pin has a rod of its own"
        )


def _check_throws(scene: Scene, engine: Engine, arranged: Arrangement) -> None:
    key, angles = f"{_PATH}.throw_angles_deg", arranged.throw_angles_deg
    if not angles:
        _check_even_firing(scene, engine)
        return
    if len(angles) != engine.throws:
        raise scene.invalid(key, f"must have one angle per throw ({engine.throws})")
    if angles[0]:
        raise scene.invalid(key, "must begin with 0: angles count from the first throw")
    _ = engine.firing_angles_deg  # refuses throws that contradict the firing order


def _check_even_firing(scene: Scene, engine: Engine) -> None:
    """Even firing is possible only where all rods of a pin ask for the same angle of it."""
    splay = f", split pins ({_PATH}.pin_splay_deg)" if engine.arranged.layout == "V" else ""
    for cylinder in range(1, engine.cylinders + 1):
        first = engine.throw_of(cylinder) + 1
        gap = shortest_turn_deg(engine.even_angle_deg(cylinder) - engine.even_angle_deg(first))
        if abs(gap) > 1e-6:
            raise scene.invalid(
                "engine.firing_order",
                f"cannot be even: cylinders {first} and {cylinder} on one pin would need throws "
                f"{abs(gap):g} deg apart",
                f"Give {_PATH}.throw_angles_deg{splay}, or another order or bank angle.",
            )


def _check_balancer(scene: Scene, path: str, shaft: BalancerShaft, before: tuple[BalancerShaft, ...]) -> None:
    moment = shaft.balances == "moment"
    if moment and shaft.distance_mm is None:
        raise scene.invalid(f"{path}.distance_mm", "must be given where balances = 'moment'")
    if not moment and shaft.distance_mm is not None:
        raise scene.invalid(
            f"{path}.distance_mm",
            "a shaft that balances a force has one mass",
            "Leave it out, or give balances = 'moment'.",
        )
    if moment and shaft.z_mm is not None:
        raise scene.invalid(
            f"{path}.z_mm", "two opposite masses act alike wherever they are", "Leave it out."
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
