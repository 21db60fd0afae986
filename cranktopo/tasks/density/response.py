"""Differentiable responses of the throw: implicit differentiation of the equilibrium by the moduli.

All functions take relative moduli (1 = solid material, shape (nx, ny, nz)), the solid fraction of every cell
likewise, nodal forces divided by the modulus and displacements in mm (cases, 3, nodes...), and must be called
inside `double_precision()`. They are differentiable by `jax.grad` and friends; a solve runs eagerly, so do
not wrap them in `jax.jit`.
"""

from __future__ import annotations

import math

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.units import KG_PER_TONNE, NMM_PER_NM, density_tonne_per_mm3
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.load_type import load_type
from cranktopo.numerics.device_arrays import on_device, zeros_like
from cranktopo.numerics.grid.conjugate_gradients import System
from cranktopo.numerics.grid.equilibrium import Advice, Solution, solve_system
from cranktopo.numerics.grid.lattice import layer_blocks
from cranktopo.numerics.grid.multigrid import build_tables
from cranktopo.numerics.grid.operator import strain_energy_densities, strain_energy_density
from cranktopo.numerics.grid.partition import WHOLE
from cranktopo.numerics.precision import Precision
from cranktopo.tasks.density.model import ThrowModel, case_forces, cell_volumes_mm3

_ADVICE = Advice(
    rounded="Stiff parts move far on soft ones: take stiffer bearing springs, a shorter throw or more web.",
    unsolved="Check that a load path joins the journals, or use a smaller stiffness contrast.",
)


def solve(
    model: ThrowModel,
    moduli: jax.Array,
    *,
    forces: jax.Array | None = None,
    guess: jax.Array | None = None,
    tolerance: float = 1e-8,
    precision: Precision = "float32",
) -> Solution:
    """Return the displacements of every load case; the array `guess` to start from is gone afterwards."""
    load = model.forces if forces is None else forces
    start = zeros_like(load) if guess is None else guess
    tables = build_tables(model.lattice, model.levels)
    system = System(on_device(tables.blocks), model.supports, moduli, load)
    return solve_system(tables, system, start, tolerance, model.case_names, precision, _ADVICE)


def displacements(model: ThrowModel, moduli: jax.Array, tolerance: float = 1e-8) -> jax.Array:
    """Solve for differentiable displacements (cases, 3, nodes...), mm; the adjoint is one more solve."""

    @jax.custom_vjp
    def field(moduli: jax.Array) -> jax.Array:
        return solve(model, moduli, tolerance=tolerance).displacements

    def forward(moduli: jax.Array) -> tuple[jax.Array, tuple[jax.Array, jax.Array]]:
        u = field(moduli)
        return u, (moduli, u)

    def backward(saved: tuple[jax.Array, jax.Array], cotangent: jax.Array) -> tuple[jax.Array]:
        moduli, u = saved
        adjoint = solve(model, moduli, forces=cotangent, tolerance=tolerance).displacements
        return (-_energy_density(layer_blocks(model.lattice), adjoint, u),)

    field.defvjp(forward, backward)
    return field(moduli)


def adjoint_gradients(
    model: ThrowModel, adjoint: jax.Array, u: jax.Array, solid: jax.Array
) -> tuple[jax.Array, jax.Array]:
    """Return the derivatives (nx, ny, nz) of any function of u by relative moduli and by the solid fraction.

    `adjoint` (cases, 3, nodes...) is the solution whose nodal forces are the function's derivative by u.
    """
    by_moduli = -_energy_density(layer_blocks(model.lattice), adjoint, u)
    if not model.spinning:
        return by_moduli, jnp.zeros_like(solid)
    return by_moduli, jax.grad(lambda s: jnp.sum(case_forces(model, s) * adjoint))(solid)


def compliances(model: ThrowModel, u: jax.Array, forces: jax.Array | None = None) -> jax.Array:
    """Return the work of the loads of the full throw, F . u per case (cases,), N mm."""
    load = model.forces if forces is None else forces
    return _works(load, u, model.modulus_MPa, model.share)


def compliance_gradients(model: ThrowModel, u: jax.Array) -> jax.Array:
    """Return the derivatives (cases, nx, ny, nz) of the compliances by relative moduli, N mm; self-adjoint.

    Body forces stay as they are: `compliance_gradients_by_solid` adds what changes with the mass.
    """
    return _scaled_energies(layer_blocks(model.lattice), u, -model.modulus_MPa / model.share)


def compliance_gradients_by_solid(model: ThrowModel, u: jax.Array, solid: jax.Array) -> jax.Array:
    """Return the derivatives (cases, nx, ny, nz) of the compliances by the solid fraction, N mm."""

    def work(solid: jax.Array) -> jax.Array:
        return jnp.sum(case_forces(model, solid) * u, axis=(1, 2, 3, 4))

    # The load moves u as well: for a linear structure that doubles its direct effect on F . u.
    by_load: jax.Array = jax.jacrev(work)(solid)
    return 2 * by_load * model.modulus_MPa / model.share


def case_load(case: LoadCase) -> float:
    """Return the load whose work is the compliance: torque in N mm, or pin force in N."""
    if load_type(case.kind).turns:
        return case.torque_Nm * NMM_PER_NM
    return math.hypot(case.radial_N, case.tangential_N)


def stiffness(model: ThrowModel, compliance_N_mm: float, case: str) -> float:
    """Return the stiffness of the full throw: N m/rad under a torque, N/mm under a force."""
    load = model.cases[model.case_names.index(case)]
    return case_load(load) ** 2 / compliance_N_mm / (NMM_PER_NM if load_type(load.kind).turns else 1.0)


def throw_mass_kg(model: ThrowModel, solid: jax.Array, density_kg_m3: float) -> jax.Array:
    """Return the mass of the full throw, kg."""
    tonne = density_tonne_per_mm3(density_kg_m3) * jnp.sum(solid * cell_volumes_mm3(model.lattice))
    return tonne * KG_PER_TONNE / model.share


def throw_unbalance_kg_mm(model: ThrowModel, solid: jax.Array, density_kg_m3: float) -> jax.Array:
    """Return the mass of the full throw times the y of its centre of mass, kg mm."""
    _, y = _arms_mm(model)
    return throw_mass_kg(model, solid * (y[:, :-1] + y[:, 1:]) / 2, density_kg_m3)


def throw_inertia_kg_mm2(model: ThrowModel, solid: jax.Array, density_kg_m3: float) -> jax.Array:
    """Return the moment of inertia of the full throw about the crank axis, kg mm2; exact for full cells."""
    squares = []
    for axis, arm in enumerate(_arms_mm(model)):
        low, high = np.delete(arm, -1, axis), np.delete(arm, 0, axis)
        squares.append((low**2 + low * high + high**2) / 3)
    return throw_mass_kg(model, solid * (squares[0] + squares[1]), density_kg_m3)


def _arms_mm(model: ThrowModel) -> tuple[Array, Array]:
    if model.arms_mm is None:
        raise ValueError("a model without arms_mm does not say where its nodes are")
    return model.arms_mm


@jax.jit
def _works(load: jax.Array, u: jax.Array, modulus: jax.Array, share: jax.Array) -> jax.Array:
    return WHOLE.dot(load, u) * modulus / share


@jax.jit
def _scaled_energies(blocks: jax.Array, u: jax.Array, factor: jax.Array) -> jax.Array:
    return factor * strain_energy_densities(blocks, u)


_energy_density = jax.jit(strain_energy_density)
