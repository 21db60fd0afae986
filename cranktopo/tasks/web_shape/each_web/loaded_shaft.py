"""A shaft on all its main bearings as the search for its webs needs it: safety and loads of every web."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.progress import Json
from cranktopo.base.result import Result
from cranktopo.base.units import MM_PER_M
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.bearings import bearing_spring_N_per_mm
from cranktopo.engine.histories import WebHistory, WebLoads
from cranktopo.engine.judged_speeds import rated_speeds, speeds_of_range
from cranktopo.engine.plan.planning import plan_for_stress
from cranktopo.tasks.shaft.assembly import Bearings
from cranktopo.tasks.shaft.stage import shaft_effects
from cranktopo.tasks.shaft_safety.judged import judged_shaft, judged_webs
from cranktopo.tasks.shaft_safety.result import WebSafety
from cranktopo.tasks.throw_fea.targets import resolve_target
from cranktopo.tasks.web_shape.each_web.groups import WebGroup

_METHOD = "lsa"
"""The method of the search."""
_NEAR = 1.1
"""Safety over that of the worst speed up to which the search has a speed's loads: a web that it changes loses
less than this at the others, and the shaft is judged again at all of them."""


class WebInShaft(Result):
    """A web of a shaft: moments in its middle, largest less smallest over the cycle, and its least safety."""

    web: int
    """Its number from the free end, 1 first."""
    throw: int
    bending_range_Nm: float
    """Range of the bending moment in the plane of the throw."""
    side_bending_range_Nm: float
    """Range of that across the throw."""
    torque_range_Nm: float
    """Range of the torque about the crank axis."""
    safety: float
    """Least safety over the cycle, in the shaft."""
    part: str
    """Its place: pin_fillet, journal_fillet, outlets or elsewhere."""


class ShaftFigures(Result):
    """A whole crank, judged on all its main bearings."""

    mass_kg: float
    torsion_end_to_end_Nm_per_rad: float
    safety: float
    """Least of all webs."""
    webs: tuple[WebInShaft, ...]

    @property
    def safeties(self) -> tuple[float, ...]:
        """Least safety of each web."""
        return tuple(web.safety for web in self.webs)


class WebsInShaft(Result):
    """Least safety of every web of a whole crank, judged on all its main bearings."""

    webs: tuple[WebSafety, ...]

    @property
    def safety(self) -> float:
        """Least of all webs."""
        return min(web.safety for web in self.webs)


@dataclass(frozen=True)
class LoadedShaft:
    """A judged shaft with the load histories of each web, one for each speed that may decide."""

    figures: ShaftFigures
    histories: tuple[tuple[WebHistory, ...], ...]

    def loads(self, group: WebGroup) -> WebLoads:
        """Return what the webs of a group carry."""
        return WebLoads(tuple(history for web in group.webs for history in self.histories[web - 1]))

    def as_json(self) -> Json:
        """Return all of it as plain data."""
        curves = [[_plain(history) for history in of_web] for of_web in self.histories]
        return {"figures": self.figures.as_json(), "histories": curves}

    @classmethod
    def of_json(cls, data: Json) -> LoadedShaft:
        """Return what `as_json` gave."""
        histories = tuple(tuple(map(_history, of_web)) for of_web in data["histories"])
        return cls(ShaftFigures.of_json(data["figures"], "shaft of the run"), histories)


def loaded_shaft(design: Scene | str, fillet_fraction: float) -> LoadedShaft:
    """Return the shaft of a design at the speeds of `rated_speeds`.

    Where the effect `continuous_shaft` is on, the range of speeds counts. Main bearings are springs where the
    design tells them, else rigid.

    Args:
        fillet_fraction: element size in a fillet over its radius.

    Raises:
        CranktopoError: missing loads or strengths, sharp fillets, or a failed solve.
    """
    target = resolve_target(design, fillets=True, whole=True, crank=True)
    bearings, speeds = _asked(target.scene)
    found, judged = judged_shaft(target, bearings, _METHOD, speeds, fillet_fraction)
    safety, histories = judged.safety(), list(zip(*judged.web_histories(), strict=True))
    webs = tuple(
        WebInShaft(
            web=web.web,
            throw=web.throw,
            safety=web.safety,
            part=web.part,
            **_ranges(target.scene, histories[web.web - 1]),
        )
        for web in safety.webs
    )
    torsion = found.stiffness.end_to_end_Nm_per_rad
    figures = ShaftFigures(
        mass_kg=found.mass_kg, torsion_end_to_end_Nm_per_rad=torsion, safety=safety.safety, webs=webs
    )
    deciding = tuple(_deciding(web, histories[web.web - 1]) for web in safety.webs)
    return LoadedShaft(figures, deciding)


def webs_in_shaft(design: Scene, fillet_fraction: float) -> WebsInShaft:
    """Return the safety of every web of that shaft alone, at the same speeds.

    Arguments and errors as of `loaded_shaft`.
    """
    target = resolve_target(design, fillets=True, whole=True, crank=True)
    bearings, speeds = _asked(target.scene)
    return WebsInShaft(webs=judged_webs(target, bearings, _METHOD, speeds, fillet_fraction))


def _asked(scene: Scene) -> tuple[Bearings, list[float]]:
    """Return the bearings and the speeds at which a shaft is judged, rpm."""
    on = "continuous_shaft" in plan_for_stress(scene).enabled
    at = (speeds_of_range if on else rated_speeds)(scene, shaft_effects(scene))
    bearings: Bearings = "rigid" if bearing_spring_N_per_mm(scene) is None else "spring"
    return bearings, [engine_of(one).speed_rpm for one in at]


def _deciding(web: WebSafety, histories: Sequence[WebHistory]) -> tuple[WebHistory, ...]:
    """Return the histories of the speeds at which a web is about as little safe as anywhere."""
    pairs = zip(histories, web.over_speeds, strict=True)
    return tuple(one for one, safety in pairs if safety <= _NEAR * web.safety)


def _ranges(scene: Scene, histories: Sequence[WebHistory]) -> dict[str, float]:
    """Return the ranges of the moments in the middle of a web, of several speeds the largest."""
    lever_m = sum(scene.web_z_mm) / 2 / MM_PER_M
    radius_m = scene.throw.radius_mm / MM_PER_M
    found = [
        {
            "bending_range_Nm": one.moment_Nm + lever_m * one.radial_N / 2,
            "side_bending_range_Nm": one.side_moment_Nm + lever_m * one.tangential_N / 2,
            "torque_range_Nm": radius_m * one.tangential_N / 2 + one.own_swing_Nm / 4 - one.torque_Nm,
        }
        for one in histories
    ]
    return {name: max(float(np.ptp(moments[name])) for moments in found) for name in found[0]}


def _plain(history: WebHistory) -> Json:
    return {
        name: value.tolist() if isinstance(value, np.ndarray) else list(value)
        for name, value in vars(history).items()
        if value is not None
    }


def _history(data: Json) -> WebHistory:
    curves: dict[str, Array] = {name: np.array(data[name]) for name in data if name != "labels"}
    return WebHistory(**curves, labels=tuple(data["labels"]))
