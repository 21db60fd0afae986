"""Extreme load states over the cycle, which of them become load cases, and why the others need none.

The optimiser minimises the compliance of a linear structure. Multiplying a case by a factor multiplies its
compliance by the square of it and leaves the best shape as it is, so a state whose loads are a multiple of
another's needs no case of its own.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.engine import Engine
from cranktopo.design.misfire import all_firing
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import Extreme, LoadAnalysis, analyse, at_extreme_speeds
from cranktopo.engine.forces import INERTIA_EFFECTS, near_share, rods_on_pins, rotating_forces
from cranktopo.engine.gas import STEP_DEG
from cranktopo.engine.kinematics import exact_motion, force_ratios
from cranktopo.engine.load_case import LOAD_TYPES, MAIN_KINDS, LoadCase, LoadKind


@dataclass(frozen=True)
class ExtremeState:
    """An extreme state of the throw's loads.

    Attributes:
        name: `max_radial`, `max_torque`, `min_torque`, `max_tangential` or `overspeed_inertia`.
        case: its loads, under the name of the load case that it would be.
        deg: crank angle from firing top dead centre; None when the scene gives only the value.
        unit: the scene does not tell its size.
        redundant: why it needs no load case of its own; empty when it is one.
    """

    name: str
    case: LoadCase
    deg: float | None = None
    unit: bool = False
    redundant: str = ""


def extreme_states(scene: Scene, enabled: frozenset[str]) -> tuple[ExtremeState, ...]:
    """Return the extreme states of a scene, those that become load cases in the order of their kinds.

    All cylinders fire, also where `engine.misfire` names some that do not.

    Args:
        enabled: names of the effects that are on; the inertia effects change the forces, without
            `centrifugal` the overspeed state acts on the pin alone, and with `torsional_vibration` the
            torques are those of the vibrating shaft, each at the speed where it is worst.
    """
    if scene.engine is None:
        why = "unit load: the scene has no engine"
        return tuple(_unit_state(kind.name, why) for kind in LOAD_TYPES.values() if kind.unit_load)
    scene = all_firing(scene)
    analysis, *others = [analyse(at, enabled) for at in at_extreme_speeds(scene, enabled)]
    high, low = _torques((analysis, *others))
    throws = "" if scene.shaft is None or scene.shaft.gives_stiffness else ", throws in closed form"
    states = [_radial(scene, analysis), _torque_state("max_torque", *high, throws), _tangential(analysis)]
    if low[1] is not None:
        states.append(_torque_state("min_torque", *low, throws))
    overspeed = _overspeed(scene, analysis, enabled)
    if _load(overspeed) or overspeed.case.speed_rpm:
        states.append(overspeed)
    return _mark_redundant(tuple(states), enabled)


def _unit_state(name: LoadKind, why: str) -> ExtremeState:
    kind = LOAD_TYPES[name]
    case = LoadCase.model_validate({"name": name, "kind": name, kind.load: kind.unit_load, "source": why})
    return ExtremeState(kind.state, case, unit=True)


def _radial(scene: Scene, analysis: LoadAnalysis) -> ExtremeState:
    given, cycle = analysis.engine.max_gas_force_N, analysis.cycle
    if given is not None:
        share, source = near_share(scene), "engine.max_gas_force_N"
        source += f", times {share:.3g} for the web nearer to its rod" if share != 1 else ""
        case = LoadCase(name="bending", kind="bending", radial_N=given * share, source=source)
        return ExtremeState("max_radial", case)
    if cycle is None:
        return _unit_state("bending", "unit load: neither engine.gas nor engine.max_gas_force_N is given")
    worst = cycle.largest("web_force_N")
    source = f"largest radial force on the web, at {_where(analysis, worst)}"
    case = LoadCase(name="bending", kind="bending", radial_N=worst.value, source=source)
    return ExtremeState("max_radial", case, worst.deg)


_Torque = tuple[LoadAnalysis, Extreme | None]
"""A torque and the analysis at its speed; None where the scene does not tell it."""


def _torques(analyses: Sequence[LoadAnalysis]) -> tuple[_Torque, _Torque]:
    """Largest and smallest torque ahead of or behind a throw, each at the speed where it is that."""
    engine, found = analyses[0].engine, [(one, one.cycle.section_torque()) for one in analyses if one.cycle]
    high: _Torque = (analyses[0], None)
    low = high
    if found:
        at_high, at_low = max(found, key=lambda f: f[1][0].value), min(found, key=lambda f: f[1][1].value)
        high, low = (at_high[0], at_high[1][0]), (at_low[0], at_low[1][1])
    if engine.max_torque_Nm is not None:
        high = analyses[0], Extreme(engine.max_torque_Nm, None)
    if engine.min_torque_Nm is not None:
        low = analyses[0], Extreme(engine.min_torque_Nm, None)
    return high, low


def _torque_state(name: str, analysis: LoadAnalysis, torque: Extreme | None, throws: str) -> ExtremeState:
    """Return an extreme of the torque; `throws` tells where the stiffness of a vibrating shaft is from."""
    if torque is None:
        return _unit_state("torsion", "unit load: neither engine.gas nor engine.max_torque_Nm is given")
    which = "largest" if name == "max_torque" else "smallest"
    vibrates = analysis.cycle is not None and analysis.cycle.torque.vibrates
    section = f"{torque.place} of the vibrating shaft{throws}" if vibrates else "behind a throw"
    source = f"{which} torque {section}, at {_where(analysis, replace(torque, place=''))}"
    if torque.deg is None:
        source = f"engine.{name}_Nm"
    case = LoadCase(name="torsion", kind="torsion", torque_Nm=torque.value, source=source)
    return ExtremeState(name, case, torque.deg)


def _tangential(analysis: LoadAnalysis) -> ExtremeState:
    cycle, given = analysis.cycle, analysis.engine.max_torque_Nm
    if cycle is not None:
        worst = cycle.largest("tangential_force_N")
        source = f"largest tangential force, at {_where(analysis, worst)}"
    elif given is not None:
        worst = Extreme(given * NMM_PER_NM / analysis.radius_mm, None)
        source = "engine.max_torque_Nm over the throw radius"
    else:
        return _unit_state("tangential", "unit load: neither engine.gas nor engine.max_torque_Nm is given")
    case = LoadCase(name="tangential", kind="tangential", tangential_N=worst.value, source=source)
    return ExtremeState("max_tangential", case, worst.deg)


def _overspeed(scene: Scene, analysis: LoadAnalysis, enabled: frozenset[str]) -> ExtremeState:
    """Inertia alone at the highest speed: the rods pull the pin outward, one alone at top dead centre."""
    engine = analysis.engine
    speed = max(engine.overspeed_rpm or 0.0, engine.speed_rpm)
    rotating = rotating_forces(engine, analysis.balance, analysis.radius_mm, speed)
    kg, deg = _pulling_kg(scene, engine, enabled)
    source = f"inertia of piston and rod at top dead centre without gas force, {speed:g} rpm"
    if engine.rods_per_pin > 1:
        source = f"inertia of both pistons and rods of a pin without gas force, {speed:g} rpm"
    pull = -kg * rotating.r_w2_m_s2 + 0.0
    case = LoadCase(name="bending", kind="bending", radial_N=pull, source=source)
    if "centrifugal" in enabled:
        way = "inward" if rotating.throw_N < 0 else "outward"
        source += f", with {abs(rotating.throw_N):.0f} N of the throw itself {way}"
        case = LoadCase(name="centrifugal", kind="centrifugal", radial_N=pull, speed_rpm=speed, source=source)
    return ExtremeState("overspeed_inertia", case, deg % 360.0 + (360.0 if engine.strokes == 4 else 0.0))


def _pulling_kg(scene: Scene, engine: Engine, enabled: frozenset[str]) -> tuple[float, float]:
    """Mass on the pin that would pull as much as rods and pistons at their worst, and the crank angle."""
    angle = np.arange(0.0, engine.cycle_deg, STEP_DEG)
    radius, length = scene.throw.radius_mm, engine.rod_length_mm
    one = np.full_like(angle, engine.rod_rotating_kg * ("rotating_rod_mass" in enabled))
    if "reciprocating_inertia" in enabled:
        moving = exact_motion(np.radians(angle), radius, length).acceleration_ratio
        one += engine.reciprocating_kg * moving * force_ratios(np.radians(angle), radius, length).radial
    curves = [rods.superpose(one, angle, engine.cycle_deg) for rods in rods_on_pins(scene, engine)]
    curve = max(curves, key=lambda kg: float(kg.max()))
    return float(curve.max()), float(angle[int(curve.argmax())])


def _mark_redundant(states: tuple[ExtremeState, ...], enabled: frozenset[str]) -> tuple[ExtremeState, ...]:
    """Keep the largest state of each kind as the load case; the others are multiples of it."""
    marked = []
    for state in states:
        rival = max((s for s in states if s.case.kind == state.case.kind), key=lambda s: abs(_load(s)))
        if rival is not state:
            factor = _load(state) / _load(rival) if _load(rival) else 0.0
            why = (
                f"{factor:+z.3f} times {rival.name}: a linear structure has the same best shape, and "
                f"{100 * factor**2:.1f} % of its compliance"
            )
            state = replace(state, redundant=why)
        marked.append(state)
    order = list(LOAD_TYPES)
    return tuple(sorted(marked, key=lambda s: (bool(s.redundant), order.index(s.case.kind))))


def _load(state: ExtremeState) -> float:
    case = state.case
    return case.radial_N or case.torque_Nm or case.tangential_N


def _where(analysis: LoadAnalysis, extreme: Extreme) -> str:
    if extreme.deg is None:
        return ""
    place = f", {extreme.place}" if extreme.place else ""
    return f"{extreme.deg:g} deg, {analysis.engine.speed_rpm:g} rpm{place}"


__all__ = ["DEFAULT_EFFECTS", "LoadCase", "LoadKind", "load_cases"]

DEFAULT_EFFECTS = INERTIA_EFFECTS | set(MAIN_KINDS)


def load_cases(scene: DesignLike, enabled: frozenset[str] | None = None) -> tuple[LoadCase, ...]:
    """Return the load cases of a scene, one per kind that is enabled, in the order of `LOAD_TYPES`.

    Args:
        scene: the scene; without an engine the cases carry unit loads (1000 N, 1 N m).
        enabled: names of the effects that are on; bending, torsion and the inertia of piston and rod when
            not given.

    Raises:
        CranktopoError: gas data that cannot be used.
    """
    scene = as_scene(scene)
    effects = DEFAULT_EFFECTS if enabled is None else enabled
    states = extreme_states(scene, effects)
    return tuple(state.case for state in states if not state.redundant and state.case.kind in effects)
