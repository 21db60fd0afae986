"""Webs of a shaft that are to be equal: mirror pairs, webs of one die, webs that need the same safety."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from cranktopo.base.frames import shortest_turn_deg

ALIKE_PERCENT = 2.0
"""Difference of least safeties, %, below which webs are to be equal; meshes scatter them by 0.5 %."""
_SAME_DEG = 1e-6


@dataclass(frozen=True)
class WebGroup:
    """Webs that are to be equal, by their numbers from the free end, 1 first."""

    webs: tuple[int, ...]

    @property
    def name(self) -> str:
        """Name of its folder in the run."""
        return "web-" + (f"{self.webs[0]}-to-{self.webs[-1]}" if self._row else "-".join(map(str, self.webs)))

    @property
    def words(self) -> str:
        """The webs in a sentence: `web 3`, `webs 1 and 8`."""
        *more, last = map(str, self.webs)
        if self._row:
            return f"webs {self.webs[0]} to {last}"
        return f"webs {', '.join(more)} and {last}" if more else f"web {last}"

    @property
    def _row(self) -> bool:
        """Tell whether they are many that follow each other."""
        return len(self.webs) > 2 and self.webs == tuple(range(self.webs[0], self.webs[-1] + 1))

    def least(self, safeties: Sequence[float]) -> float:
        """Return the least of safeties, one for each web of the shaft."""
        return min(safeties[web - 1] for web in self.webs)


def web_groups(
    angles_deg: Sequence[float], safeties: Sequence[float], same_webs: Sequence[Sequence[int]] = ()
) -> tuple[WebGroup, ...]:
    """Return the groups of a shaft's webs, in the order of their first web.

    Args:
        angles_deg: of the throws.
        safeties: least safety of each web where all are equal.
        same_webs: groups that are given; they stay as they are.
    """
    fixed = [WebGroup(tuple(sorted(webs))) for webs in same_webs]
    taken = {web for group in fixed for web in group.webs}
    free = [web for web in range(1, len(safeties) + 1) if web not in taken]
    twin = len(safeties) + 1 if is_mirrored(angles_deg) else 0
    pairs = {tuple(sorted({web, twin - web} & set(free))) if twin else (web,) for web in free}
    merged: list[WebGroup] = []
    for group in sorted(map(WebGroup, pairs), key=lambda one: (one.least(safeties), one.webs)):
        if merged and group.least(safeties) <= (1 + ALIKE_PERCENT / 100) * merged[-1].least(safeties):
            merged[-1] = WebGroup(tuple(sorted(merged[-1].webs + group.webs)))
        else:
            merged.append(group)
    return tuple(sorted([*fixed, *merged], key=lambda one: one.webs))


def is_mirrored(angles_deg: Sequence[float]) -> bool:
    """Tell whether a shaft is its own image in its middle: mirrored, or turned about an axis across it."""
    pairs = list(zip(angles_deg, reversed(angles_deg), strict=True))
    return any(
        all(abs(shortest_turn_deg(one + sign * other - begin)) < _SAME_DEG for one, other in pairs)
        for sign in (-1, 1)
        for begin in [pairs[0][0] + sign * pairs[0][1]]
    )
