"""Error of the coarse ring of the bench, as it was measured against settled webs."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

from cranktopo.design.halves import scale_to_usual

MOST_MM, MOST_DEG = 5.0, 10.0
"""Largest way of a dimension from the settled web, in proportion on smaller journals than usual: beyond it
no error is known."""
_LEAST = {"torsion": 0.3, "bending": 0.35}
"""Percent: edges of journals and bores that move through the cells."""
_SHARES = {
    "length_mm": (0.03, 0.04),
    "bore_diameter_mm": (0.06, 0.18),
    "outer_diameter_mm": (0.06, 0.3),
    "fillet_mm": (0.45, 0.4),
    "thickness_mm": (0.06, 0.2),
    "width_mm": (0.12, 0.45),
    "half_angle_deg": (0.75, 0.75),
}
_OTHERS = 0.15, 0.45
"""Percent per percent that a stiffness changes by a dimension, in torsion and bending.

From 140 moves of one dimension of 20 throws (`tests.studies.live_ring`, 10000 to 10067 and 20000 to 20071),
with a third to spare. What moves the edge of a journal, across which cells of 4 mm bend a web, has the most.
Of a wider counterweight cells tell a change that elements do not have (moves 20223 and 20366).
"""
_BY_WAY = {"radius_mm": (0.2, 0.8)}
"""The same per percent of the dimension's own way: cells found a third of what a throw's radius does to the
bending of a hollow throw."""
_NOT_MEASURED = ("fillet_axial_mm", "recess_mm")
"""Dimensions of a fillet that were not compared."""
MOST_PERCENT = 1.0
"""Error beyond which nothing is told."""


def stated_errors(
    first: Mapping[str, Any], moved: Mapping[str, Any], change_percent: Mapping[str, float]
) -> dict[str, float]:
    """Return the error of each stiffness that cells tell of a moved web, percent, where it is small enough.

    None too far away. A stiffness per mass has the error of the stiffness, as a mass is known.

    Args:
        first: tables of the design that has settled.
        change_percent: of each stiffness, and of others per mass, by the cells, since then.
    """
    found = moved_dimensions(first, moved)
    if found is None or any(key.endswith(_NOT_MEASURED) for key in found):
        return {}
    errors = {name: _error(name.removesuffix("_per_mass"), found, change_percent) for name in change_percent}
    return {name: error for name, error in errors.items() if error <= MOST_PERCENT}


def _error(
    stiffness: str, moved: Mapping[str, tuple[float, float]], change_percent: Mapping[str, float]
) -> float:
    column, error = list(_LEAST).index(stiffness), _LEAST[stiffness]
    for key, (before, after) in moved.items():
        last = key.rpartition(".")[2]
        if last in _BY_WAY:
            error += _BY_WAY[last][column] * 100 * abs(after / before - 1)
        else:
            error += _SHARES.get(last, _OTHERS)[column] * abs(change_percent[stiffness])
    return error


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
    most_mm = MOST_MM / max(scale, 1.0)
    return any(
        abs(new - old) > (MOST_DEG if key.endswith("_deg") else most_mm) for key, (old, new) in moved.items()
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
