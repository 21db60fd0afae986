"""The couple of a throw whose halves differ: its unbalance does not lie in the plane of its cylinder."""

from __future__ import annotations

import math

from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.halves import difference, of_halves
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import fillet_ring
from cranktopo.throw.drilling.moments import drilled
from cranktopo.throw.moments import body_moments
from cranktopo.throw.web import web_bodies


def product_of_inertia_kg_mm2(scene: Scene) -> complex:
    """Sum of mass times place along the shaft times place across it, about the plane of the cylinder.

    Real along the throw, imaginary toward +x; places count toward the second web. Rods have none. Where the
    halves are alike it is 0, and nothing is computed.
    """
    if not difference(scene):
        return 0j
    first, second = of_halves(scene, _half)
    return second - first


def _half(scene: Scene) -> complex:
    """Return what a half throw adds, its places counted from the mid-pin plane.

    Main journals are about the axis and add nothing but what is drilled out of them.
    """
    plane_mm, density = scene.pitch_mm / 2, density_kg_per_mm3(scene.material.density_kg_m3)
    web = (body_moments(web_bodies(scene), plane_mm) - drilled(scene, None, plane_mm)).times(density)
    web = web + bolted_mass(scene, plane_mm)
    return complex(web.first_y + density * _crankpin_mm5(scene), web.first_x)


def _crankpin_mm5(scene: Scene) -> float:
    """Volume times both distances of half of the crankpin with its fillet, drillings not taken out."""
    pin = scene.throw.crankpin
    half_mm, radius = pin.length_mm / 2, pin.radius_mm
    edge, height, from_face = fillet_ring(pin)
    cylinder = math.pi * (radius**2 - pin.bore_radius_mm**2) * half_mm**2 / 2
    fillet = float((math.pi * (edge**2 - radius**2) * height * (half_mm - from_face)).sum())
    return scene.throw.radius_mm * (cylinder + fillet)
