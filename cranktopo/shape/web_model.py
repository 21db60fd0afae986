"""Stiffness and mass of a parametric web on the optimiser's cells, with exact gradients by its dimensions.

Parameters -> signed distance of the cells -> smooth step -> fill -> relative moduli, linear in the fill (a
boundary cell is partly full, not penalised) -> displacements -> responses. Call inside `double_precision()`.
"""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from cranktopo.domain.build import Domain, build_domain
from cranktopo.effects import plan
from cranktopo.fem.model import ThrowModel, build_model
from cranktopo.fem.response import compliance_gradients, compliances, solve, stiffness
from cranktopo.loads.cases import load_cases
from cranktopo.optimise.material import CONTRAST
from cranktopo.remodel.family import Layout
from cranktopo.remodel.manufacturing_limits import ManufacturingLimits
from cranktopo.remodel.model_fill import smooth_step
from cranktopo.remodel.parametric_web import ParametricWeb
from cranktopo.scene import Scene
from cranktopo.units import density_kg_per_mm3

Array = NDArray[np.float64]
_TOLERANCE = 1e-5
"""Relative residual of the search; the error of a compliance is its square."""
_TOLERANCE_ORIGINAL = 1e-8
_PER_MASS = "_per_mass"


@dataclass(frozen=True)
class Responses:
    """Quantities of a web and their gradients.

    Attributes:
        values: by quantity: mass kg, inertia kg mm2, unbalance kg mm, torsion N m/rad, bending N/mm, both
            stiffnesses per mass.
        slopes: gradients by the parameters, each (parameters,), per mm or degree.
        by_cell: gradients by the fill of the web's cells, each (nx, ny, nw).
        fill: of the web's cells (nx, ny, nw), 0 to 1.
        displacements: of every load case, the first guess of the next solve.
    """

    values: dict[str, float]
    slopes: dict[str, Array]
    by_cell: dict[str, Array]
    fill: Array
    displacements: jax.Array


@dataclass(frozen=True)
class WebModel:
    """The cells of a throw whose web has a layout's dimensions.

    Attributes:
        original: quantities of the scene's own web on the same cells.
    """

    scene: Scene
    limits: ManufacturingLimits
    domain: Domain
    model: ThrowModel
    original: dict[str, float]

    def web(self, layout: Layout) -> ParametricWeb:
        """A web of the layout on the cells between the web faces."""
        x, y, z = ((nodes[1:] + nodes[:-1]) / 2 for nodes in self._nodes)
        return ParametricWeb(layout, self.scene, self.limits, (x, y, z[self.layers]))

    @property
    def layers(self) -> slice:
        """Layers of the web along z."""
        return slice(*self.domain.web_layers)

    @property
    def _nodes(self) -> tuple[Array, Array, Array]:
        grid = self.domain.grid
        return grid.x_mm, grid.y_mm, grid.z_mm

    def fill(self, web: ParametricWeb, values: Array) -> Array:
        """Fill of the web's cells (nx, ny, nw), 0 to 1."""
        return smooth_step(web.inside_mm(values)[0], self.domain.grid.largest_edge_mm)[0]

    def responses(
        self, web: ParametricWeb, values: Array, quantities: Collection[str], guess: jax.Array | None = None
    ) -> Responses:
        """All quantities of the web with these values, and the gradients of some by the parameters.

        Raises:
            CranktopoError: the solve failed.
        """
        inside, which = web.inside_mm(values)
        fill, slope = smooth_step(inside, self.domain.grid.largest_edge_mm)
        design, layers = self.domain.design[:, :, self.layers], self.layers
        moduli, solid = self.domain.fixed.copy(), self.domain.fixed.copy()
        moduli[:, :, layers] += design * (CONTRAST + (1 - CONTRAST) * fill)
        solid[:, :, layers] += design * fill
        solved = solve(self.model, jnp.asarray(moduli), guess=guess, tolerance=_TOLERANCE)
        found = _quantities(self.model, self.domain, self.scene, solid, solved.displacements)
        by_cell = self._by_cell(found, solved.displacements)
        slopes = {
            name: web.pulled_back(values, which, by_cell[name] * slope)
            for name in sorted(set(quantities) & set(by_cell))
        }
        return Responses(found, slopes, by_cell, fill, solved.displacements)

    def _by_cell(self, found: dict[str, float], u: jax.Array) -> dict[str, Array]:
        design = self.domain.design[:, :, self.layers]
        result = {
            name: np.broadcast_to(weight, self.domain.fixed.shape)[:, :, self.layers] * design
            for name, weight in mass_weights(self.domain, self.scene).items()
        }
        energies = np.asarray(compliance_gradients(self.model, u))[..., self.layers]
        work = np.asarray(compliances(self.model, u))
        for case, c, energy in zip(self.model.cases, work, energies, strict=True):
            k, mass = found[case.name], found["mass"]
            result[case.name] = -k / float(c) * (1 - CONTRAST) * energy * design
            result[case.name + _PER_MASS] = (result[case.name] - k / mass * result["mass"]) / mass
        return result


def web_model(scene: Scene, limits: ManufacturingLimits, resolution_mm: float) -> WebModel:
    """The cells of a scene's envelope for a search over dimensions, under bending and torsion.

    Raises:
        CranktopoError: no envelope, or a failed solve.
    """
    domain = build_domain(scene, resolution_mm)
    effects = plan(scene).enabled - {"tangential", "centrifugal"} | {"bending", "torsion"}
    model = build_model(scene, domain, load_cases(scene, effects))
    own = build_domain(scene, resolution_mm, "web", domain.extent, domain.grid).fixed
    solved = solve(model, jnp.asarray(own), tolerance=_TOLERANCE_ORIGINAL)
    return WebModel(
        scene, limits, domain, model, _quantities(model, domain, scene, own, solved.displacements)
    )


def mass_weights(domain: Domain, scene: Scene) -> dict[str, Array]:
    """What a full cell adds to mass, kg, inertia, kg mm2, and unbalance of the throw, kg mm."""
    grid = domain.grid
    kg = density_kg_per_mm3(scene.material.density_kg_m3) * domain.volume_mm3 / domain.share
    x, y = ((nodes[1:] + nodes[:-1]) / 2 for nodes in (grid.x_mm, grid.y_mm))
    own = sum(float(steps[0]) ** 2 for steps in grid.steps_mm[:2]) / 12
    square = x[:, None, None] ** 2 + y[None, :, None] ** 2 + own
    return {"mass": kg, "inertia": kg * square, "unbalance": kg * y[None, :, None]}


def _quantities(
    model: ThrowModel, domain: Domain, scene: Scene, solid: Array, u: jax.Array
) -> dict[str, float]:
    found = {name: float((weight * solid).sum()) for name, weight in mass_weights(domain, scene).items()}
    for case, work in zip(model.cases, np.asarray(compliances(model, u)), strict=True):
        found[case.name] = stiffness(model, float(work), case.name)
        found[case.name + _PER_MASS] = found[case.name] / found["mass"]
    return found
