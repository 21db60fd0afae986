"""Stiffness and mass of a parametric web on the optimiser's cells, with exact gradients by its dimensions.

Parameters -> signed distance of the cells -> smooth step -> fill -> relative moduli, linear in the fill (a
boundary cell is partly full, not penalised) -> displacements -> responses. Call inside `double_precision()`.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, replace

import jax
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.cells.domain import Domain, build_domain, centres_mm
from cranktopo.design.free_dimensions import (
    DimensionName,
    free_range_mm,
    is_of_counterweight,
    own_dimension_mm,
    with_dimensions,
)
from cranktopo.design.halves import without_zones
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.states import main_load_cases
from cranktopo.numerics.device_arrays import on_device
from cranktopo.tasks.density.material import CONTRAST
from cranktopo.tasks.density.model import ThrowModel, build_model
from cranktopo.tasks.density.response import compliances, solve
from cranktopo.tasks.density.responses import Design, Response, gradients, quantities_of
from cranktopo.tasks.refit.family import Layout, free_dimensions, scene_at
from cranktopo.tasks.refit.model_fill import smooth_step
from cranktopo.tasks.refit.parametric_web import ParametricWeb
from cranktopo.tasks.web_shape.search_goal import Quantities
from cranktopo.tasks.web_shape.shaft_frequency import NAME, frequency_of, needed_for, slope_of
from cranktopo.tasks.web_shape.start import free_bores
from cranktopo.throw.manufacturing_limits import ManufacturingLimits

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

    Fillets and another thickness are not on the cells, their gradients are 0.

    Attributes:
        known: every quantity that its load cases allow.
        original: those of the scene's own web on the same cells.
    """

    scene: Scene
    limits: ManufacturingLimits
    domain: Domain
    model: ThrowModel
    known: Mapping[str, Response]
    original: dict[str, float]

    def web(self, layout: Layout) -> ParametricWeb:
        """Return a web of the layout on the cells between the web faces."""
        return ParametricWeb(layout, self.scene, self.limits, centres_mm(self.domain))

    def webs(self) -> _SolvedWebs:
        """Return webs on these cells, solved one after another."""
        return _SolvedWebs(self)

    def fill(self, web: ParametricWeb, values: Array) -> Array:
        """Return the fill of the web's cells (nx, ny, nw), 0 to 1."""
        return smooth_step(web.inside_mm(values)[0], self.domain.grid.largest_edge_mm)[0]

    def responses(
        self, web: ParametricWeb, values: Array, quantities: Collection[str], guess: jax.Array | None = None
    ) -> Responses:
        """Return all quantities of the web with these values, and the gradients of some by the parameters."""
        inside, which = web.inside_mm(values)
        fill, slope = smooth_step(inside, self.domain.grid.largest_edge_mm)
        layers = slice(*self.domain.web_layers)
        design = self.domain.design_fraction[:, :, layers]
        moduli, solid = self.domain.passive_fraction.copy(), self.domain.passive_fraction.copy()
        moduli[:, :, layers] += design * (CONTRAST + (1 - CONTRAST) * fill)
        solid[:, :, layers] += design * fill
        left, by_bores = _left_by_bores(self.scene, self.domain, web.layout, values)
        stiff = 1 - (1 - CONTRAST) * (1 - left)
        solved = solved_design(self.model, moduli * stiff, solid * left, _TOLERANCE, guess)
        functions = tuple(response.value for response in self.known.values())
        found, by_moduli, by_solid = map(np.asarray, gradients(self.model, functions, solved, {}))
        by_fill = ((1 - CONTRAST) * stiff * by_moduli + left * by_solid)[..., layers] * design
        by_cell = dict(zip(self.known, by_fill, strict=True))
        pulled = {
            name: web.vjp(values, which, by_cell[name] * slope)
            for name in sorted(needed_for(quantities) & set(by_cell))
        }
        by_left = (1 - CONTRAST) * moduli * by_moduli + solid * by_solid
        for name, rest in zip(self.known, by_left, strict=True):
            for bore, thinner in by_bores.items() if name in pulled else ():
                pulled[name][web.layout.names.index(bore)] += (rest * thinner).sum()
        named = dict(zip(self.known, map(float, found), strict=True))
        if shaft := frequency_of(self.scene, named):
            named[NAME], by_cell[NAME] = shaft.frequency_Hz, slope_of(shaft, by_cell)
            pulled |= {NAME: slope_of(shaft, pulled)} if NAME in quantities else {}
        return Responses(named, pulled, by_cell, fill, solved.displacements)


class _SolvedWebs:
    """Webs on cells, each solved from the displacements of the one before."""

    def __init__(self, model: WebModel) -> None:
        self.scene, self._model = model.scene, model
        self._guess: jax.Array | None = None

    def web(self, layout: Layout) -> ParametricWeb:
        """Return a web of the layout on the cells."""
        return self._model.web(layout)

    def responses(self, web: ParametricWeb, values: Array, quantities: Collection[str]) -> Responses:
        """Do as `WebModel.responses`."""
        guess, self._guess = self._guess, None  # a solve takes it, also one that fails
        found = self._model.responses(web, values, quantities, guess)
        self._guess = found.displacements
        return found


def web_model(scene: Scene, limits: ManufacturingLimits, resolution_mm: float) -> WebModel:
    """Return the cells of a scene's envelope for a search over dimensions, under bending and torsion.

    Raises:
        CranktopoError: no envelope, or a failed solve.
    """
    domain = _domain_without_free_bores(scene, resolution_mm)
    model = build_model(scene, domain, main_load_cases(scene, plan(scene).enabled))
    known = quantities_of(scene, model)
    own = build_domain(scene, resolution_mm, "web", domain.extent, domain.grid).passive_fraction
    solved = solved_design(model, own, own, _TOLERANCE_ORIGINAL)
    original = {name: float(response.value(solved)) for name, response in known.items()}
    if shaft := frequency_of(scene, original):
        original[NAME] = shaft.frequency_Hz
    return WebModel(scene, limits, domain, model, known, original)


def solved_design(
    model: ThrowModel, moduli: Array, solid: Array, tolerance: float, guess: jax.Array | None = None
) -> Design:
    """Return a throw solved with moduli and fills of its cells, to a relative residual."""
    relative = on_device(moduli)
    u = solve(model, relative, guess=guess, tolerance=tolerance).displacements
    works = compliances(model, u)
    return Design(relative, on_device(solid), works, works, u)


def _domain_without_free_bores(scene: Scene, resolution_mm: float) -> Domain:
    """Return the cells of the design space with free bores filled; the pin is loaded outside its own.

    A counterweight that changes is no fixed part of them.
    """
    free = free_bores(scene)
    if any(map(is_of_counterweight, free_dimensions(scene))):
        bare = scene.web.model_copy(update={"counterweight": None})
        scene = without_zones(scene.model_copy(update={"web": bare}))  # rules of the search keep the zones
    filled = build_domain(with_dimensions(scene, dict.fromkeys(free, 0.0)), resolution_mm)
    if "pin_bore" not in free:
        return filled
    widest = with_dimensions(scene, {"pin_bore": (free_range_mm(scene, "pin_bore") or (0.0, 0.0))[1]})
    pin = build_domain(widest, resolution_mm, "envelope", filled.extent, filled.grid).pin
    return replace(filled, pin=pin)


def _left_by_bores(
    scene: Scene, domain: Domain, layout: Layout, values: Array
) -> tuple[Array, dict[str, Array]]:
    """Return the share of each cell that free bores leave, (nx, ny, nz), and its derivatives, 1/mm.

    A bore runs through its journal and the web. A solid journal whose bore the layout lacks stays solid.
    """
    sized = scene_at(scene, layout, values)
    rests = {n: _left_by_bore(sized, domain, n) for n in free_bores(scene) if own_dimension_mm(sized, n)}
    left, gradients = np.ones(domain.grid.cells), dict[str, Array]()
    for name, (rest, _) in rests.items():
        left *= rest
        if name in layout.dimensions:
            others = [other for key, (other, _) in rests.items() if key != name]
            gradients[name] = np.prod([rests[name][1], *others], axis=0)
    return left, gradients


def _left_by_bore(scene: Scene, domain: Domain, name: DimensionName) -> tuple[Array, Array]:
    grid, (start, end), main = domain.grid, domain.web_layers, name == "journal_bore"
    journal, axis = scene.throw.journals[0 if main else 1]
    x, y = ((nodes[1:] + nodes[:-1]) / 2 for nodes in (grid.x_mm, grid.y_mm))
    step = grid.largest_edge_mm
    radius, by_radius = _stepped_radius(journal.bore_radius_mm, step)
    rest, slope = smooth_step(np.hypot(x[:, None], y[None, :] - axis) - radius, step)
    bored = np.arange(grid.cells[2]) < end if main else np.arange(grid.cells[2]) >= start
    by_diameter = np.where(bored, -slope[:, :, None] * by_radius / 2, 0.0)
    return np.where(bored, rest[:, :, None], 1.0), by_diameter


def _stepped_radius(radius_mm: float, step_mm: float) -> tuple[float, float]:
    """Return the step's radius at which a hole takes its true area, and its derivative by the hole's radius.

    A step of half-width h about a circle of radius r takes pi (r2 + 0.2 h2).
    """
    square, more = radius_mm**2, 0.2 * step_mm**2
    far = np.sqrt(square + more)
    return float(square / far), float(radius_mm * (2 - square / far**2) / far)
