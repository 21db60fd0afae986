"""The web of a half throw read back as a web of a design: outline, counterweight, bevels, drillings.

Dimensions come from exact faces. Outlines that fit these are compared with the silhouette of the body, and
the nearest one is taken; a silhouette that is none of them becomes a profile through stations.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.files import kernel_surface_of
from cranktopo.bodies.solid.step import CHORD_MM
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.tasks.crank_import.bevelled_edge import read_edge
from cranktopo.tasks.crank_import.bevels import read_bevels
from cranktopo.tasks.crank_import.compared import Compared
from cranktopo.tasks.crank_import.half_body import EXACT, HalfBody
from cranktopo.tasks.crank_import.oil_drillings import (
    has_neighbours_bore,
    read_drillings,
    with_known_outlets,
    with_outlet_radius,
)
from cranktopo.tasks.crank_import.pockets import read_pockets
from cranktopo.tasks.crank_import.silhouette import apart_mm, drawn_outline, silhouette
from cranktopo.tasks.crank_import.web_candidates import web_candidates

if TYPE_CHECKING:
    from manifold3d import Manifold

_EXACT = 2e-4
"""Distance of outlines over the throw radius below which one counts as the body's own.

The silhouette of a body lies inside it by the chords of its triangles besides: `CHORD_MM`.
"""
_TOLD_EXACT = 2e-5
"""Share of the volume in which a difference of the exact volumes of body and design is told."""
_NEIGHBOURS = "a drilling of a neighbouring throw ends in it and takes {:.4g} mm3 of its design"


@dataclass(frozen=True)
class ReadWeb:
    """A scene with the web that comes nearest to a body, and how near.

    Attributes:
        outline: its outline and counterweight in words.
        outline_mm, outline_rms_mm: largest distance of both silhouettes along the crank, and its root mean
            square.
        compared: the half throw of the body, and that of the scene.
    """

    scene: Scene
    outline: str
    outline_mm: float
    outline_rms_mm: float
    compared: Compared

    def differences_from(self, body: HalfBody) -> Iterator[str]:
        """Yield what `compared` tells, or else the least difference.

        That is one that the exact volumes of both show, or of triangles one beyond their facets.
        """
        found = list(self.compared.differences)
        yield from found
        off = body.solid.volume_mm3 - half_throw_volume_mm3(self.scene)
        if found:
            return
        if body.near != EXACT:
            yield from self.compared.differences_beyond_facets
        elif abs(off) > _TOLD_EXACT * body.solid.volume_mm3:
            neighbours = off < 0 and has_neighbours_bore(body, self.scene)
            yield _NEIGHBOURS.format(-off) if neighbours else self.compared.least_difference(off)


@dataclass(frozen=True)
class ImportedWeb:
    """A distinct half throw beside the design read from it."""

    body: HalfBody
    read: ReadWeb
    name: str


def read_web(
    body: HalfBody,
    throw: Mapping[str, Any],
    material: Mapping[str, Any],
    name: str,
    others: Sequence[Scene] = (),
) -> ReadWeb:
    """Return the scene with the web of a half throw; `others` of the same crank were read before.

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
        data = body.near.rounded(data)
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
    read = ReadWeb(scene, words, *off, Compared(solid, _scene_solid(scene)))
    return _with_features(body, read, others)


def _scene_solid(scene: Scene) -> Manifold:
    return _solid(scene.model_copy(update={"name": "half throw"}))


@lru_cache(maxsize=4)
def _solid(scene: Scene) -> Manifold:
    """Return a half throw by the kernel; several halves of a crank may have one design."""
    return solid_of(kernel_surface_of(scene, "half"), scene.name)


def _with_features(body: HalfBody, read: ReadWeb, others: Sequence[Scene]) -> ReadWeb:
    """Return the web with the bevels, pockets and drillings that bring it nearer to the body."""
    data = read.scene.model_dump(mode="json", exclude_none=True)
    bevels = sorted(read_bevels(body, read.scene), key=lambda bevel: str(bevel["face"]))
    features = [("web", "bevel", table) for table in bevels]
    features += [("web", "pocket", table) for table in read_pockets(body, read.scene)]
    features += [("throw", "drilling", table) for table in read_drillings(body, read.scene)]
    features += [("web", "counterweight", {"edge": table}) for table in read_edge(body, read.scene)]
    for table, key, feature in features:
        before = data[table].get(key, ())
        for form in _forms(body, read.scene, key, body.near.rounded(feature), others):
            changed = {**before, **form} if isinstance(before, dict) else [*before, form]
            tried = {**data, table: {**data[table], key: changed}}
            try:
                found = _changed(read, scene_from_dict(tried, read.scene.name))
            except CranktopoError:
                continue
            if _nearer(found, read):
                data, read = tried, found
            break
    return read


def _forms(
    body: HalfBody, scene: Scene, key: str, table: dict[str, Any], others: Sequence[Scene]
) -> Iterator[dict[str, Any]]:
    """Yield the forms of a feature, of which the first that a design can have is taken."""
    if key == "drilling":
        known = with_known_outlets(table, others)
        yield known if "outlet_radius_mm" in known else with_outlet_radius(table, body, scene)
    yield table


def _nearer(found: ReadWeb, read: ReadWeb) -> bool:
    """Tell whether a web differs from the body by less than another one does.

    Most often the least that can differ tells it, without another pass of the boolean engine.
    """
    differs = found.compared.differs_mm3
    return differs < read.compared.least_mm3 or differs < read.compared.differs_mm3


def _changed(read: ReadWeb, scene: Scene) -> ReadWeb:
    """Return the same body with another scene."""
    return replace(read, scene=scene, compared=Compared(read.compared.solid, _scene_solid(scene)))
