"""The half throw as layers along the crank axis, with sections: what is solid, designable, pin or web."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Literal

import numpy as np
from manifold3d import Manifold

from cranktopo.base.errors import invalid
from cranktopo.base.spans import Section, common, disc_section, polygon_section, section_difference
from cranktopo.bodies.envelope_file import (
    SECTIONS,
    envelope_bounds_mm,
    envelope_from_file,
    envelope_section,
    envelope_sections,
)
from cranktopo.bodies.zones import frozen_at, staying_at, zone_heights_mm, zones_change
from cranktopo.design.clearance import clearance_limit
from cranktopo.design.schema import Scene
from cranktopo.throw.envelope import Envelope
from cranktopo.throw.feature import Body, DrilledBody
from cranktopo.throw.journal import Journal
from cranktopo.throw.recess import FilletRecess
from cranktopo.throw.web import check_inside, kept_bodies, kept_holes, web_bodies, web_spans

ORIGINAL_KEY = "original.file"
GridContent = Literal["envelope", "web"]


@dataclass(frozen=True)
class AxialLayer:
    """Material in the plane between two heights of the half throw; None for nothing.

    Its sections, of which passive is undesignable solid and web the full one, may change between the heights.
    What it has as passive may replace what other layers between these heights have as design.
    """

    z_mm: tuple[float, float]
    passive: Section | None
    design: Section | None
    pin: Section | None
    web: Section | None
    changes: bool = False
    replaces_design: bool = False

    @property
    def sections(self) -> dict[str, Section]:
        """Those that hold something, by the names of the domain's fractions."""
        named = {
            "passive_fraction": self.passive,
            "design_fraction": self.design,
            "pin": self.pin,
            "web": self.web,
        }
        return {name: section for name, section in named.items() if section is not None}


def half_throw_layers(scene: Scene, target: GridContent) -> list[AxialLayer]:
    """Return the layers along z: main journal, web (cut where its section changes), crankpin; undrilled."""
    start, stop = scene.web_z_mm
    pin_shape = _annulus(scene.throw.crankpin, scene.throw.radius_mm)
    layers = [AxialLayer((0.0, start), _annulus(scene.throw.main_journal, 0.0), None, None, None)]
    layers += _own_web(scene) if target == "web" else _design_space(scene)
    layers.append(AxialLayer((stop, scene.pitch_mm / 2), pin_shape, None, pin_shape, None))
    return layers


def _annulus(journal: Journal, y_mm: float) -> Section:
    outer, bore = disc_section(journal.radius_mm, y_mm), disc_section(journal.bore_radius_mm, y_mm)
    return section_difference(outer, bore) if journal.bore_radius_mm else outer


def _own_web(scene: Scene) -> list[AxialLayer]:
    if scene.original is not None:
        return _body_from_file(scene, envelope_from_file(Path(scene.original.file), key=ORIGINAL_KEY))
    bodies = [body for body in web_bodies(scene) if not isinstance(body, (DrilledBody, FilletRecess))]
    section, changing = _section(bodies), [ends for body in bodies for ends in body.changing_z_mm]
    cuts = [z for ends in (*changing, *(body.z_mm for body in bodies)) for z in ends]
    return [
        AxialLayer(z, section, None, None, section, any(low < sum(z) / 2 < high for low, high in changing))
        for z in _ranges_mm(scene, cuts)
    ]


def _body_from_file(scene: Scene, body: Manifold) -> list[AxialLayer]:
    """Return a body of triangles as thin layers with the section in their middle."""
    found = []
    for z in _ranges_mm(scene, [float(z) for z in np.linspace(*scene.web_z_mm, SECTIONS + 1)]):
        shape = polygon_section([np.asarray(contour) for contour in body.slice(sum(z) / 2).to_polygons()])
        found.append(AxialLayer(z, passive=shape, design=None, pin=None, web=shape))
    return found


def _section(bodies: Sequence[Body]) -> Section:
    return lambda y_mm, z_mm: list(zip(*web_spans(bodies, y_mm, z_mm), strict=True))


def _design_space(scene: Scene) -> list[AxialLayer]:
    """Return the envelope less the bores as layers, what is kept solid; in a clearance the journal alone."""
    (start, stop), envelope, throw = scene.web_z_mm, design_envelope(scene), scene.throw
    low, high = start + envelope.bearing_clearance_mm, stop - envelope.rod_clearance_mm
    bores = [
        disc_section(journal.bore_radius_mm, y) for journal, y in throw.journals if journal.bore_radius_mm > 0
    ]
    bodies, found = (*kept_bodies(scene), *kept_holes(scene)), list[AxialLayer]()
    heights = [float(z) for z in np.linspace(low, high, envelope_sections(envelope) + 1)]
    heights += zone_heights_mm(scene)
    for z in _ranges_mm(scene, [*heights, *(z for body in bodies for z in body.z_mm)]):
        middle = sum(z) / 2
        if low < middle < high:
            found += _design_layers(scene, z, bores)
            continue
        journal, y = throw.journals[0 if middle < low else 1]
        shape = section_difference(disc_section(journal.radius_mm, y), *bores)
        found.append(AxialLayer(z, passive=shape, design=None, pin=None, web=shape))
    return found


def _design_layers(scene: Scene, z_mm: tuple[float, float], bores: Sequence[Section]) -> Iterator[AxialLayer]:
    """Yield the design space between two heights of the web, and what of the web stays in it as it is."""
    middle = sum(z_mm) / 2

    def here(bodies: Sequence[Body]) -> list[Body]:
        return [
            body
            for body in bodies
            if body.z_mm[0] < middle < body.z_mm[1] and not isinstance(body, DrilledBody)
        ]

    envelope = design_envelope(scene)
    outline = _turning_free(scene, envelope_section(envelope, middle))
    check_inside(scene, outline, middle, of_facets=envelope.stl_file is not None)
    kept = here(kept_bodies(scene))
    cuts = [*bores, *(hole.spans for hole in here(kept_holes(scene)))]
    web = section_difference(outline, *cuts, *frozen_at(scene, middle))
    passive = section_difference(_section(kept), *cuts) if kept else None
    yield AxialLayer(z_mm, passive, section_difference(web, passive) if passive else web, None, web)
    for stays, designed in staying_at(scene, middle):
        own, changes = section_difference(stays, *filter(None, [passive])), zones_change(scene, middle)
        yield AxialLayer(z_mm, own, None, None, None if designed else own, changes, replaces_design=designed)


def _turning_free(scene: Scene, section: Section) -> Section:
    limit = clearance_limit(scene)
    if limit is None:
        return section
    far = 2 * max(abs(end) for end in envelope_bounds_mm(design_envelope(scene)))
    return common(section, polygon_section([limit.contour(far)]))


def _ranges_mm(scene: Scene, cuts: list[float]) -> list[tuple[float, float]]:
    start, stop = scene.web_z_mm
    return list(pairwise(sorted({start, stop, *(z for z in cuts if start < z < stop)})))


def design_envelope(scene: Scene) -> Envelope:
    """Return the envelope of an optimisation; raises CranktopoError where the scene has none."""
    if scene.envelope is None:
        raise invalid("envelope", None, "an optimisation needs a design envelope", "Add an [envelope] table.")
    return scene.envelope
