"""Load cases and beams shared by the physics tests."""

from __future__ import annotations

import jax.numpy as jnp
import numpy as np

from cranktopo.fem.boundary_conditions import CaseSupports, build_supports
from cranktopo.fem.lattice import Lattice
from cranktopo.fem.model import ThrowModel
from cranktopo.loads.cases import LoadCase

BENDING = LoadCase("bending", "bending", radial_N=1000.0)
TORSION = LoadCase("torsion", "torsion", torque_Nm=100.0)
CENTRIFUGAL = LoadCase("centrifugal", "centrifugal", radial_N=-500.0, speed_rpm=3000.0)
TANGENTIAL = LoadCase("tangential", "tangential", tangential_N=1000.0)


def clamped_beam(lattice: Lattice, levels: int, component: int, modulus_MPa: float) -> ThrowModel:
    """A beam along z, clamped at z = 0, loaded by 1 N spread evenly over its end face."""
    supports, forces = build_supports(lattice, (0.0, 0.0), levels, (CaseSupports((), (), ()),))
    nx, ny, _ = lattice.cells
    weights = np.outer(np.r_[0.5, np.ones(nx - 1), 0.5], np.r_[0.5, np.ones(ny - 1), 0.5]) / (nx * ny)
    forces[0, component, :, :, -1] = -weights
    case = LoadCase("end", "bending", radial_N=1.0)
    return ThrowModel(lattice, levels, supports, jnp.asarray(forces / modulus_MPa), (case,), modulus_MPa, 1.0)
