"""Distances of places from the faces of the throw around a web's outline and features, by scene."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from functools import partial

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.throw.counterweight.sector import Sector
from cranktopo.throw.drilling.table import drill_bores

DistanceOf = Callable[[Scene, Array], Array]
"""Of a scene and points (3, n), mm; zero on the face."""
_BESIDE_MM = 1e-3
"""How far beyond its rims a point may lie that counts as on a fillet."""


def throw_faces(scene: Scene, mirrored: bool, with_journals: bool) -> Iterator[tuple[str, DistanceOf]]:
    """Faces that no parameter of the web's section moves but the counterweight's, each with its distance.

    Args:
        with_journals: journals and both end sections as well.
    """
    if mirrored:
        yield "plane of symmetry", lambda _, at: at[0]
    for k, name in enumerate(("journal face", "pin face")):
        yield name, partial(_above_web_face, k)
    for k, (journal, _) in enumerate(scene.throw.journals):
        if journal.bore_radius_mm:
            yield "bore", partial(_off_bore, k)
    for k in range(len(drill_bores(scene))):
        yield "drilling", partial(_off_drilling, k)
    yield from _counterweight_faces(scene)
    if with_journals:
        yield "journal section", lambda _, at: at[2]
        yield "pin section", lambda scene, at: at[2] - scene.pitch_mm / 2
        yield from (("cylinder", partial(_off_journal, k)) for k in range(2))


def _counterweight_faces(scene: Scene) -> Iterator[tuple[str, DistanceOf]]:
    """Rim and sharp flank of a counterweight that is one piece with the web, its face where it is thinner."""
    weight = scene.web.counterweight
    if weight is None or weight.bolted:
        return
    yield "counterweight rim", lambda scene, at: sector_of(scene).below_rim_mm(at[0], at[1])
    if weight.fillet_mm is None:
        yield "counterweight flank", lambda scene, at: sector_of(scene).inside_flank_mm(at[0], at[1])
    if weight.thickness_mm is not None and weight.thickness_mm < scene.web.thickness_mm:
        end = 1 if weight.face == "journal" else 0
        yield "counterweight face", lambda scene, at: at[2] - sector_of(scene).z_mm[end]


def sector_of(scene: Scene) -> Sector:
    """The counterweight of a scene that has one, without its fillets."""
    assert scene.web.counterweight is not None
    return scene.web.counterweight.sector(scene)


def _above_web_face(number: int, scene: Scene, at: Array) -> Array:
    above: Array = at[2] - scene.web_z_mm[number]
    return above


def _off_bore(number: int, scene: Scene, at: Array) -> Array:
    journal, y = scene.throw.journals[number]
    return np.asarray(np.hypot(at[0], at[1] - y) - journal.bore_radius_mm)


def _off_drilling(number: int, scene: Scene, at: Array) -> Array:
    bore = drill_bores(scene)[number]
    return bore.off_axis_mm(at[0], at[1], at[2]) - bore.radius_mm


def _off_journal(number: int, scene: Scene, at: Array) -> Array:
    journal, y = scene.throw.journals[number]
    return np.asarray(np.hypot(at[0], at[1] - y) - journal.radius_mm)


def off_fillet(number: int, scene: Scene, at: Array) -> Array:
    """Distance from the quarter of the ring that is the fillet, as its section has it; far from the rest."""
    journal, y = scene.throw.journals[number]
    section, side = journal.fillet, 1.0 if number else -1.0
    across = np.hypot(at[0], at[1] - y) - journal.radius_mm - section.radial_mm
    height = side * (at[2] - scene.web_z_mm[number]) - section.axial_mm
    beyond = (across > _BESIDE_MM) | (height > _BESIDE_MM)
    return np.asarray(section.off_mm(across, height) + np.where(beyond, section.radial_mm, 0.0))
