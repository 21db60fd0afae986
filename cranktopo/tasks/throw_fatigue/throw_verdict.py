"""Answer of the crankshaft rule to a whole throw: the worst of those to its webs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cranktopo.tasks.throw_fatigue.m53 import LEAST_FACTOR
from cranktopo.tasks.throw_fatigue.rule_check import VERDICTS, RuleCheck, Verdict


@dataclass(frozen=True)
class ThrowVerdict:
    """Answer to a throw.

    Attributes:
        target: name of the throw.
        verdict: the worst of its webs'.
        safety: least acceptability factor of its webs.
        reason: places that are not judged and why; else the place of the least factor and how it is found.
    """

    target: str
    verdict: Verdict
    safety: float
    reason: str = ""

    @property
    def words(self) -> str:
        """The answer with the least factor, that asked for and the reason."""
        asked = f"{self.verdict} by UR M53, least Q {self.safety:.3f}, {LEAST_FACTOR:g} asked"
        return f"{asked} ({self.reason})" if self.reason else asked


def worst_verdict(checks: Sequence[RuleCheck]) -> Verdict:
    """Return the worst answer among those to several webs."""
    return min((check.verdict for check in checks), key=VERDICTS.index)


def throw_verdict(target: str, checks: Sequence[RuleCheck]) -> ThrowVerdict:
    """Return the answer to a throw with the checks of its webs."""
    safety = min(check.safety for check in checks)
    return ThrowVerdict(target, worst_verdict(checks), safety, _reason(checks))


def _reason(checks: Sequence[RuleCheck]) -> str:
    verdict = worst_verdict(checks)
    if verdict == "not covered":
        return checks[0].not_covered
    if verdict == "not judged":
        open_ones = [(check, *one) for check in checks for one in check.not_judged.items()]
        return "; ".join(f"{_at(check, place)}: {why}" for check, place, why in open_ones)
    worst = min(checks, key=lambda check: check.safety)
    return _at(worst, worst.place_words(worst.least_place))


def _at(check: RuleCheck, place: str) -> str:
    return f"{check.web}, {place}" if check.web else place
