"""Scene tables of the engine that loads the throw: gas, masses, cylinders, firing order."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from cranktopo.scene.base import Finite, NonNegative, Positive, SceneTable


class Gas(SceneTable):
    """Cylinder pressure: a measured indicator diagram, or a combustion model fitted to the peak.

    The combustion model needs `peak_pressure_MPa` and `peak_angle_deg`; every other value has a common
    default. All pressures are absolute.
    """

    indicator_csv: str | None = None
    peak_pressure_MPa: Positive | None = None
    peak_angle_deg: Finite | None = None
    ambient_pressure_MPa: Positive = 0.101325
    intake_pressure_MPa: Positive | None = None
    exhaust_pressure_MPa: Positive | None = None
    compression_ratio: float = Field(default=9.0, gt=1, le=40)
    burn_duration_deg: float = Field(default=60.0, gt=0, le=180)
    wiebe_shape: float = Field(default=2.0, gt=0, le=10)
    polytropic_compression: float = Field(default=1.32, gt=1, le=1.5)
    polytropic_expansion: float = Field(default=1.27, gt=1, le=1.5)
    exhaust_opening_deg: float = Field(default=130.0, gt=60, lt=180)

    @property
    def intake_MPa(self) -> float:
        """Cylinder pressure during intake (two-stroke: scavenging), MPa; ambient when not given."""
        return self.intake_pressure_MPa or self.ambient_pressure_MPa

    @property
    def exhaust_MPa(self) -> float:
        """Cylinder pressure during the exhaust stroke, MPa; ambient when not given."""
        return self.exhaust_pressure_MPa or self.ambient_pressure_MPa


class Masses(SceneTable):
    """Moving masses of one cylinder; the rod is split into two masses at its ends."""

    piston_group_kg: NonNegative = 0.0
    rod_reciprocating_kg: NonNegative = 0.0
    rod_rotating_kg: NonNegative = 0.0


class Engine(SceneTable):
    """The engine that loads the throw.

    Cylinder 1 is at the free end of the shaft, the last one at the takeoff; firing is evenly spaced.
    """

    bore_mm: Positive
    rod_length_mm: Positive
    speed_rpm: NonNegative
    overspeed_rpm: Positive | None = None
    strokes: Literal[2, 4] = 4
    cylinders: int = Field(default=1, ge=1, le=48)
    firing_order: tuple[int, ...] = ()
    gas: Gas | None = None
    masses: Masses = Masses()
    max_gas_force_N: Positive | None = None
    max_torque_Nm: Positive | None = None
    min_torque_Nm: Finite | None = None

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
