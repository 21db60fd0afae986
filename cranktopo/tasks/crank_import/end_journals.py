"""Outermost main journals of a body: whole, or cut in their middle because the throw repeats."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.tasks.crank_import.choices import EndJournals
from cranktopo.tasks.crank_import.found_crank import FoundJournal

_ALIKE = 1e-3
"""Share in which one length is another one, or half of it."""
_Ends = tuple[bool, bool]
"""Of the low and of the high end."""


def cut_ends(
    journals: Sequence[FoundJournal], pins: int, followed: _Ends, ends: EndJournals
) -> tuple[_Ends, list[str]]:
    """Tell which ends lie in the middle of an outer main journal, and what was assumed.

    Args:
        journals: main journals, from low to high.
        pins: number of crankpins.
        followed: ends where a step of the shaft follows: the journal there is whole.
        ends: what the user says of both.
    """
    if ends != "auto":
        return (ends == "cut", ends == "cut"), []
    if len(journals) == 1 and pins == 1:
        return (True, True), []
    if len(journals) == 2 and not any(followed):
        return _of_one_throw(journals, pins)
    lengths = [one.length_mm for one in journals if not any(one.free)]
    lengths += [journals[-end].length_mm for end in (0, 1) if followed[end] and journals[-end].free[end]]
    low, high = (not followed[end] and _is_half(journals[-end], end, lengths) for end in (0, 1))
    if low and high:
        return (True, True), ["the outer main journals are half as long as an inner one: cut in their middle"]
    words = f"the {'first' if low else 'last'} main journal is half as long as another one: cut in its middle"
    return (low, high), [words] if low or high else []


def _is_half(journal: FoundJournal, end: int, lengths: Sequence[float]) -> bool:
    return journal.free[end] and any(abs(2 * journal.length_mm / length - 1) < _ALIKE for length in lengths)


def _of_one_throw(journals: Sequence[FoundJournal], pins: int) -> tuple[_Ends, list[str]]:
    """Two outer journals and no other measure: those of one throw are cut where they are alike."""
    alike = pins == 1 and abs(journals[0].length_mm / journals[1].length_mm - 1) < _ALIKE
    word = "cut in their middle, as one throw of a shaft" if alike else "whole"
    return (alike, alike), [f"the outer main journals are {word} (--end-journals says otherwise)"]
