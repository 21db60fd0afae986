"""Stiffness and mass of a parametric web on the optimiser's cells, with exact gradients by its dimensions.

Parameters -> signed distance of the cells -> smooth step -> fill -> relative moduli, linear in the fill (a
boundary cell is partly full, not penalised) -> displacements -> responses. Call inside `double_precision()`.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.cells.domain import Domain, build_domain, centres_mm
from cranktopo.bodies.volume import bolted_mass
from cranktopo.design.manufacturing_limits import ManufacturingLimits
from cranktopo.design.schema import Scene
from cranktopo.engine.cases import load_cases
from cranktopo.engine.load_case import LOAD_TYPES, MAIN_KINDS
from cranktopo.engine.plan.planning import plan
from cranktopo.tasks.density.material import CONTRAST
from cranktopo.tasks.density.model import ThrowModel, build_model
from cranktopo.tasks.density.response import compliances, solve
from cranktopo.tasks.density.responses import Design, Response, gradients, quantities
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.model_fill import smooth_step
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.shape.free_bores import FreeBores, domain_without_free_bores
from cranktopo.tasks.shape.search_goal import Quantities

_TOLERANCE = 1e-5
"""Relative residual of the search; the error of a compliance is its square."""
_TOLERANCE_ORIGINAL = 1e-8


@dataclass(frozen=True)
class Responses(Quantities):
    """Quantities of a web and their gradients.

    Attributes:
        by_cell: gradients by the fill of the web's cells, each (nx, ny, nw).
        fill: of the web's cells (nx, ny, nw), 0 to 1.
        displacements: of every load case, the first guess of the next solve.
    """

    by_cell: dict[str, Array]
    fill: Array
    displacements: jax.Array


@dataclass(frozen=True)
class WebModel:
    """The cells of a throw whose web has a layout's dimensions.

    Attributes:
        known: every quantity that its load cases allow.
        original: those of the scene's own web on the same cells.
        bores: the free ones; fillets and another thickness are not on the cells, their gradients are 0.
    """

    scene: Scene
    limits: ManufacturingLimits
    domain: Domain
    model: ThrowModel
    known: Mapping[str, Response]
    original: dict[str, float]
    bores: FreeBores

    def web(self, layout: Layout) -> ParametricWeb:
        """Return a web of the layout on the cells between the web faces."""
        return ParametricWeb(layout, self.scene, self.limits, centres_mm(self.domain))

    def webs(self) -> SolvedWebs:
        """Return webs on these cells, solved one after another."""
        return SolvedWebs(self)

    @property
    def layers(self) -> slice:
        """Layers of the web along z."""
        return slice(*self.domain.web_layers)

    def fill(self, web: ParametricWeb, values: Array) -> Array:
        """Return the fill of the web's cells (nx, ny, nw), 0 to 1."""
        return smooth_step(web.inside_mm(values)[0], self.domain.grid.largest_edge_mm)[0]

    def responses(
        self, web: ParametricWeb, values: Array, quantities: Collection[str], guess: jax.Array | None = None
    ) -> Responses:
        """Return all quantities of the web with these values, and the gradients of some by the parameters.

        Raises:
            CranktopoError: the solve failed.
        """
        inside, which = web.inside_mm(values)
        fill, slope = smooth_step(inside, self.domain.grid.largest_edge_mm)
        design, layers = self.domain.design_fraction[:, :, self.layers], self.layers
        moduli, solid = self.domain.passive_fraction.copy(), self.domain.passive_fraction.copy()
        moduli[:, :, layers] += design * (CONTRAST + (1 - CONTRAST) * fill)
        solid[:, :, layers] += design * fill
        left, by_bores = self.bores.left(web.layout, values)
        stiff = 1 - (1 - CONTRAST) * (1 - left)
        solved = _solved(self.model, moduli * stiff, solid * left, _TOLERANCE, guess)
        found, by_moduli, by_solid = map(np.asarray, gradients(self.model, self._functions, solved, {}))
        by_fill = ((1 - CONTRAST) * stiff * by_moduli + left * by_solid)[..., layers] * design
        by_cell = dict(zip(self.known, by_fill, strict=True))
        pulled = {
            name: web.vjp(values, which, by_cell[name] * slope)
            for name in sorted(set(quantities) & set(by_cell))
        }
        by_left = (1 - CONTRAST) * moduli * by_moduli + solid * by_solid
        for name, rest in zip(self.known, by_left, strict=True):
            for bore, thinner in by_bores.items() if name in pulled else ():
                pulled[name][web.layout.names.index(bore)] += (rest * thinner).sum()
        named = dict(zip(self.known, map(float, found), strict=True))
        return Responses(named, pulled, by_cell, fill, solved.displacements)

    @property
    def _functions(self) -> tuple[Callable[[Design], jax.Array], ...]:
        return tuple(response.value for response in self.known.values())


class SolvedWebs:
    """Webs on cells, each solved from the displacements of the one before."""

    def __init__(self, model: WebModel) -> None:
        self.scene, self._model = model.scene, model
        self._guess: jax.Array | None = None

    def web(self, layout: Layout) -> ParametricWeb:
        """Return a web of the layout on the cells."""
        return self._model.web(layout)

    def responses(self, web: ParametricWeb, values: Array, quantities: Collection[str]) -> Responses:
        """Do as `WebModel.responses`."""
        found = self._model.responses(web, values, quantities, self._guess)
        self._guess = found.displacements
        return found


def web_model(scene: Scene, limits: ManufacturingLimits, resolution_mm: float) -> WebModel:
    """Return the cells of a scene's envelope for a search over dimensions, under bending and torsion.

    Raises:
        CranktopoError: no envelope, or a failed solve.
    """
    domain = domain_without_free_bores(scene, resolution_mm)
    effects = plan(scene).enabled - set(LOAD_TYPES) | set(MAIN_KINDS)
    model = build_model(scene, domain, load_cases(scene, effects))
    known = quantities(model, scene.material.density_kg_m3, bolted_mass(scene))
    own = build_domain(scene, resolution_mm, "web", domain.extent, domain.grid).passive_fraction
    solved = _solved(model, own, own, _TOLERANCE_ORIGINAL)
    original = {name: float(response.value(solved)) for name, response in known.items()}
    return WebModel(scene, limits, domain, model, known, original, FreeBores(scene, domain))


def _solved(
    model: ThrowModel, moduli: Array, solid: Array, tolerance: float, guess: jax.Array | None = None
) -> Design:
    relative = jnp.asarray(moduli)
    u = solve(model, relative, guess=guess, tolerance=tolerance).displacements
    works = compliances(model, u)
    return Design(relative, jnp.asarray(solid), works, works, u)
