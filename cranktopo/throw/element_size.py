"""Growth of the element size away from what needs fine elements, in formulae of the mesher."""

from __future__ import annotations

GROWTH = 0.5
"""Growth of the element size per mm of distance."""


def tube_term(finest_mm: float, across: str, along: str, radius_mm: float) -> str:
    """Return a formula of the largest element size around the surface of a tube, mm.

    Args:
        across, along: formulae in parentheses of the distances from its axis.
    """
    return f"{finest_mm!r}+{GROWTH!r}*Fabs(Sqrt({across}^2+{along}^2)-{radius_mm!r})"
