"""A lighter rod at no less safety: shank and bosses searched by the analytic strength of the rod.

Eyes may only grow: what they widen under load is not in the model. Bores, widths, bolts and length stay.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import at_work
from cranktopo.design.checks.rod import check_rod, least_dimensions, rod_of
from cranktopo.design.named import DesignLike, as_scene, with_values
from cranktopo.design.rod import Rod
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import analyse, at_speed
from cranktopo.numerics.optimisers.gradient_search import central_difference, minimise
from cranktopo.tasks.rod.result import FreeDimension, LighterRod, RodStrength
from cranktopo.tasks.rod.stage import check_rod_strength

_FREE = ("small_end_diameter_mm", "big_end_diameter_mm", "boss_width_mm", "boss_above_mm", "boss_below_mm")
_SHANK = ("shank_small_mm", "shank_big_mm", "shank_width_mm")
_WALLS = ("flange_mm", "web_mm")
_ONLY_GROW = ("small_end_diameter_mm", "big_end_diameter_mm")
_LOWEST, _HIGHEST = 0.3, 3.0
"""Bounds over the value at the start."""
_STEP, _EVALUATIONS = 1e-4, 100
"""Step of derivatives and end of the search, over the value at the start."""
_KEPT = 1e-4
"""Share by which safeties are kept above those of the start, for the rounding of the dimensions."""


def lighten_rod(
    design: DesignLike, method: str = "lsa", least_wall_mm: float = 3.0
) -> tuple[Scene, LighterRod]:
    """Return the design with a lighter rod whose smallest safeties are not below those of its own rod.

    Kept are the smallest safety against yield of all sections and struts, the smallest for fatigue, and the
    length that each bolt is screwed in.

    Raises:
        CranktopoError: as `check_rod_strength`, or no lighter rod was found.
    """
    scene = as_scene(design)
    rod, _ = rod_of(scene)
    before = check_rod_strength(scene, method)
    names = (*_FREE, *_SHANK, *(_WALLS if rod.shank != "plain" else ()))
    start = np.array([getattr(rod, name) for name in names])
    bounds = _bounds(rod, names, start, least_wall_mm)

    @lru_cache(maxsize=512)
    def judged(values: tuple[float, ...]) -> Array:
        """Mass and all that must stay below 0, relative."""
        tried = _with(scene, names, np.array(values) * start)
        found = check_rod_strength(tried, method)
        return np.concatenate(
            [[found.masses.total_kg / before.masses.total_kg], _excess(tried, found, before)]
        )

    def of(values: Array) -> Array:
        return judged(tuple(map(float, values)))

    def objective(values: Array) -> tuple[float, Array]:
        return float(of(values)[0]), central_difference(of, values, _STEP)[0]

    def constraints(values: Array) -> tuple[Array, Array]:
        return of(values)[1:], central_difference(of, values, _STEP)[1:]

    with at_work("searching a lighter rod"):
        best = minimise(objective, constraints, bounds, np.ones(len(names)), _STEP, _EVALUATIONS)
    lighter = with_values(
        scene, {f"rod.{n}": round(float(v), 3) for n, v in zip(names, best * start, strict=True)}
    )
    after = check_rod_strength(lighter, method)
    if after.masses.total_kg >= before.masses.total_kg or _excess(lighter, after, before).max() > 1e-3:
        raise CranktopoError(
            f"{scene.name}: no lighter rod of this shape at no less safety was found.",
            hint="Change rod.shank, or give dimensions that are farther from the limits.",
        )
    return lighter, _told(scene, lighter, before, after, names, bounds)


def with_elements(searched: LighterRod, before: RodStrength, after: RodStrength) -> LighterRod:
    """Return a search with the smallest safeties by finite elements of both rods."""
    first, last = before.elements, after.elements
    assert first is not None
    assert last is not None
    return searched.model_copy(
        update={
            "elements_yield_safety": (first.yield_safety, last.yield_safety),
            "elements_fatigue_safety": (first.fatigue_safety, last.fatigue_safety),
        }
    )


def _bounds(rod: Rod, names: tuple[str, ...], start: Array, least_wall_mm: float) -> tuple[Array, Array]:
    """Bounds over the start: eyes do not shrink, walls are no thinner than can be made."""
    low, high = np.full(len(names), _LOWEST), np.full(len(names), _HIGHEST)
    for place, name in enumerate(names):
        if name in _ONLY_GROW:
            low[place] = 1.0
        if name in _WALLS:
            low[place] = min(least_wall_mm / start[place], 1.0)
        if name == "boss_below_mm" and rod.bolt is not None:  # the grip of the bolt stays
            low[place] = high[place] = 1.0
        if name == "boss_above_mm" and rod.bolt is not None:
            low[place] = min(rod.bolt.engaged_mm / start[place], 1.0)
    return low, high


def _with(scene: Scene, names: tuple[str, ...], values: Array) -> Scene:
    """The scene with a rod of these dimensions and its masses, not checked."""
    assert scene.rod is not None
    rod = scene.rod.model_copy(update=dict(zip(names, map(float, values), strict=True)))
    return scene.model_copy(update={"rod": rod})


def _safeties(found: RodStrength) -> tuple[list[float], list[float]]:
    """Safeties against yield, of struts too, and for fatigue."""
    static = [*(s.yield_safety for s in found.sections), *(b.yield_safety for b in found.buckling)]
    return static, [s.fatigue_safety for s in found.sections]


def _excess(scene: Scene, found: RodStrength, before: RodStrength) -> Array:
    """Values that must stay below 0: lost safeties, and dimensions below what the others leave them."""
    lost = [
        1 + _KEPT - value / min(limit)
        for values, limit in zip(_safeties(found), _safeties(before), strict=True)
        for value in values
    ]
    rod = scene.rod
    assert rod is not None
    short = [(smallest - getattr(rod, key)) / smallest for key, smallest in least_dimensions(rod)]
    return np.array([*lost, *short])


def _told(
    scene: Scene,
    lighter: Scene,
    before: RodStrength,
    after: RodStrength,
    names: tuple[str, ...],
    bounds: tuple[Array, Array],
) -> LighterRod:
    check_rod(lighter)
    first, last = scene.rod, lighter.rod
    dimensions = tuple(
        FreeDimension(
            name=name,
            start_mm=(start := float(getattr(first, name))),
            value_mm=float(getattr(last, name)),
            low_mm=float(low * start),
            high_mm=float(high * start),
        )
        for name, low, high in zip(names, *bounds, strict=True)
    )
    speed = max(before.speeds_rpm)
    return LighterRod(
        start_kg=before.masses.total_kg,
        result_kg=after.masses.total_kg,
        smallest_yield_safety=(min(_safeties(before)[0]), min(_safeties(after)[0])),
        smallest_fatigue_safety=(min(_safeties(before)[1]), min(_safeties(after)[1])),
        speed_rpm=speed,
        crankpin_pull_N=(_pin_pull_N(scene, speed), _pin_pull_N(lighter, speed)),
        rotating_unbalance_kg_mm=(
            before.masses.rotating_kg * scene.throw.radius_mm,
            after.masses.rotating_kg * scene.throw.radius_mm,
        ),
        dimensions=dimensions,
    )


def _pin_pull_N(scene: Scene, speed_rpm: float) -> float:
    """Largest force on the crankpin away from the crank at a speed, with the rod's rotating mass."""
    cycle = analyse(at_speed(scene, speed_rpm)).cycle
    assert cycle is not None
    return -cycle.extreme("web_force_N")[1].value
