"""Fillets of a body from CAD: found on its faces, not taken from the design."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.design.schema import Scene
from cranktopo.throw.journal import ASPECT, FilletSection

_FIT_MM = 1e-3
"""Largest distance of a face's points from a circle or ellipse turned about the axis of a journal."""
_TANGENT_MM = 0.02
"""Allowed distance of a fillet's ends from the journal's cylinder and the web's face."""
_LEAST_MM = 0.05
_SAMPLES = 7
_LARGEST_CONDITION = 1e8
_NAMES = {"main_journal": "main journal", "crankpin": "crankpin"}


@dataclass(frozen=True)
class FilletRing:
    """A face that is part of a ring about the axis of a journal: centre circle, mm, and section."""

    centre_radius_mm: float
    centre_z_mm: float
    section: FilletSection


def with_found_fillets(gmsh: Any, scene: Scene, name: str) -> Scene:
    """Return the scene with the fillets of the half throw that the open, synchronised session holds.

    Raises:
        CranktopoError: a journal without a round or elliptical fillet that is tangent to it and to the web's
            face.
    """
    patches, throw = _patches(gmsh), scene.throw
    for key, y in zip(_NAMES, (0.0, throw.radius_mm), strict=True):
        rings = [ring for points in patches if (ring := ring_of(points, y)) is not None]
        found = _fillet(scene, key, rings, name)
        axial = None if found.round else found.axial_mm
        update = {"fillet_mm": found.radial_mm, "fillet_axial_mm": axial}
        throw = throw.model_copy(update={key: getattr(throw, key).model_copy(update=update)})
    return scene.model_copy(update={"throw": throw})


def ring_of(points_mm: Array, axis_y_mm: float) -> FilletRing | None:
    """Return the ring about the line x = 0, y = `axis_y_mm` that points (n, 3) lie on; None without one.

    In the half-plane through the axis the points lie on a circle, found by linear least squares
    (I. Kasa, A circle fitting procedure and its error analysis, IEEE Trans. IM 25, 1976), else on an ellipse
    with its axes along the crank and across, found likewise.
    """
    out, z = np.hypot(points_mm[:, 0], points_mm[:, 1] - axis_y_mm), points_mm[:, 2]
    return _ring(out, z, round_=True) or _ring(out, z, round_=False)


def _ring(out: Array, z: Array, *, round_: bool) -> FilletRing | None:
    middle = out.mean(), z.mean()
    u, v = out - middle[0], z - middle[1]
    size = max(np.ptp(u), np.ptp(v))
    if size == 0:
        return None
    columns, right = [2 * u / size, 2 * v / size, np.ones_like(u)], (u**2 + v**2) / size**2
    matrix = np.stack(columns if round_ else [*columns, -((v / size) ** 2)], axis=1)
    if np.linalg.cond(matrix) > _LARGEST_CONDITION:
        return None
    a, b, c, *flatter = np.linalg.lstsq(matrix, right, rcond=None)[0] * size
    square = 1 + sum(flatter) / size  # of the radial over the axial semi-axis
    if not ASPECT[0] <= 1 / np.sqrt(max(square, 1e-9)) <= ASPECT[1]:
        return None
    b /= square
    radius = float(np.sqrt(max(c * size + a**2 + square * b**2, 0.0)))
    section = FilletSection(radius, radius / float(np.sqrt(square)))
    if np.abs(section.off_mm(u - a, v - b)).max() > _FIT_MM:
        return None
    return FilletRing(float(a + middle[0]), float(b + middle[1]), section)


def _patches(gmsh: Any) -> list[Array]:
    """Return points (n, 3) on every face that is neither plane nor cylinder."""
    faces = [tag for _, tag in gmsh.model.getEntities(2)]
    return [
        sampled(gmsh, tag) for tag in faces if gmsh.model.getType(2, tag) not in ("Plane", "Cylinder", "Cone")
    ]


def sampled(gmsh: Any, tag: int) -> Array:
    """Return points (n, 3) on a face of the open session."""
    low, high = gmsh.model.getParametrizationBounds(2, tag)
    u, v = np.meshgrid(*(np.linspace(a, b, _SAMPLES) for a, b in zip(low, high, strict=True)))
    values = gmsh.model.getValue(2, tag, np.stack([u.ravel(), v.ravel()], axis=1).ravel())
    return np.asarray(values).reshape(-1, 3)


def _fillet(scene: Scene, key: str, rings: list[FilletRing], name: str) -> FilletSection:
    journal, (start, end) = getattr(scene.throw, key), scene.web_z_mm
    face, toward = (start, 1.0) if key == "main_journal" else (end, -1.0)
    near = []
    for ring in rings:
        radial, axial = ring.section.radial_mm, ring.section.axial_mm
        foot, top = ring.centre_radius_mm - radial, ring.centre_z_mm + toward * axial
        off = max(abs(foot - journal.radius_mm), abs(top - face))
        if off < _TANGENT_MM and ring.section.shorter_mm > _LEAST_MM:
            return FilletSection(round(radial, 9), round(axial, 9))
        if off < radial:
            near.append((off, foot, top, radial))
    what = f"{name}: no fillet found at the {_NAMES[key]}"
    if near:
        _, foot, top, radius = min(near)
        raise CranktopoError(
            f"{what} that runs from its {journal.outer_diameter_mm:g} mm cylinder into the web's face at "
            f"z = {face:g} mm: one of {radius:.3g} mm runs from {2 * foot:.4g} mm diameter to "
            f"z = {top:.4g} mm.",
            hint="Correct the dimensions of the design given with --design.",
        )
    raise CranktopoError(
        f"{what}: the stress at a sharp edge is singular, so that any value of it follows from the mesh.",
        hint="Give the body a round fillet of constant radius there, or an elliptical one.",
    )
