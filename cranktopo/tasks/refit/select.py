"""Choice of features and stations: each is kept only for the overlap that it gains.

The regions where the web cannot follow the body suggest the pockets to try.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.companion import ALONE, Companion
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.near_ties import best_first, first_of_the_best
from cranktopo.base.notes import silent
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.search import MOST, Fit, FitProblem, minimise_misfit, outline_guess, with_stations
from cranktopo.throw.fitted import FittedFeature
from cranktopo.throw.manufacturing_limits import ManufacturingLimits
from cranktopo.throw.web import FITTED_TO_REGIONS, FITTED_TO_SECTIONS

_LEAST_SHARE = 0.002
"""Least volume of a residual region that is reported, over that of the web."""
_DEEPER_CELLS = 1
"""Layers of cells taken off to tell a region from a thin layer along a fitted surface."""


@dataclass(frozen=True)
class ResidualRegion:
    """A connected region in which model and body differ, thicker than two cells.

    Attributes:
        kind: "window" (open at both web faces), "recess" (open at one face or the side), "hollow" (closed,
            or open into a bore only) where the body has a hole that the model lacks; "material" where the
            body has material that the model lacks.
        volume_mm3: on both sides of x = 0; places are those of the part at x >= 0.
        pair: it does not reach x = 0, so there is one on either side.
        face: the web face at which a recess is open, or None.
    """

    kind: Literal["window", "recess", "hollow", "material"]
    volume_mm3: float
    centre_mm: tuple[float, float, float]
    low_mm: tuple[float, float, float]
    high_mm: tuple[float, float, float]
    pair: bool
    face: Literal["journal", "pin"] | None


def residual_regions(problem: FitProblem, model: Array) -> list[ResidualRegion]:
    """Return the regions in which a model's fill differs from the body, largest first."""
    target = problem.target.filled
    found = []
    for excess, lacking in ((model - target, False), (target - model, True)):
        for region in _regions(excess > MOST):
            volume = float(2 * excess[region].sum() * np.prod(problem.target.cell_mm))
            if volume >= _LEAST_SHARE * problem.target.volume_mm3:
                found.append(_describe(problem, region, volume, lacking))
    return best_first(found, lambda region: region.volume_mm3)


def _regions(mask: Mask) -> list[Mask]:
    """Return connected parts of a mask that remain without its outer layer, each with that layer put back."""
    from scipy import ndimage

    # The mirror plane and the web faces are no surfaces of a region.
    padded = np.pad(mask, ((1, 0), (0, 0), (1, 1)), mode="edge")
    core = ndimage.binary_erosion(padded, iterations=_DEEPER_CELLS, border_value=1)[1:, :, 1:-1]
    labels, count = ndimage.label(core)
    corners = ndimage.generate_binary_structure(3, 3)
    grown = [ndimage.binary_dilation(labels == i + 1, corners, _DEEPER_CELLS) & mask for i in range(count)]
    return [region for region in grown if region.any()]


def _describe(problem: FitProblem, region: Mask, volume: float, lacking: bool) -> ResidualRegion:
    cells = problem.target
    where = np.argwhere(region)
    axes = (cells.x_mm, cells.y_mm, cells.z_mm)
    half = cells.cell_mm / 2
    low = tuple(float(axis[k] - h) for axis, k, h in zip(axes, where.min(axis=0), half, strict=True))
    high = tuple(float(axis[k] + h) for axis, k, h in zip(axes, where.max(axis=0), half, strict=True))
    centre = tuple(float(axis[where[:, i]].mean()) for i, axis in enumerate(axes))
    on_journal, on_pin = bool(region[:, :, 0].any()), bool(region[:, :, -1].any())
    kind: Literal["window", "recess", "hollow", "material"] = "hollow"
    if lacking:
        kind = "material"
    elif on_journal and on_pin:
        kind = "window"
    elif on_journal or on_pin or _open_sideways(problem, region):
        kind = "recess"
    face: Literal["journal", "pin"] | None = None
    if kind == "recess" and on_journal != on_pin:
        face = "journal" if on_journal else "pin"
    pair = bool(where[:, 0].min() > 0)
    return ResidualRegion(kind, volume, _triple(centre), _triple(low), _triple(high), pair, face)


def _open_sideways(problem: FitProblem, region: Mask) -> bool:
    """Tell whether the void reaches the outside of the body in its own plane, other than through a bore."""
    from scipy import ndimage

    void = ~problem.target.solid & (problem.free > 0.5)
    labels, _ = ndimage.label(void)
    outside = set(np.unique(labels[-1])) | set(np.unique(labels[:, 0])) | set(np.unique(labels[:, -1]))
    return bool((set(np.unique(labels[region])) & outside) - {0})


def _triple(values: tuple[float, ...]) -> tuple[float, float, float]:
    x, y, z = (round(value, 2) for value in values)
    return x, y, z


_FIRST_STATIONS = 7
_LEAST_STATIONS, _GAIN_OVER = 5, 3
"""Least number of stations, and how many numbers a gain is looked at over."""
_SHARP = 0.5
"""Half-width of the step, in cells, at which overlaps are compared."""
_MOST_POCKETS = 4


@dataclass(frozen=True)
class Candidate:
    """A web of the family on the way; the overlap of the fills leaves bores and drillings out."""

    layout: Layout
    values: Array
    overlap: float
    step: str


@dataclass(frozen=True)
class FitTrial:
    """One row of the table of what was tried; the gain is in percentage points against the web before."""

    step: str
    parameters: int
    iou_percent: float
    gain_percent: float
    kept: bool


def searches(limits: ManufacturingLimits) -> int:
    """Return about how many searches a selection takes: pockets depend on what the body lacks."""
    features = sum(map(len, FITTED_TO_SECTIONS)) + _MOST_POCKETS * len(FITTED_TO_REGIONS)
    return 1 + features + limits.max_stations - _LEAST_STATIONS + 1


class FitTask(NamedTuple):
    """A search from an initial guess, and its name in the table of what was tried."""

    layout: Layout
    guess: Array
    step: str


def fits_from(problem: FitProblem, tasks: Sequence[FitTask], beside: Companion) -> list[Candidate | None]:
    """Return one search from each initial guess, every second one in the second process.

    An entry is None where a search finds nothing that keeps the limits.
    """
    others = [beside.begin(_fit_silently, problem, task) for task in tasks[1::2]]
    found = []
    for i, task in enumerate(tasks):
        problem.pace.begin(task.step)
        found.append(others[i // 2]() if i % 2 else fit_from(problem, task))
    return found


def _fit_silently(problem: FitProblem, task: FitTask) -> Candidate | None:
    with silent():
        return fit_from(problem, task)


def fit_from(problem: FitProblem, task: FitTask) -> Candidate | None:
    """Return one search from one initial guess; None where it finds nothing that keeps the limits."""
    cell = float(problem.target.cell_mm[0])
    fit = Fit(problem, task.layout)
    values, error = minimise_misfit(fit, task.guess, (2 * cell, cell, cell / 2), task.step)
    if not np.isfinite(error):
        return None
    return Candidate(task.layout, values, float(fit.overlap(values, _SHARP * cell)), task.step)


def select(problem: FitProblem, beside: Companion = ALONE) -> tuple[Candidate, tuple[FitTrial, ...]]:
    """Return the web in which every parameter gains enough overlap, and all trials in their order.

    Args:
        beside: a second process, which takes a part of the searches that do not need each other.

    Raises:
        CranktopoError: not even the plain outline keeps the limits.
    """
    outline = FitTask(Layout(_FIRST_STATIONS), outline_guess(problem, _FIRST_STATIONS), "outline")
    (best,) = fits_from(problem, [outline], beside)
    if best is None:
        raise CranktopoError(
            "remodel: no outline keeps the manufacturing limits.",
            hint="Lower the least wall or the least radius.",
            code=ExitCode.CRITERION_NOT_MET,
        )
    trials = [_trial(best, 0.0, True)]
    best = _features(problem, best, trials, beside)
    best = _stations(problem, best, trials, beside)
    return best, tuple(trials)


def _features(problem: FitProblem, best: Candidate, trials: list[FitTrial], beside: Companion) -> Candidate:
    for group in FITTED_TO_SECTIONS:
        manufactured = (part.manufactured(problem.limits) for part in group)
        possible = (part for part in manufactured if part is not None and part.possible(problem.scene))
        guesses = ((part, part.guess(problem.target, problem.scene, problem.limits)) for part in possible)
        choices = [(part, guess) for part, guess in guesses if guess is not None]
        best = _try(problem, best, choices, trials, beside)
    for _ in range(_MOST_POCKETS):
        before = best
        for choice in _pockets(problem, best):
            best = _try(problem, best, [choice], trials, beside)
            if best is not before:
                break
        if best is before:
            break
    return best


def _try(
    problem: FitProblem,
    best: Candidate,
    choices: Sequence[tuple[FittedFeature, Array]],
    trials: list[FitTrial],
    beside: Companion,
) -> Candidate:
    layouts = [replace(best.layout, parts=(*best.layout.parts, part)) for part, _ in choices]
    tasks = [
        FitTask(layout, np.concatenate([best.values, guess]), part.label)
        for layout, (part, guess) in zip(layouts, choices, strict=True)
    ]
    found = [fitted for fitted in fits_from(problem, tasks, beside) if fitted is not None]
    chosen = first_of_the_best([best, *found], _overlap)
    if 100 * (chosen.overlap - best.overlap) < problem.limits.least_gain_percent:
        chosen = best
    trials += [_trial(fitted, fitted.overlap - best.overlap, fitted is chosen) for fitted in found]
    return chosen


def _pockets(problem: FitProblem, best: Candidate) -> Iterator[tuple[FittedFeature, Array]]:
    """Return the features that could take out what the body lacks, largest region first."""
    for region in residual_regions(problem, model_fill(problem, best)):
        for kind in FITTED_TO_REGIONS if region.kind != "material" else ():
            found = kind.in_region(region)
            part = None if found is None else found.manufactured(problem.limits)
            if part is not None:
                yield part, part.guess(region, problem.scene.web_z_mm)


def _stations(problem: FitProblem, best: Candidate, trials: list[FitTrial], beside: Companion) -> Candidate:
    """Return the fewest stations that come within the least gain of the most that any number tried reaches.

    Numbers are tried upwards until another two bring less than the least gain.
    """
    numbers = range(_LEAST_STATIONS, problem.limits.max_stations + 1)
    tasks = [
        FitTask(
            replace(best.layout, stations=stations),
            with_stations(best.layout, best.values, stations),
            f"{stations} stations",
        )
        for stations in numbers
    ]
    tried: list[Candidate] = []
    # Three are needed in any case; the further ones are tried one by one.
    for some in (tasks[:_GAIN_OVER], *([task] for task in tasks[_GAIN_OVER:])):
        tried += [found for found in fits_from(problem, some, beside) if found is not None]
        if len(tried) >= _GAIN_OVER and tried[-1].overlap - tried[-_GAIN_OVER].overlap < _least(problem):
            break
    chosen = best
    if tried:
        chosen = first_of_the_best(tried, _overlap, within=_least(problem))
    for i, found in enumerate(tried):
        gain = found.overlap - tried[i - 1].overlap if i else 0.0
        trials.append(_trial(found, gain, found is chosen))
    return chosen


def _overlap(candidate: Candidate) -> float:
    return candidate.overlap


def _least(problem: FitProblem) -> float:
    return problem.limits.least_gain_percent / 100


def model_fill(problem: FitProblem, candidate: Candidate) -> Array:
    """Return the fill of the cells by a candidate, bores and drillings cut out, (nx, ny, nz) in [0, 1]."""
    sharp = _SHARP * float(problem.target.cell_mm[0])
    return Fit(problem, candidate.layout).fill(candidate.values, sharp)


def _trial(candidate: Candidate, gain: float, kept: bool) -> FitTrial:
    return FitTrial(candidate.step, len(candidate.values), 100 * candidate.overlap, 100 * gain, kept)
