"""The bound of a scene in memory: cells -> densities of variable stiffness -> displacements -> proof.

The modulus is linear in the density, so the problem of the densities that prove most is convex. Each step
solves it with compliances linear in the reciprocals of the densities, which has a closed form but for one
weight per constraint (convex linearisation; C. Fleury, V. Braibant, IJNME 23, 1986; one constraint on the
mass: optimality criteria).
"""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass

import jax
import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import at_work, detail
from cranktopo.bodies.cells.domain import Domain, build_domain, on_cells
from cranktopo.bodies.cells.outside import OutsideEnvelope, outside_envelope, without_counterweight
from cranktopo.design.goal.constraint import Constraint
from cranktopo.design.goal.limit import Goal
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.plan.simulated import apply_physics_plan
from cranktopo.engine.states import main_load_cases
from cranktopo.numerics.device_arrays import on_device
from cranktopo.tasks.bound.certificate import (
    Certificate,
    LinearUnderestimator,
    best_certificate,
    energies,
    excluded,
    mass_range,
    minimum_product,
    supporting_lines,
    underestimator_of,
)
from cranktopo.tasks.bound.webs import AdmissibleDensities, ConvexProblem, convex_problem, webs_of
from cranktopo.tasks.density.assess import assess_original
from cranktopo.tasks.density.material import CONTRAST
from cranktopo.tasks.density.model import ThrowModel, build_model
from cranktopo.tasks.density.problem import Assessment
from cranktopo.tasks.density.response import solve

_MINIMUM_DENSITY = 1e-3
"""Least density while the displacements are sought, so that cells can come back."""
_MOVE = 0.3
_LARGEST_WEIGHT = 1e3


def next_densities(
    underestimator: LinearUnderestimator,
    cases: int,
    density: Array,
    goal: Array,
    constraints: Sequence[Constraint],
    weights: Array,
) -> tuple[Array, Array]:
    """Return the densities after one step and the weights of the constraints.

    Args:
        underestimator: of the displacements of the web with these densities.
        cases: number of load cases, whose compliances come first among the quantities.
    """
    low, high = np.maximum(density - _MOVE, _MINIMUM_DENSITY), np.minimum(density + _MOVE, 1.0)
    gains, amounts = -underestimator.rows[:cases] * density**2, underestimator.rows[cases:]
    base = underestimator.base.copy()
    base[:cases] += 2 * np.tensordot(underestimator.rows[:cases], density, 3)
    signs = np.array([c.sign for c in constraints])
    limits = np.array([c.bound for c in constraints])
    at = np.array([underestimator.names.index(c.quantity) for c in constraints], int)

    def densities(y: Array) -> tuple[Array, Array]:
        normal = goal.copy()
        np.add.at(normal, at, y * signs)
        above, below = np.tensordot(normal[:cases], gains, 1), np.tensordot(normal[cases:], amounts, 1)
        ratio = np.where(below > 0, above / np.where(below > 0, below, 1.0), 1.0)
        found = np.where((above <= 0) & (below <= 0), density, np.sqrt(np.maximum(ratio, 0.0)))
        return np.clip(underestimator.webs.makeable(found, above, below), low, high), normal

    def loss(y: Array) -> tuple[float, Array]:
        found, normal = densities(y)
        proven = base + np.concatenate([np.tensordot(gains, 1 / found, 3), np.tensordot(amounts, found, 3)])
        excess = signs * (proven[at] - limits)
        return -float(normal @ proven - y @ (signs * limits)), -excess

    if len(constraints):
        from scipy.optimize import minimize

        box = [(0.0, _LARGEST_WEIGHT)] * len(constraints)
        weights = minimize(loss, weights, jac=True, method="L-BFGS-B", bounds=box).x
    return densities(weights)[0], weights


_STEPS = 40
_TOLERANCE = 1e-2
"""Relative residual of the solves: loose, as the proof asks for any displacements."""
_SETTLED, _QUIET = 5e-4, 3
"""Change of the goal over so many steps at which the displacements no longer improve."""
_HOPELESS = 900.0
"""Weight of a constraint that no web seems to keep."""
_START = 0.5
_CORNERS, _CORNER_STEPS, _ROOM = 4, 6, 0.01
"""Of a stiffness per mass: most further masses at which displacements are sought, steps at each, and the
share of what is reached that the proof may leave open."""


@dataclass(frozen=True)
class BoundModel:
    """The cells of a scene under bending and torsion, and every web that they may hold.

    Attributes:
        original: the scene's own web on them.
        outside: what of the original lies outside of the envelope; None of halves that differ.
    """

    scene: Scene
    domain: Domain
    model: ThrowModel
    webs: AdmissibleDensities
    original: Assessment
    outside: OutsideEnvelope | None

    @property
    def reference_compliances(self) -> dict[str, float]:
        """Compliances of the original, N mm, by load case."""
        return {case.name: case.compliance_N_mm for case in self.original.cases}

    def solved(self, density: Array, guess: jax.Array | None, tolerance: float) -> jax.Array:
        """Return displacements of the web with these densities; a failed solve raises CranktopoError."""
        moduli = self.webs.fixed.copy()
        moduli[:, :, self.webs.layers] += self.webs.design * (CONTRAST + (1 - CONTRAST) * density)
        return solve(self.model, on_device(moduli), guess=guess, tolerance=tolerance).displacements

    def underestimator(self, u: jax.Array) -> LinearUnderestimator:
        """Return what displacements prove about every web."""
        proven = energies(self.model, self.webs, u)
        return underestimator_of(
            self.webs, self.model.case_names, proven, self.original.quantities, self.reference_compliances
        )


def bound_model(scene: Scene, resolution_mm: float, goal: Goal | None = None) -> BoundModel:
    """Return the cells of a scene for bounds; call inside `double_precision()`.

    Raises:
        CranktopoError: no envelope, or a failed solve.
    """
    effects = plan(scene, goal=goal)
    scene = apply_physics_plan(scene, effects).with_optimise(resolution_mm=resolution_mm)
    cases = main_load_cases(scene, effects.enabled)
    domain = build_domain(without_counterweight(scene), resolution_mm)
    model = build_model(scene, domain, cases)
    webs, outside = webs_of(scene, domain, model), outside_envelope(scene)
    return BoundModel(scene, domain, model, webs, assess_original(model, scene, domain), outside)


@dataclass(frozen=True)
class Bound:
    """Proven bound of a goal over all webs of an envelope.

    Attributes:
        value: of the goal's quantity; None where no web keeps all limits.
        reached: what cells of variable stiffness reach, which is no web: the proof cannot do better.
        multipliers: percent that the bound loses per percent of each limit, in the order of the constraints.
        density: of these cells (nx, ny, nw).
    """

    problem: ConvexProblem
    value: float | None
    original: float
    reached: float
    multipliers: tuple[float, ...]
    steps: int
    seconds: float
    density: Array
    displacements: jax.Array

    @property
    def percent(self) -> float | None:
        """The value in percent of the original's; None where no web keeps all limits."""
        return None if self.value is None else 100 * self.value / self.original


@at_work("bound: what no web of the envelope can beat")
def prove(model: BoundModel, goal: Goal, start: Array | None = None) -> Bound:
    """Return the bound of a goal, from densities (nx, ny, nw) or uniform ones; inside `double_precision()`.

    Raises:
        CranktopoError: a goal about which nothing can be proven, or a failed solve.
    """
    began, problem = time.perf_counter(), convex_problem(goal, model.original.quantities)
    search, original = _DensitySearch(model, problem, start), model.original.quantities[goal.quantity]
    while not search.settled:
        search.step()
        reached = problem.goal_value(search.values[-1], original)
        detail(f"step {len(search.values)}: {goal.quantity} {reached:.5g} with cells of any stiffness")
    certificate = search.certificate()
    if certificate.value <= 0 and goal.sense == "maximise":
        raise CranktopoError(
            f"bound: the displacements that were found prove nothing about {goal.quantity}.",
            hint="Use smaller cells.",
            code=ExitCode.NOT_CONVERGED,
        )
    return Bound(
        problem,
        None if np.isinf(certificate.value) else problem.goal_value(certificate.value, original),
        original,
        problem.goal_value(search.values[-1], original),
        tuple(
            float(abs(weight * constraint.bound) / certificate.value)
            for weight, constraint in zip(certificate.weights, problem.constraints, strict=True)
        ),
        len(search.values),
        time.perf_counter() - began,
        search.density,
        search.u,
    )


def densities_on_cells(coarse: BoundModel, density: Array, fine: BoundModel) -> Array:
    """Return densities of some cells (nx, ny, nw) on those of another model of the scene."""
    return np.maximum(on_cells(coarse.domain, density, fine.domain), _MINIMUM_DENSITY)


class _DensitySearch:
    """Densities that become better step by step, and what the displacements of the last ones prove."""

    def __init__(self, model: BoundModel, problem: ConvexProblem, start: Array | None) -> None:
        self._model, self._problem = model, problem
        self._weights = np.ones(len(problem.constraints))
        self.density = np.full(model.webs.design.shape, _START) if start is None else start
        self.u, self.underestimator = self._solved()
        self._goal = self.underestimator.weights_of(problem.quantity)
        self._mass = self.underestimator.weights_of("mass")
        self.values: list[float] = []
        self._refuted = False

    @property
    def settled(self) -> bool:
        """True where further steps would change little."""
        last = self.values[-_QUIET:]
        quiet = len(last) == _QUIET and max(last) - min(last) <= _SETTLED * abs(last[-1])
        return quiet or len(self.values) >= _STEPS or self._refuted

    def step(self) -> None:
        """Improve the densities once."""
        goal, mass = self._goal, self._mass
        if self._problem.per_mass:
            goal = self._weighted_sum(mass) * goal + self._weighted_sum(goal) * mass
        self._weights = self._improve(goal, self._problem.constraints, self._weights)
        if max(self._weights, default=0.0) >= _HOPELESS:
            self._refuted = excluded(self.underestimator, self._problem.constraints, self._weights)
        value = self._weighted_sum(self._goal)
        self.values.append(value * self._weighted_sum(mass) if self._problem.per_mass else value)

    def certificate(self) -> Certificate:
        """Return what the displacements prove about the goal."""
        constraints = self._problem.constraints
        if self._refuted:
            return Certificate(np.inf, self._weights)
        if not self._problem.per_mass:
            return best_certificate(self.underestimator, self._goal, constraints, self._weights)
        return self._proof_per_mass()

    def _proof_per_mass(self) -> Certificate:
        """Return lines from displacements at the best mass, then at those where the lines leave most room."""
        mass, constraints = self._mass, self._problem.constraints
        kept = [index for index, c in enumerate(constraints) if c.quantity != "mass"]
        others = [constraints[index] for index in kept]
        slope, reached = self._weighted_sum(self._goal) / self._weighted_sum(mass), self.values[-1]
        low, high = mass_range(self.underestimator, mass, constraints)
        lines = supporting_lines(self.underestimator, self._goal, mass, others, self._weights[kept], slope)
        for _ in range(_CORNERS):
            certificate, slope = minimum_product(lines, low, high)
            if certificate.value > (1 - _ROOM) * reached:
                break
            weights = certificate.weights
            for _ in range(_CORNER_STEPS):
                weights = self._improve(self._goal + slope * mass, others, weights)
            lines += supporting_lines(self.underestimator, self._goal, mass, others, weights, slope)
        certificate, _ = minimum_product(lines, low, high)
        weights = np.zeros(len(constraints))
        weights[kept] = certificate.weights
        return Certificate(certificate.value, weights)

    def _improve(self, goal: Array, constraints: Sequence[Constraint], weights: Array) -> Array:
        """Take one step of the densities and solve them; returns the weights of the constraints."""
        cases = len(self._model.model.cases)
        self.density, weights = next_densities(
            self.underestimator, cases, self.density, goal, constraints, weights
        )
        self.u, self.underestimator = self._solved(self.u)
        return weights

    def _solved(self, guess: jax.Array | None = None) -> tuple[jax.Array, LinearUnderestimator]:
        u = self._model.solved(self.density, guess, _TOLERANCE)
        return u, self._model.underestimator(u)

    def _weighted_sum(self, weights: Array) -> float:
        """Return a weighted sum of the quantities of the present densities."""
        underestimator = self.underestimator
        return float(weights @ (underestimator.base + np.tensordot(underestimator.rows, self.density, 3)))
