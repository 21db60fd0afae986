"""Check of a solid against the closed form of its volume, and its mass properties."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

from cranktopo.base.errors import CranktopoError, ExitCode, solver_error
from cranktopo.bodies.solid.culprit import Culprit
from cranktopo.numerics.cad_volume import triangulated_moments, triangulated_volume_mm3
from cranktopo.numerics.gmsh_session import DimTags, unless_it_fails

VOLUME_TOLERANCE = 2e-5
"""Relative difference between the CAD kernel's volume and the closed form that is let through.

The kernel integrates over faces that end in intersection curves, such as a crowned bevel through a spline
outline, to about 5e-6 of the half throw; the smallest pocket is 1e-4 of it.
"""
DOUBTFUL = 100.0
"""Difference, over what is allowed, up to which it may be the kernel's integration alone: 53 was seen."""
ROUNDING_TOLERANCE = 0.05
"""The same of what the roundings of outlets take.

The kernel's take less than a rolled ball: 1 % at 0.4 of the bore's radius, 13 % at 1.6 where the bore leans
by 27 deg (`tests/physics/throw/test_outlet_roundings.py`).
"""


class NotCutError(CranktopoError):
    """The parts into which the CAD kernel cut a body do not add up to it."""


def check_parts(parts_mm3: float, whole_mm3: float, share: float = VOLUME_TOLERANCE) -> None:
    """Check that the volumes of a body's parts differ from its own by no more than a share of it.

    Raises:
        NotCutError: they do; the kernel may lose a part where a face lies in a plane but for rounding.
    """
    if abs(parts_mm3 - whole_mm3) > share * whole_mm3:
        raise NotCutError(
            f"the CAD kernel cannot cut this body: its parts have {parts_mm3:.2f} mm3 together, "
            f"the whole {whole_mm3:.2f} mm3.",
            hint="Repair the solid in CAD, or give it as STL.",
            code=ExitCode.SOLVER,
        )


def volume_mm3(occ: Any, body: DimTags) -> float:
    """Return the volume of all solids of a body, mm3."""
    return float(sum(occ.getMass(*pair) for pair in _solids(body)))


@dataclass(frozen=True)
class SolidProperties:
    """Mass properties of a body of unit density; inertia is the integral of x2 + y2 about the crank axis."""

    volume_mm3: float
    centre_mm: tuple[float, float, float]
    inertia_z_mm5: float


@dataclass(frozen=True)
class ClosedForm:
    """Volume of a body by the closed form, mm3, and that part of it which outlets' roundings take."""

    volume_mm3: float
    roundings_mm3: float = 0.0

    @property
    def allowed_mm3(self) -> float:
        """Largest difference of the kernel's volume that is let through."""
        return VOLUME_TOLERANCE * self.volume_mm3 + ROUNDING_TOLERANCE * self.roundings_mm3


def check_body(
    occ: Any,
    body: DimTags,
    expected: ClosedForm,
    name: str,
    find_culprit: Callable[[], Culprit] | None = None,
) -> None:
    """Check that the kernel gave one body, its volume by the closed form, else raise CranktopoError.

    Where the kernel's own integration misses the closed form by little, triangles on the faces decide.

    Args:
        find_culprit: returns the feature that makes the difference, for the message.
    """
    missed = misfit(occ, body, expected)
    if missed <= 1 or (missed <= DOUBTFUL and _fits_by_triangles(body, expected)):
        return
    found = find_culprit() if find_culprit else None
    solids, by = _solids(body), f", from {found.feature} on" if found else ""
    if len(solids) != 1:
        raise CranktopoError(
            f"{name}: falls apart into {len(solids)} bodies{by}; {_smallest(occ, solids)}.",
            hint="A pocket or a drilling cuts it through there, or the outline does not join the journals.",
        )
    raise solver_error(
        f"{name}: the CAD kernel built {occ.getMass(*solids[0]):.2f} mm3, the closed form is "
        f"{expected.volume_mm3:.2f} mm3{by}.",
        found.hint
        if found
        else "Features touch or overlap in a way it cannot resolve: move them apart by 0.1 mm.",
    )


def _fits_by_triangles(body: DimTags, expected: ClosedForm) -> bool:
    """Tell whether triangles hold the volume; a body whose faces have none does not."""
    ((_, tag),) = _solids(body)
    found = unless_it_fails(lambda: [triangulated_volume_mm3(tag)])
    return any(_off(volume, expected) <= 1 for volume in found)


def _smallest(occ: Any, solids: DimTags) -> str:
    """Return size and place of the smallest of bodies, or that there is none."""
    if not solids:
        return "no solid is left"
    least = min(solids, key=lambda pair: float(occ.getMass(*pair)))
    place = ", ".join(f"{value:.1f}" for value in occ.getCenterOfMass(*least))
    return f"the smallest has {occ.getMass(*least):.3g} mm3 at ({place}) mm"


def check_no_hollow(occ: Any, body: DimTags, name: str) -> None:
    """Check that one body has no closed hollow, which no tool reaches, else raise CranktopoError."""
    ((_, tag),) = _solids(body)
    _, shells = occ.getSurfaceLoops(tag)
    if len(shells) == 1:
        return
    boxes = [_box(occ, shell) for shell in shells]
    boxes.remove(max(boxes, key=lambda box: math.dist(box[:3], box[3:])))
    x, y, z = ((low + high) / 2 for low, high in zip(boxes[0][:3], boxes[0][3:], strict=True))
    raise CranktopoError(
        f"{name}: has {len(boxes)} closed hollows that no tool reaches, one of them at "
        f"x = {x:.4g}, y = {y:.4g}, z = {z:.4g} mm.",
        hint="Where two webs are one flying web, take no pocket from the faces that they have in common.",
    )


def _box(occ: Any, faces: Sequence[int]) -> tuple[float, ...]:
    """Least and largest coordinates of faces, mm."""
    boxes = [occ.getBoundingBox(2, int(face)) for face in faces]
    columns = list(zip(*boxes, strict=True))
    return (*map(min, columns[:3]), *map(max, columns[3:]))


def misfit(occ: Any, body: DimTags, expected: ClosedForm) -> float:
    """Return the difference of the kernel's volume over what is allowed; inf if it is not one body."""
    solids = _solids(body)
    return _off(float(occ.getMass(*solids[0])), expected) if len(solids) == 1 else math.inf


def _off(volume_mm3: float, expected: ClosedForm) -> float:
    return abs(volume_mm3 - expected.volume_mm3) / expected.allowed_mm3


def without_crumbs(occ: Any, bodies: DimTags, form: ClosedForm) -> DimTags:
    """Return the largest body alone where it has the whole volume: tools that overlap leave crumbs."""
    solids = sorted(_solids(bodies), key=lambda pair: -occ.getMass(*pair))
    if len(solids) < 2 or misfit(occ, solids[:1], form) > 1:
        return bodies
    occ.remove(solids[1:], recursive=True)
    return solids[:1]


def _solids(body: DimTags) -> DimTags:
    return [pair for pair in body if pair[0] == 3]


def solid_properties(occ: Any, body: DimTags, form: ClosedForm | None = None) -> SolidProperties:
    """Return volume, centre and inertia about the crank axis of one body, from the kernel's exact faces.

    Args:
        form: closed form of a checked body. By triangles where the kernel integrates it wrong.
    """
    (tag,) = [tag for dim, tag in body if dim == 3]
    volume = float(occ.getMass(3, tag))
    if form is not None and _off(volume, form) > 1:
        found = triangulated_moments(tag)
        return SolidProperties(found.volume, found.centre, found.polar)
    x, y, z = occ.getCenterOfMass(3, tag)
    about_centre = occ.getMatrixOfInertia(3, tag)[8]
    return SolidProperties(volume, (x, y, z), about_centre + volume * (x**2 + y**2))
