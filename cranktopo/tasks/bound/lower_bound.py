"""The bound of a scene in memory: cells -> densities of variable stiffness -> displacements -> proof."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import jax
import jax.numpy as jnp
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.bodies.cells.domain import Domain, build_domain
from cranktopo.bodies.cells.web_cells import on_cells
from cranktopo.design.goal.limit import Goal
from cranktopo.design.schema import Scene
from cranktopo.engine.cases import load_cases
from cranktopo.engine.load_case import LOAD_TYPES, MAIN_KINDS
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.plan.simulated import simulated_scene
from cranktopo.tasks.bound.energies import energies
from cranktopo.tasks.bound.per_mass import least_product, lines_of, mass_range
from cranktopo.tasks.bound.proof import Plane, Proof, best_proof, excluded, plane_of
from cranktopo.tasks.bound.requirements import LINEAR, Ceiling, Wanted, wanted_of
from cranktopo.tasks.bound.sizing import LEAST, next_densities
from cranktopo.tasks.bound.webs import Webs, webs_of
from cranktopo.tasks.density.assess import assess_original
from cranktopo.tasks.density.assessment import Assessment
from cranktopo.tasks.density.material import CONTRAST
from cranktopo.tasks.density.model import ThrowModel, build_model
from cranktopo.tasks.density.response import solve

Progress = Callable[[str], None]
_STEPS = 40
_TOLERANCE = 1e-2
"""Relative residual of the solves: loose, as the proof asks for any displacements."""
_SETTLED, _QUIET = 5e-4, 3
"""Change of the goal over so many steps at which the displacements no longer improve."""
_HOPELESS = 900.0
"""Weight of a ceiling that no web seems to keep."""
_START = 0.5
_CORNERS, _CORNER_STEPS, _ROOM = 4, 6, 0.01
"""Of a stiffness per mass: most further masses at which displacements are sought, steps at each, and the
share of what is reached that the proof may leave open."""


@dataclass(frozen=True)
class BoundModel:
    """The cells of a scene under bending and torsion, and every web that they may hold.

    Attributes:
        original: the scene's own web on them.
        outside: share of the original's volume outside of the envelope.
    """

    scene: Scene
    domain: Domain
    model: ThrowModel
    webs: Webs
    original: Assessment
    outside: float

    @property
    def works(self) -> dict[str, float]:
        """Compliances of the original, N mm, by load case."""
        return {case.name: case.compliance_N_mm for case in self.original.cases}

    def solved(self, density: Array, guess: jax.Array | None, tolerance: float) -> jax.Array:
        """Displacements of the web with these densities.

        Raises:
            CranktopoError: the solve failed.
        """
        moduli = self.webs.fixed.copy()
        moduli[:, :, self.webs.layers] += self.webs.design * (CONTRAST + (1 - CONTRAST) * density)
        return solve(self.model, jnp.asarray(moduli), guess=guess, tolerance=tolerance).displacements

    def plane(self, u: jax.Array) -> Plane:
        """What displacements prove about every web."""
        proven = energies(self.model, self.webs, u)
        return plane_of(self.webs, self.model.case_names, proven, self.original.quantities, self.works)


def bound_model(scene: Scene, resolution_mm: float, goal: Goal | None = None) -> BoundModel:
    """The cells of a scene for bounds; call inside `double_precision()`.

    Raises:
        CranktopoError: no envelope, or a failed solve.
    """
    effects = plan(scene, goal=goal)
    scene = simulated_scene(scene, effects).with_optimise(resolution_mm=resolution_mm)
    cases = load_cases(scene, effects.enabled - set(LOAD_TYPES) | set(MAIN_KINDS))
    domain = build_domain(_unkept(scene), resolution_mm)
    model = build_model(scene, domain, cases)
    own = build_domain(scene, resolution_mm, "web", domain.extent, domain.grid).fixed
    webs = webs_of(scene, domain, model)
    room = webs.fixed.copy()
    room[:, :, webs.layers] += webs.design
    outside = float((np.maximum(own - room, 0) * domain.volume_mm3).sum() / (own * domain.volume_mm3).sum())
    return BoundModel(scene, domain, model, webs, assess_original(model, scene, domain), outside)


def _unkept(scene: Scene) -> Scene:
    """The scene whose envelope keeps no counterweight solid: a search over dimensions pockets it."""
    return scene.model_copy(update={"web": scene.web.model_copy(update={"counterweight": None})})


@dataclass(frozen=True)
class Bound:
    """What no web of an envelope can beat.

    Attributes:
        value: of the goal's quantity; None where no web keeps all limits.
        reached: what cells of variable stiffness reach, which is no web: the proof cannot do better.
        prices: percent that the bound loses per percent of each limit, in the order of the ceilings.
        density: of these cells (nx, ny, nw).
    """

    wanted: Wanted
    value: float | None
    original: float
    reached: float
    prices: tuple[float, ...]
    steps: int
    seconds: float
    density: Array
    displacements: jax.Array

    @property
    def percent(self) -> float | None:
        """The value in percent of the original's; None where no web keeps all limits."""
        return None if self.value is None else 100 * self.value / self.original


def prove(
    model: BoundModel, goal: Goal, progress: Progress = lambda _: None, start: Array | None = None
) -> Bound:
    """The bound of a goal on some cells; call inside `double_precision()`.

    Args:
        start: densities to begin with (nx, ny, nw), such as those of larger cells; uniform by default.

    Raises:
        CranktopoError: a goal about which nothing can be proven, or a failed solve.
    """
    began, wanted = time.perf_counter(), wanted_of(goal, model.original.quantities)
    search, original = _Search(model, wanted, start), model.original.quantities[goal.quantity]
    while not search.settled:
        search.step()
        reached = wanted.told(search.values[-1], original)
        progress(f"step {len(search.values)}: {goal.quantity} {reached:.5g} with cells of any stiffness")
    proof = search.proof()
    if proof.value <= 0 and goal.sense == "maximise":
        raise CranktopoError(
            f"bound: the displacements that were found prove nothing about {goal.quantity}.",
            hint="Use smaller cells.",
            code=ExitCode.NOT_CONVERGED,
        )
    return Bound(
        wanted,
        None if np.isinf(proof.value) else wanted.told(proof.value, original),
        original,
        wanted.told(search.values[-1], original),
        tuple(
            float(abs(weight * ceiling.limit) / proof.value)
            for weight, ceiling in zip(proof.weights, wanted.ceilings, strict=True)
        ),
        len(search.values),
        time.perf_counter() - began,
        search.density,
        search.u,
    )


def densities_on_cells(coarse: BoundModel, density: Array, fine: BoundModel) -> Array:
    """Densities of some cells (nx, ny, nw) on those of another model of the scene."""
    return np.maximum(on_cells(coarse.domain, density, fine.domain), LEAST)


class _Search:
    """Densities that become better step by step, and what the displacements of the last ones prove."""

    def __init__(self, model: BoundModel, wanted: Wanted, start: Array | None) -> None:
        self._model, self._wanted = model, wanted
        self._goal = _at(model, wanted.quantity)
        self._weights = np.ones(len(wanted.ceilings))
        self.density = np.full(model.webs.design.shape, _START) if start is None else start
        self.u, self.plane = self._solved()
        self.values: list[float] = []
        self._refuted = False

    @property
    def settled(self) -> bool:
        """Whether further steps would change little."""
        last = self.values[-_QUIET:]
        quiet = len(last) == _QUIET and max(last) - min(last) <= _SETTLED * abs(last[-1])
        return quiet or len(self.values) >= _STEPS or self._refuted

    def step(self) -> None:
        """Improve the densities once."""
        goal = self._goal
        if self._wanted.per_mass:
            mass = _at(self._model, "mass")
            goal = self._told(mass) * goal + self._told(goal) * mass
        self._weights = self._improve(goal, self._wanted.ceilings, self._weights)
        if max(self._weights, default=0.0) >= _HOPELESS:
            self._refuted = excluded(self.plane, self._wanted.ceilings, self._weights)
        value = self._told(self._goal)
        self.values.append(value * self._told(_at(self._model, "mass")) if self._wanted.per_mass else value)

    def proof(self) -> Proof:
        """What the displacements prove about the goal."""
        ceilings = self._wanted.ceilings
        if self._refuted:
            return Proof(np.inf, self._weights)
        if not self._wanted.per_mass:
            return best_proof(self.plane, self._goal, ceilings, self._weights)
        return self._proof_per_mass()

    def _proof_per_mass(self) -> Proof:
        """Lines from displacements at the best mass, then at those where the lines leave most room."""
        mass, ceilings = _at(self._model, "mass"), self._wanted.ceilings
        kept = [index for index, c in enumerate(ceilings) if c.quantity != "mass"]
        others = [ceilings[index] for index in kept]
        slope, reached = self._told(self._goal) / self._told(mass), self.values[-1]
        low, high = mass_range(self.plane, mass, ceilings)
        lines = lines_of(self.plane, self._goal, mass, others, self._weights[kept], slope)
        for _ in range(_CORNERS):
            proof, slope = least_product(lines, low, high)
            if proof.value > (1 - _ROOM) * reached:
                break
            weights = proof.weights
            for _ in range(_CORNER_STEPS):
                weights = self._improve(self._goal + slope * mass, others, weights)
            lines += lines_of(self.plane, self._goal, mass, others, weights, slope)
        proof, _ = least_product(lines, low, high)
        weights = np.zeros(len(ceilings))
        weights[kept] = proof.weights
        return Proof(proof.value, weights)

    def _improve(self, goal: Array, ceilings: Sequence[Ceiling], weights: Array) -> Array:
        """Take one step of the densities and solve them; returns the weights of the ceilings."""
        cases = len(self._model.model.cases)
        self.density, weights = next_densities(self.plane, cases, self.density, goal, ceilings, weights)
        self.u, self.plane = self._solved(self.u)
        return weights

    def _solved(self, guess: jax.Array | None = None) -> tuple[jax.Array, Plane]:
        u = self._model.solved(self.density, guess, _TOLERANCE)
        return u, self._model.plane(u)

    def _told(self, weights: Array) -> float:
        """A weighted sum of the quantities of the present densities."""
        plane = self.plane
        return float(weights @ (plane.base + np.tensordot(plane.rows, self.density, 3)))


def _at(model: BoundModel, quantity: str) -> Array:
    names = (*model.model.case_names, *LINEAR)
    return np.array([float(name == quantity) for name in names])
