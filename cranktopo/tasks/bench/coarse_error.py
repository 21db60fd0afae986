"""Error of the coarse ring of the bench, as it was measured against settled webs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

_MOST_MM, _MOST_DEG = 5.0, 10.0
"""Largest way of a dimension from the settled web: beyond it no error is known."""
_ERROR = {"torsion": (0.3, 0.06, 1.0), "bending": (0.6, 0.15, 2.2)}
"""Percent; per percent of change by the cells; and per mm of a fillet, which the cells do not have.

Of 150 moves of one dimension of four throws more than 95 in 100 keep to it (tests.studies.coarse_ring).
"""


def stated_errors(
    first: Mapping[str, Any], moved: Mapping[str, Any], change_percent: Mapping[str, float]
) -> dict[str, float]:
    """Return the error of each stiffness that cells tell of a moved web, percent; none too far away.

    Args:
        first: tables of the design that has settled.
        change_percent: of each quantity, by the cells, since then.
    """
    found = moved_dimensions(first, moved)
    if found is None:
        return {}
    fillets_mm = sum(abs(after - before) for key, (before, after) in found.items() if "fillet" in key)
    errors = {}
    for name, change in change_percent.items():
        least, share, by_fillet = _ERROR[name.removesuffix("_per_mass")]
        errors[name] = least + share * abs(change) + by_fillet * fillets_mm
    return errors


def moved_dimensions(
    first: Mapping[str, Any], moved: Mapping[str, Any]
) -> dict[str, tuple[float, float]] | None:
    """Return what each moved dimension was and is, mm or deg; None if one is too far, or for another web."""
    before, after = (dict(_dimensions(data)) for data in (first, moved))
    if before.keys() != after.keys():
        return None
    found = {key: (before[key], after[key]) for key in before if before[key] != after[key]}
    if any(
        abs(new - old) > (_MOST_DEG if key.endswith("_deg") else _MOST_MM)
        for key, (old, new) in found.items()
    ):
        return None
    return found


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
