"""Keys of `[fatigue]` that methods take: only those are assumed, and a given one that none takes is told."""

from __future__ import annotations

from collections.abc import Sequence

from cranktopo.base.notes import note
from cranktopo.design.assumed import FATIGUE, Assumption
from cranktopo.design.material import Fatigue
from cranktopo.tasks.fatigue.criteria import safety_method

_TOLD_BY_THEMSELVES = {"hardening", "journal_hardening", "spectrum", "scatter"}
"""Tables of `[fatigue]`: a method without a use for one refuses it, or says why in a line of its own."""


def taken_keys(methods: Sequence[str]) -> set[str]:
    """Return the keys and tables of `[fatigue]` that any of some methods takes."""
    return {key for name in methods for key in safety_method(name).takes}


def assumed_by(assumptions: Sequence[Assumption], methods: Sequence[str]) -> tuple[Assumption, ...]:
    """Return the assumptions without those of `[fatigue]` that none of the methods takes."""
    taken = taken_keys(methods)
    paths = [(item, item.key.split(".")) for item in assumptions]
    return tuple(item for item, (table, key, *_) in paths if table != FATIGUE or key in taken)


def unused_keys(settings: Fatigue, methods: Sequence[str]) -> tuple[str, ...]:
    """Return the keys of `[fatigue]` that a design gives and none of the methods takes."""
    unused = _given_keys(settings) - taken_keys(methods) - _TOLD_BY_THEMSELVES
    return tuple(key for key in Fatigue.model_fields if key in unused)


def _given_keys(settings: Fatigue) -> set[str]:
    """Return the keys that a design gives; a stored scene has every key: those not at their default."""
    fields_set = settings.model_fields_set
    if not set(Fatigue.model_fields) - _TOLD_BY_THEMSELVES <= fields_set:
        return fields_set
    return {key for key, of in Fatigue.model_fields.items() if getattr(settings, key) != of.default}


def note_unused(name: str, settings: Fatigue, methods: Sequence[str]) -> None:
    """Say in one line which given keys change nothing; no line where there is none."""
    keys = ", ".join(f"fatigue.{key}" for key in unused_keys(settings, methods))
    if keys:
        by = f"method{'s' * (len(methods) > 1)} {' and '.join(repr(one) for one in methods)}"
        note(f"{name}: not used by {by}: {keys}")
