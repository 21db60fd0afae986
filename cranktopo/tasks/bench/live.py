"""The live answer to a drag: what is exact at once, and the picture; a pure function of the tables."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.base.frames import about_z_deg
from cranktopo.base.units import NMM_PER_NM
from cranktopo.bodies.shown_solid import shown_half
from cranktopo.design.clearance import clearances_mm
from cranktopo.design.halves import halves
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.histories import load_history
from cranktopo.engine.performance import mean_pressure_MPa, power_kW
from cranktopo.engine.throw_compliance import web_lever_mm
from cranktopo.engine.vibration.shaft_chain import estimated_chain
from cranktopo.report.shading import SHARP_DEGREES, web_sides_mm
from cranktopo.report.viewer.scene3d import PARTNERS, Arrays, scaled
from cranktopo.tasks.bench.front_view import front_view
from cranktopo.tasks.fatigue.m53 import concentration_factors, dimensions, nominal_stresses, outside_validity
from cranktopo.tasks.fatigue.rule_check import fillet_checks
from cranktopo.tasks.fatigue.safety_field import load_kinds

_BROKEN = re.compile(r"(?:^|(?<=[\s:]))((?:[a-z_]\w*(?:\[\d+\])*\.)*[a-z_]\w*(?:\[\d+\])*) = ")


def live_numbers(data: dict[str, Any]) -> dict[str, Any]:
    """Return what is known of a design in closed form, or what of it is broken, by key.

    Args:
        data: tables of the design, file names absolute.
    """
    return _of_sound(data, lambda scene: {"gauges": exact_values(scene), "notes": notes(scene)})


def live_picture(data: dict[str, Any]) -> dict[str, Any]:
    """Return the solid and the front view of a design, or what of it is broken."""
    return _of_sound(
        data,
        lambda scene: {
            "picture": _picture(scene),
            "front": front_view(scene),
            "turns_deg": _turns_deg(scene),
        },
    )


def _of_sound(data: dict[str, Any], answer: Callable[[Scene], dict[str, Any]]) -> dict[str, Any]:
    try:
        return answer(scene_from_dict(data, "design", whole=True))
    except CranktopoError as error:
        return {"broken": broken_rules(error)}


def broken_rules_of(data: dict[str, Any]) -> list[dict[str, str]]:
    """Return the rules that the tables of a design break."""
    try:
        scene_from_dict(data, "design", whole=True)
    except CranktopoError as error:
        return broken_rules(error)
    return []


def broken_rules(error: CranktopoError) -> list[dict[str, str]]:
    """Return each line of a refusal with the key that it names."""
    lines = [line.strip() for line in str(error).splitlines()]
    lines = lines[1:] if len(lines) > 1 else lines
    return [{"key": (found[1] if (found := _BROKEN.search(line)) else ""), "message": line} for line in lines]


def _picture(scene: Scene) -> str:
    """Return both half throws, or the one where they are alike, for the 3D view."""
    pair, arrays = halves(scene), Arrays()
    alike = pair[0] is pair[1]
    bodies = [
        _shown(arrays, half, partner)
        for half, partner in zip(pair[:1] if alike else pair, PARTNERS[1 if alike else 2], strict=True)
    ]
    return arrays.packed_with({"bodies": bodies, "first": 0, "stress": None, "steps": None}, quick=True)


def _shown(arrays: Arrays, half: Scene, partner: int) -> dict[str, Any]:
    mesh = shown_half(half).calculate_normals(0, SHARP_DEGREES).to_mesh64(0)
    table, faces = np.asarray(mesh.vert_properties), np.asarray(mesh.tri_verts)
    low, high = table[:, :3].min(axis=0), table[:, :3].max(axis=0)
    return {
        "name": half.name,
        "half_pitch_mm": half.pitch_mm / 2,
        "partner": partner,
        "low_mm": low.tolist(),
        "size_mm": (high - low).tolist(),
        "sides_mm": web_sides_mm(half.web_z_mm),
        "positions": arrays.add(scaled((table[:, :3] - low) / (high - low), 65535, np.uint16)),
        "normals": arrays.add(scaled(table[:, 3:6], 127, np.int8)),
        "journal": arrays.add(np.zeros(len(table), np.uint8)),
        "faces": arrays.add(faces.astype(np.uint32)),
        "stress": [],
    }


def _turns_deg(scene: Scene) -> list[float]:
    """Return the angle of every throw about z, deg; one throw where there is no engine."""
    return [about_z_deg(angle) for angle in scene.shaft_angles_deg] if scene.engine else [0.0]


def exact_values(scene: Scene) -> dict[str, float]:
    """Return every quantity of a design that is known in closed form, by the name of its gauge."""
    balance = throw_balance(scene)
    found = {
        "mass": balance.mass_kg,
        "inertia": balance.inertia_kg_mm2,
        "unbalance": balance.throw_unbalance_kg_mm,
    }
    if balance.balance_factor_percent is not None:
        found["balance_factor"] = balance.balance_factor_percent
    for part in (_room, _loads, _rule, _vibration):
        try:
            found |= dict(part(scene))
        except CranktopoError:
            continue  # what the design does not say yet has no gauge
    return found


def _room(scene: Scene) -> Iterator[tuple[str, float]]:
    for name, gap in clearances_mm(scene).items():
        yield ("piston_gap" if "piston" in name else "crankcase_gap"), gap


def _loads(scene: Scene) -> Iterator[tuple[str, float]]:
    if scene.engine is None:
        return
    found = analyse(scene)
    if found.cycle is None:
        return
    radius, work = scene.throw.radius_mm, found.cycle.indicated_work_J
    yield "gas_force", found.cycle.extreme("gas_force_N")[0].value
    yield "pin_force", found.cycle.extreme("rod_force_N")[0].value
    yield "mean_torque", found.cycle.engine_torque()[0]
    yield "mean_pressure", 10 * mean_pressure_MPa(work, found.engine, radius)
    yield "power", power_kW(found.cycle.mean_work_J, found.engine)


def _rule(scene: Scene) -> Iterator[tuple[str, float]]:
    """Yield the acceptability factors of both fillets by the rule's polynomials, the worse web's."""
    if scene.material.ultimate_MPa is None or not all(j.fillet_mm for j, _ in scene.throw.journals):
        return
    history = load_history(scene, "extremes", load_kinds(scene, "extremes")[0])
    force, torque = float(np.ptp(history.radial_N)) / 2, float(np.ptp(history.torque_Nm)) / 2
    near, far = halves(scene)
    checks = []
    for half, share in ((near, far.pitch_mm), (far, near.pitch_mm)):
        share /= near.pitch_mm + far.pitch_mm
        size, moment = dimensions(half), force * share * web_lever_mm(half)
        nominal = nominal_stresses(size, moment, force * share, torque * NMM_PER_NM)
        checks.append(fillet_checks(half, size, concentration_factors(size), nominal))
    for fillet in ("pin", "journal"):
        yield f"m53_{fillet}", min(check[fillet].acceptability for check in checks)


def _vibration(scene: Scene) -> Iterator[tuple[str, float]]:
    if scene.shaft is None or scene.engine is None:
        return
    elastic = [f for f in estimated_chain(scene).chain.natural_frequencies_Hz() if f > 1e-3]
    if elastic:
        yield "natural_frequency", elastic[0]


def notes(scene: Scene) -> list[str]:
    """Return what limits the closed forms: ratios outside the validity of the rule's polynomials."""
    return [f"IACS UR M53, polynomials: {line}" for line in outside_validity(dimensions(scene))]
