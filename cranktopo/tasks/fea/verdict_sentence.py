"""How a web compares with another in one sentence: what got worse is said first."""

from __future__ import annotations

from collections.abc import Mapping

from cranktopo.tasks.fea.quantities import BENDING, MASS, TORSION, Quantity

NOTICEABLE_PERCENT = 0.05
"""Changes below half of the last printed digit are none."""
_WORDS: dict[Quantity, tuple[str, str]] = {
    MASS: ("heavier", "lighter"),
    TORSION: ("stiffer in torsion", "softer in torsion"),
    BENDING: ("stiffer in bending", "softer in bending"),
}


def comparison_sentence(subject: str, changes_percent: Mapping[Quantity, float], reference: str) -> str:
    """`subject` against `reference`, of mass and both stiffnesses, with what got worse in front."""
    worse = [_words(q, v) for q, v in changes_percent.items() if q.better * v < -NOTICEABLE_PERCENT]
    better = [_words(q, v) for q, v in changes_percent.items() if q.better * v > NOTICEABLE_PERCENT]
    if not worse and not better:
        return f"{subject} is like {reference}."
    first, rest = (worse, better) if worse else (better, [])
    return f"{subject} is {_joined(first)} than {reference}" + (f"; it is {_joined(rest)}." if rest else ".")


def worse_line(changes_percent: Mapping[Quantity, float], reference: str) -> str:
    """Return what got worse, for the terminal; empty where nothing did."""
    worse = [_words(q, v) for q, v in changes_percent.items() if q.better * v < -NOTICEABLE_PERCENT]
    return f"worse than {reference}: {_joined(worse)}" if worse else ""


def percent_change(now: float, before: float) -> float:
    """By how much a value differs from another, %."""
    return 100 * (now / before - 1)


def _words(quantity: Quantity, percent: float) -> str:
    return f"{abs(percent):.1f} % {_WORDS[quantity][percent < 0]}"


def _joined(parts: list[str]) -> str:
    return f"{', '.join(parts[:-1])} and {parts[-1]}" if len(parts) > 1 else parts[0]
