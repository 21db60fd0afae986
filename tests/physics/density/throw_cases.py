"""Load cases and beams shared by the physics tests."""

from __future__ import annotations

import jax.numpy as jnp
import numpy as np

from cranktopo.design.schema import Scene
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.plan.simulated import apply_physics_plan
from cranktopo.numerics.grid.boundary_conditions import CaseSupports, build_supports
from cranktopo.numerics.grid.lattice import Cells, Lattice
from cranktopo.tasks.density.model import ThrowModel

BENDING = LoadCase(name="bending", kind="bending", radial_N=1000.0)
TORSION = LoadCase(name="torsion", kind="torsion", torque_Nm=100.0)
CENTRIFUGAL = LoadCase(name="centrifugal", kind="centrifugal", radial_N=-500.0, speed_rpm=3000.0)
TANGENTIAL = LoadCase(name="tangential", kind="tangential", tangential_N=1000.0)


def forged(scene: Scene, **settings: float) -> Scene:
    """The scene with a forged web, as simulated; `settings` are further keys of `optimise`."""
    changed = scene.optimise.model_copy(update={"process": "forged", **settings})
    scene = scene.model_copy(update={"optimise": changed})
    return apply_physics_plan(scene, plan(scene))


def clamped_beam(
    lattice: Lattice, levels: int, component: int, modulus_MPa: float, beam: Cells | None = None
) -> ThrowModel:
    """A beam along z, clamped at z = 0, loaded by 1 N spread evenly over its end face.

    `beam` is its number of cells where it fills only the first ones of the grid.
    """
    supports, forces = build_supports(lattice, (0.0, 0.0), levels, (CaseSupports((), (), ()),))
    nx, ny, nz = beam or lattice.cells
    weights = np.outer(np.r_[0.5, np.ones(nx - 1), 0.5], np.r_[0.5, np.ones(ny - 1), 0.5]) / (nx * ny)
    forces[0, component, : nx + 1, : ny + 1, nz] = -weights
    case = LoadCase(name="end", kind="bending", radial_N=1.0)
    return ThrowModel(lattice, levels, supports, jnp.asarray(forces / modulus_MPa), (case,), modulus_MPa, 1.0)
