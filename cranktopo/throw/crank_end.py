"""Ends of the crank: steps from the outer main journal outwards, each with its moments in closed form."""

from __future__ import annotations

import math
from abc import abstractmethod
from dataclasses import dataclass
from typing import Annotated, Literal

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.fit import FIT
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.base.table import Length, LengthOrZero, SceneTable
from cranktopo.throw.moments import Moments

_ALONG = Field(ge=0, lt=360, allow_inf_nan=False)
_MOST_STEPS = 24


@dataclass(frozen=True)
class Slot:
    """A keyway: straight walls, a flat bottom, along the whole step.

    Attributes:
        bottom_mm: distance of the bottom from the crank axis.
        angle_deg: its direction from throw 1 in the sense of rotation.
    """

    width_mm: float
    bottom_mm: float
    angle_deg: float


class EndStep(SceneTable):
    """A solid of revolution about the crank axis, with what is cut out of it."""

    length_mm: Length = Field(examples=[30.0])
    """Length along the crank."""

    @property
    @abstractmethod
    def radii_mm(self) -> tuple[float, float]:
        """Outer radius at its inner and at its outer face, mm."""

    @property
    def bore_radius_mm(self) -> float:
        """Radius of its axial bore, mm; 0 where it is solid."""
        return 0.0

    @property
    def bolt_holes_mm(self) -> tuple[tuple[float, float, float], ...]:
        """Holes along the crank through all of it: x and y of the axis, and the radius, mm."""
        return ()

    @property
    def slot(self) -> Slot | None:
        """Its keyway, if it has one."""
        return None

    def check(self, key: str) -> None:
        """Refuse dimensions that give no body."""
        least = min(self.radii_mm)
        if self.bore_radius_mm >= least:
            raise invalid(
                f"{key}.bore_diameter_mm",
                2 * self.bore_radius_mm,
                f"must be smaller than the step's diameter of {2 * least:g} mm",
                "Use 0 for a solid step.",
            )

    def moments(self) -> Moments:
        """Return volume and moments about the crank axis, y along throw 1, of unit density."""
        inner, outer = self.radii_mm
        bore, length = self.bore_radius_mm, self.length_mm
        volume = math.pi * length * ((inner**2 + inner * outer + outer**2) / 3 - bore**2)
        fourth = sum(inner**k * outer ** (4 - k) for k in range(5)) / 5
        found = Moments(volume, 0.0, 0.0, math.pi / 2 * length * (fourth - bore**4))
        for x, y, radius in self.bolt_holes_mm:
            area = math.pi * radius**2
            hole = Moments(area, area * x, area * y, area * (x**2 + y**2 + radius**2 / 2))
            found = found - hole.times(length)
        return found if self.slot is None else found - _slot_moments(self.slot, inner).times(length)

    def twist_per_mm3(self) -> float:
        """Return the integral of dz / J, 1/mm3, J the polar second moment of its sections."""
        share, weights = _GAUSS
        inner, outer = self.radii_mm
        radius = inner + (outer - inner) * share
        if self.slot is not None:
            radius = (radius + self.slot.bottom_mm) / 2  # the largest circle beside the keyway
        return float((weights / (math.pi / 2 * (radius**4 - self.bore_radius_mm**4))).sum()) * self.length_mm


def _rule() -> tuple[Array, Array]:
    nodes, weights = gauss_legendre(24)
    return np.asarray((nodes + 1) / 2), np.asarray(weights / 2)


_GAUSS = _rule()


class _RoundStep(EndStep):
    """A step with one diameter."""

    diameter_mm: Length = Field(examples=[30.0])
    """Outer diameter."""
    bore_diameter_mm: LengthOrZero = 0.0
    """Diameter of the axial bore; 0 = solid. A solid step closes the bore of the main journal."""

    @property
    @override
    def radii_mm(self) -> tuple[float, float]:
        return self.diameter_mm / 2, self.diameter_mm / 2

    @property
    @override
    def bore_radius_mm(self) -> float:
        return self.bore_diameter_mm / 2


class SeatStep(_RoundStep):
    """A step that may be the seat of a part; fit and surface stand on the drawing and change no result."""

    fit: Annotated[str, Field(pattern=FIT)] | None = Field(default=None, examples=["k6"])
    """Tolerance of its diameter (ISO 286): position `f`, `g`, `h`, `js`, `k`, `m`, `n` or `p` and grade 4 to
    10; without it that of `drawing.general_tolerances`."""
    roughness_um: float | None = Field(default=None, ge=0.01, le=100, examples=[0.8], allow_inf_nan=False)
    """Mean roughness Ra; without it that of all other surfaces."""
    run_out_mm: float | None = Field(default=None, ge=1e-4, le=10, examples=[0.02], allow_inf_nan=False)
    """Circular run-out to the axis of the outer main journals."""


class CylinderStep(SeatStep):
    """Plain cylinder: nose, seat of a bearing, a seal or a pulley."""

    kind: Literal["cylinder"]


class GearSeatStep(SeatStep):
    """Cylinder on which a gear sits; the gear itself is a rotor of `[shaft]`."""

    kind: Literal["gear_seat"]


class ThreadStep(_RoundStep):
    """Cylinder with a thread, which is named and not cut: the body has its outer diameter."""

    kind: Literal["thread"]
    thread: str = Field(pattern=r"^[^\n]{1,40}$", examples=["M24x1.5"])
    """Designation of the thread."""


class ConeStep(EndStep):
    """Cone, for a hub that is pulled onto it."""

    kind: Literal["cone"]
    diameter_mm: Length = Field(examples=[30.0])
    """Diameter at its inner face, toward the throws."""
    outer_end_diameter_mm: Length = Field(examples=[25.0])
    """Diameter at its outer face."""
    bore_diameter_mm: LengthOrZero = 0.0
    """Diameter of the axial bore; 0 = solid."""

    @property
    @override
    def radii_mm(self) -> tuple[float, float]:
        return self.diameter_mm / 2, self.outer_end_diameter_mm / 2

    @property
    @override
    def bore_radius_mm(self) -> float:
        return self.bore_diameter_mm / 2


class FlangeStep(SeatStep):
    """Flange with bolt holes, evenly spaced on a circle."""

    kind: Literal["flange"]
    bolts: int = Field(ge=1, le=64, examples=[6])
    """Number of bolt holes."""
    bolt_circle_mm: Length = Field(examples=[22.0])
    """Diameter of the circle of their axes."""
    bolt_diameter_mm: Length = Field(examples=[4.0])
    """Diameter of the holes, which run through the flange."""
    first_bolt_deg: Annotated[float, _ALONG] = 0.0
    """Direction of the first hole from throw 1, in the sense of rotation."""

    @property
    @override
    def bolt_holes_mm(self) -> tuple[tuple[float, float, float], ...]:
        angles = np.radians(self.first_bolt_deg + 360.0 / self.bolts * np.arange(self.bolts))
        arm = self.bolt_circle_mm / 2
        return tuple(
            (arm * math.sin(angle), arm * math.cos(angle), self.bolt_diameter_mm / 2) for angle in angles
        )

    @override
    def check(self, key: str) -> None:
        super().check(key)
        arm, radius = self.bolt_circle_mm / 2, self.bolt_diameter_mm / 2
        if arm + radius >= self.diameter_mm / 2 or arm - radius <= self.bore_radius_mm:
            raise invalid(
                f"{key}.bolt_circle_mm",
                self.bolt_circle_mm,
                f"holes of {self.bolt_diameter_mm:g} mm must lie between bore and rim of the flange "
                f"({self.bore_diameter_mm:g} and {self.diameter_mm:g} mm)",
            )
        if self.bolts > 1 and 2 * arm * math.sin(math.pi / self.bolts) <= 2 * radius:
            raise invalid(f"{key}.bolts", self.bolts, "that many holes meet each other", "Take fewer.")


class KeywayStep(SeatStep):
    """Cylinder with a keyway along its whole length."""

    kind: Literal["keyway"]
    width_mm: Length = Field(examples=[8.0])
    """Width of the keyway."""
    depth_mm: Length = Field(examples=[4.0])
    """Depth of its bottom below the top of the cylinder."""
    angle_deg: Annotated[float, _ALONG] = 0.0
    """Direction of the keyway from throw 1, in the sense of rotation."""

    @property
    @override
    def slot(self) -> Slot | None:
        return Slot(self.width_mm, self.diameter_mm / 2 - self.depth_mm, self.angle_deg)

    @override
    def check(self, key: str) -> None:
        super().check(key)
        radius, bore = self.diameter_mm / 2, self.bore_radius_mm
        if self.width_mm >= self.diameter_mm:
            raise invalid(f"{key}.width_mm", self.width_mm, "must be smaller than the step's diameter")
        edge = math.sqrt(radius**2 - (self.width_mm / 2) ** 2)
        if not radius - edge < self.depth_mm < radius - bore:
            raise invalid(
                f"{key}.depth_mm",
                self.depth_mm,
                f"must be > {radius - edge:.4g} and < {radius - bore:.4g} mm: its corners lie in the "
                "material, its bottom above the bore",
            )


class BodyStep(EndStep):
    """A body from CAD, in the frame of the crank but for its place along the shaft."""

    kind: Literal["body"]
    file: str = Field(examples=["flange.step"])
    """STEP file of one solid, mm: z along the crank toward the output, y along throw 1. It reaches from z = 0
    by `length_mm` toward +z at the output, toward -z at the free end. Relative to this file."""

    @property
    @override
    def radii_mm(self) -> tuple[float, float]:
        return math.inf, math.inf


CrankEndStep = Annotated[
    CylinderStep | ConeStep | FlangeStep | KeywayStep | GearSeatStep | ThreadStep | BodyStep,
    Field(discriminator="kind"),
]


class CrankEnd(SceneTable):
    """One end of the crank. With it the outer main journal on its side has its full length."""

    side: Literal["free", "output"] = Field(examples=["free"])
    """The end before cylinder 1, or that behind the last throw."""
    step: tuple[CrankEndStep, ...] = Field(default=(), max_length=_MOST_STEPS)
    """Steps of the end from the outer face of the outer main journal outwards, each against the last."""


def _slot_moments(slot: Slot, radius: float) -> Moments:
    """Return the moments per mm of what a keyway takes out of a cylinder."""
    half, low = slot.width_mm / 2, slot.bottom_mm
    edge, turn = math.sqrt(radius**2 - half**2), math.asin(half / radius)
    # Integrals over |x| < half of s, x2 s and s3, s = sqrt(radius2 - x2) the height of the cylinder.
    first = half * edge + radius**2 * turn
    second = (half * (2 * half**2 - radius**2) * edge + radius**4 * turn) / 4
    third = (half * (5 * radius**2 - 2 * half**2) * edge + 3 * radius**4 * turn) / 4
    area = first - 2 * half * low
    arm = half * (radius**2 - low**2) - half**3 / 3
    polar = second - 2 * half**3 / 3 * low + (third - 2 * half * low**3) / 3
    angle = math.radians(slot.angle_deg)
    return Moments(area, arm * math.sin(angle), arm * math.cos(angle), polar)
