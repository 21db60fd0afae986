"""Error of the coarse ring of the bench, as it was measured against settled webs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from cranktopo.design.halves import scale_to_usual

_MOST_MM, _MOST_DEG = 5.0, 10.0
"""Largest way of a dimension from the settled web, in proportion on smaller journals than usual: beyond it
no error is known."""
_ERROR = {"torsion": (0.3, 0.06, 1.4), "bending": (0.6, 0.15, 2.2)}
"""Percent; per percent of change by the cells; and per mm of a fillet, which the cells do not have, on
journals of usual size.

Of 150 moves of one dimension of four throws more than 95 in 100 keep to it (tests.studies.coarse_ring).
"""
_MOST_UNSEEN_PERCENT = 1.0
"""Error beyond which nothing is told where a fillet moved."""


def stated_errors(
    first: Mapping[str, Any], moved: Mapping[str, Any], change_percent: Mapping[str, float]
) -> dict[str, float]:
    """Return the error of each stiffness that cells tell of a moved web, percent.

    None too far away, and none where what the cells do not see of a fillet may be too much.

    Args:
        first: tables of the design that has settled.
        change_percent: of each quantity, by the cells, since then.
    """
    found = moved_dimensions(first, moved)
    if found is None:
        return {}
    fillets_mm = _scale(first) * sum(
        abs(after - before) for key, (before, after) in found.items() if "fillet" in key
    )
    errors = {}
    for name, change in change_percent.items():
        least, share, by_fillet = _ERROR[name.removesuffix("_per_mass")]
        unseen = least + by_fillet * fillets_mm
        if not fillets_mm or unseen <= _MOST_UNSEEN_PERCENT:
            errors[name] = unseen + share * abs(change)
    return errors


def moved_dimensions(
    first: Mapping[str, Any], moved: Mapping[str, Any]
) -> dict[str, tuple[float, float]] | None:
    """Return what each moved dimension was and is, mm or deg; None if one is too far, or for another web."""
    before, after = (dict(_dimensions(data)) for data in (first, moved))
    if before.keys() != after.keys():
        return None
    found = {key: (before[key], after[key]) for key in before if before[key] != after[key]}
    return None if found and _too_far(found, _scale(first)) else found


def _too_far(moved: Mapping[str, tuple[float, float]], scale: float) -> bool:
    most_mm = _MOST_MM / max(scale, 1.0)
    return any(
        abs(new - old) > (_MOST_DEG if key.endswith("_deg") else most_mm) for key, (old, new) in moved.items()
    )


def _scale(data: Mapping[str, Any]) -> float:
    """Return the factor that brings a throw to usual size, at which the errors were measured."""
    journals = (data["throw"][name] for name in ("main_journal", "crankpin"))
    return scale_to_usual(min(float(journal["outer_diameter_mm"]) for journal in journals))


def _dimensions(data: Any, key: str = "") -> Iterator[tuple[str, float]]:
    """Yield the numbers of throw and web by key path; words count by their letters."""
    if isinstance(data, Mapping):
        for name, value in data.items():
            if key or name in ("throw", "web", "second_web"):
                yield from _dimensions(value, f"{key}.{name}" if key else name)
    elif isinstance(data, list | tuple):
        for number, value in enumerate(data):
            yield from _dimensions(value, f"{key}[{number}]")
    elif isinstance(data, int | float):
        yield key, float(data)
    else:
        yield f"{key}={data}", 0.0
