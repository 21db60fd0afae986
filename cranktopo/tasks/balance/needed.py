"""Counterweights of each throw beside what it needs, in words: as needed, too heavy, how much is missing."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np

from cranktopo.base.units import number_text
from cranktopo.engine.balance.free_forces import NeededCounterweight
from cranktopo.engine.balance.throw import is_as_needed
from cranktopo.report.page import Fact
from cranktopo.tasks.balance.result import Balance


@dataclass(frozen=True)
class _ThrowNeed:
    """Need of the counterweights of a throw together.

    Attributes:
        kg_mm: beyond what they have, real away from the crankpin: below zero where they are too heavy.
        own_kg_mm: what they have.
    """

    throw: int
    kg_mm: complex
    own_kg_mm: float

    @property
    def as_needed(self) -> bool:
        along = self.kg_mm.real
        size = -along if -along > abs(self.kg_mm.imag) else abs(self.kg_mm)
        return is_as_needed(size, self.own_kg_mm)

    @property
    def too_heavy(self) -> bool:
        """Tell whether what is to be added points along the throw, where no counterweight is."""
        return not self.as_needed and -self.kg_mm.real > abs(self.kg_mm.imag)

    @property
    def words(self) -> str:
        if self.as_needed:
            return "as needed"
        if self.too_heavy:  # what points sideways no lighter counterweight takes away
            return f"too heavy by {number_text(-self.kg_mm.real)} kg mm"
        return f"{number_text(abs(self.kg_mm))} kg mm needed beyond what it has"


def counterweight_words(data: Balance) -> str:
    """Return in a sentence which throws have what they need or too much; empty where all lack something."""
    needs = _throw_needs(data)
    if not any(need.as_needed or need.too_heavy for need in needs):
        return ""
    throws_by_need: dict[str, list[str]] = {}
    for need in needs:
        throws_by_need.setdefault(need.words, []).append(str(need.throw))
    if len(throws_by_need) == 1:
        return f"Counterweights of each throw: {needs[0].words}."
    return f"Counterweights: {'; '.join(f'{_throws(own)} {words}' for words, own in throws_by_need.items())}."


def _throws(numbers: Sequence[str]) -> str:
    *most, last = numbers
    return f"throws {', '.join(most)} and {last}" if most else f"throw {last}"


def counterweight_fact(data: Balance) -> Fact:
    """Return the throw whose counterweights are farthest from what it needs."""
    share = data.arrangement.balanced_oscillating_share
    masses = f"its rotating{f' and {100 * share:g} % of the oscillating' if share else ''} masses"
    needs = _throw_needs(data)
    off = [need for need in needs if not need.as_needed] or needs[:1]
    worst = max(off, key=lambda need: abs(need.kg_mm))
    if worst.as_needed or worst.too_heavy:
        return Fact("Counterweights of a throw", worst.words, f"to balance {masses}", "neutral")
    size = f"{number_text(abs(worst.kg_mm))} kg mm"
    return Fact("Counterweights of a throw", size, f"to balance {masses}, beyond what it has", "neutral")


def _throw_needs(data: Balance) -> list[_ThrowNeed]:
    return [
        _throw_need(number, angle_deg, [one for one in data.counterweights if one.throw == number])
        for number, angle_deg in enumerate(data.arrangement.throw_angles_deg, start=1)
    ]


def _throw_need(throw: int, angle_deg: float, webs: Iterable[NeededCounterweight]) -> _ThrowNeed:
    """Return what the webs of a throw need together; `angle_deg` is that of the throw in the shaft."""
    found = list(webs)
    kg_mm = sum(-one.unbalance_kg_mm * np.exp(1j * np.radians(one.deg - angle_deg)) for one in found)
    return _ThrowNeed(throw, complex(kg_mm), sum(one.own_kg_mm for one in found))
