"""The live answer to a drag: what is exact at once; a pure function of the tables."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np

from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.checks.engine import shaft_warnings
from cranktopo.design.clearance import clearances_mm
from cranktopo.design.halves import halves
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.histories import load_history
from cranktopo.engine.performance import mean_pressure_MPa, power_kW, pressure_warnings
from cranktopo.engine.plan.planning import left_off, plan_for_stress
from cranktopo.engine.throw_compliance import throw_stiffness_Nm_per_rad, web_lever_mm
from cranktopo.engine.vibration.disk_error import FEW_THROWS_ERROR, few_throws
from cranktopo.engine.vibration.shaft_chain import estimated_chain
from cranktopo.tasks.bench.bearing_forces import largest_bearing_force_N, polars
from cranktopo.tasks.bench.engine_loads import EngineLoads
from cranktopo.tasks.bench.engine_plots import line_plots, live_plots
from cranktopo.tasks.fatigue import lsa
from cranktopo.tasks.shaft.stage import of_stiffness
from cranktopo.tasks.throw_fatigue.m53 import (
    LEAST_FACTOR,
    concentration_factors,
    dimensions,
    nominal_stresses,
    outside_validity,
)
from cranktopo.tasks.throw_fatigue.m53_material import process_remark, uncovered_material
from cranktopo.tasks.throw_fatigue.needs import load_kinds
from cranktopo.tasks.throw_fatigue.rule_fillets import fillet_checks

_CLOSED_FORM = "live, closed-form stiffness: up to 20 % too low"
"""Throws by elements are 1.0 to 1.56 times as stiff as in closed form, on the engines that were measured."""
_OF_FEW_THROWS = f"; disks of so few throws: {FEW_THROWS_ERROR}"
_AS_SETTLED = "live, stiffness of a throw as it settled last"
_WAITS = "waits: the torque of the vibrating shaft takes seconds"
RULE = ("m53_pin", "m53_journal")
_GAS_GAUGES = ("gas_force", "pin_force", "bearing_force", "mean_torque", "mean_pressure", "power")
_Part = Callable[[EngineLoads], Iterator[tuple[str, float]]]
_BROKEN = re.compile(r"(?:^|(?<=[\s:]))((?:[a-z_]\w*(?:\[\d+\])*\.)*[a-z_]\w*(?:\[\d+\])*) = ")


def live_numbers(data: dict[str, Any], stiffness_factors: Sequence[float] = ()) -> dict[str, Any]:
    """Return what is known of a design at once, what it rests on, and warnings; or what is broken, by key.

    Args:
        data: tables of the design, file names absolute.
        stiffness_factors: of each throw, elements over closed form, at a web that has settled.
    """
    return of_sound(data, lambda scene: gauge_numbers(scene, stiffness_factors))


def gauge_numbers(scene: Scene, stiffness_factors: Sequence[float] = ()) -> dict[str, Any]:
    """Return gauges, what those rest on that are not exact, marks of the rule, notes and warnings.

    What needs the torque of a vibrating shaft waits until the web has settled: it takes seconds.
    """
    soft, waiting = rests_on_stiffness(scene), RULE if may_vibrate(scene) else ()
    corrected = with_stiffness(scene, stiffness_factors) if soft and stiffness_factors else scene
    loads = EngineLoads(corrected)
    gauges = _values(loads, _QUICK if waiting else _PARTS)
    resting = ["natural_frequency"] if soft and "natural_frequency" in gauges else []
    words = _AS_SETTLED if stiffness_factors else _CLOSED_FORM
    rings = {**_of_gas(scene), **dict.fromkeys(resting, words), **dict.fromkeys(waiting, _WAITS)}
    if "natural_frequency" in gauges and few_throws(scene):
        rings["natural_frequency"] = f"{rings.get('natural_frequency', 'live')}{_OF_FEW_THROWS}"
    return {
        "gauges": gauges,
        "rings": rings,
        "of_stiffness": resting,
        "stiffness": "" if not resting else "settled" if stiffness_factors else "closed form",
        "waiting": list(waiting),
        "strengths_MPa": fillet_strengths_MPa(scene),
        "marks": {name: LEAST_FACTOR for name in RULE if name in gauges or name in waiting},
        "polars": _unless_refused(polars, loads),
        "plots": [*_unless_refused(live_plots, loads), *_unless_refused(line_plots, loads)],
        "notes": notes(scene),
        "warnings": [*quick_warnings(scene), *(() if waiting else load_warnings(scene))],
    }


def may_vibrate(scene: Scene) -> bool:
    """Tell whether a design has a shaft line, whose vibration the plan then judges."""
    return scene.shaft is not None and scene.engine is not None


def rests_on_stiffness(scene: Scene) -> bool:
    """Tell whether the first natural frequency is that of throws whose stiffness the design does not give."""
    return may_vibrate(scene) and scene.shaft is not None and not scene.shaft.gives_stiffness


def with_stiffness(scene: Scene, factors: Sequence[float]) -> Scene:
    """Return the scene whose throws are stiffer than in closed form, each by its factor.

    A throw that has been added since has the mean of all.
    """
    count = len(scene.shaft_angles_deg)
    each = factors if len(factors) == count else [sum(factors) / len(factors)] * count
    return of_stiffness(scene, [factor * throw_stiffness_Nm_per_rad(scene) for factor in each])


def _of_gas(scene: Scene) -> dict[str, str]:
    """Tell what the gauges rest on that follow from the cylinder pressure."""
    gas = scene.engine.gas if scene.engine else None
    if gas is None:
        return {}
    words = "measured trace" if gas.indicator_csv else "map over speed" if gas.map else "combustion model"
    return dict.fromkeys(_GAS_GAUGES, f"live, {words}")


def of_sound(data: dict[str, Any], answer: Callable[[Scene], dict[str, Any]]) -> dict[str, Any]:
    """Return the answer for a design, or what of it is broken, by key."""
    try:
        return answer(scene_from_dict(data, "design", whole=True))
    except CranktopoError as error:
        return {"broken": violated_rules(error)}


def violated_rules_of(data: dict[str, Any]) -> list[dict[str, str]]:
    """Return the rules that the tables of a design break."""
    try:
        scene_from_dict(data, "design", whole=True)
    except CranktopoError as error:
        return violated_rules(error)
    return []


def violated_rules(error: CranktopoError) -> list[dict[str, str]]:
    """Return each line of a refusal with the key that it names."""
    lines = [line.strip() for line in str(error).splitlines()]
    lines = lines[1:] if len(lines) > 1 else lines
    return [{"key": (found[1] if (found := _BROKEN.search(line)) else ""), "message": line} for line in lines]


def exact_values(scene: Scene) -> dict[str, float]:
    """Return every quantity of a design that is known in closed form, by the name of its gauge."""
    return _values(EngineLoads(scene), _PARTS)


def rule_values(scene: Scene) -> dict[str, float]:
    """Return the acceptability of both fillets by the rule's polynomials; nothing where it cannot judge."""
    return dict(_parts(EngineLoads(scene), (_rule,)))


def first_frequency(scene: Scene) -> dict[str, float]:
    """Return the first natural frequency of a shaft line by its gauge."""
    return dict(_parts(EngineLoads(scene), (_vibration,)))


def _values(loads: EngineLoads, parts: Sequence[_Part]) -> dict[str, float]:
    balance = throw_balance(loads.scene)
    found = {
        "mass": balance.mass_kg,
        "inertia": balance.inertia_kg_mm2,
        "unbalance": balance.throw_unbalance_kg_mm,
    }
    if balance.balance_factor_percent is not None:
        found["balance_factor"] = balance.balance_factor_percent
    return found | dict(_parts(loads, parts))


def _parts(loads: EngineLoads, parts: Sequence[_Part]) -> Iterator[tuple[str, float]]:
    for part in parts:
        try:
            yield from dict(part(loads)).items()
        except CranktopoError:
            continue  # what the design does not say yet has no gauge


def _room(loads: EngineLoads) -> Iterator[tuple[str, float]]:
    for name, gap in clearances_mm(loads.scene).items():
        yield ("piston_gap" if "piston" in name else "crankcase_gap"), gap


def _loads(loads: EngineLoads) -> Iterator[tuple[str, float]]:
    if loads.scene.engine is None:
        return
    found = loads.analysis
    if found.cycle is None:
        return
    radius, work = loads.scene.throw.radius_mm, found.cycle.indicated_work_J
    yield "gas_force", found.cycle.extreme("gas_force_N")[0].value
    yield "pin_force", found.cycle.extreme("rod_force_N")[0].value
    yield "mean_torque", found.cycle.engine_torque()[0]
    yield "mean_pressure", 10 * mean_pressure_MPa(work, found.engine, radius)
    yield "power", power_kW(found.cycle.mean_work_J, found.engine)


def _rule(loads: EngineLoads) -> Iterator[tuple[str, float]]:
    """Yield the acceptability factors of both fillets by the rule's polynomials, the worse web's."""
    scene = loads.scene
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


def fillet_strengths_MPa(scene: Scene) -> dict[str, float]:
    """Return the strength of a point of each fillet, by the rule's gauge; nothing without a material for it.

    The stress gradient is that of a notch, 2 over its radius: the smaller a fillet, the more it supports.
    """
    if any(getattr(scene.material, key) is None for key in lsa.NEEDS):
        return {}
    radii = scene.throw.crankpin.fillet_mm, scene.throw.main_journal.fillet_mm
    if not all(radii):
        return {}
    points, _, _ = lsa.point_strength_MPa(2 / np.array(radii), lsa.lsa_strength(scene))
    return dict(zip(RULE, points.tolist(), strict=True))


def _vibration(loads: EngineLoads) -> Iterator[tuple[str, float]]:
    scene = loads.scene
    if scene.shaft is None or scene.engine is None:
        return
    elastic = [f for f in estimated_chain(scene).chain.natural_frequencies_Hz() if f > 1e-3]
    if elastic:
        yield "natural_frequency", elastic[0]


def _bearings(loads: EngineLoads) -> Iterator[tuple[str, float]]:
    if loads.turns and loads.scene.engine is not None and loads.scene.engine.gas is not None:
        yield "bearing_force", largest_bearing_force_N(loads)


_QUICK: Sequence[_Part] = (_room, _loads, _bearings, _vibration)
_PARTS = (*_QUICK, _rule)


def _unless_refused(
    found: Callable[[EngineLoads], list[dict[str, Any]]], loads: EngineLoads
) -> list[dict[str, Any]]:
    try:
        return found(loads)
    except CranktopoError:
        return []  # loads that cannot be used are told as a warning


def notes(scene: Scene) -> list[str]:
    """Return what limits the closed forms: ratios and material outside the rule, throws that differ."""
    found = [f"IACS UR M53, polynomials: {line}" for line in outside_validity(dimensions(scene))]
    rule_remarks = uncovered_material(scene), process_remark(scene)
    found += [f"IACS UR M53: {line}." for line in rule_remarks if line]
    if scene.crank is not None and not scene.crank.uniform:
        found.append("The throws of the crank differ: gauges and pictures are of the throw in this file.")
    return found


def quick_warnings(scene: Scene) -> list[str]:
    """Return what `loads` and `vibration` warn of at once."""
    try:
        return [*pressure_warnings(scene), *(shaft_warnings(scene) if scene.shaft else ())]
    except CranktopoError as error:
        return [str(error)]


def load_warnings(scene: Scene) -> list[str]:
    """Return what `plan` leaves out although it is above the threshold; it solves a vibrating shaft."""
    try:
        missing = left_off(scene, plan_for_stress(scene))
    except CranktopoError as error:
        return [str(error)]
    return [missing] if missing else []
