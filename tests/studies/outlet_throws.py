"""Outlets of oil bores in the pins of three throws: stress factors by elements, and a second method.

Factors are those of IACS UR M53: largest principal stress in the outlet over the nominal stress of the pin,
in pure bending in the plane of the crank and in torsion.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.units import MPA_PER_GPA
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.numerics.tetrahedra.stress import nodal_stress, principal_stresses
from cranktopo.tasks.throw_fatigue.stress_model import solve_stresses
from cranktopo.tasks.throw_fea.targets import Target
from cranktopo.tasks.throw_fea.unit_fields import unit_fields
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.outlet import DrillOutlet
from cranktopo.throw.drilling.table import drill_bores
from tests.studies.example_throws import rule_throws

Array = NDArray[np.float64]
BENDING, TORSION = 0, 1
_KINDS = ("moment", "torsion")
_NEAR = 1.6
"""Reach of an outlet over the radius of its rounding's edge."""
_ELEMENTS = 0.6
"""Element size over the bore's diameter where a throw has no bore."""


@dataclass(frozen=True)
class Outlet:
    """One radial oil bore in the middle of a pin.

    Attributes:
        angle_deg: about the pin's axis, 0 away from the crank axis.
        pin_bore_mm: axial bore of the pin; the design's own where it is None.
    """

    throw: str
    angle_deg: float
    bore_mm: float
    rounding_mm: float
    pin_bore_mm: float | None = None

    def scene(self, drilled: bool = True) -> Scene:
        """The throw on the bearings of Appendix III of the rule, with the bore or without."""
        data = rule_throws()[self.throw].model_dump(mode="json", exclude_none=True)
        pin = data["throw"]["crankpin"]
        if self.pin_bore_mm is not None:
            pin["bore_diameter_mm"] = self.pin_bore_mm
        data["supports"] = {"bending": "pinned", "torsion": "free"}
        data["throw"]["drilling"] = [self._drilling(bool(pin["bore_diameter_mm"]))] if drilled else []
        return scene_from_dict(data, self.throw)

    def _drilling(self, to_bore: bool) -> dict[str, Any]:
        """To the axial bore, or across a solid pin."""
        far = ("crankpin_bore", self.angle_deg) if to_bore else ("crankpin", self.angle_deg - 180)
        start, end = (
            {"on": on, "angle_deg": angle, "place_mm": 0.0}
            for on, angle in (("crankpin", self.angle_deg), far)
        )
        return {"from": start, "to": end, "diameter_mm": self.bore_mm, "outlet_radius_mm": self.rounding_mm}


OUTLETS = (
    Outlet("rule-example", 0.0, 5.0, 1.5),
    Outlet("mikron-iiic-plain", 30.0, 5.0, 1.0),
    Outlet("industrial-gas", 180.0, 20.0, 4.0, pin_bore_mm=45.0),
)


def by_elements(outlet: Outlet, fraction: float) -> Array:
    """Factors in bending and torsion; `fraction`: element size over the radius of the rounding."""
    scene = outlet.scene()
    model = solve_stresses(Target(outlet.throw, scene), _KINDS, fraction)
    channel, mouth = _first(scene)
    depth, aside = _about(mouth, model.surface.points_mm.T)
    near = (aside < _NEAR * (channel.radius_mm + mouth.rounding_mm)) & (depth < 2 * outlet.bore_mm)
    sizes = np.abs(principal_stresses(model.stress.stress_MPa)).max(axis=-1)
    return np.asarray(sizes[:, near].max(axis=1) / _nominal_MPa(outlet, scene))


def without_bore(outlet: Outlet) -> tuple[Array, Array]:
    """What the throw without its bore says of it.

    Returns:
        Stress at the outlet's place over the nominal one: axial in bending, shear in torsion. Factors of the
        bore by G. Kirsch (1898) in that throw's stresses: 3 s1 - s2 of the stresses across the bore's
        axis, largest over a bore's diameter of depth.
    """
    scene = outlet.scene(drilled=False)
    _, mouth = _first(outlet.scene())
    meshed, material = mesh_throw(scene, _ELEMENTS * outlet.bore_mm), scene.material
    youngs = material.E_GPa * MPA_PER_GPA
    model = assemble(meshed.mesh, youngs, material.poisson)
    fields = unit_fields(model, scene, meshed.mesh.mirrored, _KINDS)
    found = nodal_stress(model, np.stack([f.displacement_mm for f in fields]), youngs, material.poisson)
    across = _across(mouth, found.nodal_MPa)
    line = _along_axis(mouth, model.nodes_mm.T, across, outlet.bore_mm)
    first, nominal = line[:, 0], _nominal_MPa(outlet, scene)
    local = np.abs([first[BENDING, 0], first[TORSION, 2]]) / nominal
    return local, _kirsch(line).max(axis=1) / nominal


def _first(scene: Scene) -> tuple[DrillBore, DrillOutlet]:
    (channel,) = drill_bores(scene)
    return channel, channel.outlets[0]


def _nominal_MPa(outlet: Outlet, scene: Scene) -> Array:
    """Nominal stresses at the outlet in bending and torsion per N mm, UR M53.2.1.2.2 and 2.2.2."""
    pin = scene.throw.crankpin
    modulus = math.pi / 32 * (pin.outer_diameter_mm**4 - pin.bore_diameter_mm**4) / pin.outer_diameter_mm
    return np.array([abs(math.cos(math.radians(outlet.angle_deg))), 0.5]) / modulus


def _about(mouth: DrillOutlet, points_mm: Array) -> tuple[Array, Array]:
    """Depth of points (n, 3) below the outlet along its axis, and distance from that, mm."""
    offset = points_mm - np.array(mouth.point_mm)
    depth = -offset @ mouth.normal
    return depth, np.linalg.norm(offset + depth[:, None] * mouth.normal, axis=1)


def _across(mouth: DrillOutlet, stress: Array) -> Array:
    """Stresses (..., 3) axial, around and their shear, of stresses (..., 6): those across the bore's axis."""
    x, y, _ = mouth.normal
    xx, yy, zz, xy, yz, zx = np.moveaxis(stress, -1, 0)
    return np.stack([zz, y * y * xx + x * x * yy - 2 * x * y * xy, y * zx - x * yz], axis=-1)


def _along_axis(mouth: DrillOutlet, nodes_mm: Array, stress: Array, reach_mm: float) -> Array:
    """Stresses (fields, places, 3) along the bore's axis by a quadratic through the nodes around it."""
    offset = nodes_mm - np.array(mouth.point_mm)
    near = np.linalg.norm(offset, axis=1) < 1.2 * reach_mm
    basis = _quadratic(offset[near])
    values = stress[:, near].swapaxes(0, 1).reshape(near.sum(), -1)
    coefficients = np.linalg.lstsq(basis, values, rcond=None)[0]
    depth = np.linspace(0.0, reach_mm, 50)[:, None]
    line = _quadratic(-depth * mouth.normal) @ coefficients
    return line.reshape(len(depth), len(stress), 3).swapaxes(0, 1)


def _quadratic(at: Array) -> Array:
    x, y, z = at.T
    return np.stack([np.ones(len(at)), x, y, z, x * x, y * y, z * z, x * y, y * z, z * x], axis=1)


def _kirsch(stress: Array) -> Array:
    """Largest stress at a small hole in a plate with stresses (..., 3)."""
    one, other, shear = np.moveaxis(stress, -1, 0)
    mean, radius = (one + other) / 2, np.hypot((one - other) / 2, shear)
    return np.asarray(2 * np.abs(mean) + 4 * radius)
