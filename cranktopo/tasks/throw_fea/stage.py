"""Body-fitted evaluation of several targets: by element size, or as accurate and as fast as asked for."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import Pace, note
from cranktopo.design.assumed import EVALUATED, assumed_text, filter_by_table
from cranktopo.tasks.throw_fea.evaluation import Evaluation, evaluate
from cranktopo.tasks.throw_fea.levels import ErrorTarget, evaluate_to
from cranktopo.tasks.throw_fea.result import FlyingWebResult
from cranktopo.tasks.throw_fea.studies import EVALUATION, key_of, load_study
from cranktopo.tasks.throw_fea.targets import Target, TargetLike, at_a_bearing, resolve_targets


@dataclass(frozen=True)
class MeshRequest:
    """Accuracy of an evaluation: by the size of the elements, or by accuracy and time; nothing: the default.

    Raises:
        CranktopoError: a size beside accuracy or time.
    """

    element_size_mm: float | None = None
    accuracy_percent: float | None = None
    budget_s: float | None = None

    def __post_init__(self) -> None:
        if self.element_size_mm and (self.accuracy_percent or self.budget_s):
            raise CranktopoError(
                "--element-size-mm excludes --accuracy and --budget.",
                hint="Give the size, or what it should do.",
                code=ExitCode.USAGE,
            )


@dataclass(frozen=True)
class Evaluations:
    """Evaluations in the order of their targets, and the names of those that miss the accuracy asked for."""

    evaluations: tuple[Evaluation, ...]
    missed: tuple[str, ...] = ()


def evaluate_target(target: TargetLike, request: MeshRequest | None = None) -> Evaluation:
    """Return the evaluation of one target: a target, a scene, or a path or name as the user types it.

    Raises:
        CranktopoError: no such target, no valid mesh, or a failed solve.
    """
    return evaluate_targets([target], request).evaluations[0]


def evaluate_targets(targets: Sequence[TargetLike], request: MeshRequest | None = None) -> Evaluations:
    """Evaluate targets one after the other.

    Raises:
        CranktopoError: no valid mesh, or a failed solve.
    """
    evaluations, missed = [], []
    resolved = resolve_targets(targets, whole=True)
    print_assumed(resolved, EVALUATED)
    pace = Pace("evaluation", len(resolved))
    request = request or MeshRequest()
    for target in map(at_a_bearing, resolved):
        pace.begin(target.name)
        evaluation, reached = _evaluate(target, request)
        missed += [] if reached else [f"{target.name} ({evaluation.error_percent:.2f} %)"]
        webs = _flying_webs(target, request)
        evaluations.append(replace(evaluation, flying_webs=webs))
        missed += [f"{web.name} ({web.error_percent:.2f} %)" for web in webs if _misses(web, request)]
    return Evaluations(tuple(evaluations), tuple(missed))


def _flying_webs(target: Target, request: MeshRequest) -> tuple[FlyingWebResult, ...]:
    if not target.flying:
        return ()
    from cranktopo.tasks.throw_fea.flying_web import evaluate_flying_web

    return tuple(evaluate_flying_web(web, request.element_size_mm) for web in target.flying)


def print_assumed(targets: Sequence[Target], tables: Sequence[str]) -> None:
    """Print what targets do not say and a command uses of these tables, and what plans take out of them."""
    for target in targets:
        if target.left_out:
            note(f"{target.name}: {target.left_out}")
        found = filter_by_table(target.assumed, tables)
        if found:
            note(f"{target.name}: {assumed_text(found)}")


def _misses(web: FlyingWebResult, request: MeshRequest) -> bool:
    return request.accuracy_percent is not None and web.error_percent > request.accuracy_percent


def _evaluate(target: Target, request: MeshRequest) -> tuple[Evaluation, bool]:
    if request.accuracy_percent is None and request.budget_s is None:
        return evaluate(target, request.element_size_mm), True
    measured = load_study(key_of(target), EVALUATION)
    found, reached = evaluate_to(target, ErrorTarget(request.accuracy_percent, request.budget_s), measured)
    if request.budget_s is not None and found.total_seconds > request.budget_s:
        note(f"note: {target.name}: took {found.total_seconds:.1f} s, --budget was {request.budget_s:g} s.")
    return found, reached
