"""Webs of every kind on the cells of a bound, and a bar whose stiffest shape is known."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray
from scipy import ndimage

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design.schema import Scene
from cranktopo.numerics.grid.lattice import Lattice
from cranktopo.tasks.bound.lower_bound import BoundModel
from cranktopo.tasks.bound.webs import AdmissibleDensities
from cranktopo.tasks.density.build import build_chain
from cranktopo.tasks.density.material import CONTRAST, physical_density
from cranktopo.tasks.density.model import ThrowModel, case_forces
from cranktopo.tasks.density.response import compliances, solve
from cranktopo.tasks.density.responses import Design, quantities
from cranktopo.tasks.density.stage import optimise_density, prepare
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.refit.model_fill import smooth_step
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.web_shape.start import outline_start
from cranktopo.throw.bevel import FittedBevel
from tests.physics.density.throw_cases import clamped_beam

Array = NDArray[np.float64]


def quantities_of(model: BoundModel, density: Array, power: float = 1.0) -> Array:
    """Compliances, then mass, inertia and unbalance of a web over the original's."""
    layers, fixed, design = model.webs.layers, model.webs.fixed, model.webs.design
    moduli, solid = fixed.copy(), fixed.copy()
    moduli[:, :, layers] += design * (CONTRAST + (1 - CONTRAST) * density**power)
    solid[:, :, layers] += design * density
    return _relative(model, moduli, solid)


def quantities_of_body(model: BoundModel, cells: Array) -> Array:
    """The same of a body that fills a share of every cell (nx, ny, nz)."""
    return _relative(model, cells, cells)


def _relative(model: BoundModel, moduli: Array, solid: Array) -> Array:
    stiff, filled = jnp.asarray(moduli), jnp.asarray(solid)
    u = solve(model.model, stiff, forces=case_forces(model.model, filled), tolerance=1e-8).displacements
    works = compliances(model.model, u)
    known = quantities(model.model, model.scene.material.density_kg_m3)
    found = Design(stiff, filled, works, works, u)
    sums = [float(known[name].value(found)) / model.original.quantities[name] for name in model.webs.amounts]
    cases = zip(np.asarray(works), model.reference_compliances.values(), strict=True)
    return np.array([*(work / own for work, own in cases), *sums])


def random_blobs(model: BoundModel, seed: int) -> Array:
    """A field of blobs and voids of random size and share (nx, ny, nw)."""
    draw = np.random.default_rng(seed)
    rough = ndimage.gaussian_filter(draw.random(model.webs.design.shape), draw.uniform(0.3, 2.0))
    level = np.quantile(rough, draw.uniform(0.1, 0.8))
    return np.clip(0.5 + draw.uniform(2, 60) * (rough - level), 0.1, 1) * (model.webs.design > 0)


def random_webs(model: BoundModel, count: int, seed: int) -> Iterator[Array]:
    """Fills (nx, ny, nw) of parametric webs with random outlines and bevels."""
    scene, draw = model.scene, np.random.default_rng(seed)
    limits, grid = usual_limits(scene), model.domain.grid
    x, y, z = ((nodes[1:] + nodes[:-1]) / 2 for nodes in (grid.x_mm, grid.y_mm, grid.z_mm))
    web = ParametricWeb(
        Layout(7, (FittedBevel("journal"), FittedBevel("pin"))), scene, limits, (x, y, z[model.webs.layers])
    )
    outline, size = outline_start(scene, limits), scene.web.thickness_mm
    for _ in range(count):
        bevels = draw.uniform([40.0, 0.1, 0.0, -0.3, 0.1, 0.0], [60.0, 0.9, 0.5, 0.3, 0.9, 0.5])
        values = [*(outline + draw.normal(0, size / 4, len(outline))), *(bevels * [1, *[size] * 5])]
        yield smooth_step(web.inside_mm(np.array(values))[0], grid.largest_edge_mm)[0]


def simp_density(scene: Scene, model: BoundModel, penalty: float, **settings: float) -> Array:
    """What the density optimisation makes of the scene on the same cells (nx, ny, nw)."""
    told = {"resolution_mm": model.scene.optimise.resolution_mm, "max_iterations": 12, "penalty": penalty}
    return optimise_density(prepare(scene.with_optimise(**told | settings))).design.physical


def pressed(scene: Scene, model: BoundModel, seed: int) -> Array:
    """A random field as the scene's process makes it (nx, ny, nw)."""
    density_chain = build_chain(scene, model.domain)
    x = jnp.asarray(random_blobs(model, seed))
    return np.asarray(jax.jit(physical_density)(density_chain, x, 8.0))


def own_body(model: BoundModel) -> Array:
    """The original web (nx, ny, nz)."""
    domain, cell_mm = model.domain, model.scene.optimise.resolution_mm
    return build_domain(model.scene, cell_mm, "web", domain.extent, domain.grid).passive_fraction


def loaded_bar(layers: int = 8) -> tuple[ThrowModel, AdmissibleDensities, float]:
    """A bar along z, clamped at one end, pulled evenly at each layer, without Poisson's ratio.

    Returns:
        Its model, its webs and its least compliance at the volume of a quarter of its cells: the area of each
        layer is as its force, so that every layer has the same stress.
    """
    lattice, modulus = Lattice((2, 2, layers), 1.0, 1.0, (1.0,) * layers, 0.0), 1000.0
    beam = clamped_beam(lattice, 1, 2, modulus)
    end = np.asarray(beam.forces)[:, :, :, :, -1]
    pulls = np.linspace(0.2, 1.0, layers) / 4
    forces = np.zeros_like(np.asarray(beam.forces))
    forces[..., 1:] = end[..., None] * pulls
    normal = np.cumsum(pulls[::-1])[::-1]
    solid = np.ones(lattice.cells)
    webs = AdmissibleDensities(0 * solid, solid, slice(0, layers), {"mass": solid}, {"mass": 0.0})
    volume = solid.sum() / 4
    return replace(beam, forces=jnp.asarray(forces)), webs, float(normal.sum()) ** 2 / (modulus * volume)
