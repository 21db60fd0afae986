"""Fields of fatigue safety as unstructured VTK files for ParaView."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.files import replacing
from cranktopo.tasks.fatigue.safety_field import FatigueField


def write_fatigue_vtu(path: Path, field: FatigueField) -> None:
    """Write safety, amplitude, mean and signed extremes over the surface of the whole throw.

    Args:
        path: the .vtu file; quadratic triangles, mm, MPa.

    Raises:
        CranktopoError: the file cannot be written.
    """
    import meshio

    points, faces = throw_surface(field)
    high = field.amplitude_MPa + field.mean_MPa
    data = {
        "safety": field.safety.ravel(),
        "amplitude_MPa": field.amplitude_MPa.ravel(),
        "mean_MPa": field.mean_MPa.ravel(),
        "highest_signed_von_mises_MPa": high.ravel(),
        "lowest_signed_von_mises_MPa": (field.mean_MPa - field.amplitude_MPa).ravel(),
        "fillet": np.tile(field.model.on_fillet.astype(float), len(field.model.images)),
    }
    mesh = meshio.Mesh(points, [("triangle6", faces)], point_data=data)
    with replacing(path) as temporary:
        meshio.write(temporary, mesh, file_format="vtu", binary=True, compression="zlib")


def throw_surface(field: FatigueField) -> tuple[Array, NDArray[np.intp]]:
    """Nodes (images x n, 3) and outward six-node faces of the whole throw, image by image."""
    model = field.model
    count, pitch = model.surface.points_mm.shape[1], model.scene.pitch_mm
    points, faces = [], []
    base = _outward(field)
    for index, image in enumerate(model.images):
        points.append(image.points_mm(model.surface.points_mm, pitch).T)
        flipped = image.flip_x != image.flip_z
        faces.append((base[:, [0, 2, 1, 5, 4, 3]] if flipped else base) + index * count)
    return np.concatenate(points), np.concatenate(faces)


def _outward(field: FatigueField) -> NDArray[np.intp]:
    """Faces of the model turned so that their corners run counter-clockwise seen from outside."""
    surface = field.model.surface
    faces = surface.faces.T
    a, b, c = (surface.points_mm[:, faces[:, i]] for i in range(3))
    normal = np.cross((b - a).T, (c - a).T)
    inward = (normal * surface.normals[faces[:, :3]].mean(axis=1)).sum(axis=1) < 0
    return np.where(inward[:, None], faces[:, [0, 2, 1, 5, 4, 3]], faces)
