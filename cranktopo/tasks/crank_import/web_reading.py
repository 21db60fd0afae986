"""The web of a half throw read back as a web of a design: outline, counterweight, bevels, drillings.

Dimensions come from exact faces. Outlines that fit these are compared with the silhouette of the body, and
the nearest one is taken; a silhouette that is none of them becomes a profile through stations.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.files import kernel_surface_of
from cranktopo.bodies.solid.step import CHORD_MM
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import mesh_of, solid_of
from cranktopo.tasks.crank_import.bevelled_edge import read_edge
from cranktopo.tasks.crank_import.bevels import read_bevels
from cranktopo.tasks.crank_import.half_body import EXACT, HalfBody
from cranktopo.tasks.crank_import.oil_drillings import read_drillings, with_outlet_radius
from cranktopo.tasks.crank_import.pockets import read_pockets
from cranktopo.tasks.crank_import.silhouette import apart_mm, drawn_outline, silhouette
from cranktopo.tasks.crank_import.web_candidates import web_candidates

if TYPE_CHECKING:
    from manifold3d import Manifold

_EXACT = 2e-4
"""Distance of outlines over the throw radius below which one counts as the body's own.

The silhouette of a body lies inside it by the chords of its triangles besides: `CHORD_MM`.
"""
_TOLD, _TOLD_EXACT = 1e-3, 2e-5
"""Share of the volume in which a difference of body and design is told, of triangles and of exact volumes."""
_OUTLETS = 0.5
"""Rounded outlets are believed where they take away half of what differs."""


@dataclass(frozen=True)
class ReadWeb:
    """A scene with the web that comes nearest to a body, and how near.

    Attributes:
        outline: its outline and counterweight in words.
        outline_mm, outline_rms_mm: largest distance of both silhouettes along the crank, and its root mean
            square.
        solid, scene_solid: the half throw of the body, and that of the scene.
    """

    scene: Scene
    outline: str
    outline_mm: float
    outline_rms_mm: float
    solid: Manifold
    scene_solid: Manifold

    @cached_property
    def _common_mm3(self) -> float:
        """Volume that both have: one pass of the boolean engine tells what either lacks."""
        return float((self.solid ^ self.scene_solid).volume())

    @property
    def missing_mm3(self) -> float:
        """Volume that the body has and the scene lacks."""
        return max(0.0, float(self.solid.volume()) - self._common_mm3)

    @property
    def extra_mm3(self) -> float:
        """Volume that the scene has and the body lacks."""
        return max(0.0, float(self.scene_solid.volume()) - self._common_mm3)

    @property
    def differences(self) -> Iterator[str]:
        """Volumes, in words, that one of body and scene lacks, each with the place of its largest part."""
        for what, volume, one, other in (
            ("the design lacks", self.missing_mm3, self.solid, self.scene_solid),
            ("the design adds", self.extra_mm3, self.scene_solid, self.solid),
        ):
            if volume > _TOLD * self.solid.volume():
                x, y, z = _largest_centre_mm(one - other)
                yield f"{what} {volume:.4g} mm3, most of it near ({x:.4g}, {y:.4g}, {z:.4g}) mm"

    def differences_from(self, body: HalfBody) -> Iterator[str]:
        """Yield what `differences` does, or else the least difference that the exact volumes of both show."""
        found = list(self.differences)
        yield from found
        off = body.solid.volume_mm3 - half_throw_volume_mm3(self.scene)
        if not found and body.near == EXACT and abs(off) > _TOLD_EXACT * body.solid.volume_mm3:
            apart = (self.solid - self.scene_solid) if off > 0 else (self.scene_solid - self.solid)
            x, y, z = _largest_centre_mm(apart)
            what = "lacks" if off > 0 else "adds"
            yield f"the design {what} {abs(off):.4g} mm3, perhaps near ({x:.4g}, {y:.4g}, {z:.4g}) mm"

    @property
    def differs_mm3(self) -> float:
        """Volume in which body and scene differ."""
        return self.missing_mm3 + self.extra_mm3


def _largest_centre_mm(solid: Manifold) -> Array:
    """Return the centre of mass of the largest part of a solid: slivers along faces may hang on to it."""
    part = max(solid.decompose(), key=lambda one: one.volume())
    return np.asarray(mesh_of(part).as_trimesh().center_mass)


@dataclass(frozen=True)
class ImportedWeb:
    """A distinct half throw beside the design read from it."""

    body: HalfBody
    read: ReadWeb
    name: str


def read_web(body: HalfBody, throw: Mapping[str, Any], material: Mapping[str, Any], name: str) -> ReadWeb:
    """Return the scene with the web of a half throw.

    Raises:
        CranktopoError: no web of the family fits the throw.
    """
    solid = solid_of(body.mesh, name)
    exact_mm = max(_EXACT * throw["radius_mm"] + CHORD_MM, body.near.outline_mm)
    found: list[tuple[tuple[float, float], tuple[float, int], str, Scene]] = []
    refusals: list[CranktopoError] = []
    start = throw["main_journal"]["length_mm"] / 2
    own = silhouette(solid, start, start + body.half.thickness_mm)
    for rank, (words, web) in enumerate(web_candidates(body, throw["radius_mm"], own)):
        data = {"name": name, "throw": dict(throw), "web": web, "material": dict(material)}
        data = rounded(data, body.near.digits)
        try:
            scene = scene_from_dict(data, name)
        except CranktopoError as error:
            refusals.append(error)
            continue
        drawn = drawn_outline(scene)
        off, area = apart_mm(own, drawn), ((own - drawn) + (drawn - own)).area()
        found.append((off, (round(area / own.area(), 4), rank), words, scene))
        if off[0] < exact_mm:
            break
    if not found:
        raise refusals[-1]
    off, _, words, scene = min(found, key=lambda one: (one[0][0] > exact_mm, one[1]))
    return _with_features(body, ReadWeb(scene, words, *off, solid, _scene_solid(scene)))


def rounded(data: Any, digits: int) -> Any:
    """Return tables with all numbers rounded."""
    if isinstance(data, Mapping):
        return {key: rounded(value, digits) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [rounded(value, digits) for value in data]
    return round(data, digits) if isinstance(data, float) else data


def _scene_solid(scene: Scene) -> Manifold:
    return solid_of(kernel_surface_of(scene, "half"), scene.name)


def _with_features(body: HalfBody, read: ReadWeb) -> ReadWeb:
    """Return the web with the bevels, pockets and drillings that bring it nearer to the body."""
    data = read.scene.model_dump(mode="json", exclude_none=True)
    bevels = sorted(read_bevels(body, read.scene), key=lambda bevel: str(bevel["face"]))
    features = [("web", "bevel", table) for table in bevels]
    features += [("web", "pocket", table) for table in read_pockets(body, read.scene)]
    features += [("throw", "drilling", table) for table in read_drillings(body, read.scene)]
    features += [("web", "counterweight", {"edge": table}) for table in read_edge(body, read.scene)]
    for table, key, feature in features:
        feature, before = rounded(feature, body.near.digits), data[table].get(key, ())
        changed = {**before, **feature} if isinstance(before, dict) else [*before, feature]
        tried = {**data, table: {**data[table], key: changed}}
        try:
            scene = scene_from_dict(tried, read.scene.name)
            found = replace(read, scene=scene, scene_solid=_scene_solid(scene))
        except CranktopoError:
            continue
        if found.differs_mm3 < read.differs_mm3:
            data, read = tried, found
    outlets = with_outlet_radius(body, read.scene) if read.scene.throw.drilling else None
    if outlets is None:
        return read
    found = replace(read, scene=outlets, scene_solid=_scene_solid(outlets))
    return found if found.differs_mm3 < _OUTLETS * read.differs_mm3 else read
