"""Safety of every part of every web of a shaft whose stresses are known, at some speeds."""

from __future__ import annotations

import time
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.notes import note
from cranktopo.design.assumed import filter_by_table
from cranktopo.design.crank_throws import carried
from cranktopo.engine.analysis import at_speed, engine_of
from cranktopo.engine.histories import WebHistory
from cranktopo.numerics.tetrahedra.solver import RESIDUAL_LIMIT
from cranktopo.tasks.dynamics.stage import DynamicShaft
from cranktopo.tasks.dynamics.stress import moving_factors
from cranktopo.tasks.fatigue.criteria import check_method, criterion
from cranktopo.tasks.fatigue.taken_keys import assumed_by
from cranktopo.tasks.shaft.assembly import Bearings, ShaftBearings
from cranktopo.tasks.shaft.cycle import loads_on_bearings_N
from cranktopo.tasks.shaft.on_film import Support
from cranktopo.tasks.shaft.result import ShaftEvaluation
from cranktopo.tasks.shaft.stage import (
    evaluate_shaft,
    not_on_bearings,
    of_stiffness,
    shaft_left_off,
    speed_scenes,
    stands_on_bearings,
    support_of,
    throw_targets,
    with_stiffness_of,
)
from cranktopo.tasks.shaft.web_loads import web_histories
from cranktopo.tasks.shaft_safety.plots import BearingPolar
from cranktopo.tasks.shaft_safety.result import (
    SafetySeconds,
    ShaftSafety,
    SpeedSafety,
    StressOverCycle,
    WebSafety,
    WorstPlace,
)
from cranktopo.tasks.shaft_safety.worst_stress import stress_over_cycle
from cranktopo.tasks.throw_fatigue.least import PARTS, Part, least_safeties
from cranktopo.tasks.throw_fatigue.mesh_quality import JudgedQuality
from cranktopo.tasks.throw_fatigue.remarks import (
    cut_outlet_words,
    mesh_shortfall,
    note_quality,
    note_yielding,
)
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField, field_of_states
from cranktopo.tasks.throw_fatigue.shaft_stress import (
    ShaftStress,
    SolvedCycle,
    factors_of,
    solve_shaft_stress,
    solved_cycle,
)
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION, check_fillets
from cranktopo.tasks.throw_fea.targets import USED, Target

_RESIDUAL = 1e-4
"""Accepted where safeties alone are asked for; solves aim at a hundredth, which changes these by 1e-7."""


def judged_shaft(
    target: Target,
    bearings: ShaftBearings,
    method: str,
    speeds_rpm: Sequence[float] = (),
    fillet_fraction: float = RULE_FRACTION,
    *,
    add_worst_speed: bool = False,
) -> tuple[ShaftEvaluation, JudgedShaft]:
    """Return the shaft of a target with what its webs and bearings carry, and what judges its webs.

    Arguments and errors as of `assess_shaft` and `evaluate_shaft`.
    """
    stresses = stresses_of_throws(target, bearings, method, fillet_fraction)
    return judged_by_stresses(target, bearings, method, stresses, speeds_rpm, add_worst_speed=add_worst_speed)


def judged_webs(
    target: Target, bearings: Bearings, method: str, speeds_rpm: Sequence[float], fillet_fraction: float
) -> tuple[WebSafety, ...]:
    """Return the least safety of every part of every web alone, without what else is told of a shaft.

    Arguments and errors as of `judged_shaft`.
    """
    stresses = stresses_of_throws(target, bearings, method, fillet_fraction, _RESIDUAL)
    bodies = {name: stress.body for name, stress in stresses.items()}
    own = [stresses[throw.name] for throw in throw_targets(target)]
    scene = with_stiffness_of(target, bearings, bodies)
    return JudgedShaft(replace(target, scene=scene), bearings, own, speeds_rpm, method).webs()


def stresses_of_throws(
    target: Target,
    bearings: ShaftBearings,
    method: str,
    fillet_fraction: float,
    residual: float = RESIDUAL_LIMIT,
) -> dict[str, ShaftStress]:
    """Return the stresses of all fields of each different throw by its name; all is checked before."""
    check_judged(target, bearings, method)
    throws = dict.fromkeys(throw_targets(target))
    return {throw.name: solve_shaft_stress(throw, fillet_fraction, residual) for throw in throws}


def judged_by_stresses(
    target: Target,
    bearings: ShaftBearings,
    method: str,
    stresses: Mapping[str, ShaftStress],
    speeds_rpm: Sequence[float],
    *,
    add_worst_speed: bool,
) -> tuple[ShaftEvaluation, JudgedShaft]:
    """Return what `judged_shaft` does, of throws whose stresses are known."""
    throws = throw_targets(target)
    bodies = {name: stress.body for name, stress in stresses.items()}
    found = evaluate_shaft(
        target, bearings, speeds_rpm=speeds_rpm, bodies=bodies, add_worst_speed=add_worst_speed
    )
    own = [stresses[throw.name] for throw in throws]
    note(f"{target.name}: safety of {2 * len(throws)} webs at {len(found.on_bearings)} speeds")
    vibrating = of_stiffness(target.scene, found.stiffness.throws_Nm_per_rad)
    speeds = [at.speed_rpm for at in found.on_bearings]
    return found, JudgedShaft(replace(target, scene=vibrating), bearings, own, speeds, method)


def check_judged(target: Target, bearings: ShaftBearings, method: str) -> None:
    """Check everything that a user can get wrong, before the first solve."""
    criterion(method)
    if not stands_on_bearings(target.scene, bearings):
        raise not_on_bearings("--method: the safety over the cycle needs")
    for throw in dict.fromkeys(throw_targets(target)):
        check_method(throw.scene, method)
        check_fillets(throw)


@dataclass(frozen=True)
class JudgedShaft:
    """A shaft whose throws' stresses are known, to be judged at some speeds.

    Attributes:
        moving: the shaft with its mass, where its vibration is judged; the stresses are those of
            `moving_stress` then.
    """

    target: Target
    bearings: ShaftBearings
    throws: Sequence[ShaftStress]
    speeds_rpm: Sequence[float]
    method: str
    moving: DynamicShaft | None = None

    def webs(self) -> tuple[WebSafety, ...]:
        """Return the least safety of every part of every web."""
        return _webs(self._least(self._loads()[1]), self._judged_rpm)

    def safety(self) -> ShaftSafety:
        """Return the least safety of every part, and the worst point in full."""
        begin = time.perf_counter()
        angle_deg, loads = self._loads()
        solved = time.perf_counter()
        speeds, least = self._judged_rpm, self._least(loads)
        table = np.stack([least[key] for key in least])  # (parts, speeds)
        where, when = np.unravel_index(int(table.argmin()), table.shape)
        throw, side, _ = list(least)[int(where)]
        labels = tuple(f"{angle:g}" for angle in angle_deg)
        field = field_of_states(self.throws[throw].model, self.method, loads[throw][when], labels)
        stress = stress_over_cycle(field, loads[throw][when], angle_deg)
        if self.moving is None:  # the mesh is that of the shaft without mass, which tells it
            note_quality(field)
        note_yielding(field, self.target.scene.material.yield_MPa)
        finished = time.perf_counter()
        quality = field.model.quality
        return ShaftSafety(
            method=self.method,
            safety=float(table.min()),
            worst=_worst(field, throw, side, speeds[when], stress),
            webs=_webs(least, speeds),
            speeds=_by_speed(least, speeds),
            load_states=angle_deg.size * len(speeds),
            quality=JudgedQuality(**vars(quality), within_rule=quality.within_limits),
            mesh_shortfall=self.missed_checks or None,
            not_judged=" ".join(filter(None, dict.fromkeys(cut_outlet_words(t.model) for t in self.throws)))
            or None,
            left_off=None if self.moving else shaft_left_off(self.target.scene) or None,
            seconds=_seconds(self.throws, solved - begin, finished - solved),
            assumed=assumed_by(filter_by_table(self.target.assumed, USED), (self.method,)),
        )

    def web_histories(self) -> list[tuple[WebHistory, ...]]:
        """Return at each speed what loads each web, as `web_histories` has it."""
        scenes = [one.model.scene for one in self.throws]
        return [web_histories(throws, scenes, forces, cycle) for throws, forces, cycle in self._cycles]

    def bearing_loads(self, speed_rpm: float) -> BearingPolar:
        """Return the forces on the main bearings at one speed."""
        scene, sections = self.target.scene, carried(self.target.scene)
        _, _, cycle = solved_cycle(self.throws, scene, at_speed(scene, speed_rpm), self._support)
        on_bearings = loads_on_bearings_N(cycle)[list(sections)]
        return BearingPolar(speed_rpm, cycle.angle_deg, tuple(s + 1 for s in sections), on_bearings)

    @property
    def missed_checks(self) -> str:
        """The checks that the mesh of any throw misses, each with the names of the throws."""
        models = {id(one.model): one.model for one in self.throws}.values()
        found = {model.name: missed for model in models if (missed := mesh_shortfall(model))}
        if len(models) == 1:
            return "".join(found.values())
        return "; ".join(f"{name}: {missed}" for name, missed in found.items())

    @property
    def _support(self) -> Support:
        return support_of(self.target.scene, self.bearings)

    @property
    def _judged_rpm(self) -> list[float]:
        """Speeds that are judged, the engine's own where none is given."""
        return [engine_of(at).speed_rpm for at in speed_scenes(self.target.scene, self.speeds_rpm)]

    @cached_property
    def _cycles(self) -> list[SolvedCycle]:
        """The shaft at each speed, solved once for all that is asked of it."""
        scene = self.target.scene
        return [
            solved_cycle(self.throws, scene, at, self._support) for at in speed_scenes(scene, self.speeds_rpm)
        ]

    def _loads(self) -> tuple[Array, list[Array]]:
        """Angles, and of each throw the factors of its fields, (speeds, states, fields)."""
        if self.moving is not None:
            cycles = [self.moving.cycle(rpm) for rpm in self.speeds_rpm]
            moved = zip(*(moving_factors(self.throws, cycle) for cycle in cycles), strict=True)
            return cycles[0].shaft.angle_deg, [np.stack(of_throw) for of_throw in moved]
        found = [factors_of(self.throws, self.target.scene, solved) for solved in self._cycles]
        return found[0][0], list(np.stack([loads for _, loads in found], axis=1))

    def _least(self, loads: Sequence[Array]) -> dict[tuple[int, int, Part], Array]:
        """Least safety at every speed by throw, its web and part; equal throws are judged at once."""
        found: dict[tuple[int, int, Part], Array] = {}
        for model in {id(one.model): one.model for one in self.throws}.values():
            own = [index for index, one in enumerate(self.throws) if one.model is model]
            judged = least_safeties(model, [loads[index] for index in own], self.method)
            for index, parts in zip(own, judged, strict=True):
                found |= {(index, side, part): safety for (side, part), safety in parts.items()}
        return found


def _worst(
    field: FatigueField, throw: int, side: int, speed_rpm: float, stress: StressOverCycle
) -> WorstPlace:
    highest, lowest = map(float, field.critical.states)
    return WorstPlace(
        web=2 * throw + side + 1,
        throw=throw + 1,
        speed_rpm=speed_rpm,
        highest_deg=highest,
        lowest_deg=lowest,
        critical=field.critical,
        over_cycle=stress,
    )


def _webs(least: dict[tuple[int, int, Part], Array], speeds: Sequence[float]) -> tuple[WebSafety, ...]:
    webs = sorted({(throw, side) for throw, side, _ in least})
    return tuple(
        _web(throw, side, {p: least[throw, side, p] for p in PARTS if (throw, side, p) in least}, speeds)
        for throw, side in webs
    )


def _web(throw: int, side: int, parts: dict[Part, Array], speeds: Sequence[float]) -> WebSafety:
    values = {part: float(safety.min()) for part, safety in parts.items()}
    worst = min(values, key=lambda part: values[part])
    return WebSafety(
        web=2 * throw + side + 1,
        throw=throw + 1,
        pin_fillet=values["pin_fillet"],
        journal_fillet=values["journal_fillet"],
        outlets=values.get("outlets"),
        elsewhere=values.get("elsewhere"),
        safety=values[worst],
        part=worst,
        speed_rpm=speeds[int(parts[worst].argmin())],
        over_speeds=tuple(np.min(list(parts.values()), axis=0).tolist()),
    )


def _by_speed(least: dict[tuple[int, int, Part], Array], speeds: Sequence[float]) -> tuple[SpeedSafety, ...]:
    found = []
    for index, speed in enumerate(speeds):
        throw, side, part = min(least, key=lambda key: least[key][index])
        safety = float(least[throw, side, part][index])
        found.append(SpeedSafety(speed_rpm=speed, safety=safety, web=2 * throw + side + 1, part=part))
    return tuple(found)


def _seconds(throws: Sequence[ShaftStress], cycles: float, safety: float) -> SafetySeconds:
    each = list({id(one): one.seconds for one in throws}.values())
    mesh, unit_fields, stresses = (sum(parts) for parts in zip(*each, strict=True))
    return SafetySeconds(mesh=mesh, unit_fields=unit_fields, stresses=stresses, cycles=cycles, safety=safety)
