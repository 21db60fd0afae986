"""Tables and text of the rod by finite elements."""

from __future__ import annotations

from collections.abc import Iterator

from cranktopo.report.result_table import Column, tabulate, terminal
from cranktopo.tasks.rod.result import EyeShape, RodElements, RodPlace, RodPreload, RodStrength

EYES: tuple[Column[EyeShape], ...] = (
    Column("bore", 0, lambda e: e.eye),
    Column("under the largest", 0, lambda e: e.load),
    Column("force_N", 0, lambda e: e.force_N),
    Column("pressed_deg", 0, lambda e: e.contact_deg),
    Column("across_um", 1, lambda e: e.across_um),
    Column("along_um", 1, lambda e: e.along_um),
    Column("permitted_um", 1, lambda e: e.permitted_um),
)
"""Change of the bores, also of those in closed form."""
VOLUME_PERCENT = 0.05
"""Error of a mesh's volume from which it is told."""


def elements_text(elements: RodElements, rod: RodStrength) -> str:
    """Return tables and lines of a rod by finite elements."""
    columns: tuple[Column[RodPlace], ...] = (
        Column("place", 0, lambda p: p.place),
        Column("x_mm", 1, lambda p: p.point_mm[0]),
        Column("y_mm", 1, lambda p: p.point_mm[1]),
        Column("z_mm", 1, lambda p: p.point_mm[2]),
        Column("highest_MPa", 1, lambda p: p.max_MPa),
        Column("lowest_MPa", 1, lambda p: p.min_MPa),
        Column("error_percent", 1, lambda p: p.error_percent),
        Column("yield", 2, lambda p: p.yield_safety),
        Column("fatigue", 2, lambda p: p.fatigue_safety),
        Column("closed form yield", 2, lambda p: rod.section_of(p.place).yield_safety),
        Column("closed form fatigue", 2, lambda p: rod.section_of(p.place).fatigue_safety),
    )
    size = f"{elements.nodes:,} nodes, elements of {elements.element_size_mm:.3g} mm"
    pins = "rigid pins touch" if elements.contact else "pressure by the cosine"
    part = "half" if rod.oblique_split else "quarter"
    lines = [f"By finite elements on a {part}, {pins}: {size}; von Mises stress, positive in tension"]
    lines.append(terminal(tabulate(columns, elements.places)))
    if elements.at_sharp_edges is not None:
        sharp = elements.at_sharp_edges
        lines.append(
            f"Nearer than {elements.edge_distance_mm:.2g} mm to sharp inner edges the mesh decides: "
            f"{sharp.von_mises_MPa:.0f} MPa {_at(sharp.point_mm)}, not judged."
        )
    lines += too_coarse(elements)
    lines += _by_bolts(elements.preload)
    lines.append("Change of the bores' diameters by finite elements")
    lines.append(terminal(tabulate(EYES, elements.eyes)))
    return "\n\n".join(lines)


def too_coarse(elements: RodElements) -> Iterator[str]:
    """Yield a line where elements that could not be bent to the surface miss a part of the body."""
    if abs(elements.volume_error_percent) > VOLUME_PERCENT:
        yield (
            "THE MESH IS TOO COARSE for the shape: its volume is off by "
            f"{elements.volume_error_percent:+.2g} %. Stresses where it leaves the surface are wrong; choose "
            "smaller elements (--element-size-mm)."
        )


def _by_bolts(preload: RodPreload | None) -> Iterator[str]:
    """Yield the preload that is in the stresses, and whether it keeps the split closed."""
    if preload is None:
        yield "The design has no bolts of the cap (`[rod.bolt]`): no preload is in these stresses."
        return
    yield (
        f"The mean preload, {preload.mean_N:,.0f} N in each bolt, is in these stresses; it may be "
        f"{preload.least_N:,.0f} N (after settling) to {preload.largest_N:,.0f} N. At heads and threads "
        "`bolts` judges."
    )
    if preload.least_pressure_MPa > 0:
        yield (
            f"The split stays closed with the least preload: {preload.least_pressure_MPa:.0f} MPa are left "
            f"on its edges, {_at(preload.point_mm)}."
        )
    else:
        yield (
            "The split opens with the least preload: rod and cap are one body here; where they part, "
            "stresses of cap and big end are larger."
        )


def opening(preload: RodPreload | None) -> Iterator[str]:
    """Yield a line where rod and cap part."""
    if preload and preload.least_pressure_MPa <= 0:
        yield (
            f"THE SPLIT OPENS: {-preload.least_pressure_MPa:.0f} MPa of tension on its edges with a preload "
            f"of {preload.least_N:,.0f} N, {_at(preload.point_mm)}, by elements"
        )


def _at(point_mm: tuple[float, float, float]) -> str:
    x, y, z = point_mm
    return f"at ({x:.1f}, {y:.1f}, {z:.1f}) mm"
