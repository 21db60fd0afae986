"""Scene tables of what is joined to the crankshaft, and of its damping."""

from __future__ import annotations

from typing import Literal

from pydantic import Field

from cranktopo.base.table import (
    SHOWN,
    Inertia,
    LossFactor,
    SceneTable,
    Strength,
    TorsionalDamping,
    TorsionalStiffness,
    TurningSpeed,
)


class Rotor(SceneTable):
    """A disk on the shaft."""

    inertia_kg_m2: Inertia = Field(examples=[0.02])
    """Inertia about the crank axis."""
    stiffness_Nm_per_rad: TorsionalStiffness | None = Field(default=None, examples=[2.0e6])
    """Torsional stiffness of the shaft between it and its neighbour; rigid when it is not given."""


class Propeller(Rotor):
    """Propeller, of an aircraft or a ship; it takes up the engine's mean torque."""

    inertia_kg_m2: Inertia = Field(examples=[0.6])
    """Inertia about the crank axis, with the water that moves with it."""
    damping_Nms_per_rad: TorsionalDamping = 0.0
    """Torque by which air or water resists its vibration, over the angular velocity of that vibration."""


class Coupling(Rotor):
    """Elastic coupling behind the flywheel, or behind the crankshaft where there is none."""

    inertia_kg_m2: Inertia = Field(examples=[0.05])
    """Inertia of its driven half; the driving half belongs to the flywheel."""
    stiffness_Nm_per_rad: TorsionalStiffness = Field(examples=[2.0e4])
    """Dynamic torsional stiffness."""
    loss_factor: LossFactor = 0.0
    """Loss factor of its elements: 0.1 to 0.2 for rubber; relative damping over 2 pi."""


class Damper(SceneTable):
    """Torsional vibration damper at the free end: a ring, joined to its hub by rubber or a viscous fluid."""

    kind: Literal["rubber", "viscous"] = Field(examples=["viscous"])
    """`rubber` needs stiffness and loss factor; `viscous` damping, and stiffness where it has springs."""
    ring_inertia_kg_m2: Inertia = Field(examples=[0.03])
    """Inertia of the ring; of a viscous damper the ring in the fluid."""
    hub_inertia_kg_m2: Inertia = Field(examples=[0.01])
    """Inertia of all that is fixed to the shaft: the hub, and the housing of a viscous damper."""
    damping_Nms_per_rad: TorsionalDamping | None = Field(
        default=None, examples=[6.0], json_schema_extra=SHOWN
    )
    """Torque between ring and hub over their relative angular velocity."""
    stiffness_Nm_per_rad: TorsionalStiffness | None = Field(default=None, examples=[5.0e4])
    """Dynamic torsional stiffness between ring and hub."""
    loss_factor: LossFactor | None = Field(default=None, examples=[0.15])
    """Loss factor of the rubber."""


class ShaftTable(SceneTable):
    """What turns with the crankshaft, and what damps it: the model of torsional vibration.

    From the free end to the takeoff: damper, pulley, the throws, flywheel, coupling, driven machine or
    propeller. Values behind a gear are referred to the speed of the crankshaft.
    """

    speed_min_rpm: TurningSpeed | None = Field(default=None, examples=[700.0])
    """Lowest speed that is looked at; by default a third of `engine.speed_rpm`."""
    speed_max_rpm: TurningSpeed | None = Field(default=None, examples=[2800.0])
    """Highest speed that is looked at; by default the larger of the engine's speed and overspeed."""
    throw_stiffness_Nm_per_rad: TorsionalStiffness | None = Field(default=None, examples=[1.5e5])
    """Torsional stiffness of a throw; by default that of finite elements in `vibration` and `fatigue`, and
    the mean of Carter's and Ker Wilson's formulae in the plan and the load cases of optimisations."""
    cylinder_damping_Nms_per_rad: TorsionalDamping = 0.0
    """Absolute damping: torque at each throw over the angular velocity of its vibration (friction)."""
    throw_damping_Nms_per_rad: TorsionalDamping = 0.0
    """Relative damping: torque between neighbouring throws over their relative angular velocity."""
    throw_loss_factor: LossFactor = 0.02
    """Relative damping of the crankshaft as loss factor; 0.02 is a dynamic magnifier of 50 by itself."""
    permitted_shear_MPa: Strength | None = Field(default=None, examples=[40.0])
    """Largest nominal alternating shear stress of journals and pins; speeds above it are barred."""
    pulley: Rotor | None = None
    """Pulley, gear or fan at the free end."""
    damper: Damper | None = None
    flywheel: Rotor | None = None
    """Flywheel at the takeoff."""
    coupling: Coupling | None = None
    driven: Rotor | None = None
    """Driven machine behind coupling or flywheel; it takes up the engine's mean torque."""
    propeller: Propeller | None = None
