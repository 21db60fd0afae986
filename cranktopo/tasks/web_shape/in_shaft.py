"""A search whose throw stands in its shaft: the loads of its webs there, and the safety that they have."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.notes import indented, note
from cranktopo.base.progress import Json, StageMemory
from cranktopo.design.goal.limit import Goal
from cranktopo.design.halves import difference
from cranktopo.design.misfire import all_firing
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import HistoryKind, LoadHistory, WebHistory, WebLoads
from cranktopo.engine.judged_histories import histories_of
from cranktopo.engine.plan.planning import plan_for_stress
from cranktopo.tasks.shaft_safety.result import WebSafety
from cranktopo.tasks.throw_fatigue.needs import load_kinds
from cranktopo.tasks.web_shape.each_web.groups import WebGroup
from cranktopo.tasks.web_shape.each_web.loaded_shaft import (
    LoadedShaft,
    ShaftFigures,
    WebInShaft,
    WebsInShaft,
    loaded_shaft,
)
from cranktopo.tasks.web_shape.evaluated_web import Judging, kept_safety
from cranktopo.tasks.web_shape.optimum import ShapeSettings
from cranktopo.tasks.web_shape.result import LeastInShaft, SafetyInShaft
from cranktopo.tasks.web_shape.stage import stresses_in

EFFECT = "continuous_shaft"
STRESS_ALONE = "the stress is one of a throw alone"
_NEAR = 1.1
"""Safety of a web over the least of all up to which its loads count: all get the same dimensions, and what
these change is less."""


def asks_for_shaft(scene: Scene, goal: Goal, settings: ShapeSettings) -> bool:
    """Tell whether the plan has the shaft on, and the goal asks for what it changes."""
    if isinstance(settings.loads, WebLoads) or not stresses_in(goal.quantities):
        return False
    return EFFECT in plan_for_stress(scene).enabled


def left_alone(scene: Scene, goal: Goal) -> str:
    """Return why the throw of a search cannot stand in its shaft; empty where it can."""
    return STRESS_ALONE if "stress" in goal.quantities else without_shaft(scene)


def without_shaft(scene: Scene) -> str:
    """Return why the web of a scene cannot be judged in its shaft; empty where it can."""
    if differing := difference(scene):
        return f"{differing} makes its two webs differ"
    if scene.original is not None:
        return "[original] gives the body of one web"
    return "supports.bending is 'clamped'" if scene.supports.bending == "clamped" else ""


@dataclass(frozen=True)
class SearchInShaft:
    """The shaft of the design's own web, and the loads that a search takes from it."""

    scene: Scene
    shaft: LoadedShaft
    loads: WebLoads
    fillet_fraction: float

    def judged(self, web: Scene, goal: Goal, work: StageMemory) -> SafetyInShaft:
        """Return the safety of the shaft with the best web beside what the goal asks for."""
        original = self.shaft.figures
        found = _shaft(in_its_shaft(web), "shaft-result", self.fillet_fraction, work).figures
        return SafetyInShaft(**vars(least_in_shaft(goal, original, found)))


def search_in_shaft(
    scene: Scene, goal: Goal, settings: ShapeSettings, work: StageMemory
) -> SearchInShaft | None:
    """Return the loads of a scene's webs in their shaft over its range of speeds, all cylinders firing.

    None where the throw of the search stands alone.

    A throw that stands alone under the loads of a web has nearly its safety in the shaft: the loads are made
    so much larger or smaller that the design's own web has just that. Where the plan alone has the effect on,
    the states of a throw alone count as well, as in `fatigue`.

    Raises:
        CranktopoError: missing loads or strengths, or a failed solve.
    """
    if not asks_for_shaft(scene, goal, settings) or left_alone(scene, goal):
        return None
    note(f"{scene.name}: effect {EFFECT}: the loads of its webs are those in the shaft on all its bearings")
    fraction = settings.fillet_fraction
    shaft = _shaft(in_its_shaft(scene), "shaft", fraction, work)
    least = shaft.figures.safety
    near = tuple(web.web for web in shaft.figures.webs if web.safety <= _NEAR * least)
    loads = shaft.loads(WebGroup(near))

    share = kept_safety(work, "web-in-shaft", scene, Judging(loads, fraction)) / least
    histories = tuple(_times(one, share) for one in loads.histories)
    if scene.effects.continuous_shaft == "auto":
        assert not isinstance(settings.loads, WebLoads)
        histories += _of_throw_alone(scene, settings.loads)
    return SearchInShaft(scene, shaft, WebLoads(histories), fraction)


def least_in_shaft(
    goal: Goal, original: ShaftFigures | WebsInShaft, result: ShaftFigures | WebsInShaft
) -> LeastInShaft:
    """Return the safety of a shaft with a web that was found beside what a goal asks for."""
    limits = [limit for limit in goal.limits_of("fatigue_safety") if limit.sense == ">="]
    required = [least for limit in limits if (least := limit.required(original.safety)) is not None]
    webs: Sequence[WebInShaft | WebSafety] = result.webs
    worst = min(webs, key=lambda one: one.safety)
    return LeastInShaft(
        original=original.safety,
        result=result.safety,
        required=max(required, default=None),
        web=worst.web,
        part=worst.part,
    )


def in_its_shaft(scene: Scene) -> Scene:
    """Return a scene whose plan has the shaft on, all cylinders firing."""
    return all_firing(scene).with_effect(EFFECT, "on")


def _shaft(scene: Scene, name: str, fillet_fraction: float, work: StageMemory) -> LoadedShaft:
    def solved() -> Json:
        with indented():
            return loaded_shaft(scene, fillet_fraction).as_json()

    found = LoadedShaft.of_json(work.once(name, solved))
    note(f"{scene.name}: least safety in the shaft {found.figures.safety:.3f}")
    return found


def _times(history: WebHistory, share: float) -> WebHistory:
    """Return loads that are larger by a share: stress and safety follow in proportion."""
    return replace(
        history,
        radial_N=share * history.radial_N,
        tangential_N=share * history.tangential_N,
        torque_Nm=share * history.torque_Nm,
        angular_speed_rad_s=np.sqrt(share) * history.angular_speed_rad_s,
        moment_Nm=share * history.moment_Nm,
        side_moment_Nm=share * history.side_moment_Nm,
        swing_Nm=None if history.swing_Nm is None else share * history.swing_Nm,
    )


def _of_throw_alone(scene: Scene, kind: HistoryKind) -> tuple[WebHistory, ...]:
    """Return the states of a throw alone as both its webs have them; none has a moment beside it.

    The far web is mirrored in the middle of the pin, so that what it passes on turns the other way.
    """
    found: Sequence[LoadHistory] = histories_of(scene, kind, load_kinds(scene, kind)[0])
    return tuple(
        WebHistory(
            one.radial_N,
            one.tangential_N,
            side * one.torque_Nm,
            one.angular_speed_rad_s,
            one.labels,
            np.zeros_like(one.radial_N),
            np.zeros_like(one.radial_N),
            swing_Nm=one.swing_Nm,
        )
        for one in found
        for side in (1.0, -1.0)
    )
