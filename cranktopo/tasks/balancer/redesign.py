"""The lightest balancer shaft within the ranges of its design: no more deflection than wanted, nothing worse.

Free are the diameters, bores and places of bearings that have a range in the scene. Bearings that the scene
proposes are added.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import at_work
from cranktopo.design.balancer import BalancerBearing, BalancerPart
from cranktopo.design.loading import value_at
from cranktopo.design.named import DesignLike, as_scene, with_values
from cranktopo.design.schema import Scene
from cranktopo.numerics.optimisers.gradient_search import by_differences, minimise, minimise_violation
from cranktopo.tasks.balancer.result import BalancerStrength, KeptLimit, Redesign, ShaftDimension
from cranktopo.tasks.balancer.stage import check_balancer, checked_part, is_thrust, strength_of

_STEP_MM, _END, _EVALUATIONS = 0.1, 1e-5, 200
"""Step of derivatives, as places along the shaft count to 0.01 mm; change over a range that ends a search."""
_DECIMALS = 3
_KEPT, _MISSED = 2e-4, 1e-4
"""Share by which a wanted limit is kept in the search, for the rounding of dimensions; share by which a limit
may be missed that is what the given shaft has: what no dimension changes has no such room."""
_CHANGING = 1e-6
"""Relative change over a range that is more than rounding; other limits would be noise to the search."""
_WALL_MM = 3.0
_PRICE = 100.0
"""Of a limit that is missed, over the mass of the given shaft: far above usual ones."""


@dataclass(frozen=True)
class _Free:
    """A free dimension of an entry of steps or bearings; one of an added bearing has no value of its own."""

    rows: Literal["step", "bearing"]
    number: int
    name: str
    own_mm: float | None
    range_mm: tuple[float, float]

    @property
    def key(self) -> str:
        return f"balancer.{self.rows}[{self.number}].{self.name}"


def redesign_balancer(design: DesignLike) -> tuple[Scene, BalancerStrength]:
    """Return the design with its lightest balancer shaft within the ranges of the scene, and its strength.

    Kept are the wanted deflection of each probe, and of the given shaft the shortest life of a bearing and
    the least safety of all notches of each kind.

    Raises:
        CranktopoError: as `check_balancer`, nothing is free, ranges that make no shaft, or no shaft within
            them keeps every limit.
    """
    scene = as_scene(design)
    before = check_balancer(scene)
    proposed = _proposed(scene)
    _check_ranges(proposed)
    task = _Task(proposed, before, tuple(_free(proposed, len(_part(scene).bearing))))
    if not task.free and not _added(scene):
        raise CranktopoError(
            f"{scene.name}: balancer: nothing is free for a redesign.",
            hint="Give free_diameter_mm or free_bore_mm of a [[balancer.step]], free_z_mm of a "
            "[[balancer.bearing]], or a [[balancer.redesign.bearing]].",
        )
    found = task.rounded(task.best())
    after = check_balancer(found)
    limits = task.limits(after)
    worst = max(limits, key=lambda limit: limit.excess, default=None)
    if worst is not None and worst.excess > _MISSED:
        raise CranktopoError(
            f"{scene.name}: no balancer shaft within the ranges keeps every limit: the nearest one has "
            f"{worst.quantity} {worst.after:.4g} {worst.unit}".rstrip()
            + f", wanted {worst.sense} {worst.limit:.4g}.",
            hint="Widen the ranges, make more dimensions free, or add a bearing.",
        )
    redesign = Redesign(
        start_kg=before.mass_kg,
        result_kg=after.mass_kg,
        added_bearings=len(after.bearings) - len(before.bearings),
        limits=limits,
        dimensions=tuple(task.dimensions(found)),
    )
    return found, after.model_copy(update={"redesign": redesign})


def changes_of(scene: Scene, strength: BalancerStrength) -> dict[str, Any]:
    """Return what a redesign changes in the text of its design, by key path; None takes a table away."""
    assert strength.redesign is not None
    bearings = _part(scene).bearing
    added = range(len(bearings) - strength.redesign.added_bearings, len(bearings))
    changes: dict[str, Any] = {
        f"balancer.bearing[{number}]": bearings[number].model_dump(mode="json", exclude_unset=True)
        for number in added
    }
    changes |= {d.key: d.value_mm for d in strength.redesign.dimensions if d.start_mm is not None}
    return {**changes, "balancer.redesign.bearing": None} if added else changes


@dataclass(frozen=True)
class _Task:
    """A search: the proposed shaft, the strength of the given one, what is free."""

    proposed: Scene
    before: BalancerStrength
    free: tuple[_Free, ...]

    def best(self) -> Array:
        """Return the free dimensions of the lightest shaft, or of the one that is nearest to the limits."""
        if not self.free:
            return np.zeros(0)

        def judged(values: Array) -> Array:
            tried = self._at(values.tolist())
            found = strength_of(tried, _part(tried))
            excess = [one.excess + (one.limit != one.before) * _KEPT for one in self.limits(found)]
            return np.array([found.mass_kg / self.before.mass_kg, *excess])

        low, high = np.array([one.range_mm for one in self.free]).T
        mass, excesses = by_differences(judged, _STEP_MM)

        def objective(shares: Array) -> tuple[float, Array]:
            value, slopes = mass(low + shares * (high - low))
            return value, slopes * (high - low)

        def every(shares: Array) -> tuple[Array, Array]:
            values, slopes = excesses(low + shares * (high - low))
            return values, slopes * (high - low)

        ends, middle = (0 * low, 0 * low + 1), 0 * low + 0.5  # a bore has no slope where there is none yet
        changing = np.flatnonzero(np.abs(every(middle)[1]).max(axis=1) > _CHANGING)

        def constraints(shares: Array) -> tuple[Array, Array]:
            values, slopes = every(shares)
            return values[changing], slopes[changing]

        with at_work("searching a balancer shaft"):
            best = minimise(objective, constraints, ends, middle, _END, _EVALUATIONS)
            if constraints(best)[0].max(initial=0.0) > _MISSED:
                count = len(changing)
                best = minimise_violation(
                    objective, constraints, count, _PRICE, ends, best, _END, _EVALUATIONS
                )
        return np.asarray(low + best * (high - low))

    def limits(self, after: BalancerStrength) -> tuple[KeptLimit, ...]:
        """Return what a shaft has to keep beside what it has."""
        return tuple(_limits(_part(self.proposed), self.before, after))

    def rounded(self, values: Array) -> Scene:
        """Return the design with these dimensions, rounded and checked."""
        rounded = zip(self.free, values, strict=True)
        return with_values(self.proposed, {one.key: round(float(v), _DECIMALS) for one, v in rounded})

    def dimensions(self, found: Scene) -> Iterator[ShaftDimension]:
        """Yield the free dimensions with their values in a design."""
        data = found.model_dump(mode="json")
        for one in self.free:
            low, high = one.range_mm
            yield ShaftDimension(
                key=one.key, start_mm=one.own_mm, value_mm=value_at(data, one.key), low_mm=low, high_mm=high
            )

    def _at(self, values: Sequence[float]) -> Scene:
        """The proposed design with these dimensions, not checked."""
        own = _part(self.proposed)
        changed: dict[str, list[Any]] = {"step": list(own.step), "bearing": list(own.bearing)}
        for one, value in zip(self.free, values, strict=True):
            rows = changed[one.rows]
            rows[one.number] = rows[one.number].model_copy(update={one.name: value})
        part = own.model_copy(update={name: tuple(rows) for name, rows in changed.items()})
        return self.proposed.model_copy(update={"balancer": part})


def _part(scene: Scene) -> BalancerPart:
    assert scene.balancer is not None
    return scene.balancer


def _proposed(scene: Scene) -> Scene:
    """The design with the bearings that its redesign adds, which are its own then."""
    part = _part(scene)
    rest = part.redesign and part.redesign.model_copy(update={"bearing": ()})
    changed = {"bearing": (*part.bearing, *_added(scene)), "redesign": rest}
    return scene.model_copy(update={"balancer": part.model_copy(update=changed)})


def _added(scene: Scene) -> tuple[BalancerBearing, ...]:
    redesign = _part(scene).redesign
    return redesign.bearing if redesign else ()


def _free(scene: Scene, own_bearings: int) -> Iterator[_Free]:
    """Yield the free dimensions of a shaft whose first bearings are not added."""
    part = _part(scene)
    for number, step in enumerate(part.step):
        for name in ("diameter_mm", "bore_mm"):
            found = getattr(step, f"free_{name}")
            if found is not None:
                yield _Free("step", number, name, getattr(step, name), found)
    for number, bearing in enumerate(part.bearing):
        if bearing.free_z_mm is not None:
            own = bearing.z_mm if number < own_bearings else None
            yield _Free("bearing", number, "z_mm", own, bearing.free_z_mm)


def _check_ranges(scene: Scene) -> None:
    """Check that every shaft of the ranges is one: the thinnest has walls, bearings stay apart and on it."""
    part = _part(scene)
    thin = []
    for number, step in enumerate(part.step):
        least, most = (
            (step.free_diameter_mm or (step.diameter_mm,))[0],
            (step.free_bore_mm or (step.bore_mm,))[-1],
        )
        if (step.free_diameter_mm or step.free_bore_mm) and least - most < 2 * _WALL_MM:
            name = "free_diameter_mm" if step.free_bore_mm is None else "free_bore_mm"
            raise scene.invalid(
                f"balancer.step[{number}].{name}",
                f"must leave a wall of {_WALL_MM:g} mm: least diameter {least:g}, largest bore {most:g} mm",
            )
        thin.append(step.model_copy(update={"diameter_mm": least, "bore_mm": most}))
    checked_part(scene.model_copy(update={"balancer": part.model_copy(update={"step": tuple(thin)})}))
    for number, bearing in enumerate(part.bearing):
        if bearing.free_z_mm is not None:
            _check_range(scene, number, bearing.free_z_mm)


def _check_range(scene: Scene, number: int, range_mm: tuple[float, float]) -> None:
    part, (low, high) = _part(scene), range_mm
    ends = _STEP_MM, part.length_mm - _STEP_MM
    key = f"balancer.bearing[{number}].free_z_mm"
    if low < ends[0] or high > ends[1]:
        raise scene.invalid(key, f"must be within {ends[0]:g} and {ends[1]:g} mm, the ends of the shaft")
    for other, bearing in enumerate(part.bearing):
        first, last = bearing.free_z_mm or (bearing.z_mm, bearing.z_mm)
        apart = last < low - 2 * _STEP_MM or first > high + 2 * _STEP_MM
        if other != number and not is_thrust(bearing) and not is_thrust(part.bearing[number]) and not apart:
            raise scene.invalid(key, f"must keep away from the bearing at {bearing.z_mm:g} mm")


def _limits(part: BalancerPart, before: BalancerStrength, after: BalancerStrength) -> Iterator[KeptLimit]:
    """Yield what a shaft has to keep, with its values before and after."""
    target_mm = part.redesign.deflection_mm if part.redesign else None
    for own, found in zip(before.probes, after.probes, strict=True):
        most = target_mm or own.permitted_mm or own.deflection_mm
        yield _limit(f"deflection of {own.name}", "mm", "<=", own.deflection_mm, found.deflection_mm, most)
    lives = [
        min((b.life_h for b in one.bearings if b.life_h is not None), default=None) for one in (before, after)
    ]
    if lives[0] is not None and lives[1] is not None:
        yield _limit("shortest life", "h", ">=", lives[0], lives[1], lives[0])
    for kind in ("running", "starting", "reversed") if before.notches else ():
        first, last = (min(getattr(n, f"{kind}_safety") for n in one.notches) for one in (before, after))
        yield _limit(f"least safety, {kind}", "", ">=", first, last, first)


def _limit(
    quantity: str, unit: str, sense: Literal["<=", ">="], before: float, after: float, limit: float
) -> KeptLimit:
    return KeptLimit(quantity=quantity, unit=unit, sense=sense, before=before, after=after, limit=limit)
