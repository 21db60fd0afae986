"""The residual told is the one there is: against a product in extended precision, element by element."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace

import jax.numpy as jnp
import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.ndimage import gaussian_filter

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.cells.domain import Domain, build_domain
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.numerics.grid.boundary_conditions import CaseSupports
from cranktopo.numerics.grid.lattice import CORNERS, Lattice, layer_blocks, parity_sum_of
from cranktopo.tasks.density.material import build_interpolation, relative_moduli
from cranktopo.tasks.density.model import ThrowModel, build_model, case_supports
from cranktopo.tasks.density.response import solve
from tests.hard.cases import THROW_LOADS
from tests.hard.oracle import Array, rigid_motion

EXTENDED = np.longdouble
Extended = NDArray[np.longdouble]
pytestmark = pytest.mark.skipif(
    bool(np.finfo(EXTENDED).eps > 1e-18), reason="no extended precision on this processor"
)

CELL_MM, TOLERANCE = 6.4, 1e-8


def smooth(shape: tuple[int, ...], widths: float = 1.5) -> Array:
    """A random field that is evenly spread from 0 to 1."""
    noise = gaussian_filter(np.random.default_rng(1).standard_normal(shape), widths, mode="nearest")
    return np.asarray(noise.ravel().argsort().argsort().reshape(shape) / (noise.size - 1))


@dataclass(frozen=True)
class Hidden:
    """A throw that moves much further than it bends: density of the web, penalty, bearing springs, sizes."""

    density: Callable[[tuple[int, ...]], Array]
    penalty: float = 3.0
    spring: float | None = None
    floor: float | None = None
    sizes: Mapping[str, float] = field(default_factory=dict)

    def scene(self) -> Scene:
        plain = with_values(load_scene("mikron-iiic-plain"), self.sizes)
        if self.spring is None:
            return plain
        changed = {"torsion": "spring", "bending": "spring", "bearing_spring_N_per_mm": self.spring}
        return plain.model_copy(update={"supports": plain.supports.model_copy(update=changed)})

    def moduli(self, domain: Domain) -> Array:
        chain = replace(build_interpolation(domain, 1.0), penalty=self.penalty)
        density = self.density(chain.design_fraction.shape)
        if self.floor is None:
            return np.asarray(relative_moduli(chain, jnp.asarray(density)))
        first, last = chain.web_layers
        web = chain.design_fraction * self.floor ** (1 - density)
        return np.asarray(chain.passive_fraction.at[:, :, first:last].add(web))


GAP_150_MM = {
    "throw.radius_mm": 192.0,
    "engine.rod_length_mm": 600.0,
    "engine.bore_mm": 100.0,
    "envelope.y_max_mm": 226.0,
}
"""Between journals of 42 mm; the engine is one that has such a stroke."""
CASES = {
    "moduli from 1e-12 to 1": Hidden(lambda shape: smooth(shape, 0.0), floor=1e-12),
    "penalty 6, density to 0.3": Hidden(lambda shape: 0.3 * smooth(shape), penalty=6.0),
    "penalty 6, density to 0.27": Hidden(lambda shape: 0.27 * smooth(shape), penalty=6.0),
    "density 0.02": Hidden(lambda shape: np.full(shape, 0.02)),
    "bearings of 10 N/mm": Hidden(smooth, spring=10.0),
    "bearings of 1000 N/mm": Hidden(smooth, spring=1000.0),
    "gap of 150 mm, smooth": Hidden(smooth, sizes=GAP_150_MM),
    "gap of 150 mm, white": Hidden(lambda shape: smooth(shape, 0.0), sizes=GAP_150_MM),
    "gap of 150 mm, 0/1 cells": Hidden(lambda shape: np.round(smooth(shape, 0.0)), sizes=GAP_150_MM),
}


QUICK = "penalty 6, density to 0.3", "density 0.02", "bearings of 10 N/mm", "bearings of 1000 N/mm"
"""On cells of one grid; a throw on soft bearings moves further than it bends, as one with a gap does."""


@pytest.mark.parametrize(
    "name", [name if name in QUICK else pytest.param(name, marks=pytest.mark.slow) for name in CASES]
)
def test_told_is_true(float64: None, name: str) -> None:
    case = CASES[name]
    scene, domain = case.scene(), build_domain(case.scene(), CELL_MM)
    model, moduli = build_model(scene, domain, THROW_LOADS), case.moduli(domain)
    solution = solve(model, jnp.asarray(moduli), tolerance=TOLERANCE)
    for index, load in enumerate(THROW_LOADS):
        told = float(solution.relative_residual[index])
        supports = case_supports(scene, domain, load)
        u = np.asarray(solution.displacements[index])
        true = true_residual(model, domain, supports, moduli, np.asarray(model.forces[index]), u)
        assert told <= TOLERANCE
        assert true / 1.1 < told < 1.1 * true


@pytest.mark.slow
def test_a_floor_is_told(float64: None) -> None:
    """No displacements in float64 have the residual; who asks is told why, and what to do."""
    case = Hidden(smooth, spring=1.0)
    scene, domain = case.scene(), build_domain(case.scene(), CELL_MM)
    with pytest.raises(CranktopoError, match="Float64 ends there") as caught:
        solve(build_model(scene, domain, THROW_LOADS), jnp.asarray(case.moduli(domain)), tolerance=TOLERANCE)
    assert "stiffer bearing springs" in caught.value.hint


def true_residual(
    model: ThrowModel, domain: Domain, supports: CaseSupports, moduli: Array, forces: Array, u: Array
) -> float:
    """What is out of balance over the load, as admissible displacements feel it."""
    lattice, origin = model.lattice, (float(domain.grid.x_mm[0]), float(domain.grid.y_mm[0]))
    free = np.ones(lattice.field_shape, bool)
    free[list(supports.fixed_at_x0), 0] = False
    free[list(supports.fixed_at_z_end), :, :, -1] = False
    free[..., [0, *(motion.plane for motion in supports.motions)]] = False
    motions = np.array([rigid_motion(lattice, origin, m.plane, m.motion).ravel() for m in supports.motions])
    motions = motions.astype(EXTENDED)
    springs = np.array([motion.stiffness for motion in supports.motions]) / model.modulus_MPa
    inverse = _inverse(motions @ motions.T)

    def norm(field: Extended, on_sections: Extended) -> float:
        return float(np.sqrt(np.sum((field * free) ** 2) + on_sections @ inverse @ on_sections))

    load = forces.astype(EXTENDED)
    left = load - product(lattice, moduli, u.astype(EXTENDED))
    moved = inverse @ (motions @ u.ravel().astype(EXTENDED))
    return norm(left, motions @ left.ravel() - springs * moved) / norm(load, motions @ load.ravel())


def product(lattice: Lattice, moduli: Array, u: Extended) -> Extended:
    """Forces of all elements, whose matrices are those of the solver's parity blocks without rounding."""
    nx, ny, nz = lattice.cells
    total = np.zeros(u.shape, EXTENDED)
    for layer in range(nz):
        at = [u[:, i : i + nx, j : j + ny, layer + k] for i, j, k in CORNERS]
        forces = np.einsum("acbd,bdxy->acxy", element(lattice, layer), np.stack(at)) * moduli[:, :, layer]
        for part, (i, j, k) in zip(forces, CORNERS, strict=True):
            total[:, i : i + nx, j : j + ny, layer + k] += part
    return total


def element(lattice: Lattice, layer: int) -> Extended:
    """Matrix (8, 3, 8, 3) of a cell."""
    blocks = layer_blocks(lattice)[..., layer].astype(EXTENDED)
    signs = np.prod(np.where(CORNERS[None] == 1, 2 * CORNERS[:, None] - 1, 1), axis=2).astype(EXTENDED)
    matrix = np.zeros((8, 3, 8, 3), EXTENDED)
    for p, c, d in np.ndindex(8, 3, 3):
        rows, columns = signs[:, parity_sum_of(p, c)], signs[:, parity_sum_of(p, d)]
        matrix[:, c, :, d] += blocks[p, c, d] * np.outer(rows, columns)
    return matrix


def _inverse(matrix: Extended) -> Extended:
    """Inverse by Newton's method, which corrects that of NumPy in float64."""
    found = np.linalg.inv(matrix.astype(float)).astype(EXTENDED)
    for _ in range(3):
        found = found @ (2 * np.eye(len(found)) - matrix @ found)
    return np.asarray(found)
