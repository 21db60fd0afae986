"""The optimisation as init / step: pure functions from state to state."""

from __future__ import annotations

import math
import time
from collections.abc import Sequence
from dataclasses import dataclass, replace

import jax
import jax.numpy as jnp
import numpy as np
from numpy.typing import NDArray

from cranktopo.domain.build import Domain
from cranktopo.fem.model import ThrowModel, build_model, case_forces
from cranktopo.fem.multigrid import Precision
from cranktopo.fem.response import (
    compliance_gradients,
    compliance_gradients_by_solid,
    compliances,
    solve,
)
from cranktopo.loads.cases import LoadCase
from cranktopo.optimise.forging_constraint import open_cells
from cranktopo.optimise.material import (
    Interpolation,
    build_interpolation,
    greyness,
    physical_density,
    relative_moduli,
    smooth_density,
    solid_fraction,
    volume_fraction,
)
from cranktopo.optimise.optimality_criteria import update
from cranktopo.optimise.state import Record, State
from cranktopo.scene.schema import Scene

Array = NDArray[np.float64]

# Projection continuation: beta doubles when a stage's objective has settled or its iterations are spent.
BETA_FIRST, BETA_LAST = 1.0, 16.0
STAGE_ITERATIONS = 6
# A stage has settled, and the last one converged, when the objective changes by less over the window.
STAGE_PLATEAU, FINAL_PLATEAU = 5e-3, 1e-3
WINDOW = 3
FEASIBILITY = 1e-3
GREYNESS_LIMIT = 0.15
# The steeper the projection, the smaller the move: a full step would flip boundary cells to and fro.
MOVE_FIRST, MOVE_LEAST = 0.2, 0.05
# The error of a compliance is the square of the residual's: a loose solve, started from the last design's
# displacements, leads to the same design in half the cycles. The final design is judged at a tight tolerance.
TOLERANCE, TOLERANCE_EARLY = 1e-3, 1e-2


@dataclass(frozen=True)
class Solving:
    """How exactly the linear systems of the design iterations are solved.

    Attributes:
        tolerance_early: relative residual before the last projection stage.
        tolerance: relative residual in the last stage.
        precision: of the multigrid cycle inside the float64 iteration.
        plain: hexahedra without incompatible modes.
    """

    tolerance_early: float = TOLERANCE_EARLY
    tolerance: float = TOLERANCE
    precision: Precision = "float32"
    plain: bool = False


@dataclass(frozen=True)
class DensityProblem:
    """Everything constant during an optimisation.

    Attributes:
        model: the discrete throw.
        chain: density-to-modulus chain.
        weights: objective weight per load case.
        target: volume fraction of the design space.
        max_iterations: limit on designs evaluated.
        solving: how exactly its equations are solved.
    """

    model: ThrowModel
    chain: Interpolation
    weights: tuple[float, ...]
    target: float
    max_iterations: int
    solving: Solving = Solving()


@dataclass(frozen=True)
class Design:
    """Densities of a design on the cells of the web's layers (nx, ny, nw), 0 outside the design space.

    Attributes:
        filtered: smooth density before the projection.
        physical: projected density, which has stiffness and mass.
    """

    filtered: Array
    physical: Array


def build_problem(
    scene: Scene, domain: Domain, cases: Sequence[LoadCase], solving: Solving | None = None
) -> DensityProblem:
    """The optimisation problem of a scene on a domain; call inside `double_precision()`.

    Args:
        scene: settings, material, supports.
        domain: cells with a design space.
        cases: load cases of the objective.
        solving: how exactly its equations are solved.
    """
    solving = solving or Solving()
    settings = scene.optimise
    weights = {name: getattr(settings.weights, name) for name in type(settings.weights).model_fields}
    return DensityProblem(
        model=build_model(scene, domain, cases, plain=solving.plain),
        chain=build_chain(scene, domain),
        weights=tuple(weights[case.kind] for case in cases),
        target=settings.volume_fraction,
        max_iterations=settings.max_iterations,
        solving=solving,
    )


def build_chain(scene: Scene, domain: Domain) -> Interpolation:
    """The density-to-modulus chain of a scene on a domain; call inside `double_precision()`.

    Args:
        scene: filter radius, where it gives one, and whether the web comes from a die.
        domain: cells with a design space.
    """
    radius = scene.optimise.filter_radius_mm or default_filter_radius_mm(domain)
    die = scene.effects.manufacturing_constraint == "on"
    return build_interpolation(domain, radius, open_cells(scene, domain) if die else None)


def default_filter_radius_mm(domain: Domain) -> float:
    """Filter radius when the scene gives none: 2.5 cells, and never below 3 mm."""
    return max(3.0, 2.5 * domain.grid.largest_edge_mm)


def init(problem: DensityProblem) -> State:
    """The uniform start design."""
    x = np.full(problem.chain.design.shape, problem.target)
    return State(x=x, evaluated=x, displacements=np.zeros(problem.model.forces.shape), beta=BETA_FIRST)


def step(problem: DensityProblem, state: State) -> State:
    """Evaluate the state's design, record it and update the design.

    Args:
        problem: the constants.
        state: a running state.

    Returns:
        The next state; converged or stopped ones keep the design that was evaluated last.

    Raises:
        CranktopoError: the linear solve failed.
    """
    started = time.perf_counter()
    model = problem.model
    beta = jnp.asarray(state.beta)
    x = jnp.asarray(state.x)
    moduli, solid, volume, grey = _design(problem.chain, x, beta)
    forces = case_forces(model, solid)
    guess = jnp.asarray(state.displacements)
    tolerance, precision = _tolerance(problem.solving, state.beta), problem.solving.precision
    solution = solve(model, moduli, forces=forces, guess=guess, tolerance=tolerance, precision=precision)
    values = tuple(float(c) for c in compliances(model, solution.displacements, forces))
    initial = state.initial_N_mm or values
    factors = jnp.asarray([w / c for w, c in zip(problem.weights, initial, strict=True)])
    factors = factors / sum(problem.weights)
    by_moduli, by_solid = _slopes(model, solution.displacements, solid, factors)
    limits = jnp.asarray(problem.target), jnp.asarray(_move(state.beta))
    new_x = np.asarray(_update(problem.chain, x, beta, by_moduli, *limits, by_solid))
    record = Record(
        iteration=len(state.history) + 1,
        beta=state.beta,
        objective=float(jnp.dot(factors, jnp.asarray(values))),
        compliance_N_mm=values,
        volume_fraction=float(volume),
        greyness=float(grey),
        change=float(np.abs(new_x - state.x).max()),
        cg_iterations=int(solution.iterations),
        seconds=time.perf_counter() - started,
        notice=solution.notice,
    )
    advanced = replace(
        state,
        evaluated=state.x,
        displacements=np.asarray(solution.displacements),
        initial_N_mm=initial,
        history=(*state.history, record),
    )
    return _advance(problem, advanced, new_x)


def _slopes(
    model: ThrowModel, u: jax.Array, solid: jax.Array, factors: jax.Array
) -> tuple[jax.Array, jax.Array | None]:
    """Derivative of the objective by the moduli, and by the solid where its own mass loads it."""
    by_moduli = jnp.einsum("b,bxyz->xyz", factors, compliance_gradients(model, u))
    if not model.spinning:
        return by_moduli, None
    each = compliance_gradients_by_solid(model, u, solid)
    return by_moduli, jnp.einsum("b,bxyz->xyz", factors, each)


def final_design(problem: DensityProblem, state: State) -> Design:
    """Densities of the last design evaluated.

    Args:
        problem: the optimisation.
        state: one with at least one design evaluated.
    """
    return design_of(problem.chain, state.evaluated, state.last.beta)


def design_of(chain: Interpolation, x: Array, beta: float) -> Design:
    """Densities of design variables at a projection steepness.

    Args:
        chain: the density-to-modulus chain.
        x: design variables (nx, ny, nw) in [0, 1].
        beta: projection steepness.
    """
    filtered, physical = _densities(chain, jnp.asarray(x), jnp.asarray(beta))
    return Design(filtered=np.asarray(filtered), physical=np.asarray(physical))


def with_limit(problem: DensityProblem, state: State) -> State:
    """A stopped state set running again when the problem's iteration limit allows more.

    Args:
        problem: gives the iteration limit.
        state: any state; one that is not stopped comes back as it is.
    """
    if state.status == "stopped" and len(state.history) < problem.max_iterations:
        return replace(state, status="running", reason="")
    return state


def iterations_left(problem: DensityProblem, state: State) -> int:
    """Upper estimate of the iterations still needed, for the progress display.

    Args:
        problem: gives the iteration limit.
        state: where the optimisation stands.
    """
    stages = 1 + round(math.log2(BETA_LAST / state.beta))
    in_stage = len(state.history) - state.stage_start
    return min(problem.max_iterations - len(state.history), max(1, stages * STAGE_ITERATIONS - in_stage))


def _advance(problem: DensityProblem, state: State, new_x: Array) -> State:
    """The next design, its projection, and whether the evaluated one ends the run."""
    in_stage = len(state.history) - state.stage_start
    plateau = _plateau(state, in_stage) if in_stage > WINDOW else np.inf
    beta, stage_start = state.beta, state.stage_start
    if beta < BETA_LAST and (plateau < STAGE_PLATEAU or in_stage >= STAGE_ITERATIONS):
        beta, stage_start = 2 * beta, len(state.history)
    following = replace(state, x=new_x, beta=beta, stage_start=stage_start)
    last = state.last
    feasible = abs(last.volume_fraction - problem.target) <= FEASIBILITY
    if last.beta >= BETA_LAST and plateau < FINAL_PLATEAU and feasible and last.greyness <= GREYNESS_LIMIT:
        reason = (
            f"objective changed by less than {100 * FINAL_PLATEAU:g} % over {WINDOW} iterations, "
            f"volume fraction within {FEASIBILITY:g} of its target, "
            f"greyness {last.greyness:.3f} at most {GREYNESS_LIMIT:g}"
        )
        return replace(following, status="converged", reason=reason)
    if len(state.history) >= problem.max_iterations:
        reason = f"iteration limit {problem.max_iterations} reached before the objective settled"
        return replace(following, status="stopped", reason=reason)
    return following


def _move(beta: float) -> float:
    return max(MOVE_LEAST, MOVE_FIRST / math.sqrt(beta))


def _tolerance(solving: Solving, beta: float) -> float:
    return solving.tolerance if beta >= BETA_LAST else solving.tolerance_early


def _plateau(state: State, in_stage: int) -> float:
    """Relative spread of the objective over the last window of the current stage."""
    recent = [row.objective for row in state.history[-min(WINDOW + 1, in_stage) :]]
    return (max(recent) - min(recent)) / abs(recent[-1])


@jax.jit
def _densities(chain: Interpolation, x: jax.Array, beta: jax.Array) -> tuple[jax.Array, jax.Array]:
    return smooth_density(chain, x) * (chain.design > 0), physical_density(chain, x, beta)


@jax.jit
def _design(
    chain: Interpolation, x: jax.Array, beta: jax.Array
) -> tuple[jax.Array, jax.Array, jax.Array, jax.Array]:
    density = physical_density(chain, x, beta)
    moduli, solid = relative_moduli(chain, density), solid_fraction(chain, density)
    return moduli, solid, volume_fraction(chain, density), greyness(chain, density)


_update = jax.jit(update)
