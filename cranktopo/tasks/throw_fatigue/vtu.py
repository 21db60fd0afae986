"""Fields of fatigue safety as unstructured VTK files for ParaView."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.numerics.tetrahedra.stress import outward_faces, turned_faces
from cranktopo.report.vtu import write_surface_vtu
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField


def write_fatigue_vtu(path: Path, field: FatigueField) -> None:
    """Write safety, amplitude, mean and signed extremes over the surface of the whole throw.

    Args:
        path: the .vtu file; quadratic triangles, mm, MPa.

    Raises:
        CranktopoError: the file cannot be written.
    """
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
    write_surface_vtu(path, points, faces, data)


def throw_surface(field: FatigueField) -> tuple[Array, NDArray[np.intp]]:
    """Nodes (images x n, 3) and outward six-node faces of the whole throw, image by image."""
    model = field.model
    count, pitch = model.surface.points_mm.shape[1], model.scene.pitch_mm
    points, faces = [], []
    base = outward_faces(model.surface)
    for index, image in enumerate(model.images):
        points.append(image.points_mm(model.surface.points_mm, pitch).T)
        flipped = image.flip_x != image.flip_z
        faces.append((turned_faces(base) if flipped else base) + index * count)
    return np.concatenate(points), np.concatenate(faces)
