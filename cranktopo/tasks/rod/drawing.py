"""Workshop drawing of the rod: its views, a table of all numbers, notes.

Lengths are in mm.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

from cranktopo.base.files import replacing
from cranktopo.base.fit import hole_limits_text
from cranktopo.design.checks.rod import rod_of
from cranktopo.design.named import DesignLike, as_scene
from cranktopo.design.rod_body import rod_mass
from cranktopo.design.rod_strength import rod_strength_notes
from cranktopo.design.schema import Scene
from cranktopo.tasks.bolts.stage import check_rod_bolt
from cranktopo.tasks.drawing.sheet import SheetPage, write_pages
from cranktopo.tasks.rod.drawing_views import RodViews


def draw_rod(design: DesignLike, path: Path | str) -> None:
    """Write the drawing of a design's rod, A3 (.pdf, .svg, .png or .dxf).

    Raises:
        CranktopoError: no rod, no engine, bolts without gas pressure, or the file cannot be written.
    """
    scene, path = as_scene(design), Path(path)
    page = rod_page(scene)
    with replacing(path) as temporary:
        write_pages([page], scene.name, [temporary])


def rod_page(scene: Scene) -> SheetPage:
    """Return the page of a design's rod; raises CranktopoError as `draw_rod`."""
    views = RodViews(scene)
    material = views.rod.material or scene.material
    mass = rod_mass(views.rod, views.length, scene.material)
    return SheetPage(
        rooms=views.rooms,
        views=(views.front, views.lengthwise, views.shank),
        lines=[*_table(scene)],
        title=f"{scene.name}: connecting rod",
        material=material.name,
        mass=f"{mass.total_kg:.3f} kg with all fitted parts, {mass.body_kg:.3f} kg without",
        notes=[*_notes(scene), *rod_strength_notes(views.rod, scene), *scene.drawing.notes],
        in_row=True,
    )


def _notes(scene: Scene) -> Iterator[str]:
    rod, length = rod_of(scene)
    drawing, mass = scene.drawing, rod_mass(rod, length, scene.material)
    yield f"General tolerances {drawing.general_tolerances} unless stated."
    yield (
        f"Both bores finished with the cap tightened, Ra {drawing.rod_bore_roughness_um:g} µm; other bores "
        f"Ra {drawing.bore_roughness_um:g} µm, all other surfaces Ra {drawing.surface_roughness_um:g} µm. "
        "Break sharp edges 0.3 mm."
    )
    ends = f"small end {mass.reciprocating_kg:.3f} kg, big end {mass.rotating_kg:.3f} kg"
    yield f"Weighed on both axes: {ends}."


def _table(scene: Scene) -> Iterator[str]:
    """Yield the lines of the table of dimensions."""
    rod, fit = rod_of(scene)[0], scene.drawing.rod_bore_fit
    bores = (rod.small_end_bore_mm, rod.pin_diameter_mm, rod.big_end_bore_mm)
    small, pin, big = (hole_limits_text(bore, fit) for bore in bores)
    yield f"SMALL END   ⌀{rod.small_end_diameter_mm:g}, bore {small}"
    yield f"            width {rod.small_end_width_mm:g}"
    if rod.bush_thickness_mm:
        yield f"BUSH        wall {rod.bush_thickness_mm:g}, bore {pin}"
        if rod.bush_interference_um:
            yield f"            interference {rod.bush_interference_um:g} µm of the diameter"
    yield f"BIG END     ⌀{rod.big_end_diameter_mm:g}, bore {big}"
    oblique = f"oblique by {rod.split_angle_deg:g}°" if rod.split_angle_deg else "square"
    yield f"            width {rod.big_end_width_mm:g}, split {oblique} at the axis"
    heights = f"{rod.boss_above_mm:g} above, {rod.boss_below_mm:g} below"
    yield f"BOSSES      {rod.boss_width_mm:g} wide, {heights}"
    yield f"SHANK       {rod.shank}, {rod.shank_width_mm:g} wide; height at the axes:"
    yield f"            small end {rod.shank_small_mm:g}, big end {rod.shank_big_mm:g}"
    if rod.shank != "plain":
        yield f"            flange {rod.flange_mm:g}, web {rod.web_mm:g}"
    if rod.oil_hole_mm:
        yield f"OIL HOLE    ⌀{rod.oil_hole_mm:g} from bore to bore"
    yield from _bolt_lines(scene)


def _bolt_lines(scene: Scene) -> Iterator[str]:
    bolt, checked = rod_of(scene)[0].bolt, check_rod_bolt(scene)
    if bolt is None or checked is None:
        return
    yield f"BOLTS       2 x {bolt.thread} - {bolt.strength_class}, hole ⌀{bolt.hole_mm:g}"
    held = "nut" if bolt.held_in == "nut" else "tapped in the rod"
    yield f"            head's face ⌀{bolt.head_mm:g}, flat on the cap"
    yield f"            grip {bolt.grip_mm:g}, engaged {bolt.engaged_mm:g}, {held}"
    if rod_of(scene)[0].split_angle_deg:
        yield f"            {rod_of(scene)[0].bolt_distance_mm:g} apart, square to the split"
    yield f"            tightened to {checked.vdi_2230.torque_Nm:.1f} N m"
