"""What pages hold of 3D bodies, unpacked as the browser does it."""

from __future__ import annotations

import base64
import json
import struct
import zlib
from typing import Any

import numpy as np

from cranktopo.numerics.surfaces.mesh import SurfaceMesh


def unpacked(text: str) -> tuple[dict[str, Any], list[np.ndarray]]:
    """The header of a packed scene, and its arrays."""
    quick = text.startswith("=")
    block = base64.b64decode(text[1:]) if quick else zlib.decompress(base64.b64decode(text))
    (length,) = struct.unpack("<I", block[:4])
    header = json.loads(block[4 : 4 + length])
    rest = block[4 + length :]
    arrays = [np.frombuffer(rest, a["type"], a["length"], a["offset"]) for a in header["arrays"]]
    return header, arrays


def small_web(text: str) -> SurfaceMesh:
    """The body of `packed_web`: a corner names the vertex so many before the newest one, 0 a new one."""
    header, arrays = unpacked(text)
    (body,) = header["bodies"]
    points = arrays[body["points"]].reshape(-1, 3) / body["steps"]
    corners, named = list[int](), 0
    for newer in arrays[body["corners"]].tolist():
        corners.append(named - newer)
        named += newer == 0
    assert named == len(points)
    return SurfaceMesh(np.array(body["low_mm"]) + points * body["size_mm"], np.array(corners).reshape(-1, 3))
