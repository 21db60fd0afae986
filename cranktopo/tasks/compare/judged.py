"""Fatigue of compared targets: what no method can judge is left open, with the reason."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

from cranktopo.base.errors import CranktopoError
from cranktopo.base.notes import note
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import HistoryKind
from cranktopo.engine.plan.planning import plan_for_stress
from cranktopo.tasks.throw_fatigue.assessment import FatigueAssessment, FatigueMethod
from cranktopo.tasks.throw_fatigue.needs import check_inputs
from cranktopo.tasks.throw_fatigue.result import FieldFatigue
from cranktopo.tasks.throw_fatigue.stage import assess_by_methods
from cranktopo.tasks.throw_fatigue.stress_mesh import RULE_FRACTION
from cranktopo.tasks.throw_fatigue.text import FatigueComparison
from cranktopo.tasks.throw_fea.targets import Target

_Refusals = Mapping[int, CranktopoError]
"""Why targets cannot be judged, by their rows."""


def judge(
    targets: Sequence[Target],
    methods: Sequence[FatigueMethod],
    baseline: int,
    loads: HistoryKind,
    fillet_fraction: float = RULE_FRACTION,
) -> tuple[list[FatigueComparison], Scene | None]:
    """Return the fatigue of targets by each method, and the baseline's scene as it was assessed.

    Raises:
        CranktopoError: a method can judge no target, or a failed solve.
    """
    refused = {method: _refusals(targets, method, loads) for method in methods}
    for line in dict.fromkeys(line for one in refused.values() for line in _lines(targets, one, baseline)):
        note(line)
    found: dict[str, FatigueComparison] = {}
    loaded = None
    for rows, alike in _alike(refused, len(targets)).items():
        at = rows.index(baseline) if baseline in rows else None
        judged = [targets[row] for row in rows]
        for assessed in assess_by_methods(
            judged, alike, loads=loads, baseline=at, fillet_fraction=fillet_fraction, both_worlds=True
        ):
            found[assessed.method] = _compared(assessed, targets, refused[assessed.method], baseline)
            loaded = loaded if assessed.baseline is None else assessed.targets[assessed.baseline].scene
    return [found[method] for method in methods], loaded


def _refusals(targets: Sequence[Target], method: FatigueMethod, loads: HistoryKind) -> _Refusals:
    found: dict[int, CranktopoError] = {}
    for row, target in enumerate(targets):
        try:
            check_inputs(target, method, loads)
        except CranktopoError as error:
            found[row] = error
    if len(found) == len(targets):
        raise next(iter(found.values()))
    return found


def _alike(refused: Mapping[str, _Refusals], count: int) -> dict[tuple[int, ...], list[str]]:
    """Return the methods by the rows that they judge: those of the same rows share their solves."""
    found: dict[tuple[int, ...], list[str]] = {}
    for method, why in refused.items():
        found.setdefault(tuple(row for row in range(count) if row not in why), []).append(method)
    return found


def _compared(
    assessed: FatigueAssessment, targets: Sequence[Target], refused: _Refusals, baseline: int
) -> FatigueComparison:
    """Return the share of the comparison with a row for every target."""
    found = assessed.compared()
    rows = range(len(targets))
    safeties, summaries = iter(found.safeties), iter(found.summaries)
    return replace(
        found,
        safeties=tuple(None if row in refused else next(safeties) for row in rows),
        summaries=tuple(None if row in refused else next(summaries) for row in rows),
        verdicts=(*found.verdicts, *_lines(targets, refused, baseline), *_alone(found, targets)),
        not_judged={targets[row].name: error.message for row, error in refused.items()},
    )


def _alone(found: FatigueComparison, targets: Sequence[Target]) -> list[str]:
    """Return that safeties are those of throws alone; nothing where all are known in their shaft, too."""
    fields = [one for one in found.result.fatigue if isinstance(one, FieldFatigue)]
    alone = {one.target for one in fields if one.judged_as == "throw_alone" and not one.safety_as}
    if not any(one.name in alone and _has_shaft(one.scene) for one in targets):
        return []
    return [
        "Safety is that of a throw alone. A web that is as safe there can be less safe in its shaft: "
        "effects.continuous_shaft = 'on' in the designs tells both."
    ]


def _has_shaft(scene: Scene) -> bool:
    return plan_for_stress(scene)["continuous_shaft"].estimate_percent is not None


def _lines(targets: Sequence[Target], refused: _Refusals, baseline: int) -> list[str]:
    return [
        f"{targets[row].name}: safety not judged: {_reason(targets[row].name, error)}"
        + " No safety is compared with it." * (row == baseline)
        for row, error in refused.items()
    ]


def _reason(name: str, error: CranktopoError) -> str:
    return error.message.removeprefix("target ").removeprefix(f"'{name}': ").removeprefix(f"{name}: ")
