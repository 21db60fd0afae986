"""Natural vibrations of a whole crankshaft: the JSON object of `modes --json`."""

from __future__ import annotations

from cranktopo.base.result import Result
from cranktopo.design.assumed import Assumption
from cranktopo.tasks.shaft.assembly import Bearings


class EnergyShares(Result):
    """Shares of the kinetic energy by the direction of the motion, percent.

    Each half throw counts as the rigid body whose motion is nearest to its own.
    """

    torsion: float
    """Rotation about the crank axis."""
    in_plane: float
    """Bending in the plane of throw 1."""
    across: float
    """Bending across that plane."""
    axial: float
    """Along the crank axis."""
    rest: float
    """Deformation within half throws, and masses that share no rigid motion."""


class StationMotion(Result):
    """Motion of a piece of the shaft in a mode, the largest displacement of any piece 1."""

    z_mm: float
    in_plane: float
    """Along throw 1."""
    across: float
    """Across throw 1, ahead of it."""
    axial: float
    """Toward the output."""
    twist: float
    """Rotation about the crank axis, in the sense of rotation, times the throw radius."""


class CriticalCrossing(Result):
    """A speed at which an order of the forces on the turning shaft meets the mode."""

    speed_rpm: float
    order: float


class ShaftMode(Result):
    """A natural vibration of the whole shaft."""

    mode: int
    frequency_Hz: float
    """At rest."""
    kind: str
    shares_percent: EnergyShares
    disks_Hz: float | None
    """Frequency of disks on massless springs whose counterpart this mode is; null where it is none's."""
    last_step_percent: float
    """Change of the frequency by the last step of the reduction."""
    frequencies_Hz: tuple[float, ...]
    """At each speed, in the frame that turns with the shaft."""
    whirl: tuple[float, ...]
    """At each speed: 1 where all motion across the axis circles in the sense of rotation, -1 against it, 0
    where it stays in planes."""
    critical_speeds: tuple[CriticalCrossing, ...]
    """Within the range of speeds, the slowest first."""
    shape: tuple[StationMotion, ...]
    """At rest, from the free end."""


class SharedDisks(Result):
    """A mode of disks on massless springs that no mode of the body has alone."""

    disks_Hz: float
    modes: tuple[int, ...]
    """Modes of the body that share it, the largest share first."""
    shares_percent: tuple[float, ...]


class ShaftModes(Result):
    """Natural vibrations of a whole crankshaft: the object that `modes --json` prints."""

    schema_version: int = 1
    design: str
    bearings: Bearings
    speeds_rpm: tuple[float, ...]
    rigid_motions: int
    """Ways in which the shaft moves without strain; they are no modes."""
    highest_order: float
    """Of the forces on the turning shaft that are looked at."""
    unknowns: int
    """Of the reduced shaft."""
    steps: int
    """Steps of the reduction beyond static fields."""
    stiffness_error_percent: float
    """Bound of the discretisation error of the torsional stiffness; that of a frequency is half of it."""
    modes: tuple[ShaftMode, ...]
    disks_shared: tuple[SharedDisks, ...]
    """Modes of disks without a counterpart among the modes."""
    torsion_only: tuple[str, ...]
    """Parts whose mass the design does not give: they count in torsion alone."""
    disks_with_fluid_Hz: tuple[float, ...]
    """Torsion by disks with the fluid of a viscous damper, slowest first; empty without one."""
    assumed: tuple[Assumption, ...]
    """Keys that the design does not give and the modes depend on."""
