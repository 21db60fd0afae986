"""Life by a spectrum of speeds: rainflow cycles of every throw at every speed, damage summed by Miner's rule.

Source: FKM guideline, chapter 4.4: slope and knee of the S-N line, damage sum; Haibach's slope 2 k - 1 below
the fatigue limit, where some cycle exceeds it. Where none does, life has no limit. pyLife (Bosch Research,
Apache-2) counts the cycles.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.base.errors import packages_of
from cranktopo.design.material import Spectrum
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.engine.histories import LoadHistory, throw_histories
from cranktopo.tasks.fatigue.criterion import FatigueCriterion, LocalStress, SafetyMethod
from cranktopo.tasks.fatigue.superposition import signed_von_mises, signed_von_mises_range
from cranktopo.tasks.throw_fatigue.result import PartLife
from cranktopo.tasks.throw_fatigue.stress_model import StressModel

_CANDIDATES = 25
"""Points of a part that are followed: those of least safety, which the damage of a cycle is steepest in."""
PointJudge = Callable[[LocalStress, Index], Array]
"""Safety of some surface nodes of a model, (n,) each."""
UnitLoads = Callable[[LoadHistory], Array]
"""Factor of each unit field in each state, (states, fields)."""


@dataclass(frozen=True)
class _SpectrumSpeed:
    """A speed of the spectrum.

    Attributes:
        cycles_per_hour: working cycles in an hour of the spectrum.
        names: of the throws in words.
        loads: of each throw, factors of the unit fields in its states, (states, fields).
    """

    cycles_per_hour: float
    names: tuple[str, ...]
    loads: tuple[Array, ...]


def load_rainflow() -> Any:
    """Return what counts the cycles, of pyLife; raises CranktopoError with the line that installs it."""
    with packages_of("fatigue"):
        from pylife.stress import rainflow
    return rainflow


def counts_lives(scene: Scene, method: SafetyMethod) -> bool:
    """Tell whether the scene has a spectrum and the method judges the single cycles of it."""
    return scene.fatigue.spectrum is not None and isinstance(method, FatigueCriterion)


def speed_histories(scene: Scene, enabled: frozenset[str]) -> list[list[LoadHistory]]:
    """Return the cycles of all throws at each speed of the spectrum, by the effects that count.

    Raises:
        CranktopoError: the scene has no cylinder pressure to follow.
    """
    spectrum, engine = scene.fatigue.spectrum, engine_of(scene)
    assert spectrum is not None
    speeds = [engine.model_copy(update={"speed_rpm": step.rpm}) for step in spectrum.step]
    return [throw_histories(scene.model_copy(update={"engine": speed}), enabled) for speed in speeds]


def part_lives(
    model: StressModel,
    safety: Array,
    judge: PointJudge,
    unit_loads: UnitLoads,
    histories: Sequence[Sequence[LoadHistory]],
) -> dict[str, PartLife]:
    """Return the life of the point of each part of the surface that lives shortest.

    Args:
        safety: of each node of each image by the states of the assessment, (images, n).
        histories: of all throws at each speed of the spectrum.
    """
    steps = _steps(model.scene, unit_loads, histories)
    return {name: _life(model, safety, judge, steps, nodes) for name, nodes in model.parts.items()}


def _steps(
    scene: Scene, unit_loads: UnitLoads, histories: Sequence[Sequence[LoadHistory]]
) -> list[_SpectrumSpeed]:
    """Return the speeds of a spectrum with the loads of every throw."""
    spectrum, turns = scene.fatigue.spectrum, engine_of(scene).cycle_deg / 360
    assert spectrum is not None
    total = sum(step.share for step in spectrum.step)
    return [
        _SpectrumSpeed(
            60 * step.rpm / turns * step.share / total,
            tuple(one.labels[0].rpartition(", ")[0] for one in throws),
            tuple(unit_loads(one) for one in throws),
        )
        for step, throws in zip(spectrum.step, histories, strict=True)
    ]


def _life(
    model: StressModel,
    safety: Array,
    judge: PointJudge,
    steps: Sequence[_SpectrumSpeed],
    nodes: NDArray[np.bool_],
) -> PartLife:
    """Return the shortest life of a part: of its points, and of the throws at each of them."""
    spectrum = model.scene.fatigue.spectrum
    assert spectrum is not None
    among = np.where(nodes, safety, np.inf)
    order = among.argsort(axis=None, kind="stable")[: min(_CANDIDATES, np.isfinite(among).sum())]
    points = [(int(i), int(n)) for i, n in zip(*np.unravel_index(order, safety.shape), strict=True)]
    damage = np.stack([_damage_per_hour(model, *point, judge, steps, spectrum) for point in points])
    point, throw = np.unravel_index(int(damage.sum(axis=2).argmax()), damage.shape[:2])
    worst = damage[point, throw]
    total = float(worst.sum())
    if total == 0.0:
        return PartLife(life_hours=None, throw=None, damage_shares={})
    shares: dict[str, float] = {}
    for step, part in zip(spectrum.step, worst, strict=True):
        shares[f"{step.rpm:g}"] = shares.get(f"{step.rpm:g}", 0.0) + float(part) / total
    return PartLife(
        life_hours=spectrum.permitted_damage / total, throw=steps[0].names[throw], damage_shares=shares
    )


def _damage_per_hour(
    model: StressModel,
    image: int,
    node: int,
    judge: PointJudge,
    steps: Sequence[_SpectrumSpeed],
    spectrum: Spectrum,
) -> Array:
    """Return the damage of a surface node in an hour by each throw and step, (throws, steps).

    None where no cycle of the throw exceeds the fatigue limit, at any speed.
    """
    at, signs = slice(node, node + 1), model.images[image].signs
    found = replace(
        model.stress,
        stress_MPa=model.stress.stress_MPa[:, at],
        depth_MPa_per_mm=model.stress.depth_MPa_per_mm[:, at],
    )
    amplitude, mean, gradient, owner = list[Array](), list[Array](), list[Array](), list[Array]()
    shape = len(steps[0].loads), len(steps)
    for throw, step in np.ndindex(shape):
        loads = steps[step].loads[throw] * signs
        loops = rainflow(signed_von_mises(np.einsum("sf,fc->sc", loads, found.stress_MPa[:, 0])))
        amplitude.append(loops[0])
        mean.append(loops[1])
        gradient.append(np.full(len(loops[0]), signed_von_mises_range(found, loads).local.gradient_per_mm[0]))
        owner.append(np.full(len(loops[0]), throw * len(steps) + step))
    local = LocalStress(np.concatenate(amplitude), np.concatenate(mean), np.concatenate(gradient))
    owners = np.concatenate(owner).astype(np.intp)
    safety, least = judge(local, np.full(len(owners), node)), np.full(shape[0], np.inf)
    np.minimum.at(least, owners // len(steps), safety)
    each = damage(safety, spectrum)
    per_cycle = np.bincount(owners, weights=each, minlength=shape[0] * shape[1]).reshape(shape)
    per_cycle[least >= 1] = 0.0  # nothing has begun that smaller cycles would carry on
    return np.asarray(per_cycle * np.array([step.cycles_per_hour for step in steps]))


def rainflow(stress_MPa: Array) -> tuple[Array, Array]:
    """Return amplitude and mean of the cycles in one period of a stress that repeats, (cycles,) each."""
    rules = load_rainflow()
    first = int(stress_MPa.argmax())
    period = np.concatenate([stress_MPa[first:], stress_MPa[: first + 1]])
    recorder = rules.LoopValueRecorder()
    rules.FourPointDetector(recorder=recorder).process(period, flush=True)
    ends = np.array([recorder.values_from, recorder.values_to], dtype=float).reshape(2, -1)
    ends = np.append(ends, [[period.max()], [period.min()]], axis=1)  # from the largest value and back to it
    return np.abs(ends[0] - ends[1]) / 2, ends.mean(axis=0)


def damage(safety: Array, spectrum: Spectrum) -> Array:
    """Return the damage of single cycles by the safety of each against the fatigue limit, (n,)."""
    slope = np.where(safety < 1, spectrum.slope, 2 * spectrum.slope - 1)
    return np.asarray(safety**-slope / spectrum.knee_cycles)
