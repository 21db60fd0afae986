"""What a second OCC binding, which shares no library with gmsh, finds in a STEP file of solids.

Needs the optional extra `cad-check` (cadquery-ocp); `ocp` skips a test without it.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.cad_check.elementary import Array, elementary, torus_of

VOLUME_ACCURACY = 1e-8
"""Relative error to which the volume of each face is integrated."""
PRECISION_MM = 1e-7
_ALIGNED = 1 - 1e-3
"""Cosine between a plane's normal and an axis from which on they are parallel."""
ELEMENTARY = ("Plane", "Cylinder", "Cone", "Sphere", "Torus")
CHORD, TURN_RAD = 2e-3, 0.3
"""Chord error of triangles over the largest dimension of the body, and their largest turn."""
WELD_MM = 1e-6
"""Points of two faces on their common edge are one within it, or within twice the file's tolerance."""
BESIDE_MM = 0.01
"""Distance from a vertex from which on edges that touch there are apart."""
INNER = np.linspace(0.05, 0.95, 7)
"""Places in a face's range of parameters at which its shape is looked at."""
SAME_SPLINE, SAME_SWEPT = 1e-3, 1e-9
"""Relative departure of an elementary surface from a spline, which may approximate it, and from a sweep."""


def ocp(module: str) -> Any:
    """A module of the binding; the test is skipped without it."""
    return pytest.importorskip(f"OCP.{module}", reason="optional extra cad-check (cadquery-ocp) missing")


@dataclass(frozen=True)
class Examined:
    """What was found of a body.

    Attributes:
        faults: each in words; none of a sound body.
        kinds: number of faces by the type of their surface.
        tori_mm: (major, minor) radii of its tori.
        disguised: number of splines and swept faces that are elementary surfaces, by what they are.
        tolerance_mm: largest of all sub-shapes.
        mesh_error: relative difference of the volume inside its triangles.
        thinnest_mm: least width of a face, twice its area over its circumference.
    """

    faults: tuple[str, ...]
    volume_mm3: float
    kinds: dict[str, int]
    tori_mm: tuple[tuple[float, float], ...]
    disguised: dict[str, int]
    tolerance_mm: float
    mesh_error: float
    thinnest_mm: float


def examined(path: Path, bodies: int = 1) -> Examined:
    """Read a STEP file of so many solids again and check all of it."""
    shape = read_shape(path)
    faces, volume = list(sub_shapes(shape, "FACE")), volume_mm3(shape)
    tolerance_mm = float(ocp("ShapeAnalysis").ShapeAnalysis_ShapeTolerance().Tolerance(shape, 1))
    closed, meshed = _meshed(shape, max(WELD_MM, 2 * tolerance_mm))
    return Examined(
        faults=(*_topology(shape, bodies), *_invalid(shape), *crossing_wires(faces), *closed),
        volume_mm3=volume,
        kinds=dict(Counter(surface_kind(face) for face in faces)),
        tori_mm=tuple(sorted({_torus(face) for face in faces if surface_kind(face) == "Torus"})),
        disguised=disguises(shape),
        tolerance_mm=tolerance_mm,
        mesh_error=meshed / volume - 1,
        thinnest_mm=min(map(width_mm, faces)),
    )


def width_mm(face: Any) -> float:
    """Twice the area of a face over its circumference."""
    area, around = (ocp("GProp").GProp_GProps() for _ in range(2))
    properties = ocp("BRepGProp").BRepGProp
    properties.SurfaceProperties_s(face, area)
    properties.LinearProperties_s(face, around)
    return float(2 * area.Mass() / around.Mass())


def read_shape(path: Path) -> Any:
    """The shape in a STEP file."""
    reader = ocp("STEPControl").STEPControl_Reader()
    assert reader.ReadFile(str(path)) == ocp("IFSelect").IFSelect_ReturnStatus.IFSelect_RetDone
    reader.TransferRoots()
    return reader.OneShape()


def volume_mm3(shape: Any, accuracy: float = VOLUME_ACCURACY) -> float:
    """Volume, each face integrated to a relative accuracy."""
    found = ocp("GProp").GProp_GProps()
    ocp("BRepGProp").BRepGProp.VolumeProperties_s(shape, found, accuracy, False, False)
    return float(found.Mass())


def sub_shapes(shape: Any, kind: str, outside: str | None = None) -> Iterator[Any]:
    """Each sub-shape of a kind, those within another kind left out."""
    kinds = ocp("TopAbs").TopAbs_ShapeEnum
    skipped = [getattr(kinds, f"TopAbs_{outside}")] if outside else []
    explorer = ocp("TopExp").TopExp_Explorer(shape, getattr(kinds, f"TopAbs_{kind}"), *skipped)
    cast = ocp("TopoDS").TopoDS
    typed = getattr(cast, f"{kind.capitalize()}_s", None) or getattr(cast, kind.capitalize())  # as of 8.0
    while explorer.More():
        yield typed(explorer.Current())
        explorer.Next()


def surface_kind(face: Any) -> str:
    """Type of a face's surface as the kernel names it."""
    found = ocp("BRepAdaptor").BRepAdaptor_Surface(face).GetType()
    return str(found.name).removeprefix("GeomAbs_")


def disguises(shape: Any) -> dict[str, int]:
    """Number of faces given as splines or sweeps that are elementary surfaces, by what they are.

    A torus counts where it touches a plane across its axis: a short piece of a tube along any curve is one
    but for the kernel's own error. STEP has no toroidal surface whose tube is wider than its ring.
    """
    faces = list(sub_shapes(shape, "FACE"))
    found: Counter[str] = Counter()
    for face in faces:
        given, real = surface_kind(face), real_kind(face)
        if given not in ELEMENTARY and real and (real != "Torus" or _is_fillet(face, faces)):
            found[f"{given} is a {real}"] += 1
    return dict(found)


def _is_fillet(face: Any, faces: list[Any]) -> bool:
    """Tell whether a torus with a ring wider than its tube touches a plane at right angles to its axis."""
    torus = torus_of(*_samples(face))
    beside = [_samples(other)[1][0] for other in faces if real_kind(other) == "Plane" and _touch(face, other)]
    across = any(abs(float(normal @ torus.axis)) > _ALIGNED for normal in beside)
    return across and torus.ring_mm > torus.tube_mm


def real_kind(face: Any) -> str:
    """Type of the elementary surface that a face is, however given; empty where it is none."""
    given = surface_kind(face)
    if given in ELEMENTARY:
        return given
    return elementary(*_samples(face), SAME_SPLINE if "Spline" in given else SAME_SWEPT)


def _touch(face: Any, other: Any) -> bool:
    edges = list(sub_shapes(other, "EDGE"))
    return any(edge.IsSame(one) for edge in sub_shapes(face, "EDGE") for one in edges)


def _samples(face: Any) -> tuple[Array, Array, Array]:
    """Points (n, 3), unit normals and principal curvatures (n, 2) over a face's range of parameters."""
    low_u, high_u, low_v, high_v = ocp("BRepTools").BRepTools.UVBounds_s(face)
    adaptor = ocp("BRepAdaptor").BRepAdaptor_Surface(face)
    found = ocp("BRepLProp").BRepLProp_SLProps(adaptor, 2, PRECISION_MM)
    points, normals, curvatures = [], [], []
    for u in low_u + (high_u - low_u) * INNER:
        for v in low_v + (high_v - low_v) * INNER:
            found.SetParameters(float(u), float(v))
            if not (found.IsNormalDefined() and found.IsCurvatureDefined()):
                continue
            point, normal = found.Value(), found.Normal()
            points.append((point.X(), point.Y(), point.Z()))
            normals.append((normal.X(), normal.Y(), normal.Z()))
            curvatures.append((found.MinCurvature(), found.MaxCurvature()))
    return np.array(points), np.array(normals), np.array(curvatures)


def _torus(face: Any) -> tuple[float, float]:
    torus = ocp("BRepAdaptor").BRepAdaptor_Surface(face).Torus()
    return round(torus.MajorRadius(), 6), round(torus.MinorRadius(), 6)


def _topology(shape: Any, bodies: int) -> Iterator[str]:
    """So many solids of one shell each without free edges, nothing beside them."""
    counts = [
        sum(1 for _ in sub_shapes(shape, kind, holder))
        for kind, holder in (
            ("SOLID", None),
            ("SHELL", None),
            ("SHELL", "SOLID"),
            ("FACE", "SHELL"),
            ("EDGE", "FACE"),
            ("VERTEX", "EDGE"),
        )
    ]
    if counts != [bodies, bodies, 0, 0, 0, 0]:
        yield f"solids, shells, loose shells, faces, edges, vertices: {counts}"
    shells = ocp("ShapeAnalysis").ShapeAnalysis_Shell()
    shells.LoadShells(shape)
    shells.CheckOrientedShells(shape, True, True)
    if shells.HasFreeEdges() or shells.HasBadEdges():
        yield "free or wrongly turned edges"


def _invalid(shape: Any) -> Iterator[str]:
    """Sub-shapes that the kernel's own check finds invalid, geometry included."""
    analyzer = ocp("BRepCheck").BRepCheck_Analyzer(shape, True)
    if not analyzer.IsValid():
        bad = {
            kind: sum(not analyzer.IsValid(sub) for sub in _distinct(sub_shapes(shape, kind)))
            for kind in ("VERTEX", "EDGE", "WIRE", "FACE", "SHELL", "SOLID")
        }
        yield f"BRepCheck: {', '.join(f'{n} {kind.lower()}' for kind, n in bad.items() if n)} invalid"


def _distinct(shapes: Iterator[Any]) -> Iterator[Any]:
    seen: list[Any] = []
    for one in shapes:
        if not any(one.IsSame(other) for other in seen):
            seen.append(one)
            yield one


def crossing_wires(faces: list[Any]) -> Iterator[str]:
    """Wires with an edge that crosses itself or the next one.

    Edges that touch at their common vertex are found, too: they are within the precision beside it, and
    apart from each other farther away.
    """
    for face in faces:
        for wire in sub_shapes(face, "WIRE"):
            analysis = ocp("ShapeAnalysis").ShapeAnalysis_Wire(wire, face, PRECISION_MM)
            for number in range(1, analysis.NbEdges() + 1):
                if analysis.CheckSelfIntersectingEdge(number):
                    yield f"edge of a {surface_kind(face)} crosses itself"
                if analysis.CheckIntersectingEdges(number):
                    edges = [
                        analysis.WireData().Edge(one) for one in (number - 1 or analysis.NbEdges(), number)
                    ]
                    if _apart_mm(*edges) <= PRECISION_MM:
                        yield f"edges of a {surface_kind(face)} cross"


def _apart_mm(one: Any, other: Any) -> float:
    """Least distance of two edges, beyond `BESIDE_MM` from their ends; infinite from one that is a point."""
    if not all(ocp("BRepAdaptor").BRepAdaptor_Curve(edge).Is3DCurve() for edge in (one, other)):
        return math.inf
    inner = [_inner_edge(edge) for edge in (one, other)]
    return float(ocp("BRepExtrema").BRepExtrema_DistShapeShape(*inner).Value())


def _inner_edge(edge: Any) -> Any:
    curve = ocp("BRepAdaptor").BRepAdaptor_Curve(edge)
    first, last = curve.FirstParameter(), curve.LastParameter()
    ends = [(first, 1), (last, -1)]
    low, high = (
        at + side * min(BESIDE_MM / curve.DN(at, 1).Magnitude(), (last - first) / 10) for at, side in ends
    )
    return ocp("BRepBuilderAPI").BRepBuilderAPI_MakeEdge(curve.Curve().Curve(), low, high).Edge()


def _meshed(shape: Any, weld_mm: float) -> tuple[list[str], float]:
    """What is wrong with the triangles of a body, and the volume inside them."""
    box = ocp("Bnd").Bnd_Box()
    ocp("BRepBndLib").BRepBndLib.Add_s(shape, box)
    low, high = box.CornerMin(), box.CornerMax()
    chord = CHORD * max(high.X() - low.X(), high.Y() - low.Y(), high.Z() - low.Z())
    mesh = ocp("BRepMesh").BRepMesh_IncrementalMesh(shape, chord, False, TURN_RAD, False)
    faults = [] if mesh.GetStatusFlags() == 0 else [f"BRepMesh: status {mesh.GetStatusFlags()}"]
    parts = [_triangles(face) for face in sub_shapes(shape, "FACE")]
    if any(part is None for part in parts):
        return [*faults, "BRepMesh: a face has no triangles"], float("nan")
    corners = np.concatenate([part for part in parts if part is not None])
    volume = float(np.einsum("ij,ij->", corners[:, 0], np.cross(corners[:, 1], corners[:, 2])) / 6)
    open_edges = _open_edges(corners, weld_mm)
    return [*faults, *([f"BRepMesh: {open_edges} open edges"] if open_edges else [])], volume


def _triangles(face: Any) -> Array | None:
    """Corners (n, 3, 3) of a face's triangles, outward."""
    place = ocp("TopLoc").TopLoc_Location()
    found = ocp("BRep").BRep_Tool.Triangulation_s(face, place)
    if found is None or not found.NbTriangles():
        return None
    points = [found.Node(k + 1).Transformed(place.Transformation()) for k in range(found.NbNodes())]
    xyz = np.array([(point.X(), point.Y(), point.Z()) for point in points])
    corners = np.array([found.Triangle(k + 1).Get() for k in range(found.NbTriangles())]) - 1
    reversed_ = face.Orientation() == ocp("TopAbs").TopAbs_Orientation.TopAbs_REVERSED
    return xyz[corners[:, ::-1] if reversed_ else corners]


def _open_edges(corners: Array, weld_mm: float) -> int:
    """Number of directed edges of triangles without their counterpart, points welded."""
    from scipy.spatial import cKDTree

    points = corners.reshape(-1, 3)
    ties = cKDTree(points).query_ball_point(points, weld_mm)
    name = np.array([min(tie) for tie in ties]).reshape(-1, 3)
    name = name[(name != np.roll(name, 1, axis=1)).all(axis=1)]
    edges = Counter(map(tuple, np.concatenate([name[:, [0, 1]], name[:, [1, 2]], name[:, [2, 0]]]).tolist()))
    return sum(abs(count - edges[end, start]) for (start, end), count in edges.items())
