"""Least member and least gap: the thresholds of the projection, and the filter radius that they need.

A plate of design variables has its largest filtered density in its middle. While that is below the threshold
of the eroded design, the plate is not there, has no stiffness, and an optimiser does not make it: the least
member is the width that the nominal design has when the eroded one is about to vanish. Rods and balls vanish
earlier, so that a plate decides. Gaps are the same with void and the dilated design.

Source: F. Wang, B. S. Lazarov, O. Sigmund, On projection methods, SMO 43, 2011; X. Qian, O. Sigmund, CMAME
253, 2013, solve the same for other filters.
"""

from __future__ import annotations

from cranktopo.base.errors import invalid
from cranktopo.bodies.cells.domain import Domain
from cranktopo.design.schema import Scene
from cranktopo.numerics.filters.density_filter import THRESHOLD, Projection

LEAST_CELLS = 2.0
"""Cells that the least member or gap must span."""
_LARGEST_THRESHOLD = 0.75
"""Of the eroded design: nearer to 1 it answers too little to the design variables."""


def least_width(eroded: float) -> float:
    """Return the minimum width of a member of the nominal design, over the filter radius.

    Args:
        eroded: threshold of the eroded design, from that of the nominal one up to below 1.
    """
    from scipy.optimize import brentq

    half = brentq(lambda s: 2 * _share(s) - eroded, 0.0, 1.0)
    return float(2 * brentq(lambda t: _share(half + t) + _share(half - t) - THRESHOLD, 0.0, 1.0))


def eroded_threshold(width: float) -> float:
    """Return the eroded design's threshold for a width over the filter radius: inverse of `least_width`.

    Raises:
        ValueError: a width that the largest threshold does not reach.
    """
    from scipy.optimize import brentq

    return float(brentq(lambda eroded: least_width(eroded) - width, THRESHOLD, _LARGEST_THRESHOLD))


def projection_for(scene: Scene, radius_mm: float) -> Projection:
    """Return the thresholds that a scene's least member and gap take with a filter radius."""
    settings = scene.optimise
    above, below = (
        eroded_threshold(min(length / radius_mm, least_width(_LARGEST_THRESHOLD))) if length else THRESHOLD
        for length in (settings.min_member_mm, settings.min_gap_mm)
    )
    return Projection(THRESHOLD, above, 1.0 - below)


def filter_radius_mm(scene: Scene, domain: Domain) -> float:
    """Return the filter radius: the scene's own, the usual one, or what its least member and gap need."""
    given = scene.optimise.filter_radius_mm
    return given or max(_usual_filter_radius_mm(domain), _needed_filter_radius_mm(scene))


def _usual_filter_radius_mm(domain: Domain) -> float:
    """Return the filter radius when the scene asks for nothing: 2.5 cells, and never below 3 mm."""
    return max(3.0, 2.5 * domain.grid.largest_edge_mm)


def _needed_filter_radius_mm(scene: Scene) -> float:
    """Return the smallest filter radius for the scene's least member and gap; 0 where it asks for none."""
    lengths = (scene.optimise.min_member_mm, scene.optimise.min_gap_mm)
    return max(length or 0.0 for length in lengths) / least_width(_LARGEST_THRESHOLD)


def check_lengths(scene: Scene) -> None:
    """Check least member and gap against the cells, the web and the filter.

    Raises:
        CranktopoError: one that the cells do not resolve or the web does not hold, or a filter too small.
    """
    settings, largest = scene.optimise, scene.web.thickness_mm
    smallest = LEAST_CELLS * settings.resolution_mm
    for name in ("min_member_mm", "min_gap_mm"):
        length = getattr(settings, name)
        if length is not None and not smallest <= length <= largest:
            raise invalid(
                f"optimise.{name}",
                length,
                f"must be at least {smallest:g} mm ({LEAST_CELLS:g} cells of optimise.resolution_mm) and at "
                f"most {largest:g} mm (web.thickness_mm)",
                "Smaller cells resolve smaller lengths.",
            )
    given, needed = settings.filter_radius_mm, _needed_filter_radius_mm(scene)
    if given is not None and given < needed:
        raise invalid(
            "optimise.filter_radius_mm",
            given,
            f"must be at least {needed:.3g} mm for {_asked(scene)}",
            "Leave it out: the radius follows from the lengths.",
        )


def length_notice(scene: Scene, domain: Domain) -> str:
    """Say what minimum member and gap change without being asked; empty where nothing."""
    usual, used = _usual_filter_radius_mm(domain), filter_radius_mm(scene, domain)
    if scene.optimise.filter_radius_mm is not None or used == usual:
        return ""
    return f"the filter radius is {used:.3g} mm instead of {usual:.3g} mm, as needed for {_asked(scene)}"


def _asked(scene: Scene) -> str:
    lengths = {name: getattr(scene.optimise, name) for name in ("min_member_mm", "min_gap_mm")}
    return " and ".join(f"optimise.{name} = {value:g}" for name, value in lengths.items() if value)


def _share(distance: float) -> float:
    """Share of a cone filter between a plane through its centre and one at a distance over its radius."""
    s = min(1.0, abs(distance))
    return (s - s**3 + s**4 / 2) * (1 if distance > 0 else -1)
