"""Errors of the rungs, which of them are worth climbing, and which one to take for an accuracy."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

from cranktopo.accuracy.extrapolation import Limit, extrapolate, observed_order
from cranktopo.accuracy.level import Level, StudyName
from cranktopo.accuracy.study import Study

SCHEMA_VERSION = 1
WANTED_PERCENT = (5.0, 2.0, 1.0, 0.5)
_LADDERS: tuple[StudyName, ...] = ("judge", "fillet stress", "optimiser")
_REFERENCES = {"judge": ("graded", "uniform"), "fillet stress": ("fillet",), "optimiser": ("cells",)}
"""Families that a ladder's limit is extrapolated from, the first one that has two rungs."""


@dataclass(frozen=True)
class LevelError:
    """A rung with its errors.

    Attributes:
        rung: the rung.
        errors_percent: of each value against the ladder's limit.
        model_errors_percent: of the optimiser's own stiffnesses against the judge's, of the same shape.
        orders: observed order of convergence up to this rung in its family, by value.
        error_percent: largest of all errors, without sign; None where there is no limit.
        uncertainty_percent: of the limit that it was measured against, or of the judge's word on its shape.
        efficient: no cheaper rung of the ladder has a smaller error.
    """

    rung: Level
    errors_percent: dict[str, float]
    model_errors_percent: dict[str, float]
    orders: dict[str, float | None]
    error_percent: float | None
    uncertainty_percent: float | None
    efficient: bool = False

    @property
    def bound_percent(self) -> float | None:
        """Error that the rung surely does not exceed: its own and what is uncertain of the limit."""
        if self.error_percent is None or self.uncertainty_percent is None:
            return None
        return self.error_percent + self.uncertainty_percent

    def as_json(self) -> dict[str, Any]:
        """The rung as an entry of `accuracy --json`."""
        rung = self.rung
        return {
            "ladder": rung.ladder,
            "name": rung.name,
            "family": rung.family,
            "settings": rung.settings,
            "unknowns": rung.unknowns,
            "seconds": rung.seconds,
            "compile_seconds": rung.compile_seconds,
            "peak_memory_MiB": rung.peak_memory_MiB,
            **rung.values,
            "model": rung.model,
            "errors_percent": self.errors_percent,
            "model_errors_percent": self.model_errors_percent,
            "orders": self.orders,
            "error_percent": self.error_percent,
            "uncertainty_percent": self.uncertainty_percent,
            "efficient": self.efficient,
        }


@dataclass(frozen=True)
class ParetoFront:
    """What each accuracy costs on a design.

    Attributes:
        ascent: the rungs as measured.
        limits: extrapolated values by ladder and value.
        rungs: with their errors.
    """

    ascent: Study
    limits: dict[str, dict[str, Limit]]
    rungs: tuple[LevelError, ...]

    def cheapest(self, ladder: StudyName, percent: float) -> LevelError | None:
        """The cheapest rung of a ladder whose error is surely below a percentage.

        Args:
            ladder: its name.
            percent: the wanted error.
        """
        fit = [
            placed
            for placed in self.rungs
            if placed.rung.ladder == ladder
            and placed.bound_percent is not None
            and placed.bound_percent <= percent
        ]
        return min(fit, key=lambda placed: placed.rung.seconds, default=None)

    def as_json(self) -> dict[str, Any]:
        """The frontier as `accuracy --json` prints it and accuracy.json holds it."""
        ascent = self.ascent
        return {
            "schema_version": SCHEMA_VERSION,
            "design": ascent.design,
            "budget_s": ascent.budget_s,
            "spent_s": ascent.spent_s,
            "interrupted": ascent.interrupted,
            "machine": ascent.machine.as_json(),
            "limits": {
                ladder: {
                    name: {
                        "value": limit.value,
                        "uncertainty_percent": limit.uncertainty_percent,
                        "order": limit.order,
                    }
                    for name, limit in limits.items()
                }
                for ladder, limits in self.limits.items()
            },
            "rungs": [placed.as_json() for placed in self.rungs],
            "recommendations": self._recommendations(),
            "failures": list(ascent.failures),
        }

    def _recommendations(self) -> list[dict[str, Any]]:
        rows = []
        for ladder in (name for name in _LADDERS if name in self.limits):
            for percent in WANTED_PERCENT:
                found = self.cheapest(ladder, percent)
                rows.append(
                    {
                        "ladder": ladder,
                        "accuracy_percent": percent,
                        "rung": found.rung.name if found else None,
                        "seconds": found.rung.seconds if found else None,
                    }
                )
        return rows


def pareto_front(ascent: Study) -> ParetoFront:
    """Errors, orders and the efficient rungs of an ascent.

    Args:
        ascent: the rungs as measured.
    """
    limits: dict[str, dict[str, Limit]] = {}
    placed: list[LevelError] = []
    for ladder in _LADDERS:
        rungs = [rung for rung in ascent.rungs if rung.ladder == ladder]
        if not rungs:
            continue
        limits[ladder] = _limits(ladder, rungs)
        placed += _efficient([_placed(rung, rungs, limits[ladder]) for rung in rungs])
    return ParetoFront(ascent, limits, tuple(placed))


def _limits(ladder: StudyName, rungs: Sequence[Level]) -> dict[str, Limit]:
    for family in _REFERENCES[ladder]:
        chosen = _family(rungs, family)
        if len(chosen) > 1:
            sizes = [rung.size_mm for rung in chosen]
            found = {name: extrapolate(sizes, [r.values[name] for r in chosen]) for name in chosen[0].values}
            return {name: limit for name, limit in found.items() if limit is not None}
    return {}


def _family(rungs: Sequence[Level], family: str) -> list[Level]:
    """Rungs of a family that found something, coarsest first."""
    return sorted((r for r in rungs if r.family == family and r.values), key=lambda r: -r.size_mm)


def _placed(rung: Level, rungs: Sequence[Level], limits: dict[str, Limit]) -> LevelError:
    errors = {name: limits[name].error_percent(v) for name, v in rung.values.items() if name in limits}
    own = {
        name: 100 * (value / rung.values[name] - 1)
        for name, value in rung.model.items()
        if name in rung.values
    }
    every = [abs(error) for error in (*errors.values(), *own.values())]
    band = [max(limits[name].uncertainty_percent, rung.band_percent) for name in errors]
    return LevelError(
        rung,
        errors,
        own,
        _orders(rung, rungs),
        max(every) if errors else None,
        max(band) if band else None,
    )


def _orders(rung: Level, rungs: Sequence[Level]) -> dict[str, float | None]:
    """Observed orders over a rung and the two coarser ones of its family."""
    row = [r for r in _family(rungs, rung.family) if r.size_mm >= rung.size_mm][-3:]
    if len(row) < 3 or not rung.values:
        return {}
    sizes = [r.size_mm for r in row]
    return {name: observed_order(sizes, [r.values[name] for r in row]) for name in rung.values}


def _efficient(placed: list[LevelError]) -> list[LevelError]:
    """The same rungs, those marked that no cheaper one beats."""

    def beaten(this: LevelError) -> bool:
        return this.error_percent is None or any(
            other.rung.seconds < this.rung.seconds
            and other.error_percent is not None
            and other.error_percent <= this.error_percent
            for other in placed
        )

    return [replace(this, efficient=not beaten(this)) for this in placed]
