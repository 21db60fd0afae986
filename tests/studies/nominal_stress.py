"""Nominal stress amplitude of web and pin away from the fillets: linearised finite-element sections."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.units import MPA_PER_GPA, NMM_PER_NM
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.schema import Scene
from cranktopo.engine.forces import INERTIA_EFFECTS
from cranktopo.engine.histories import load_history
from cranktopo.engine.states import extreme_states
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.tasks.throw_fea.unit_fields import unit_fields
from tests.physics.fatigue.point_stress import PointStress, point_stress

Array = NDArray[np.float64]
YY, ZZ, YZ, ZX = 1, 2, 4, 5


def nominal_amplitude_MPa(scene: Scene) -> float:
    """Largest linearised stress amplitude of the web half-way along the throw and of the pin's mid-section.

    Least-squares linear stresses over the elements around each section, weighted by volume: membrane and
    bending out of and in the web's plane; bending and torsion of the pin.
    """
    force, torque = half_ranges(scene)
    size, material = default_element_size_mm(scene), scene.material
    meshed = mesh_throw(scene, size)
    youngs = material.E_GPa * MPA_PER_GPA
    model = assemble(meshed.mesh, youngs, material.poisson)
    fields = unit_fields(model, scene, meshed.mesh.mirrored, ("bending", "torsion"))
    found = point_stress(model, np.stack([f.displacement_mm for f in fields]), youngs, material.poisson)
    loads = np.array([force, torque * NMM_PER_NM])
    return max(_web(scene, found, size, loads), _pin(scene, found, size, loads))


def half_ranges(scene: Scene) -> tuple[float, float]:
    """Half the range of the radial force (N) and of the torque (N m) over the cycle, overspeed and rest."""
    history = load_history(scene, "extremes", INERTIA_EFFECTS | {"bending", "torsion"})
    states = extreme_states(scene, INERTIA_EFFECTS)
    radial = [*history.radial_N, *(s.case.radial_N for s in states if s.name == "overspeed_inertia")]
    return float(np.ptp(radial)) / 2, float(np.ptp(history.torque_Nm)) / 2


def _web(scene: Scene, found: PointStress, size: float, loads: Array) -> float:
    x, y, z = found.points_mm
    start, end = scene.web_z_mm
    inside = (np.abs(y - scene.throw.radius_mm / 2) < size) & (z > start) & (z < end)
    across = z[inside] - (start + end) / 2
    weight = found.volume_mm3[inside]
    bend = _line(across, found.stress_MPa[0][inside][:, YY], weight)
    along = found.stress_MPa[1][inside][:, YY]
    slope = (weight * x[inside] * along).sum() / (weight * x[inside] ** 2).sum()
    edge = np.abs(x[inside]).max()
    thick = scene.web.thickness_mm / 2
    return float(abs(loads[0]) * _largest(bend, thick) + abs(loads[1] * slope * edge))


def _pin(scene: Scene, found: PointStress, size: float, loads: Array) -> float:
    x, y, z = found.points_mm
    inside = z > scene.pitch_mm / 2 - size
    x, y, weight = x[inside], y[inside] - scene.throw.radius_mm, found.volume_mm3[inside]
    bend = _line(y, found.stress_MPa[0][inside][:, ZZ], weight)
    twist = found.stress_MPa[1][inside]
    moment = (weight * (x * twist[:, YZ] - y * twist[:, ZX])).sum()
    outer = scene.throw.crankpin.radius_mm
    shear = moment / (weight * (x**2 + y**2)).sum() * outer
    return math.hypot(loads[0] * _largest(bend, outer), math.sqrt(3) * loads[1] * shear)


def _line(position: Array, values: Array, weight: Array) -> Array:
    """Constant and slope of the weighted least-squares line."""
    basis = np.stack([np.ones_like(position), position])
    return np.linalg.solve((basis * weight) @ basis.T, (basis * weight) @ values)


def _largest(line: Array, reach: float) -> float:
    return float(abs(line[0]) + abs(line[1]) * reach)
