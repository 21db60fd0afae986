"""From a scene's process to its block in the density chain: a die, a mould or a mill, and its obstacles.

Bores are drilled, and web faces and envelope walls are machined, after forging or casting: none of them is
an obstacle or needs draft.

Minimum member and gap are thresholds of the projection. A plate of design variables has its largest filtered
density in its middle. While that is below the threshold of the eroded design, the plate has no stiffness, and
an optimiser does not make it: the minimum member is the width that the nominal design has when the eroded one
is about to vanish. Rods and balls vanish earlier, so that a plate decides. Gaps are the same with void and
the dilated design (F. Wang, B. S. Lazarov, O. Sigmund, SMO 43, 2011; X. Qian, O. Sigmund, CMAME 253, 2013).
"""

from __future__ import annotations

import math

import numpy as np

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.errors import invalid
from cranktopo.base.frames import X, Z
from cranktopo.base.spans import holds, polygon_section
from cranktopo.bodies.cells.domain import Domain, centres_mm
from cranktopo.bodies.envelope_file import envelope_bounds_mm, through_holes
from cranktopo.design.schema import Scene
from cranktopo.numerics.device_arrays import on_device
from cranktopo.numerics.filters.density_filter import THRESHOLD, Projection
from cranktopo.numerics.filters.processes import (
    ONE_CELL,
    Direction,
    ForgingConstraint,
    Offsets,
    Parting,
    ToolAccess,
    reachable,
)
from cranktopo.tasks.density.material import web_cell_mm
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.web import kept_holes

LEAST_CELLS = 2.0
"""Cells that the least member or gap must span."""
_LARGEST_THRESHOLD = 0.75
"""Of the eroded design: nearer to 1 it answers too little to the design variables."""


def least_width(eroded: float) -> float:
    """Return a nominal member's minimum width over the filter radius, by the eroded design's threshold."""
    from scipy.optimize import brentq

    half = brentq(lambda s: 2 * _share(s) - eroded, 0.0, 1.0)
    return float(2 * brentq(lambda t: _share(half + t) + _share(half - t) - THRESHOLD, 0.0, 1.0))


def eroded_threshold(width: float) -> float:
    """Return the eroded design's threshold for a width over the filter radius: inverse of `least_width`.

    Raises ValueError for a width that the largest threshold does not reach.
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
    radius_mm = scene.optimise.filter_radius_mm
    return radius_mm or max(_usual_filter_radius_mm(domain), _needed_filter_radius_mm(scene))


def _usual_filter_radius_mm(domain: Domain) -> float:
    """Return the filter radius when the scene asks for nothing: 2.5 cells, and never below 3 mm."""
    return max(3.0, 2.5 * domain.grid.largest_edge_mm)


def _needed_filter_radius_mm(scene: Scene) -> float:
    """Return the smallest filter radius for the scene's least member and gap; 0 where it asks for none."""
    lengths = [mm for mm in (scene.optimise.min_member_mm, scene.optimise.min_gap_mm) if mm]
    return max(lengths) / least_width(_LARGEST_THRESHOLD) if lengths else 0.0


def check_lengths(scene: Scene) -> None:
    """Check that cells, web and filter allow the scene's minimum member and gap."""
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
    radius, needed = settings.filter_radius_mm, _needed_filter_radius_mm(scene)
    if radius is not None and radius < needed:
        raise invalid(
            "optimise.filter_radius_mm",
            radius,
            f"must be at least {needed:.3g} mm for {_lengths_text(scene)}",
            "Leave it out: the radius follows from the lengths.",
        )
    x_min, x_max, y_min, y_max = envelope_bounds_mm(scene.envelope) if scene.envelope else (0, np.inf) * 2
    widest = max(x_max - x_min, y_max - y_min) / 2
    if radius is not None and radius > max(widest, needed):
        what = f"must be at most {widest:.3g} mm, half of the design space: a larger one leaves it uniform"
        raise invalid("optimise.filter_radius_mm", radius, what, "2 to 4 cells are usual.")


def length_notice(scene: Scene, domain: Domain) -> str:
    """Say what minimum member and gap change without being asked; empty where nothing."""
    usual, used = _usual_filter_radius_mm(domain), filter_radius_mm(scene, domain)
    if scene.optimise.filter_radius_mm is not None or used == usual:
        return ""
    return (
        f"the filter radius is {used:.3g} mm instead of {usual:.3g} mm, as needed for {_lengths_text(scene)}"
    )


def _lengths_text(scene: Scene) -> str:
    lengths = {name: getattr(scene.optimise, name) for name in ("min_member_mm", "min_gap_mm")}
    return " and ".join(f"optimise.{name} = {value:g}" for name, value in lengths.items() if value)


def _share(distance: float) -> float:
    """Share of a cone filter between a plane through its centre and one at a distance over its radius."""
    s = min(1.0, abs(distance))
    return (s - s**3 + s**4 / 2) * (1 if distance > 0 else -1)


_SOLID = 0.5
_RAMP_CELLS, _RIM_CELLS = 3.0, 0.25


def is_manufactured(scene: Scene) -> bool:
    """Tell whether a process limits the shape, in a scene as it is simulated."""
    return scene.effects.manufacturing_constraint == "on"


def pull_axis(scene: Scene) -> int:
    """Return the axis along which the halves of a die or mould leave."""
    return X if scene.optimise.parting == "lateral" else Z


def tool_radius_mm(scene: Scene) -> float:
    """Return the radius of the end mill, mm."""
    return scene.optimise.tool_radius_mm or scene.throw.radius_mm / 10


def designable(scene: Scene, domain: Domain) -> Array:
    """Return the designable fraction of the web's cells (nx, ny, nw), less what no die half reaches."""
    first, last = domain.web_layers
    design = domain.design_fraction[:, :, first:last]
    if not is_manufactured(scene) or scene.optimise.process in ("cast", "milled"):
        return design
    axis = pull_axis(scene)
    return design * reachable(open_cells(scene, domain), parting_of(domain, axis), axis)


def unreachable_share(scene: Scene, domain: Domain) -> float:
    """Share of the design space that no die half reaches past the voids of the envelope, 0 to 1."""
    first, last = domain.web_layers
    kept = designable(scene, domain) * domain.volume_mm3[:, :, first:last]
    return float(1 - kept.sum() / (domain.design_fraction * domain.volume_mm3)[:, :, first:last].sum())


def process_block(scene: Scene, domain: Domain) -> ForgingConstraint | ToolAccess | None:
    """Return the scene's process as a block of the density chain; call inside `double_precision()`."""
    if not is_manufactured(scene):
        return None
    if scene.optimise.process == "cast":
        return _mould(scene, domain)
    return _mill(scene, domain) if scene.optimise.process == "milled" else _die(scene, domain)


def parting_of(domain: Domain, axis: int = X) -> Parting:
    """Return where the halves of a die meet: in x = 0, a grid plane, or in the web's mid-plane."""
    if axis == Z:
        first, last = domain.web_layers
        return (last - first + 1) // 2, (last - first) // 2
    plane = int(np.searchsorted(domain.grid.x_mm, -1e-6 * float(domain.grid.steps_mm[0][0])))
    return plane, plane


def open_cells(scene: Scene, domain: Domain) -> Mask:
    """Return the web's cells (nx, ny, nw) that are no obstacle: designable, in a bore or in a journal.

    Bores, oil drillings, holes of features, and holes through the envelope along the crank axis are drilled
    after forging or casting.
    """
    first, last = domain.web_layers
    x, y, z = centres_mm(domain)
    bored = np.zeros((len(x), len(y)), bool)
    for journal, centre in scene.throw.journals:
        bored |= np.hypot(x[:, None], y[None, :] - centre) < journal.bore_radius_mm
    filled = (domain.design_fraction > 0) | (domain.passive_fraction > 0)
    holes = [
        holds(polygon_section(contours)(y, np.full_like(y, height)), x[:, None])
        for contours, height in zip(through_holes(scene, z.tolist()), z, strict=True)
    ]
    drilled = np.zeros((len(x), len(y), len(z)), bool)
    for body in (*kept_holes(scene), *drill_bores(scene)):
        drilled |= holds(body.spans(y[None, :, None], z[None, None, :]), x[:, None, None])
    return filled[:, :, first:last] | bored[:, :, None] | np.stack(holes, axis=-1) | drilled


def _die(scene: Scene, domain: Domain) -> ForgingConstraint:
    axis = pull_axis(scene)
    free = designable(scene, domain) > 0
    kept = on_device(_behind_journals(scene, domain) * free) if axis == Z else None
    return ForgingConstraint(
        on_device(free), kept, axis, parting_of(domain, axis), _draft_slope(scene, domain, axis)
    )


def _mould(scene: Scene, domain: Domain) -> ToolAccess:
    axis = pull_axis(scene)
    draft_slope = _draft_slope(scene, domain, axis)
    ways = (Direction(axis, -1, ONE_CELL, draft_slope), Direction(axis, 1, ONE_CELL, draft_slope))
    return _access(scene, domain, (0, 0, int(axis == Z)), ways)


def _mill(scene: Scene, domain: Domain) -> ToolAccess:
    radius, steps = tool_radius_mm(scene), web_cell_mm(domain)
    x, y, z = (max(1, math.ceil(radius / step)) for step in steps)
    # A tool centred a radius beyond the mirror plane touches what stands two radii beyond it.
    margin = (2 * x if domain.mirrored_x else x, y, z)
    faces = _tool_disc(radius, steps[0], steps[1])
    sides = _tool_disc(radius, steps[1], steps[2])
    ways = (Direction(Z, 1, faces), Direction(Z, -1, faces), Direction(X, -1, sides), Direction(X, 1, sides))
    return _access(scene, domain, margin, ways)


def _access(scene: Scene, domain: Domain, margin: tuple[int, ...], ways: tuple[Direction, ...]) -> ToolAccess:
    """Return the access of several ways; in a mirrored model the negative side's brings nothing new."""
    mirrored = domain.mirrored_x
    used = tuple(way for way in ways if not (mirrored and way.axis == X and way.inward > 0))
    free = designable(scene, domain) > 0
    air = _air(scene, domain, free, margin)
    x, y, z = margin
    return ToolAccess(on_device(free), on_device(air), (x, y, z), mirrored, used)


def _tool_disc(radius_mm: float, step_a_mm: float, step_b_mm: float) -> Offsets:
    """Return the cells whose centres lie within a radius of a cell's centre, as offsets along two axes."""
    a, b = (math.floor(radius_mm / step + 1e-9) for step in (step_a_mm, step_b_mm))
    inside = radius_mm * (1 + 1e-9)
    return tuple(
        (i, j)
        for i in range(-a, a + 1)
        for j in range(-b, b + 1)
        if math.hypot(i * step_a_mm, j * step_b_mm) <= inside
    )


def _air(scene: Scene, domain: Domain, free: Mask, margin: tuple[int, ...]) -> Array:
    """Return 1 where nothing stands, `margin` cells around the web; journals go on beyond its faces."""
    first, last = domain.web_layers
    standing = free | (domain.passive_fraction[:, :, first:last] >= _SOLID)
    (mx, my, mz), (x, y, _) = margin, centres_mm(domain)
    image = min(mx, len(x)) if domain.mirrored_x else 0  # a wide tool reaches past the whole mirror image
    standing = np.pad(standing, ((image, 0), (0, 0), (0, 0)), mode="symmetric")
    x = np.concatenate([-x[:image][::-1], x])
    faces = [
        np.hypot(x[:, None], y[None, :] - centre) < journal.radius_mm
        for journal, centre in scene.throw.journals
    ]
    below, above = (np.repeat(face[:, :, None], mz, axis=2) for face in faces)
    standing = np.concatenate([below, standing, above], axis=2)
    return 1.0 - np.pad(standing, ((mx - image, mx), (my, my), (0, 0))).astype(np.float64)


def _behind_journals(scene: Scene, domain: Domain) -> Array:
    """Return the minimum density (nx, ny, nw): 1 between the mid-plane and a journal, its draft included.

    It falls over some cells around a cone, where it is one half, so that the surface is that cone and not
    the steps of the cells in it. The cone begins just beyond the journal's rim, so that an iso-value a little
    off one half leaves no gap behind it.
    """
    x, y, z = centres_mm(domain)
    lateral, along, axial = np.meshgrid(x, y, z, indexing="ij")
    (main, main_y), (pin, pin_y) = scene.throw.journals
    start, end = scene.web_z_mm
    slope, cell = math.tan(math.radians(scene.optimise.draft_deg)), max(web_cell_mm(domain)[:2])
    rim, ramp = _RIM_CELLS * cell, _RAMP_CELLS * cell
    main_mm = main.radius_mm + rim + slope * (axial - start) - np.hypot(lateral, along - main_y)
    pin_mm = pin.radius_mm + rim + slope * (end - axial) - np.hypot(lateral, along - pin_y)
    main_side, pin_side = (sign * ((start + end) / 2 - axial) > -1e-6 * (end - start) for sign in (1, -1))
    inside_mm = np.maximum(np.where(main_side, main_mm, -ramp), np.where(pin_side, pin_mm, -ramp))
    return np.asarray(np.clip(_SOLID + inside_mm / ramp, 0.0, 1.0))


def _draft_slope(scene: Scene, domain: Domain, axis: int) -> tuple[float, float]:
    """Return the steps of the draft from layer to layer, in cells along the two other axes."""
    steps = web_cell_mm(domain)
    slope = math.tan(math.radians(scene.optimise.draft_deg)) * steps[axis]
    first, second = (slope / step for other, step in enumerate(steps) if other != axis)
    return first, second
