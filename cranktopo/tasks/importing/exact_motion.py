"""Motions that may put a body from CAD where a scene's journals are, from its exact cylinders and planes.

Cross-sections of triangles tell a place to their chord; the axes of faces tell it to the last digit, in any
attitude. Two journals of one body allow up to four motions: which one is right, sections tell.

A moved body has the rounding of the motion in its numbers, and the kernel cuts and meshes it in another way
than the same body that was not moved. So the numbers of both are rounded alike, coarser than that and far
finer than any dimension: then they are one body, and have one mesh.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.solid.checked import volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags, quiet_stdout
from cranktopo.tasks.importing.faces import (
    CylinderFace,
    Faces,
    exact_faces,
    from_line_mm,
    parallel,
)

Motion = tuple[Array, Array]
"""Rotation (3, 3) and shift, mm, (3,) after it."""
_SIZE = 0.015
"""Allowed error of a diameter and of the throw's radius over it, as that of a body's sections."""
_DECIMALS = {"CARTESIAN_POINT": 9, "DIRECTION": 11}
"""Decimals, of mm and of 1, that a body keeps. The kernel writes 12: 60 mm along an axis are 1e-10 mm off."""
_SAME = 1e-9
"""Share of the volume that rounding may change."""
_PLACES = re.compile(rf"({'|'.join(_DECIMALS)})(\s*\('[^']*',\s*)(\([^)]*\))")
_REAL = re.compile(r"[-+]?\d+\.\d*(?:E[-+]?\d+)?")


def exact_motions(gmsh: Any, scene: Scene) -> list[Motion]:
    """Return the motions of the open, synchronised session's body, those that turn it least first.

    Each puts the axis of a cylinder of the main journal's diameter on z, the plane end beyond it on z = 0,
    and a parallel cylinder of the crankpin's diameter on the y axis. Empty where a body has no such faces.
    """
    faces = exact_faces(gmsh)
    mains, pins = (
        [face for face in faces.cylinders if face.outward and _near(face.radius_mm, journal.radius_mm)]
        for journal, _ in scene.throw.journals
    )
    motions = [
        motion
        for main, pin in product(mains, pins)
        if parallel(main.axis, pin.axis)
        and _near(from_line_mm(pin.point_mm, main.point_mm, main.axis), scene.throw.radius_mm)
        for motion in _motions(main, pin, faces)
    ]
    return sorted(motions, key=lambda motion: -float(np.trace(motion[0])))


def _near(found: float, asked: float) -> bool:
    return abs(found - asked) < _SIZE * asked


def _motions(main: CylinderFace, pin: CylinderFace, faces: Faces) -> Iterator[Motion]:
    """Yield the motions of one pair of journals, z along the axis and against it."""
    axis = _mean_axis(main.axis, faces)
    for z in (axis, -axis):
        ends = [
            float(plane.point_mm @ z)
            for plane in faces.planes
            if parallel(plane.normal, z) and plane.normal @ z < 0
        ]
        if not ends:
            continue
        across = pin.point_mm - main.point_mm
        y = across - (across @ z) * z
        y /= np.linalg.norm(y)
        turn = np.array([np.cross(y, z), y, z])
        shift = -turn @ main.point_mm
        shift[2] = -min(ends)
        yield turn, shift


def _mean_axis(axis: Array, faces: Faces) -> Array:
    """Return the mean direction of all faces along an axis and across it: one has the rounding of a file."""
    found = [face.axis for face in faces.cylinders] + [plane.normal for plane in faces.planes]
    total = sum((one * np.sign(one @ axis) for one in found if parallel(one, axis)), np.zeros(3))
    return np.asarray(total / np.linalg.norm(total))


def snapped(gmsh: Any, body: DimTags) -> DimTags:
    """Return the open session's one body with its points and directions rounded, where the kernel keeps it.

    It is written and read again: a body whose volume that changes stays as it is.
    """
    occ = gmsh.model.occ
    occ.synchronize()
    with TemporaryDirectory() as folder:
        file = Path(folder) / "body.step"
        with quiet_stdout():
            gmsh.write(str(file))
            file.write_text(_PLACES.sub(_rounded, file.read_text(encoding="ascii")), encoding="ascii")
            found = occ.importShapes(str(file))
    same = [dim for dim, _ in found] == [3] and abs(
        volume_mm3(occ, found) / volume_mm3(occ, body) - 1
    ) < _SAME
    kept, spare = (found, body) if same else (body, found)
    occ.remove(spare, recursive=True)
    occ.synchronize()
    return list(kept)


def _rounded(place: re.Match[str]) -> str:
    """Return a point or direction of a STEP file with its decimals; a real of it needs a point."""

    def real(number: re.Match[str]) -> str:
        text = f"{float(number[0]):.{_DECIMALS[place[1]]}f}".rstrip("0")
        return "0." if text == "-0." else text

    return place[1] + place[2] + _REAL.sub(real, place[3])
