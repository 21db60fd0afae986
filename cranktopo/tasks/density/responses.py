"""Responses of a design: one number each, a pure JAX function of the solved design, and its whole derivative.

A response is a value of stiffness, mass or displacement that an optimisation may minimise, maximise or limit.
`jax.jit` and `jax.grad` work around its `value`. That the displacements follow the moduli is no business of a
response: `gradients` adds it, from the self-adjoint work of the loads at no cost, and by one more solve for a
response that reads displacements.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Literal, NamedTuple

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.units import NMM_PER_NM
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.balance_factor import rods_kg_mm
from cranktopo.design.goal.quantities import MOTIONS
from cranktopo.design.schema import Scene
from cranktopo.engine.load_case import LoadCase
from cranktopo.engine.load_type import load_type
from cranktopo.numerics.device_arrays import on_device
from cranktopo.tasks.density.material import MaterialInterpolation
from cranktopo.tasks.density.model import ThrowModel
from cranktopo.tasks.density.response import (
    adjoint_gradients,
    case_load,
    compliance_gradients,
    compliance_gradients_by_solid,
    throw_inertia_kg_mm2,
    throw_mass_kg,
    throw_unbalance_kg_mm,
)
from cranktopo.throw.moments import Moments


class Design(NamedTuple):
    """One design and what its loads do to it; a JAX tree.

    Attributes:
        moduli: relative modulus of every cell (nx, ny, nz).
        solid: solid fraction of every cell (nx, ny, nz), which has the mass.
        compliances: work of the loads of the full throw (cases,), N mm.
        reference_compliances: those of the first design of the optimisation.
        displacements: (cases, 3, nodes...), mm; 0 at nodes without any material.
    """

    moduli: jax.Array
    solid: jax.Array
    compliances: jax.Array
    reference_compliances: jax.Array
    displacements: jax.Array


@dataclass(frozen=True)
class Response:
    """One number of a design, by a pure JAX function `value` of the solved design.

    Attributes:
        reads_displacements: `value` reads the displacements themselves; its derivative takes a solve.
        needs_solve: `value` depends on the loads; without, it is a sum over the cells.
        stiffest: what more material, wherever it is put, makes of the response; empty where that depends.
    """

    name: str
    unit: str
    value: Callable[[Design], jax.Array]
    reads_displacements: bool = False
    needs_solve: bool = True
    stiffest: Literal["most", "least", ""] = ""


def weighted_compliance(weights: Sequence[float]) -> Response:
    """Return the weighted sum of the works of the loads, each over its value in the first design."""
    shares = on_device(np.asarray(weights) / sum(weights))
    return Response(
        "weighted compliance", "", lambda design: shares @ (design.compliances / design.reference_compliances)
    )


def relative_compliance(index: int, name: str, weight: float = 1.0) -> Response:
    """Return the work of the loads of one case over its value in the first design, times a weight."""

    def value(design: Design) -> jax.Array:
        return weight * design.compliances[index] / design.reference_compliances[index]

    return Response(f"{name} compliance", "", value)


def volume(density_chain: MaterialInterpolation) -> Response:
    """Share of the design space that is solid."""
    first, last = density_chain.web_layers
    fixed = float(np.asarray(density_chain.passive_fraction)[:, :, first:last].sum())
    total = float(np.asarray(density_chain.design_fraction).sum())

    def value(design: Design) -> jax.Array:
        return (jnp.sum(design.solid[:, :, first:last]) - fixed) / total

    return Response("volume fraction", "", value, needs_solve=False)


def quantities_of(scene: Scene, model: ThrowModel) -> dict[str, Response]:
    """Return `quantities` of a scene's throw: with what is bolted to its webs, and its rods."""
    return quantities(model, scene.material.density_kg_m3, bolted_mass(scene), rods_kg_mm(scene))


def quantities(
    model: ThrowModel,
    density_kg_m3: float,
    bolted: Moments | None = None,
    rods_kg_mm: tuple[float, float] = (0.0, 0.0),
) -> dict[str, Response]:
    """Return every quantity of a goal or a limit that the model's load cases allow, by its name in a scene.

    The stiffness of a load case has the case's name; `bolted` is of what is bolted to each web, kg and mm,
    `rods_kg_mm` of the rods' masses that turn and that oscillate.
    """
    parts = (0.0,) * 3 if bolted is None else (bolted.volume, bolted.polar, bolted.first_y)
    mass, *others = (
        _of_solid(name, unit, of, model, density_kg_m3, 2 * part)
        for (name, unit, of), part in zip(_OF_SOLID, parts, strict=True)
    )
    balanced = [_balance_factor(others[-1], *rods_kg_mm)] if rods_kg_mm[1] else []
    loaded = [r for index, case in enumerate(model.cases) for r in _of_case(index, case, mass)]
    return {response.name: response for response in (mass, *others, *balanced, *loaded)}


_OF_SOLID = (
    ("mass", "kg", throw_mass_kg),
    ("inertia", "kg mm2", throw_inertia_kg_mm2),
    ("unbalance", "kg mm", throw_unbalance_kg_mm),
)


def _of_solid(
    name: str,
    unit: str,
    of: Callable[[ThrowModel, jax.Array, float], jax.Array],
    model: ThrowModel,
    density_kg_m3: float,
    part: float,
) -> Response:
    def value(design: Design) -> jax.Array:
        found = of(model, design.solid, density_kg_m3)
        return found + part if part else found

    return Response(name, unit, value, needs_solve=False)


def _balance_factor(unbalance: Response, rotating_kg_mm: float, oscillating_kg_mm: float) -> Response:
    return Response(
        "balance_factor",
        "%",
        lambda design: -100 * (unbalance.value(design) + rotating_kg_mm) / oscillating_kg_mm,
        needs_solve=False,
    )


def _of_case(index: int, case: LoadCase, mass: Response) -> list[Response]:
    """Return stiffness, stiffness per mass and motion of the load under one case; a body force has none."""
    load, torsion = abs(case_load(case)), load_type(case.kind).turns
    if case.has_body_force or load == 0:
        return []
    unit, turn = (NMM_PER_NM, math.degrees(1)) if torsion else (1.0, 1.0)
    stiffness = Response(
        case.name,
        "N m/rad" if torsion else "N/mm",
        lambda design: load**2 / design.compliances[index] / unit,
        stiffest="most",
    )
    per_mass = ratio(f"{case.name}_per_mass", "N m/(rad kg)" if torsion else "N/(mm kg)", stiffness, mass)
    motion = Response(
        MOTIONS.get(case.name, f"{case.name}_{'twist' if torsion else 'displacement'}"),
        "deg" if torsion else "mm",
        lambda design: design.compliances[index] / load * turn,
        stiffest="least",
    )
    return [stiffness, per_mass, motion]


def ratio(name: str, unit: str, above: Response, below: Response) -> Response:
    """Return one response over another."""
    return Response(
        name,
        unit,
        lambda design: above.value(design) / below.value(design),
        above.reads_displacements or below.reads_displacements,
        above.needs_solve or below.needs_solve,
    )


def gradients(
    model: ThrowModel,
    functions: tuple[Callable[[Design], jax.Array], ...],
    design: Design,
    adjoints: Mapping[int, jax.Array],
) -> tuple[jax.Array, jax.Array, jax.Array]:
    """Return the values (k,) of functions of a solved design and their whole derivatives (k, nx, ny, nz).

    The derivatives are by the relative moduli and by the solid fraction. `adjoints` has, by the index of a
    function that reads displacements, the displacements under `loads_of` it.
    """
    values, by_moduli, by_solid, by_compliances = _partial_gradients(functions, design)
    u = design.displacements
    by_moduli += _combined(by_compliances, compliance_gradients(model, u))
    if model.spinning:
        by_solid += _combined(by_compliances, compliance_gradients_by_solid(model, u, design.solid))
    for index, adjoint in adjoints.items():
        of_u = adjoint_gradients(model, adjoint, u, design.solid)
        by_moduli, by_solid = by_moduli.at[index].add(of_u[0]), by_solid.at[index].add(of_u[1])
    return values, by_moduli, by_solid


@partial(jax.jit, static_argnums=0)
def loads_of(function: Callable[[Design], jax.Array], design: Design) -> jax.Array:
    """Return the loads of a function's adjoint solve: its derivative by the displacements."""
    loads = jax.grad(lambda u: function(design._replace(displacements=u)))(design.displacements)
    return on_material(loads, design.moduli)


@jax.jit
def on_material(field: jax.Array, moduli: jax.Array) -> jax.Array:
    """Return a field (cases, 3, nodes...) with zeros at the nodes where no cell has any stiffness."""
    filled = jnp.pad(moduli > 0, 1)
    for axis in range(3):
        size = filled.shape[axis]
        near = jax.lax.slice_in_dim(filled, 0, size - 1, axis=axis)
        filled = near | jax.lax.slice_in_dim(filled, 1, size, axis=axis)
    return field * filled


@partial(jax.jit, static_argnums=0)
def values_of(functions: tuple[Callable[[Design], jax.Array], ...], design: Design) -> jax.Array:
    """Return the values (k,) of functions of a solved design."""
    return jnp.stack([function(design) for function in functions])


@partial(jax.jit, static_argnums=0)
def _partial_gradients(
    functions: tuple[Callable[[Design], jax.Array], ...], design: Design
) -> tuple[jax.Array, jax.Array, jax.Array, jax.Array]:
    """Return the values and derivatives by moduli, solid and compliances, the displacements held."""

    def stacked(moduli: jax.Array, solid: jax.Array, compliances: jax.Array) -> jax.Array:
        return values_of(functions, design._replace(moduli=moduli, solid=solid, compliances=compliances))

    seen = design.moduli, design.solid, design.compliances
    return stacked(*seen), *jax.jacrev(stacked, (0, 1, 2))(*seen)


@jax.jit
def _combined(shares: jax.Array, fields: jax.Array) -> jax.Array:
    return jnp.einsum("kb,bxyz->kxyz", shares, fields)
