"""Scene tables of the engine that loads the throw: gas, masses, cylinders, firing order."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from cranktopo.scene.base import SHOWN, CrankAngle, Force, Length, Mass, Pressure, SceneTable, Speed, Torque


class Gas(SceneTable):
    """Cylinder pressure: a measured indicator diagram, or a combustion model fitted to the peak.

    The combustion model needs `peak_pressure_MPa` and `peak_angle_deg`; every other value has a common
    default. All pressures are absolute.
    """

    indicator_csv: str | None = Field(default=None, examples=["indicator.csv"])
    """CSV of the measured absolute pressure over one cycle, instead of the peak; relative to this file.

    Its columns are `crank_angle_deg` and `pressure_bar` or `pressure_MPa`.
    """
    peak_pressure_MPa: Pressure | None = Field(default=None, examples=[5.16], json_schema_extra=SHOWN)
    """Peak pressure that the combustion model is fitted to."""
    peak_angle_deg: CrankAngle | None = Field(default=None, examples=[11.0], json_schema_extra=SHOWN)
    """Crank angle of the peak after firing top dead centre, below 60."""
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

    Cylinder 1 is at the free end of the shaft, the last one at the takeoff; firing is evenly spaced.
    """

    bore_mm: Length = Field(examples=[95.0])
    """Cylinder bore."""
    rod_length_mm: Length = Field(examples=[166.0])
    """Distance of the rod's eye centres; longer than the throw radius."""
    speed_rpm: Speed = Field(examples=[2100.0])
    """Speed at which the gas and inertia forces are taken."""
    overspeed_rpm: Speed | None = Field(default=None, examples=[2800.0])
    """Highest speed, for centrifugal loads; at least `speed_rpm`."""
    strokes: Literal[2, 4] = 4
    """Strokes of a working cycle."""
    cylinders: int = Field(default=1, ge=1, le=48)
    """Number of cylinders, one throw each."""
    firing_order: tuple[int, ...] = ()
    """Cylinder numbers in the order of firing, evenly spaced; needed for more than one cylinder."""
    gas: Gas | None = None
    masses: Masses = Masses()
    max_gas_force_N: Force | None = Field(default=None, examples=[35900.0])
    """Largest gas force, when it is known and the pressure is not."""
    max_torque_Nm: Torque | None = Field(default=None, examples=[690.0])
    """Largest torque behind a throw; replaces the computed one."""
    min_torque_Nm: Torque | None = Field(default=None, examples=[-140.0])
    """Smallest torque behind a throw; replaces the computed one."""

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
    def throw_angles_deg(self) -> tuple[float, ...]:
        """Angle of each throw about the crank axis, deg in [0, 360), cylinder 1 first and at 0.

        Firing intervals are equal: the cylinder that fires j-th follows the first by j 180 strokes / n
        degrees of crank rotation, and its throw reaches top dead centre by then.
        """
        count, first = len(self.order), self.order.index(1)
        return tuple(
            (-(self.order.index(cylinder) - first) * self.cycle_deg / count) % 360.0
            for cylinder in range(1, count + 1)
        )

    @property
    def order(self) -> tuple[int, ...]:
        """Cylinder numbers in the order of firing."""
        return self.firing_order or (1,)
