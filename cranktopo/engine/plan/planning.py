"""The plan: each effect on or off, by the scene's own choice or by its estimate against the threshold."""

from __future__ import annotations

from collections.abc import Callable, Collection, Sequence
from dataclasses import replace
from functools import lru_cache, partial

from cranktopo.base.errors import CranktopoError, invalid
from cranktopo.base.notes import note
from cranktopo.design.goal.limit import Goal
from cranktopo.design.halves import envelope_asymmetry, may_mirror, web_asymmetry
from cranktopo.design.load_kinds import LOAD_KINDS
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.schema import Effects, Scene
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.gas import FileState, file_state, trace_states
from cranktopo.engine.load_type import load_types
from cranktopo.engine.plan.context import PlanningContext
from cranktopo.engine.plan.cost import Costing, CostRates
from cranktopo.engine.plan.effect import Effect, Estimate, PhysicsPlan, Switch
from cranktopo.engine.plan.load_rules import PlannedLoadType, quasi_static
from cranktopo.engine.plan.rules import (
    bearing_compliance,
    bores,
    bound,
    check_goal_cases,
    fatigue,
    fillets,
    lateral_symmetry,
    manufacturing_constraint,
    reciprocating_inertia,
    rotating_rod_mass,
    whole_throw,
)
from cranktopo.engine.plan.shaft_rule import continuous_shaft
from cranktopo.engine.plan.simulated import APPLIED, FEATURES, Feature, apply_physics_plan, strip_features
from cranktopo.engine.plan.vibration_rule import torsional_vibration

_Rule = Callable[[PlanningContext], Estimate]


def _of_loads(by_mass: bool) -> dict[str, _Rule]:
    """Return the rules of the load cases, by a method of their own or by their strain energy."""
    return {
        load.name: load.estimate if isinstance(load, PlannedLoadType) else partial(quasi_static, load)
        for load in load_types()
        if LOAD_KINDS[load.name].by_mass == by_mass
    }


_RULES: dict[str, _Rule] = {
    **_of_loads(by_mass=False),
    "reciprocating_inertia": reciprocating_inertia,
    "rotating_rod_mass": rotating_rod_mass,
    **_of_loads(by_mass=True),
    "torsional_vibration": torsional_vibration,
    "bearing_compliance": bearing_compliance,
    "continuous_shaft": continuous_shaft,
    "fillets": fillets,
    "bores": bores,
    "lateral_symmetry": lateral_symmetry,
    "manufacturing_constraint": manufacturing_constraint,
    "fatigue": fatigue,
    "bound": bound,
}
_VIBRATION = "torsional_vibration"
"""It comes first: the loads that the other rules look at depend on it."""
_CENTRIFUGAL = "centrifugal"
"""Next: where it is on, the pull at the highest speed is its case, and the others are compared without it."""
_LOADS = {*LOAD_KINDS, *INERTIA_EFFECTS, _VIBRATION, "continuous_shaft"}


def plan(scene: DesignLike, rates: CostRates | None = None, goal: Goal | None = None) -> PhysicsPlan:
    """Decide every effect of a scene, once for all stages that ask for it.

    Args:
        goal: what an optimisation is asked for, from `goal_of`: it takes the load cases that goal and limits
            are read off and no others. None, as for an evaluation, lets every case count that is large.

    Raises:
        CranktopoError: the scene switches an effect on that it has no data for, switches off one that it or
            the goal relies on, or leaves no load case; gas data that cannot be used.
    """
    scene = as_scene(scene)
    return _plan(scene, rates or CostRates(), goal, _file_states(scene))


def plan_for_stress(scene: Scene) -> PhysicsPlan:
    """Decide every effect for stress and fatigue, where a load counts by its size.

    The weights of the optimiser's objective say nothing about stress: a load of weight 0 acts all the same.
    The centrifugal load counts by the stress that the throw's own pull adds, of which energy is the square.
    """
    weighted = scene.with_optimise(weights=dict.fromkeys(LOAD_KINDS, 1.0))
    return _plan(weighted, CostRates(), None, _file_states(scene), for_stress=True)


def left_off(scene: Scene, effects: PhysicsPlan, among: Collection[str] = frozenset(_LOADS)) -> str:
    """Name the loads that are off although they are above the scene's threshold; empty where none is.

    Args:
        among: the loads that count only where the plan has them on.
    """
    threshold = 100 * scene.effects.threshold
    off = [
        f"{effect.name} {effect.estimate_percent:.3g} % ({effect.reason.split('; ')[0]})"
        for effect in effects.effects
        if effect.name in among and effect.state == "off" and (effect.estimate_percent or 0.0) >= threshold
    ]
    return f"left out although above the threshold of {threshold:g} %: {', '.join(off)}" if off else ""


def stress_left_off(scene: Scene) -> str:
    """Name what `left_off` does of stress and fatigue of a throw that stands alone."""
    return left_off(scene, plan_for_stress(scene))


def note_left_off(name: str, missing: str | None) -> None:
    """Tell in a line under this name what `left_off` names, if anything."""
    if missing:
        note(f"{name}: {missing}")


def _file_states(scene: Scene) -> tuple[FileState, ...]:
    """Return the states of the files that a scene names: with another content it has another plan."""
    envelope = scene.envelope.stl_file if scene.envelope else None
    zones = (*scene.envelope.frozen, *scene.envelope.removable) if scene.envelope else ()
    bodies = (zone.body_file for zone in zones)
    named = tuple(file_state(name) for name in (envelope, *bodies) if name is not None)
    return named + trace_states(scene)


@lru_cache(maxsize=64)
def _plan(
    scene: Scene,
    rates: CostRates,
    goal: Goal | None,
    _files: tuple[FileState, ...],
    *,
    for_stress: bool = False,
) -> PhysicsPlan:
    context = replace(_context(scene, rates, goal), for_stress=for_stress)
    vibration = _decide(scene.effects, _VIBRATION, _RULES[_VIBRATION](context))
    context = replace(context, vibrating=vibration.state == "on")
    pull = _decide(scene.effects, _CENTRIFUGAL, _RULES[_CENTRIFUGAL](context))
    context = replace(context, centrifugal=pull.state == "on")
    decided = tuple(
        vibration if name == _VIBRATION else _decide(scene.effects, name, rule(context))
        for name, rule in _RULES.items()
    )
    decided += whole_throw(context)
    cases = [effect.name for effect in decided if effect.state == "on" and effect.name in LOAD_KINDS]
    if goal is None:
        _check_cases(scene, cases)
    else:
        check_goal_cases(context, goal, cases)
    return PhysicsPlan(tuple(_for_all_cases(effect, len(cases)) for effect in decided))


def _context(scene: Scene, rates: CostRates, goal: Goal | None) -> PlanningContext:
    asymmetry = web_asymmetry(scene) or envelope_asymmetry(scene)
    return PlanningContext(scene, Costing(scene, rates, may_mirror(scene, asymmetry)), asymmetry, goal)


def has_vibration(scene: Scene) -> bool:
    """Tell whether the plan has torsional vibration on, without deciding the other effects.

    Raises:
        CranktopoError: as `plan`, of this effect.
    """
    estimate = _RULES[_VIBRATION](_context(scene, CostRates(), None))
    return _decide(scene.effects, _VIBRATION, estimate).state == "on"


def _check_cases(scene: Scene, cases: Sequence[str]) -> None:
    """At least one load case is on and counts: the objective is divided by the sum of their weights."""
    weights = scene.optimise.weights.model_dump()
    if any(weights[name] > 0 for name in cases):
        return
    if not any(weights.values()) or cases:
        raise invalid(
            "optimise.weights",
            {name: weights[name] for name in cases or LOAD_KINDS},
            "at least one load case that is on must have a weight above 0",
            "Raise a weight, or set effects of a case that has one to 'on'.",
        )
    raise CranktopoError(
        "effects: no load case is on.", hint=f"Set one of {', '.join(LOAD_KINDS)} to 'on' or 'auto'."
    )


def planned_scene(scene: Scene, kept: Collection[Feature] = ()) -> Scene:
    """Return the scene as its own effects plan has it simulated, features that are `kept` left in anyway."""
    return apply_physics_plan(scene, plan(scene), kept)


def with_own_reasons(effects: PhysicsPlan, design: Scene | None) -> PhysicsPlan:
    """Return the plan of a planned scene with the reasons of the design that this was made of.

    What the plan took out or switched looks like the design's own choice in the planned scene: "no bore in
    the scene", "set on in the scene".

    Args:
        design: before its plan was applied; None where it is not known, for the plan as it is.
    """
    own = {} if design is None else {one.name: one for one in plan(design).effects if one.name in APPLIED}
    return PhysicsPlan(
        tuple(
            own[one.name] if one.name in own and own[one.name].state == one.state else one
            for one in effects.effects
        )
    )


def left_out_features(scene: Scene, kept: Collection[Feature] = ()) -> str:
    """Return the features that its plan takes out of a scene's body, and why; empty where none is."""
    reasons = {effect.name: effect.reason for effect in plan(scene).effects if effect.state == "off"}
    gone = [name for name in FEATURES if name in reasons and name not in kept]
    return "; ".join(
        f"meshed without {name}: {reasons[name]}; effects.{name} = 'on' keeps them"
        for name in gone
        if strip_features(scene, name) is not scene
    )


def _for_all_cases(effect: Effect, cases: int) -> Effect:
    """The mirror saves cells in the solve of every load case."""
    if effect.name != "lateral_symmetry":
        return effect
    cost = effect.cost.model_copy(update={"seconds": effect.cost.seconds * cases})
    return effect.model_copy(update={"cost": cost})


def _decide(effects: Effects, name: str, estimate: Estimate) -> Effect:
    choice, threshold = getattr(effects, name), 100 * effects.threshold
    if choice == "on" and estimate.impossible:
        raise invalid(f"effects.{name}", choice, estimate.impossible, "Set it to 'auto' or 'off'.")
    if choice == "off" and estimate.indispensable:
        raise invalid(f"effects.{name}", choice, estimate.indispensable, "Set it to 'auto' or 'on'.")
    state: Switch
    if choice != "auto":
        state, reason = choice, _joined(f"set {choice} in the scene", estimate.because)
    elif estimate.absent:
        state, reason = "off", _joined(estimate.absent, estimate.because)
    elif estimate.needed:
        state, reason = "on", _joined(*dict.fromkeys((estimate.needed, estimate.because)))
    else:
        above = estimate.percent is not None and estimate.percent >= threshold
        state = "on" if above else "off"
        word = "above" if above else "below"
        reason = f"{estimate.because}, {word} the threshold of {threshold:g} %"
    return Effect(
        name=name,
        state=state,
        reason=reason,
        estimate_percent=estimate.percent,
        cost=estimate.cost,
        changes=estimate.changes,
    )


def _joined(*parts: str) -> str:
    return "; ".join(part for part in parts if part)
