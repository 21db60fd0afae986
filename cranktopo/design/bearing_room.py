"""Room between the fillets of a journal, in which its plain bearing is."""

from __future__ import annotations

from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.halves import halves
from cranktopo.design.schema import Scene
from cranktopo.throw.journal import Journal

BETWEEN_FILLETS = "the journal between its fillets"


def main_journals(scene: Scene, number: int) -> tuple[Journal, Journal]:
    """Return the two halves of a main journal, 0 at the free end; at an end both are that of its throw."""
    throws = throw_scenes(scene)
    before = halves(throws[number - 1])[1] if number else halves(throws[0])[0]
    behind = halves(throws[number])[0] if number < len(throws) else before
    return before.throw.main_journal, behind.throw.main_journal


def main_room_mm(scene: Scene, number: int) -> float:
    """Return the length of a main journal of the crank between its fillets, mm."""
    return _between_mm(*main_journals(scene, number))


def own_main_room_mm(scene: Scene) -> float:
    """Return the length between the fillets of a main journal between two throws of the design itself, mm."""
    first, second = halves(scene)
    return _between_mm(second.throw.main_journal, first.throw.main_journal)


def big_end_room_mm(scene: Scene) -> float:
    """Return the length of the crankpin between its fillets that each big end has, mm."""
    first, second = (half.throw.crankpin for half in halves(scene))
    return _between_mm(first, second) / scene.big_ends


def widest_big_end_mm(scene: Scene) -> tuple[float, str]:
    """Return the largest width of a big-end bearing, mm, and what it is: that of the rod, if there is one."""
    room, rod = big_end_room_mm(scene), scene.rod
    if rod is not None and rod.big_end_width_mm < room:
        return rod.big_end_width_mm, "rod.big_end_width_mm"
    return room, BETWEEN_FILLETS


def _between_mm(first: Journal, second: Journal) -> float:
    return sum(journal.length_mm / 2 - journal.fillet.reach_mm for journal in (first, second))
