"""The points of a sweep: each a pure function of its scene and of how far it goes."""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, cast

from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import plain_number
from cranktopo.design.goal.balance_moved import FELT_PERCENT
from cranktopo.design.loading import scene_from_dict, with_value
from cranktopo.design.pitch import SAME_PITCH_MM, lengths_at_pitch
from cranktopo.design.scene_files import input_files
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.runs.manifest import file_hash, settings_hash
from cranktopo.tasks.sweep.fineness import Fineness
from cranktopo.tasks.sweep.plan import OPTIMISED, Stage, SweepPlan
from cranktopo.tasks.sweep.variation import STAGE, Value
from cranktopo.tasks.throw_fatigue.needs import alone_left_off

_ID_LETTERS = 12
_LENGTHS = ("thickness_mm", "length_mm")
"""Ends of the keys on which the distance of throws depends."""


@dataclass(frozen=True)
class SweepPoint:
    """One point, whether it can be made or not.

    Attributes:
        id: beginning of the SHA-256 over scene and settings: the name of its directory.
        tables: the tables of its scene as they would be written.
        reason: why no such web can be; empty where it can.
        pitch_mm: distance of its throws; 0 where no such web can be.
        balance_percent: what its throw balances of the oscillating mass; None without counterweights.
    """

    id: str
    sha256: str
    stage: Stage
    varied: Mapping[str, Value]
    design: str
    tables: Mapping[str, Any]
    fineness: Fineness
    reason: str = ""
    pitch_mm: float = 0.0
    balance_percent: float | None = None


def points_of(
    plan: SweepPlan, settings: Mapping[str, Any] | None = None, fineness: Fineness | None = None
) -> tuple[SweepPoint, ...]:
    """Return the points of a plan in order, those that are the same only once.

    `settings` are what results depend on beside scene, stage and fineness, by default that of the plan.
    """
    found: dict[str, SweepPoint] = {}
    for design, tables in zip(plan.designs, plan.tables, strict=True):
        for varied in _varied_values(plan):
            point = _point(plan, design, tables, varied, settings or {}, fineness or plan.fineness)
            found.setdefault(point.sha256, point)
    return tuple(found.values())


def original_of(plan: SweepPlan, settings: Mapping[str, Any] | None = None) -> SweepPoint:
    """Return the first design as it is, evaluated as far as the points are: what they are compared with.

    Beside surfaces of runs alone, which have no fillets, it is without them.
    """
    stage: Stage = "fatigue" if {"fatigue", "shape"} & set(plan.stages) else "evaluate"
    tables = plan.tables[0]
    if set(plan.stages) == {"optimise"}:
        tables = with_value(tables, "effects.fillets", "off")
    original = plan.model_copy(update={"stage": stage})
    return _point(original, plan.designs[0], tables, {}, settings or {}, plan.fineness)


def _varied_values(plan: SweepPlan) -> Iterator[dict[str, Value]]:
    keys = [variation.key for variation in plan.vary]
    if plan.sampling == "grid":
        for values in itertools.product(*(variation.values for variation in plan.vary)):
            yield dict(zip(keys, values, strict=True))
        return
    for shares in _samples(plan):
        yield {v.key: v.at(share) for v, share in zip(plan.vary, shares, strict=True)}


def _samples(plan: SweepPlan) -> Sequence[Sequence[float]]:
    """Return points of the unit cube; a Sobol sequence is drawn up to a power of two and cut."""
    from scipy.stats import qmc

    count, dimensions = plan.samples or 1, len(plan.vary)
    if plan.sampling == "latin":
        drawn = qmc.LatinHypercube(dimensions, rng=plan.seed).random(count)
    else:
        drawn = qmc.Sobol(dimensions, rng=plan.seed).random_base2(math.ceil(math.log2(count)))[:count]
    return cast("list[list[float]]", drawn.tolist())


def _decisive_data(scene: Scene) -> dict[str, Any]:
    """Return what of a scene decides its results: no words on where the material's values come from."""
    return scene.model_dump(mode="json", exclude_defaults=True, exclude={"material": {"source"}})


def _point(
    plan: SweepPlan,
    design: str,
    tables: dict[str, Any],
    varied: Mapping[str, Value],
    settings: Mapping[str, Any],
    fineness: Fineness,
) -> SweepPoint:
    own, stage = tables, cast(Stage, varied.get(STAGE, plan.stage))
    for key, value in varied.items():
        if key != STAGE:
            tables = with_value(tables, key, value)
    whole = stage not in OPTIMISED
    scene, reason = _scene(tables, design, whole)
    if scene is not None and varied and plan.keep == "pitch":
        tables = _with_pitch(tables, scene, scene_from_dict(own, design, whole=True).pitch_mm)
        scene, reason = _scene(tables, design, whole)
    files = {} if scene is None else {role: file_hash(path) for role, path in input_files(scene).items()}
    known = {STAGE: stage, **fineness.settings(), "files": files, **settings}
    # without what is as by default, so that keys that a later version adds leave the hash as it is
    decisive = tables if scene is None else _decisive_data(scene)
    sha256 = settings_hash(decisive, known)
    pitch_mm = 0.0 if scene is None else scene.pitch_mm
    id_, balance = sha256[:_ID_LETTERS], None if scene is None else _balance_percent(scene)
    return SweepPoint(id_, sha256, stage, dict(varied), design, tables, fineness, reason, pitch_mm, balance)


def _balance_percent(scene: Scene) -> float | None:
    return throw_balance(scene).balance_factor_percent if scene.web.counterweight is not None else None


def left_off_lines(points: Sequence[SweepPoint]) -> list[str]:
    """Return of every design the loads that its safeties leave out although they are above the threshold.

    The first of its points with the same effects tells the sizes; points without a safety tell nothing.
    """
    found: dict[str, Scene] = {}
    for point in points:
        if point.stage in ("fatigue", "shape") and not point.reason:
            effects = sorted(dict(point.tables.get("effects", {})).items())
            key = f"{point.design} {effects}"
            if key not in found:
                found[key] = scene_from_dict(dict(point.tables), point.design, whole=True)
    missing_loads = ((scene.name, alone_left_off(scene)) for scene in found.values())
    return list(dict.fromkeys(f"{name}: {missing}" for name, missing in missing_loads if missing))


def balance_line(plan: SweepPlan, points: Sequence[SweepPoint]) -> str:
    """Return a line where points are not balanced as the original with its counterweights, or nothing."""
    found = [one.balance_percent for one in points if one.balance_percent is not None]
    own = _balance_percent(plan.original)
    if own is None or not found or max(own - min(found), max(found) - own) < FELT_PERCENT:
        return ""
    factors = " to ".join(dict.fromkeys(plain_number(percent, 3) for percent in (min(found), max(found))))
    return (
        f"balance factors of {factors} % of the oscillating mass, the original has {plain_number(own, 3)} %: "
        "no counterweight follows a web that varies, so points differ by their balance too"
    )


def pitch_line(plan: SweepPlan, points: Sequence[SweepPoint]) -> str:
    """Return a line where throws of points are not as far apart as the original's; empty where all are."""
    if not any(variation.key.endswith(_LENGTHS) for variation in plan.vary):
        return ""
    found = [point.pitch_mm for point in points if not point.reason]
    own, low, high = plan.original.pitch_mm, min(found, default=0.0), max(found, default=0.0)
    if not found or max(own - low, high - own) < SAME_PITCH_MM:
        return ""
    pitches = " to ".join(dict.fromkeys(plain_number(mm, 6) for mm in (low, high)))
    return (
        f"pitch of the throws {pitches} mm, the original has {plain_number(own, 6)} mm: the length of the "
        "engine changes; --keep pitch takes it from the main journals"
    )


def _with_pitch(tables: dict[str, Any], scene: Scene, pitch_mm: float) -> dict[str, Any]:
    """Return the tables of a scene with main journals so long that its throws are so far apart."""
    for key, length in lengths_at_pitch(scene, pitch_mm).items():
        tables = with_value(tables, key, length)
    return tables


def _scene(tables: dict[str, Any], design: str, whole: bool) -> tuple[Scene | None, str]:
    try:
        return scene_from_dict(tables, design, whole=whole), ""
    except CranktopoError as error:
        return None, str(error)
