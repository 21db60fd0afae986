"""Scene tables of the engine that loads the throw: gas, masses, cylinders, firing order."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import Annotated, Literal

from pydantic import Field

from cranktopo.base.errors import invalid
from cranktopo.base.table import (
    SHOWN,
    CrankAngle,
    Force,
    Length,
    Mass,
    Pressure,
    SceneTable,
    Speed,
    Torque,
    TurningSpeed,
    WholeNumber,
    is_unset,
)
from cranktopo.design.arrangement import Arrangement, Opposed

_IN_LINE = Arrangement()

TraceAngle = Annotated[float, Field(ge=-720, le=720, allow_inf_nan=False)]
"""An angle of a measured trace, deg, counted from wherever the indicating system does."""


class GasAtSpeed(SceneTable):
    """Cylinder pressure at one speed: a measured indicator diagram, or the peak of the combustion model."""

    rpm: TurningSpeed = Field(examples=[1000.0])
    """Speed that it belongs to; between two of them pressures are interpolated, beyond the last kept."""
    file: str | None = Field(default=None, examples=["indicator_1000.csv"])
    """CSV of the measured pressure, as `engine.gas.indicator_csv`; `engine.gas.firing_deg` is that of all."""
    peak_pressure_MPa: Pressure | None = Field(default=None, examples=[5.16], json_schema_extra=SHOWN)
    """Peak pressure at this speed, in place of a file."""
    peak_angle_deg: CrankAngle | None = Field(default=None, examples=[11.0], json_schema_extra=SHOWN)
    """Crank angle of that peak after firing top dead centre."""


class Gas(SceneTable):
    """Cylinder pressure: a measured indicator diagram, or a combustion model fitted to the peak.

    The combustion model needs `peak_pressure_MPa` and `peak_angle_deg`; every other value has a common
    default. All pressures are absolute.
    """

    indicator_csv: str | None = Field(default=None, examples=["indicator.csv"])
    """CSV of the measured absolute pressure over one cycle, instead of the peak; relative to this file. Its
    header names crank angle and pressure with their units, such as `crank_angle_deg` and `pressure_bar`."""
    firing_deg: TraceAngle = 0.0
    """Angle of firing top dead centre in the measured trace: 360 where it counts from gas exchange."""
    peak_pressure_MPa: Pressure | None = Field(default=None, examples=[5.16], json_schema_extra=SHOWN)
    """Peak pressure that the combustion model is fitted to."""
    peak_angle_deg: CrankAngle | None = Field(default=None, examples=[11.0], json_schema_extra=SHOWN)
    """Crank angle of the peak after firing top dead centre, below 60."""
    map: tuple[GasAtSpeed, ...] = Field(default=(), max_length=100)
    """Pressures over speed, in place of one indicator diagram or peak that serves all speeds."""
    ambient_pressure_MPa: Pressure = 0.101325
    """Pressure below the piston."""
    intake_pressure_MPa: Pressure | None = Field(default=None, examples=[0.09])
    """Cylinder pressure during intake (two-stroke: scavenging); ambient when not given."""
    exhaust_pressure_MPa: Pressure | None = Field(default=None, examples=[0.11])
    """Cylinder pressure during the exhaust stroke, four-stroke engines only; ambient when not given."""
    compression_ratio: float = Field(default=9.0, ge=1.5, le=40)
    """Largest over smallest cylinder volume."""
    burn_duration_deg: float = Field(default=60.0, ge=1, le=180)
    """Crank angle from start to end of combustion."""
    wiebe_shape: float = Field(default=2.0, ge=0.1, le=10)
    """Shape exponent m of the Wiebe function."""
    polytropic_compression: float = Field(default=1.32, ge=1.01, le=1.5)
    """Polytropic exponent of compression."""
    polytropic_expansion: float = Field(default=1.27, ge=1.01, le=1.5)
    """Polytropic exponent of expansion."""
    exhaust_opening_deg: float = Field(default=130.0, gt=60, lt=180)
    """Crank angle after firing top dead centre at which the exhaust opens."""

    @property
    def measured(self) -> bool:
        """True if a pressure is that of a measured trace, at one speed at least."""
        return self.indicator_csv is not None or any(at.file is not None for at in self.map)

    @property
    def modelled(self) -> bool:
        """True if the combustion model gives a pressure, at one speed at least."""
        return not self.measured or any(at.file is None for at in self.map)

    @property
    def intake_MPa(self) -> float:
        """Cylinder pressure during intake (two-stroke: scavenging), MPa; ambient when not given."""
        return self.intake_pressure_MPa or self.ambient_pressure_MPa

    @property
    def exhaust_MPa(self) -> float:
        """Cylinder pressure during the exhaust stroke, MPa; ambient when not given."""
        return self.exhaust_pressure_MPa or self.ambient_pressure_MPa


class Masses(SceneTable):
    """Moving masses of one cylinder; the rod counts as two masses, one at each end.

    Give its two parts, or the whole rod with its centre of mass, which is then split between the ends by the
    lever rule: both parts together have the rod's mass and its centre of mass.
    """

    piston_group_kg: Mass = 0.0
    """Piston with rings and piston pin."""
    rod_reciprocating_kg: Mass = 0.0
    """Part of the rod that moves with the piston."""
    rod_rotating_kg: Mass = 0.0
    """Part of the rod that turns with the crankpin."""
    rod_kg: Mass | None = Field(default=None, examples=[0.469])
    """The whole rod with its bearings, instead of its two parts; needs `rod_centre_from_big_end_mm`."""
    rod_centre_from_big_end_mm: Length | None = Field(default=None, examples=[50.8])
    """Distance of the whole rod's centre of mass from the crankpin's axis, along `engine.rod_length_mm`."""


class Engine(SceneTable):
    """The engine that loads the throw.

    Cylinder 1 is at the free end of the shaft, the last one at the takeoff; firing is evenly spaced unless
    `[engine.arrangement]` says otherwise.
    """

    bore_mm: Length = Field(examples=[95.0])
    """Cylinder bore."""
    rod_length_mm: Length = Field(examples=[166.0])
    """Distance of the rod's eye centres; longer than the throw radius."""
    speed_rpm: Speed = Field(examples=[2100.0])
    """Speed at which the gas and inertia forces are taken."""
    rated_power_kW: float | None = Field(
        default=None, ge=1e-3, le=2e5, allow_inf_nan=False, examples=[46.0], exclude_if=is_unset
    )
    """Rated power at the shaft at `speed_rpm`: `loads` gives how far that of the cylinder pressure is off."""
    rotation: Literal["clockwise", "counter-clockwise"] | None = Field(
        default=None, examples=["clockwise"], exclude_if=is_unset
    )
    """Sense of rotation as seen from outside on the output end. Files and drawings of the whole crank are of
    a clockwise one, and drawings say so: one that turns the other way is the mirror image."""
    overspeed_rpm: Speed | None = Field(default=None, examples=[2800.0])
    """Highest speed, at least `speed_rpm`: of centrifugal loads, and safety counts there as well."""
    strokes: Literal[2, 4] = 4
    """Strokes of a working cycle."""
    cylinders: int = Field(default=1, ge=1, le=48)
    """Number of cylinders, one throw each; in a `V` one for two, in a `W` one for as many as it has banks, in
    a `radial` one for all of a row."""
    firing_order: tuple[int, ...] = ()
    """Cylinder numbers in the order of firing; needed for more than one cylinder."""
    misfire: tuple[Annotated[int, WholeNumber], ...] = Field(default=(), examples=[(3,)], exclude_if=is_unset)
    """Cylinders that do not fire: they compress and expand their charge, and their inertia acts as ever."""
    gas: Gas | None = None
    masses: Masses = Masses()
    arrangement: Arrangement | None = None
    opposed: Opposed | None = Field(default=None, exclude_if=is_unset)
    max_gas_force_N: Force | None = Field(default=None, examples=[35900.0])
    """Largest gas force, when it is known and the pressure is not."""
    max_torque_Nm: Torque | None = Field(default=None, examples=[690.0])
    """Largest torque behind a throw; replaces the computed one."""
    min_torque_Nm: Torque | None = Field(default=None, examples=[-140.0])
    """Smallest torque behind a throw; replaces the computed one."""

    @property
    def own_speeds_rpm(self) -> tuple[float, ...]:
        """Its speed and its overspeed, each once."""
        return tuple(dict.fromkeys((self.speed_rpm, self.overspeed_rpm or self.speed_rpm)))

    @property
    def rod_parts_kg(self) -> tuple[float, float]:
        """Parts of the rod that move with the piston and turn with the crankpin, kg: given, or split."""
        masses = self.masses
        if masses.rod_kg is None or masses.rod_centre_from_big_end_mm is None:
            return masses.rod_reciprocating_kg, masses.rod_rotating_kg
        reciprocating = masses.rod_kg * masses.rod_centre_from_big_end_mm / self.rod_length_mm
        return reciprocating, masses.rod_kg - reciprocating

    @property
    def reciprocating_kg(self) -> float:
        """All that moves with the piston, kg."""
        return self.masses.piston_group_kg + self.rod_parts_kg[0]

    @property
    def rod_rotating_kg(self) -> float:
        """Part of the rod that turns with the crankpin, kg."""
        return self.rod_parts_kg[1]

    @property
    def cycle_deg(self) -> float:
        """Crank angle of one working cycle, deg."""
        return 180.0 * self.strokes

    @property
    def arranged(self) -> Arrangement:
        """The arrangement of the cylinders, as given or in line."""
        return self.arrangement or _IN_LINE

    @property
    def rods_per_pin(self) -> int:
        """Rods on each crankpin."""
        return self.cylinders // self.throws

    @property
    def throws(self) -> int:
        """Number of throws of the shaft."""
        arranged = self.arranged
        if arranged.layout == "radial":
            return len(arranged.throw_angles_deg) or 1
        return max(self.cylinders // len(arranged.banks_deg), 1)

    def throw_of(self, cylinder: int) -> int:
        """Index of the throw that a cylinder drives, 0 at the free end."""
        return (cylinder - 1) % self.throws

    def pin_deg(self, cylinder: int) -> float:
        """Angle of a cylinder's part of a split pin ahead of its throw's own, deg; 0 of a straight pin."""
        half = (self.arranged.pin_splay_deg or 0.0) / 2
        return half if cylinder > self.throws else -half

    def axis_deg(self, cylinder: int) -> float:
        """Direction of a cylinder's axis from that of the first bank, deg in the sense of rotation."""
        arranged = self.arranged
        if arranged.layout == "boxer":
            return 0.0 if cylinder % 2 else 180.0
        if arranged.layout == "radial":
            return 360.0 * (cylinder - 1) / self.cylinders
        return arranged.banks_deg[(cylinder - 1) // self.throws]

    @property
    def bank_angle_deg(self) -> float:
        """Angle between the two banks of a V or a boxer, of a W between its outer ones, deg; else 0."""
        return 180.0 if self.arranged.layout == "boxer" else self.arranged.banks_deg[-1]

    @property
    def directions_deg(self) -> tuple[float, ...]:
        """Direction of each cylinder's axis from that of the first, deg in the sense of rotation."""
        return tuple(map(self.axis_deg, range(1, self.cylinders + 1)))

    @property
    def throw_angles_deg(self) -> tuple[float, ...]:
        """Angle of each throw about the crank axis, deg in [0, 360), the first at 0.

        As given, else such that firing intervals are equal: the cylinder that fires j-th follows the first by
        j 180 strokes / n degrees of crank rotation, and its throw reaches top dead centre by then.
        """
        given = self.arranged.throw_angles_deg
        even = [self.even_angle_deg(cylinder) for cylinder in range(1, self.throws + 1)]
        return given or tuple((angle - even[0]) % 360.0 for angle in even)

    def even_angle_deg(self, cylinder: int) -> float:
        """Angle that a cylinder's throw has where firing is even, deg in [0, 360)."""
        count, first = len(self.order), self.order.index(1)
        fires = (self.order.index(cylinder) - first) * self.cycle_deg / count
        return (self.axis_deg(cylinder) - self.pin_deg(cylinder) - fires) % 360.0

    @property
    def firing_angles_deg(self) -> tuple[float, ...]:
        """Crank angle at which each cylinder fires, deg after the one that fires first; cylinder 1 first.

        Given throws of a four-stroke engine leave open in which of two turns a cylinder fires: those after
        some place of the firing order fire in the second; the place with the most even intervals counts.
        Throws that do not reach top dead centre in the firing order are refused.
        """
        count = len(self.order)
        if not self.arranged.throw_angles_deg:
            interval = self.cycle_deg / count
            return tuple(self.order.index(cylinder) * interval for cylinder in range(1, count + 1))
        turn = [self._dead_centre_deg(cylinder) for cylinder in self.order]
        places = range(count, 0, -1) if self.strokes == 4 else [count]
        choices = [[*turn[:place], *(angle + 360.0 for angle in turn[place:])] for place in places]
        fitting = [choice for choice in choices if all(a <= b for a, b in pairwise(choice))]
        if not fitting:
            raise invalid(
                "engine.arrangement.throw_angles_deg",
                list(self.arranged.throw_angles_deg),
                f"the cylinders {list(self.order)} reach top dead centre at "
                f"{', '.join(f'{angle:g}' for angle in turn)} deg, which is not one after the other",
                "Correct the angles or engine.firing_order.",
            )
        best = min(fitting, key=lambda fires: round(_unevenness(fires, self.cycle_deg), 6))
        return tuple(best[self.order.index(cylinder)] for cylinder in range(1, count + 1))

    def _dead_centre_deg(self, cylinder: int) -> float:
        """Crank angle of a cylinder's top dead centre after that of the first to fire, deg in [0, 360)."""
        angles = self.throw_angles_deg
        mine, first = (
            self.axis_deg(c) - self.pin_deg(c) - angles[self.throw_of(c)] for c in (cylinder, self.order[0])
        )
        return round((mine - first) % 360.0, 9) % 360.0

    @property
    def order(self) -> tuple[int, ...]:
        """Cylinder numbers in the order of firing."""
        return self.firing_order or (1,)


def _unevenness(fires_deg: Sequence[float], cycle_deg: float) -> float:
    return sum((b - a) ** 2 for a, b in pairwise([*fires_deg, fires_deg[0] + cycle_deg]))
