"""Deviation of each dimension of a design from its body: that of the faces which tell it.

The faces of a feature are found by leaving out one at a time: without them it is not read.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from cranktopo.design.schema import Scene
from cranktopo.tasks.crank_import.bevelled_edge import read_edge
from cranktopo.tasks.crank_import.bevels import read_bevels
from cranktopo.tasks.crank_import.half_body import HalfBody
from cranktopo.tasks.crank_import.oil_drillings import read_drillings
from cranktopo.tasks.crank_import.pockets import read_pockets
from cranktopo.tasks.crank_import.web_reading import ImportedWeb
from cranktopo.tasks.importing.faces import CylinderFace, Faces, PlaneFace, TorusFace

_Face = CylinderFace | PlaneFace | TorusFace
_READERS: dict[str, Callable[[HalfBody, Scene], Iterator[dict[str, Any]]]] = {
    "web.bevel": read_bevels,
    "web.pocket": read_pockets,
    "throw.drilling": read_drillings,
    "web.counterweight.edge": read_edge,
}
_FEATURE = re.compile(rf"({'|'.join(map(re.escape, _READERS))})(?:\[(\d+)\])?\.")
_JOURNALS = ("main_journal", "crankpin")
_ALONG = 1 - 1e-6
_NEAR_MM = 0.02
"""Distance of an axis, a radius or a place at which a face counts as that of a dimension."""


def deviation_mm(web: ImportedWeb, key: str) -> float | None:
    """Return how far the faces that tell a dimension are from the body, at least the rounding in the design.

    None where no face tells it: the radius of a drilling's outlet, whose surface is approximate.
    """
    found = _off_mm(web, key)
    return None if found is None else max(found, web.body.near.rounding_mm)


def _off_mm(web: ImportedWeb, key: str) -> float | None:
    feature = _FEATURE.match(key)
    if key.endswith("outlet_radius_mm"):
        return None
    if feature:
        return _worst(_faces_of_feature(web, feature[1], feature[2]))
    if key.startswith("throw."):
        return _worst(_faces_of_journals(web, key))
    if key.endswith("thickness_mm"):
        return _worst(plane for plane in web.body.faces.planes if abs(plane.normal[2]) > _ALONG)
    return web.read.outline_mm


def _worst(faces: Iterable[_Face]) -> float | None:
    return max((face.off_mm for face in faces), default=None)


def _faces_of_journals(web: ImportedWeb, key: str) -> Iterator[_Face]:
    """Yield the faces of a journal that tell a key of it; the throw's radius has those of both."""
    throw, faces = web.read.scene.throw, web.body.faces
    for name, (journal, y) in zip(_JOURNALS, throw.journals, strict=True):
        if key.startswith(f"throw.{name}.length"):
            yield from (plane for plane in faces.planes if abs(plane.normal[2]) > _ALONG)
        elif key.startswith(f"throw.{name}.fillet") or key.startswith(f"throw.{name}.recess"):
            yield from (torus for torus in faces.tori if _beside(torus.centre_mm, y) < _NEAR_MM)
        elif key.startswith(f"throw.{name}.") or key == "throw.radius_mm":
            bore = key.endswith("bore_diameter_mm")
            radius = journal.bore_diameter_mm / 2 if bore else journal.radius_mm
            rounds = (face for face in faces.cylinders if _is_round(face, y, radius))
            yield from (face for face in rounds if face.outward != bore)


def _is_round(face: CylinderFace, y_mm: float, radius_mm: float) -> bool:
    near = _beside(face.point_mm, y_mm) < _NEAR_MM and abs(face.radius_mm - radius_mm) < _NEAR_MM
    return face.upright and near


def _beside(point_mm: np.ndarray, y_mm: float) -> float:
    return float(np.hypot(point_mm[0], point_mm[1] - y_mm))


def _faces_of_feature(web: ImportedWeb, key: str, index: str | None) -> Iterator[_Face]:
    """Yield the faces without which a feature of the design is not read."""
    table: Any = web.read.scene.model_dump(mode="json", exclude_none=True)
    for part in key.split("."):
        table = table[part]
    own = table[int(index)] if index else table
    for face, others in _without_one(web.body.faces):
        read = list(_READERS[key](replace(web.body, faces=others), web.read.scene))
        if not any(_is_said(web.body.near.rounded(one), own) for one in read):
            yield face


def _without_one(faces: Faces) -> Iterator[tuple[_Face, Faces]]:
    for name in ("cylinders", "planes"):
        every = getattr(faces, name)
        for at, face in enumerate(every):
            yield face, replace(faces, **{name: every[:at] + every[at + 1 :]})


def _is_said(read: dict[str, Any], own: dict[str, Any]) -> bool:
    return all(own.get(name) == value for name, value in read.items())
