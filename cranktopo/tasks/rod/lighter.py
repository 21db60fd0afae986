"""A lighter rod at no less safety: shank and bosses searched by the analytic strength of the rod.

Eyes may only grow. Bores, widths, bolts and length stay. Ovalisation keeps the limits of the design, if any.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import at_work
from cranktopo.design.checks.rod import least_dimensions, rod_of, split_shortfalls
from cranktopo.design.named import DesignLike, as_scene, with_values
from cranktopo.design.rod import Eye, Rod
from cranktopo.design.rod_body import rod_mass
from cranktopo.design.rod_bolts import thread_end_mm
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse, at_speed
from cranktopo.numerics.optimisers.gradient_search import by_differences, minimise
from cranktopo.tasks.rod.result import EyeShape, FreeDimension, LighterRod, RodStrength
from cranktopo.tasks.rod.stage import check_rod_strength

_FREE = ("small_end_diameter_mm", "big_end_diameter_mm", "boss_width_mm", "boss_above_mm", "boss_below_mm")
_SHANK = ("shank_small_mm", "shank_big_mm", "shank_width_mm")
_WALLS = ("flange_mm", "web_mm")
_ONLY_GROW = ("small_end_diameter_mm", "big_end_diameter_mm")
_LOWEST, _HIGHEST = 0.3, 3.0
"""Bounds over the value at the start."""
_STEP, _EVALUATIONS = 1e-4, 100
"""Step of derivatives and end of the search, over the value at the start."""
_KEPT, _ROUNDED = 1e-4, 1e-3
"""Share by which safeties are kept above those of the start, for the rounding of the dimensions; share that
a rounded rod may miss of any limit."""


Limits = Callable[[Array, RodStrength], Array]
"""Values that must stay below 0, by dimensions over those of the own rod and the closed form of that rod."""


def lighten_rod(
    design: DesignLike, method: str = "lsa", least_wall_mm: float = 3.0
) -> tuple[Scene, LighterRod]:
    """Return the design with a lighter rod whose smallest safeties are not below those of its own rod.

    Kept are the smallest safety against yield of all sections and struts, the smallest for fatigue, the
    permitted ovalisation of both bores, and the length that each bolt is screwed in.

    Raises:
        CranktopoError: as `check_rod_strength`, or no lighter rod was found.
    """
    search = rod_search(as_scene(design), method, least_wall_mm)
    lighter = search.rod_at(search.best())
    after = check_rod_strength(lighter, method)
    if not search.is_better(lighter, after):
        raise search.no_lighter_rod()
    result = search.result_of(lighter, after)
    if not any(eye.permitted_um for eye in after.eyes):
        return lighter, result
    return lighter, result.model_copy(update={"result_without_limits_kg": search.unlimited_kg()})


@dataclass(frozen=True)
class RodSearch:
    """Search for a lighter rod: its free dimensions, as shares of those of the design's own rod.

    Attributes:
        start_mm, bounds: (dimensions,); the bounds are shares.
        before: strength of the own rod.
        limited: whether bores keep their permitted ovalisation.
    """

    scene: Scene
    method: str
    names: tuple[str, ...]
    start_mm: Array
    bounds: tuple[Array, Array]
    before: RodStrength
    limited: bool = True

    def within(self, values: Array, reach: float) -> RodSearch:
        """Return the same search with each dimension at most so far from given ones."""
        low, high = self.bounds
        return replace(self, bounds=(np.maximum(low, values - reach), np.minimum(high, values + reach)))

    def best(self, more: Limits | None = None, start: Array | None = None) -> Array:
        """Return the dimensions of the lightest rod within the limits of the closed form and more.

        Args:
            start: where the search begins; by default at the own rod.
        """
        before = self.before

        def judged(values: Array) -> Array:
            """Mass and all that must stay below 0, relative."""
            tried = resized(self.scene, self.names, values * self.start_mm)
            found = check_rod_strength(tried, self.method)
            mass = found.masses.total_kg / before.masses.total_kg
            beside = np.array([]) if more is None else more(values, found)
            return np.concatenate([[mass], self._excess(tried, found), beside])

        with at_work("searching a lighter rod"):
            first = np.ones(len(self.names)) if start is None else start
            return minimise(*by_differences(judged, _STEP), self.bounds, first, _STEP, _EVALUATIONS)

    def rod_at(self, values: Array) -> Scene:
        """Return the design with the rod of these dimensions, rounded to a micrometre, checked."""
        rounded = zip(self.names, values * self.start_mm, strict=True)
        return with_values(self.scene, {f"rod.{name}": round(float(value), 3) for name, value in rounded})

    def strength_at(self, values: Array) -> RodStrength:
        """Return the strength of the rod of these dimensions in closed form, neither rounded nor checked."""
        return check_rod_strength(resized(self.scene, self.names, values * self.start_mm), self.method)

    def kg_of(self, scene: Scene) -> float:
        """Return the mass of a design's rod."""
        return rod_mass(*rod_of(scene), scene.material).total_kg

    def values_of(self, scene: Scene) -> Array:
        """Return the dimensions of another design's rod."""
        return np.array([getattr(scene.rod, name) for name in self.names]) / self.start_mm

    def is_better(self, lighter: Scene, after: RodStrength) -> bool:
        """Tell whether a rod is lighter than the own one at no less safety in closed form."""
        kept = float(self._excess(lighter, after).max()) <= _ROUNDED
        return kept and after.masses.total_kg < self.before.masses.total_kg

    def _excess(self, scene: Scene, strength: RodStrength) -> Array:
        """Values that must stay below 0 of a rod: what it lost, and what its bores change too much."""
        return np.concatenate([_excess(scene, strength, self.before), _too_oval(strength) * self.limited])

    def unlimited_kg(self) -> float:
        """Return the mass of the lightest rod of the same search without limits of ovalisation."""
        free = replace(self, limited=False)
        return check_rod_strength(free.rod_at(free.best()), self.method).masses.total_kg

    def no_lighter_rod(self, judge: str = "") -> CranktopoError:
        """Return the error that tells that the search ended without a better rod."""
        limits = [eye for eye in self.before.eyes if eye.permitted_um]
        kept = " within the permitted ovalisation" * bool(limits)
        over = [eye for eye in limits if eye.ovalisation_um > (eye.permitted_um or np.inf)]
        own = "".join(
            f" The bore of its {eye.eye} changes by {eye.ovalisation_um:.1f} um, permitted are "
            f"{eye.permitted_um:g} um."
            for eye in over
        )
        return CranktopoError(
            f"{self.scene.name}: no lighter rod of this shape at no less safety{judge}{kept} was found.{own}",
            hint="Change rod.shank, or give dimensions that are farther from the limits.",
        )

    def result_of(self, lighter: Scene, after: RodStrength) -> LighterRod:
        """Return what was found."""
        before, scene = self.before, self.scene
        dimensions = tuple(
            FreeDimension(
                name=name,
                start_mm=float(start),
                value_mm=float(getattr(lighter.rod, name)),
                low_mm=float(low * start),
                high_mm=float(high * start),
            )
            for name, start, low, high in zip(self.names, self.start_mm, *self.bounds, strict=True)
        )
        speed, radius = max(before.speeds_rpm), scene.throw.radius_mm
        return LighterRod(
            start_kg=before.masses.total_kg,
            result_kg=after.masses.total_kg,
            smallest_yield_safety=(min(_safeties(before)[0]), min(_safeties(after)[0])),
            smallest_fatigue_safety=(min(_safeties(before)[1]), min(_safeties(after)[1])),
            speed_rpm=speed,
            crankpin_pull_N=(_pin_pull_N(scene, speed), _pin_pull_N(lighter, speed)),
            small_end_ovalisation_um=_of_both(before, after, "small"),
            big_end_ovalisation_um=_of_both(before, after, "big"),
            rotating_unbalance_kg_mm=(
                before.masses.rotating_kg * radius,
                after.masses.rotating_kg * radius,
            ),
            dimensions=dimensions,
        )


def rod_search(scene: Scene, method: str, least_wall_mm: float) -> RodSearch:
    """Return the search for a lighter rod of a design; raises CranktopoError as `check_rod_strength`."""
    rod, _ = rod_of(scene)
    before = check_rod_strength(scene, method)
    names = (*_FREE, *_SHANK, *(_WALLS if rod.shank != "plain" else ()))
    start = np.array([getattr(rod, name) for name in names])
    return RodSearch(scene, method, names, start, _bounds(rod, names, start, least_wall_mm), before)


def _bounds(rod: Rod, names: tuple[str, ...], start: Array, least_wall_mm: float) -> tuple[Array, Array]:
    """Bounds over the start: eyes do not shrink, walls are no thinner than can be made."""
    low, high = np.full(len(names), _LOWEST), np.full(len(names), _HIGHEST)
    for place, name in enumerate(names):
        if name in _ONLY_GROW:
            low[place] = 1.0
        if name in _WALLS:
            low[place] = min(least_wall_mm / start[place], 1.0)
        if name == "boss_width_mm":
            hole_mm = rod.bolt_distance_mm + rod.bolt_hole_mm
            low[place] = min((hole_mm + 2 * least_wall_mm) / start[place], 1.0)
        if name == "boss_below_mm" and rod.bolt is not None:  # the grip of the bolt stays
            low[place] = high[place] = 1.0
        if name == "boss_above_mm" and rod.bolt is not None:  # so does where its thread or nut is
            through = rod.bolt.held_in == "nut"
            low[place] = 1.0 if through else min(thread_end_mm(rod, rod.bolt) / start[place], 1.0)
            high[place] = 1.0 if through else _HIGHEST
    return low, high


def resized(scene: Scene, names: Sequence[str], values_mm: Array) -> Scene:
    """Return the scene with a rod of these dimensions, not checked."""
    assert scene.rod is not None
    rod = scene.rod.model_copy(update=dict(zip(names, map(float, values_mm), strict=True)))
    return scene.model_copy(update={"rod": rod})


def _safeties(strength: RodStrength) -> tuple[list[float], list[float]]:
    """Safeties against yield, of struts too, and for fatigue."""
    static = [*(s.yield_safety for s in strength.sections), *(b.yield_safety for b in strength.buckling)]
    return static, [s.fatigue_safety for s in strength.sections]


def _excess(scene: Scene, strength: RodStrength, before: RodStrength) -> Array:
    """Values that must stay below 0: lost safeties, and dimensions below what the others leave them."""
    lost = [
        1 + _KEPT - value / min(limit)
        for values, limit in zip(_safeties(strength), _safeties(before), strict=True)
        for value in values
    ]
    rod = scene.rod
    assert rod is not None
    short = [(smallest - getattr(rod, key)) / smallest for key, smallest in least_dimensions(rod)]
    oblique = [missing for _, missing, _ in split_shortfalls(rod, rod_of(scene)[1])]
    return np.array([*lost, *short, *oblique])


def _too_oval(strength: RodStrength) -> Array:
    """Ovalisation over what is permitted, less 1."""
    over = [eye.ovalisation_um / eye.permitted_um for eye in strength.eyes if eye.permitted_um]
    return np.array(over) + _KEPT - 1


def _of_both(before: RodStrength, after: RodStrength, eye: Eye) -> tuple[float, float]:
    return ovalisation_um(before.eyes, eye), ovalisation_um(after.eyes, eye)


def ovalisation_um(eyes: Sequence[EyeShape], eye: Eye) -> float:
    """Return the largest ovalisation of an eye among the loads that a limit is for."""
    return max(one.ovalisation_um for one in eyes if one.eye == f"{eye} end" and one.judged)


def _pin_pull_N(scene: Scene, speed_rpm: float) -> float:
    """Largest force on the crankpin away from the crank at a speed, with the rod's rotating mass."""
    cycle = analyse(at_speed(scene, speed_rpm)).cycle
    assert cycle is not None
    return -cycle.extreme("web_force_N")[1].value
