"""The web of a search whose throw stands alone, judged in its shaft when it is found, beside the original."""

from __future__ import annotations

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note, silent
from cranktopo.base.progress import Json, StageMemory
from cranktopo.base.side_by_side import LazyFuture
from cranktopo.design.checks.engine import speed_range_rpm
from cranktopo.design.goal.limit import Goal
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import WebLoads
from cranktopo.engine.plan.planning import plan_for_stress
from cranktopo.tasks.web_shape.each_web.loaded_shaft import WebsInShaft, webs_in_shaft
from cranktopo.tasks.web_shape.in_shaft import (
    EFFECT,
    STRESS_ALONE,
    in_its_shaft,
    least_in_shaft,
    without_shaft,
)
from cranktopo.tasks.web_shape.optimum import ShapeSettings
from cranktopo.tasks.web_shape.result import ShaftCheck
from cranktopo.tasks.web_shape.stage import stresses_in

FILLET_FRACTION = 0.5
"""Element size in a fillet over its radius. Of both webs the safety is 2.1 to 4.3 % less than on the mesh of
an evaluation, what the result has over the original 0.2 % off, in a third of the time."""


_ORIGINAL, _RESULT = "webs-in-shaft-original", "webs-in-shaft-result"


class ShaftsBeside:
    """The shafts with the original and with the web that was found, solved beside what else is to be done.

    Neither is solved where the search has the loads of the shaft itself, the goal asks for no stress, a
    single throw is its shaft, or a web cannot be judged there.
    """

    def __init__(self, scene: Scene, goal: Goal, settings: ShapeSettings, work: StageMemory) -> None:
        self._scene, self._goal, self._work = scene, goal, work
        self._fraction = max(FILLET_FRACTION, settings.fillet_fraction)
        self._asked = _asks(scene, goal, settings)
        self._why = _unjudged(scene, goal) if self._asked else ""
        self._begun: dict[str, LazyFuture[Json]] = {}

    def begin_original(self) -> None:
        """Begin with the original."""
        self._begin(_ORIGINAL, self._scene)

    def begin(self, web: Scene) -> None:
        """Begin with the web that was found, and with the original unless it has begun."""
        self.begin_original()
        self._begin(_RESULT, web)

    def judged(self) -> tuple[ShaftCheck | None, str]:
        """Return the safety of all webs in their shaft with the web that was found, and with the original.

        Both have begun. Else why there is none, in words; empty where nothing asks for it. A shaft that fails
        costs no search.

        Raises:
            CranktopoError: interruption.
        """
        if not self._asked or self._why:
            return None, self._why
        note(f"{self._scene.name}: original and result in their shaft, where the search did not have them")
        try:
            return self._check(), ""
        except CranktopoError as error:
            if error.code == ExitCode.INTERRUPTED:
                raise
            return None, error.message

    def _check(self) -> ShaftCheck:
        original, result = (self._webs(name) for name in (_ORIGINAL, _RESULT))
        least = least_in_shaft(self._goal, original, result)
        speeds = speed_range_rpm(self._scene)
        return ShaftCheck(**vars(least), speeds_rpm=speeds, fillet_fraction=self._fraction)

    def _begin(self, name: str, scene: Scene) -> None:
        def solved() -> Json:
            with silent():
                return webs_in_shaft(in_its_shaft(scene), self._fraction).as_json()

        if self._asked and not self._why and name not in self._work.kept:
            self._begun.setdefault(name, LazyFuture(solved)).begin()

    def _webs(self, name: str) -> WebsInShaft:
        kept = self._work.once(name, lambda: self._begun[name].result())
        return WebsInShaft.of_json(kept, "shaft of the run")


def _asks(scene: Scene, goal: Goal, settings: ShapeSettings) -> bool:
    """Tell whether a search of throws alone asks for a stress, of a shaft of several throws."""
    if isinstance(settings.loads, WebLoads) or not stresses_in(goal.quantities):
        return False
    return scene.engine is not None and scene.engine.throws > 1


def _unjudged(scene: Scene, goal: Goal) -> str:
    """Return why a web is judged as a throw alone only; empty where it is not."""
    effect = plan_for_stress(scene)[EFFECT]
    if effect.estimate_percent is None:
        return effect.reason
    if scene.effects.continuous_shaft == "off":
        return f"effects.{EFFECT} is off, 'auto' judges it there; {effect.reason.split('; ')[-1]}"
    return without_shaft(scene) if "fatigue_safety" in goal.quantities else STRESS_ALONE
