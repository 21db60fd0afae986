"""The discrete throw: supports and loads of every case on one stiffness field."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import MPA_PER_GPA, NMM_PER_NM, angular_speed_rad_s, density_tonne_per_mm3
from cranktopo.bodies.cells.domain import Domain
from cranktopo.design.schema import Scene
from cranktopo.engine.bearings import bearing_spring_N_per_mm
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.load_type import load_type
from cranktopo.numerics.device_arrays import on_device
from cranktopo.numerics.grid.boundary_conditions import (
    BoundaryConditions,
    CaseSupports,
    SectionMotion,
    build_supports,
)
from cranktopo.numerics.grid.lattice import Lattice

# Motions of a section that are even under x -> -x; the others are odd.
_EVEN_IN_X = ("ty", "tz", "rx")
_BENDING_FREE = {"pinned": ("tz", "rx", "ry"), "clamped": ("tz",), "spring": ("tx", "ty", "tz", "rx", "ry")}
_TORSION_FREE = {"free": ("rz", "rx", "ry"), "held": ("rz",), "spring": ("rz", "tx", "ty", "rx", "ry")}


@dataclass(frozen=True)
class ThrowModel:
    """Grid, supports and loads of a throw, ready to be solved for any field of relative moduli.

    Attributes:
        supports: springs divided by the material's modulus.
        forces: nodal forces divided by the material's modulus (cases, 3, nodes...), mm2.
        share: share of the full throw in the model.
        spin: mass density times squared angular speed over the modulus per case, 1/mm2; 0: no body force.
        arms_mm: distance (x, y) of the nodes from the crank axis, two arrays that broadcast to the nodes.
    """

    lattice: Lattice
    levels: int
    supports: BoundaryConditions
    forces: jax.Array
    cases: tuple[LoadCase, ...]
    modulus_MPa: float
    share: float
    spin: tuple[float, ...] = ()
    arms_mm: tuple[Array, Array] | None = None

    @property
    def spinning(self) -> bool:
        """True where any case has a body force; without one it costs nothing."""
        return any(self.spin)

    @property
    def case_names(self) -> tuple[str, ...]:
        """Names of the load cases, in the order of every array."""
        return tuple(case.name for case in self.cases)


def build_model(
    scene: Scene, domain: Domain, cases: Sequence[LoadCase], *, incompatible_modes: bool = True
) -> ThrowModel:
    """Return supports and nodal loads of the cases on a domain's grid; call inside `double_precision()`."""
    dx, dy, dz = domain.grid.steps_mm
    lattice = Lattice(
        domain.grid.cells,
        float(dx[0]),
        float(dy[0]),
        tuple(float(d) for d in dz),
        scene.material.poisson,
        incompatible_modes,
    )
    modulus = scene.material.E_GPa * MPA_PER_GPA
    origin = float(domain.grid.x_mm[0]), float(domain.grid.y_mm[0])
    described = tuple(case_supports(scene, domain, case) for case in cases)
    supports, forces = build_supports(lattice, origin, domain.grid.levels, described)
    for index, case in enumerate(cases):
        forces[index] += _pin_forces(domain, case)
    return ThrowModel(
        lattice=lattice,
        levels=domain.grid.levels,
        supports=supports._replace(springs=on_device(np.asarray(supports.springs) / modulus)),
        forces=on_device(forces / modulus),
        cases=tuple(cases),
        modulus_MPa=modulus,
        share=domain.symmetry_fraction,
        spin=tuple(_spin(scene, case) for case in cases),
        arms_mm=(domain.grid.x_mm[:, None, None], domain.grid.y_mm[None, :, None]),
    )


def case_supports(scene: Scene, domain: Domain, case: LoadCase) -> CaseSupports:
    """Return the mirror conditions and free section motions of one load case, by the symmetry of its kind."""
    load = load_type(case.kind)
    torsion, odd_in_x = load.odd_in_z, load.odd_in_x
    fixed_x = ((1, 2) if odd_in_x else (0,)) if domain.mirrored_x else ()
    fixed_z = ((0, 1) if torsion else (2,)) if domain.mirrored_z else ()
    free = _TORSION_FREE[scene.supports.torsion] if torsion else _BENDING_FREE[scene.supports.bending]
    kept = [m for m in free if not domain.mirrored_x or (m in _EVEN_IN_X) != odd_in_x]
    # A sprung quarter or half section carries its share of the bearing's spring, one bearing per section.
    spring = (bearing_spring_N_per_mm(scene) or 0.0) * (0.5 if domain.mirrored_x else 1.0)
    stiffness = {"tx": spring, "ty": spring}
    torque = case.torque_Nm * NMM_PER_NM * (0.5 if domain.mirrored_x else 1.0)
    first = [SectionMotion(0, m, stiffness.get(m, 0.0), _torque_on(m, torque, domain)) for m in kept]
    if domain.mirrored_z:
        return CaseSupports(fixed_x, fixed_z, tuple(first))
    # Two sections: the first one is the axial and rotational reference of the whole throw.
    last = [SectionMotion(-1, m.motion, m.stiffness, torque if m.motion == "rz" else 0.0) for m in first]
    if torsion and "tz" not in kept:
        last.append(SectionMotion(-1, "tz"))
    first = [m for m in first if m.motion not in ("tz", "rz")]
    return CaseSupports(fixed_x, fixed_z, (*first, *last))


def case_forces(model: ThrowModel, solid: jax.Array) -> jax.Array:
    """Return the nodal forces of every case over the modulus (cases, 3, nodes...), mm2.

    They hold the centrifugal force of the solid itself, by whose fraction they are differentiable.
    """
    if not model.spinning or model.arms_mm is None:
        return model.forces
    volumes, (x, y) = cell_volumes_mm3(model.lattice), model.arms_mm
    return _with_centrifugal(model.forces, solid, volumes, x, y, np.asarray(model.spin))


@jax.jit
def _with_centrifugal(
    forces: jax.Array, solid: jax.Array, volumes: Array, x: Array, y: Array, spin: Array
) -> jax.Array:
    nodal = jnp.pad(solid * volumes / 8, 1)
    for axis in range(3):
        size = nodal.shape[axis]
        near = jax.lax.slice_in_dim(nodal, 0, size - 1, axis=axis)
        nodal = near + jax.lax.slice_in_dim(nodal, 1, size, axis=axis)
    outward = jnp.stack([nodal * x, nodal * y, jnp.zeros_like(nodal)])
    return forces + spin[:, None, None, None, None] * outward


def cell_volumes_mm3(lattice: Lattice) -> Array:
    """Return the cell volumes, broadcastable to (nx, ny, nz)."""
    return lattice.dx_mm * lattice.dy_mm * np.array(lattice.dz_mm)[None, None, :]


def _spin(scene: Scene, case: LoadCase) -> float:
    if not case.has_body_force:
        return 0.0
    density = density_tonne_per_mm3(scene.material.density_kg_m3)
    return density * angular_speed_rad_s(case.speed_rpm) ** 2 / (scene.material.E_GPa * MPA_PER_GPA)


def _torque_on(motion: str, torque: float, domain: Domain) -> float:
    return torque if motion == "rz" and domain.mirrored_z else 0.0


def _pin_forces(domain: Domain, case: LoadCase) -> Array:
    """Return uniform body force on the crankpin's material, its total the model's share of the pin force."""
    weights = pin_weights(domain)
    forces = np.zeros((3, *weights.shape))
    forces[0] = case.tangential_N * domain.symmetry_fraction * weights
    forces[1] = -case.radial_N * domain.symmetry_fraction * weights
    return forces


def pin_weights(domain: Domain) -> Array:
    """Return the nodal weights (nodes...) of the mean over the crankpin's material; they add up to 1."""
    cells = domain.pin * domain.volume_mm3
    nodal = np.zeros(tuple(n + 1 for n in cells.shape))
    nx, ny, nz = cells.shape
    for i, j, k in product((0, 1), repeat=3):
        nodal[i : i + nx, j : j + ny, k : k + nz] += cells / 8
    return np.asarray(nodal / cells.sum())
