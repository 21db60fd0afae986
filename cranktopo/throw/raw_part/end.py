"""The raw end of a crank: half a main journal and the steps beyond it, solid, with allowance and draft.

Heights count outwards from the middle of the outer main journal. The parting plane is x = 0, that of the
throw beside it.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import accumulate, pairwise

from cranktopo.base.errors import invalid
from cranktopo.throw.crank_end import BodyStep, EndStep
from cranktopo.throw.raw_part.bodies import Collar, RawBody, RawHalf
from cranktopo.throw.raw_part.prism import drafted_disc
from cranktopo.throw.raw_part.table import Forging

_LEAST_SHOULDER = 0.005
"""Step of a radius, over it, that is no sliver."""
_MOST_DRAFT = math.radians(30.0)
"""Angle of a cone's lines across it, at most: a flatter or thinner cone is forged as a cylinder."""
_EQUAL = 1e-9


@dataclass(frozen=True)
class _RawStep:
    """A step with its allowance on the radius; heights and radii are those of its inner and outer face."""

    key: str
    z_mm: tuple[float, float]
    radii_mm: tuple[float, float]

    @property
    def slope(self) -> float:
        """Growth of the radius per mm outwards."""
        return (self.radii_mm[1] - self.radii_mm[0]) / (self.z_mm[1] - self.z_mm[0])

    def draft(self, forging: Forging) -> float:
        """Return the angle of a cone's lines across it, rad.

        With it all of the cone has the draft, and the lines reach as far as its circles where they end in
        the land of the flash.
        """
        steep = math.sin(math.radians(forging.draft_deg)) * math.hypot(1.0, self.slope)
        landed = 2 * math.atan(forging.land_mm / min(self.radii_mm))
        return max(math.asin(min(steep, 1.0)), landed)

    def overlap_mm(self, allowance_mm: float) -> float:
        """Return how far a cylinder goes on into this cone until both differ by more than a sliver."""
        length = self.z_mm[1] - self.z_mm[0]
        return min(max(allowance_mm, _LEAST_SHOULDER * max(self.radii_mm) / abs(self.slope)), length / 4)


@dataclass(frozen=True)
class _Face:
    """An end of a step: where it lies, and whether it is open and so needs draft."""

    z_mm: float
    open: bool


def raw_end(journal_radius_mm: float, half_mm: float, steps: dict[str, EndStep], forging: Forging) -> RawHalf:
    """Return a raw end of a crank.

    Args:
        half_mm: half the length of the outer main journal.
        steps: the steps from its outer face outwards, by their key paths.
    """
    found = _raw_steps(journal_radius_mm, half_mm, steps, forging)
    bodies = tuple(body for index in range(len(found)) for body in _bodies(found, index, forging))
    reaches = min(bodies, key=lambda body: body.z_mm[0])
    low = reaches.z_mm[0]
    if low < 0:
        raise invalid(
            "forging.allowance_mm",
            forging.allowance_mm,
            f"with the draft of {forging.draft_deg:g} deg {reaches.key} reaches {-low:.4g} mm over the "
            "middle of the outer main journal",
            "Reduce it, the draft, or the diameter of the steps beside the journal.",
        )
    return RawHalf("raw end", (0.0, max(body.z_mm[1] for body in bodies)), (), (), bodies)


def machined_in_end(steps: dict[str, EndStep]) -> tuple[str, ...]:
    """Return the keys of what is machined out of the full: bores, bolt holes and keyways of the steps."""
    return tuple(
        f"{key}.{name}"
        for key, step in steps.items()
        for name, cut in (
            ("bore_diameter_mm", step.bore_radius_mm),
            ("bolts", step.bolt_holes_mm),
            ("depth_mm", step.slot),
        )
        if cut
    )


def _raw_steps(
    journal_radius_mm: float, half_mm: float, steps: dict[str, EndStep], forging: Forging
) -> list[_RawStep]:
    """Return the half journal and the steps with their allowance; a flat cone is a cylinder."""
    found = [("journal", half_mm, (journal_radius_mm, journal_radius_mm))]
    for key, step in steps.items():
        if isinstance(step, BodyStep):
            hint = "Give cylinders and cones instead."
            raise invalid(f"{key}.kind", step.kind, "a body from CAD has no raw part", hint)
        found.append((key, step.length_mm, step.radii_mm))
    planes = accumulate((length for _, length, _ in found), initial=0.0)
    more = forging.allowance_mm
    raw = [
        _RawStep(key, z_mm, (inner + more, outer + more))
        for (key, _, (inner, outer)), z_mm in zip(found, pairwise(planes), strict=True)
    ]
    return [_cylinder(step) if step.draft(forging) > _MOST_DRAFT else step for step in raw]


def _cylinder(step: _RawStep) -> _RawStep:
    widest = max(step.radii_mm)
    return _RawStep(step.key, step.z_mm, (widest, widest))


def _bodies(steps: Sequence[_RawStep], index: int, forging: Forging) -> Iterator[RawBody]:
    """Yield the bodies of a step, the ends of which depend on the steps beside it."""
    step, more = steps[index], forging.allowance_mm
    faces = (
        _face(step, 0, steps[index - 1], more) if index else _Face(step.z_mm[0], False),
        _face(step, 1, steps[index + 1] if index + 1 < len(steps) else None, more),
    )
    if step.slope == 0:
        ends, tilted = (faces[0].z_mm, faces[1].z_mm), (faces[0].open, faces[1].open)
        yield drafted_disc(step.key, step.radii_mm[0], 0.0, ends, tilted, forging)
    else:
        yield from _cone(step, faces, forging)


def _face(step: _RawStep, end: int, beside: _RawStep | None, allowance_mm: float) -> _Face:
    """Return the inner or outer end of a step beside another one, or beside none at the end of the shaft.

    A step that is the wider one goes on by the allowance, and its face has draft. A cone and a cylinder of
    one diameter overlap, so that no face is a sliver.
    """
    out, z = (1, -1)[end == 0], step.z_mm[end]
    radius, other = step.radii_mm[end], beside.radii_mm[1 - end] if beside else 0.0
    if radius > other * (1 + _EQUAL):
        return _Face(z + out * allowance_mm, True)
    if beside is None or other > radius * (1 + _EQUAL) or (step.slope == 0) == (beside.slope == 0):
        return _Face(z, False)
    if step.slope == 0:  # into the cone; open where that narrows away
        return _Face(z + out * beside.overlap_mm(allowance_mm), out * beside.slope < 0)
    grows = out * step.slope < 0  # from the cylinder on: it begins within that
    return _Face(z + out * (1 if grows else -1) * step.overlap_mm(allowance_mm) / 2, False)


def _cone(step: _RawStep, faces: tuple[_Face, _Face], forging: Forging) -> Iterator[RawBody]:
    """Yield a cone, and on each open end a disc that is as thick as the allowance and has its outline."""
    draft = step.draft(forging)
    as_steep = forging.model_copy(update={"draft_deg": math.degrees(draft)})
    z = tuple(plane if face.open else face.z_mm for plane, face in zip(step.z_mm, faces, strict=True))
    inner, outer = ((at, step.radii_mm[0] + step.slope * (at - step.z_mm[0])) for at in z)
    yield Collar(step.key, (z[0], z[1]), 0.0, inner, outer, draft, forging.land_mm)
    for end, face in enumerate(faces):
        if face.open:
            ends = (face.z_mm, z[0]) if end == 0 else (z[1], face.z_mm)
            tilted = (end == 0, end == 1)
            yield drafted_disc(step.key, step.radii_mm[end], 0.0, ends, tilted, as_steep)
