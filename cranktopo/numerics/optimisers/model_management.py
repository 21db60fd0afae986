"""Search where a cheap model, corrected at the best design so far, proposes and a dear one judges.

With value and gradient of the dear model there, a corrected search that no longer moves is at an optimum of
the dear one. Where a proposal is no better than the best design, the next one stays nearer to that.

Source: N. M. Alexandrov, R. M. Lewis, Optimization and Engineering 2, 2001 (first-order model management).
"""

from __future__ import annotations

from typing import Protocol, TypeVar

_Judged = TypeVar("_Judged")
_Proposed = TypeVar("_Proposed")


class ManagedModels(Protocol[_Judged, _Proposed]):
    """The two models of a part, and what of them counts as better, settled and near."""

    def propose(self, best: _Judged, reach: float) -> _Proposed:
        """Return the best design of the cheap model, corrected at the best one, within a reach of that."""

    def settled(self, best: _Judged, proposed: _Proposed) -> bool:
        """Tell whether a proposal is not worth being judged, which ends the search."""

    def judge(self, proposed: _Proposed) -> _Judged | None:
        """Return the design by the dear model; None where that cannot tell."""

    def is_better(self, best: _Judged, proposed: _Proposed, found: _Judged) -> bool:
        """Tell whether a proposal replaces the best design, as it was judged."""

    def longer(self, reach: float) -> float:
        """Return the reach after a design that is better."""

    def shorter(self, best: _Judged, proposed: _Proposed, reach: float) -> float:
        """Return the reach after one that is not, or that could not be judged."""

    def is_near(self, best: _Judged, reach: float) -> bool:
        """Tell whether a reach after a design that was no better is too short to go on."""


def managed_search(
    models: ManagedModels[_Judged, _Proposed], best: _Judged, reach: float, rounds: int
) -> _Judged:
    """Return the best design that is judged in at most so many rounds, the given one included."""
    for _ in range(rounds):
        proposed = models.propose(best, reach)
        if models.settled(best, proposed):
            break
        found = models.judge(proposed)
        if found is not None and models.is_better(best, proposed, found):
            best, reach = found, models.longer(reach)
            continue
        reach = models.shorter(best, proposed, reach)
        if found is not None and models.is_near(best, reach):
            break
    return best
