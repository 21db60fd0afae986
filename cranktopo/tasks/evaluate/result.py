"""JSON of `evaluate`: each target, and what a millimetre of its dimensions is worth."""

from __future__ import annotations

from cranktopo.base.result import UNLESS_NONE, Result
from cranktopo.tasks.throw_fea.result import EvaluationResult
from cranktopo.tasks.web_shape.result import SensitivityTable


class WebSensitivities(SensitivityTable):
    """Worth of a millimetre of each dimension, and the rules that the web breaks as it is."""

    broken_rules: tuple[str, ...]


class TargetEvaluation(EvaluationResult):
    """The evaluation of one target, with its sensitivities where requested."""

    sensitivities: WebSensitivities | None = UNLESS_NONE


class EvaluationList(Result):
    """Evaluated targets, in the order in which they were given."""

    schema_version: int = 1
    evaluations: tuple[TargetEvaluation, ...]
