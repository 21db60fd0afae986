"""Ends of the crank along the shaft: outer halves of the outer main journals, and the steps beyond."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from itertools import accumulate
from pathlib import Path

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.solid.step import in_cad_kernel, step_solid
from cranktopo.design.crank import Side
from cranktopo.design.crank_throws import end_journal, throw_scenes
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.throw.crank_end import BodyStep, CylinderStep, EndStep
from cranktopo.throw.journal import Journal
from cranktopo.throw.moments import Moments

SIDES: tuple[Side, ...] = ("free", "output")
_LENGTH_TOLERANCE = 1e-4


@dataclass(frozen=True)
class EndPiece:
    """A piece of an end of the crank.

    Attributes:
        z_mm: its inner and its outer face, from the middle of main journal 0 toward the output.
        moments: about the crank axis, y along throw 1, of unit density.
        product: volume times place along the shaft times place across it; real along throw 1, imaginary +x.
        twist_per_mm3: its twist per torque over the shear modulus: the integral of dz / J.
    """

    step: EndStep
    z_mm: tuple[float, float]
    moments: Moments
    product: complex
    twist_per_mm3: float


def main_journal_places_mm(scene: Scene) -> tuple[float, ...]:
    """Return the middle of every main journal along the shaft, number 0 at 0, mm."""
    return tuple(accumulate((throw.pitch_mm for throw in throw_scenes(scene)), initial=0.0))


def crank_end(scene: Scene, side: Side) -> tuple[EndPiece, ...]:
    """Return the pieces of an end from the middle of the outer main journal outwards, if it has one."""
    outward = -1 if side == "free" else 1
    at = 0.0 if side == "free" else main_journal_places_mm(scene)[-1]
    pieces = []
    for step in _steps(scene, side):
        z_mm = at, at + outward * step.length_mm
        pieces.append(_piece(step, z_mm))
        at = z_mm[1]
    return tuple(pieces)


def end_length_mm(scene: Scene, side: Side) -> float:
    """Return how far an end reaches beyond the middle of the outer main journal; 0 where it has none."""
    return sum(step.length_mm for step in _steps(scene, side))


def ends_volume_mm3(scene: Scene) -> float:
    """Return the volume of both ends of the crank, mm3."""
    return sum(piece.moments.volume for side in SIDES for piece in crank_end(scene, side))


def _steps(scene: Scene, side: Side) -> tuple[EndStep, ...]:
    """Return the outer half of the outer main journal, and the steps beyond."""
    crank, journal = scene.crank, end_journal(scene, side)
    if crank is None or journal is None:
        return ()
    end = crank.end_on(side)
    return _half(journal), *(end.step if end else ())


def _half(journal: Journal) -> CylinderStep:
    """The outer half of a main journal; its outer face has no fillet."""
    return CylinderStep.model_construct(
        kind="cylinder",
        length_mm=journal.length_mm / 2,
        diameter_mm=journal.outer_diameter_mm,
        bore_diameter_mm=journal.bore_diameter_mm,
    )


def _piece(step: EndStep, z_mm: tuple[float, float]) -> EndPiece:
    if isinstance(step, BodyStep):
        moments, product = _body(step, z_mm[1] < z_mm[0])
        # A body twists as the cylinder of its length with its own polar second moment on the mean.
        twist = step.length_mm**2 / moments.polar
    else:
        moments, twist = step.moments(), step.twist_per_mm3()
        product = complex(moments.first_y, moments.first_x) * (z_mm[1] - z_mm[0]) / 2
    start = complex(moments.first_y, moments.first_x) * z_mm[0]
    return EndPiece(step, z_mm, moments, product + start, twist)


def _body(step: BodyStep, free: bool) -> tuple[Moments, complex]:
    """Moments of a body from CAD, and its product about its inner face; its length is checked."""
    path = Path(step.file)
    stamp = path.stat().st_mtime_ns if path.is_file() else 0
    volume, (x, y, z), inertia, (low, high) = _properties(path, stamp)
    expected = (-step.length_mm, 0.0) if free else (0.0, step.length_mm)
    slack = _LENGTH_TOLERANCE * step.length_mm
    if abs(low - expected[0]) > slack or abs(high - expected[1]) > slack:
        raise CranktopoError(
            f"crank.end: the body of '{path.name}' reaches from z = {low:.4g} to {high:.4g} mm, and its step "
            f"from {expected[0]:g} to {expected[1]:g}.",
            hint="Place it at z = 0 and give its length as length_mm.",
        )
    polar = inertia[8] + volume * (x**2 + y**2)
    product = complex(volume * y * z - inertia[5], volume * x * z - inertia[2])
    return Moments(volume, volume * x, volume * y, polar), product


_Properties = tuple[float, tuple[float, float, float], tuple[float, ...], tuple[float, float]]


@lru_cache(maxsize=8)
def _properties(path: Path, stamp: int) -> _Properties:
    return in_cad_kernel(f"crank.end: '{path.name}'", _read_properties, path, f"crank.end: '{path.name}'")


def _read_properties(path: Path, name: str) -> _Properties:
    with cad_session(f"mass of {path}") as gmsh:
        occ = gmsh.model.occ
        _, tag = step_solid(gmsh, path, name)
        x, y, z = occ.getCenterOfMass(3, tag)
        box = gmsh.model.getBoundingBox(3, tag)
        return occ.getMass(3, tag), (x, y, z), tuple(occ.getMatrixOfInertia(3, tag)), (box[2], box[5])
