"""Optimisers of the density on the same design: steps, seconds and final values.

    python -m tests.benchmarks.optimisers [CELL_MM]

Optimality criteria and this program's moving asymptotes run beside mmapy (A. Deetman's port of K. Svanberg's
code), which takes the place of the step in the same loop with the same projection. nlopt's CCSAQ, which keeps
its own loop, is restarted at every steepness of the projection; its inner evaluations count as steps. What is
not installed is said (`pip install --target FOLDER mmapy`, FOLDER on PYTHONPATH).
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import jax.numpy as jnp
import numpy as np

from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.density import loop
from cranktopo.tasks.density.assess import assess, assess_original
from cranktopo.tasks.density.build import build_problem
from cranktopo.tasks.density.problem import DensityProblem
from cranktopo.tasks.density.proposals import vjp
from cranktopo.tasks.density.responses import Design, gradients
from cranktopo.tasks.density.stage import Prepared, iterate, prepare
from cranktopo.tasks.density.state import Proposal, State

_RESTARTED_STEPS, _LAST_STEPS = 8, 20


@dataclass(frozen=True)
class Outcome:
    """One finished optimisation; stiffnesses and mass in percent of the original web."""

    name: str
    steps: int
    seconds: float
    mass: float
    torsion: float
    bending: float


def tasks(cell_mm: float) -> dict[str, Scene]:
    """The plain volume problem and the least mass at the stiffnesses of the original."""
    plain = load_scene("mikron-iiic-plain").with_optimise(resolution_mm=cell_mm, process="free")
    data = plain.model_dump(mode="json", exclude_none=True) | {"goal": {"minimise": "mass"}}
    return {"volume fraction 0.3": plain, "least mass": scene_from_dict(data)}


def run(name: str, scene: Scene, change: Callable[[DensityProblem], State]) -> Outcome:
    """Optimise with one method, in percent of the original."""
    with double_precision():
        ready: Prepared = prepare(scene)
        problem = build_problem(ready.scene, ready.domain, ready.cases)
        began = time.perf_counter()
        state = change(problem)
        seconds = time.perf_counter() - began
        found = assess(problem, ready.scene, ready.domain, loop.final_design(problem, state).physical)
        own = assess_original(problem.model, ready.scene, ready.domain)
        share = {key: 100 * value / own.quantities[key] for key, value in found.quantities.items()}
    return Outcome(name, len(state.history), seconds, share["mass"], share["torsion"], share["bending"])


def own_loop(problem: DensityProblem) -> State:
    """The problem by its own method."""
    return iterate(problem, loop.init(problem))


def functions(problem: DensityProblem, state: State, design: Design) -> tuple[np.ndarray, np.ndarray]:
    """Scaled goal and limits and their derivatives by the designable variables."""
    values, *fields = gradients(problem.model, problem.optimisation.functions, design, {})
    by_x = vjp(problem.density_chain, jnp.asarray(state.x), jnp.asarray(state.beta), *fields)
    free = np.asarray(problem.density_chain.design_fraction) > 0
    return np.asarray(values), np.asarray(by_x)[:, free]


def with_mmapy(problem: DensityProblem) -> State:
    """The loop with mmapy's step."""
    from mmapy import mmasub

    free = np.asarray(problem.density_chain.design_fraction) > 0

    def propose(problem: DensityProblem, state: State, design: Design, eroded: Design) -> Proposal:
        values, by_x = functions(problem, state, design)
        x = state.x[free][:, None]
        move = problem.schedule.largest_move(state.beta)
        memory = state.memory or {"last": x, "before": x, "low": x, "high": x}
        m = len(values) - 1
        new, *_, low, high = mmasub(
            m, len(x), len(state.history) + 1, x, np.zeros_like(x), np.ones_like(x), memory["last"],
            memory["before"], values[0], by_x[0][:, None], values[1:, None], by_x[1:], memory["low"],
            memory["high"], 1.0, np.zeros((m, 1)), np.full((m, 1), 1e3), np.ones((m, 1)), move=move,
        )  # fmt: skip
        following = state.x.copy()
        following[free] = np.clip(new[:, 0], x[:, 0] - move, x[:, 0] + move)
        kept = {"last": x, "before": memory["last"], "low": low, "high": high}
        return Proposal(following, float(values[0]), violation=float(values[1:].max()), memory=kept)

    return own_loop(replace(problem, method=propose))


def with_ccsaq(problem: DensityProblem) -> State:
    """nlopt's CCSAQ, restarted at each steepness of the projection."""
    import nlopt

    free = np.asarray(problem.density_chain.design_fraction) > 0
    found: dict[str, Any] = {"state": loop.init(problem)}

    def keep(problem: DensityProblem, state: State, design: Design, eroded: Design) -> Proposal:
        found["values"], found["slopes"] = functions(problem, state, design)
        return Proposal(state.x, float(found["values"][0]), violation=float(found["values"][1:].max()))

    watched = replace(problem, method=keep, max_iterations=10_000)

    def at(variables: np.ndarray) -> None:
        if "at" in found and np.array_equal(found["at"], variables):
            return
        x = found["state"].x.copy()
        x[free] = variables
        stage = replace(found["state"], x=x, beta=found["beta"], status="running")
        found["state"], found["at"] = loop.step(watched, stage), variables.copy()

    def goal(variables: np.ndarray, slope: np.ndarray) -> float:
        at(variables)
        slope[:] = found["slopes"][0]
        return float(found["values"][0])

    def limits(values: np.ndarray, variables: np.ndarray, slope: np.ndarray) -> None:
        at(variables)
        values[:], slope[:] = found["values"][1:], found["slopes"][1:]

    beta, x = problem.schedule.projection_first, found["state"].x[free]
    while beta <= problem.schedule.projection_last:
        found["beta"] = beta
        found.pop("at", None)
        solver = nlopt.opt(nlopt.LD_CCSAQ, len(x))
        solver.set_lower_bounds(0.0)
        solver.set_upper_bounds(1.0)
        solver.set_min_objective(goal)
        solver.add_inequality_mconstraint(limits, np.full(len(problem.optimisation.limits), 1e-4))
        solver.set_maxeval(_LAST_STEPS if beta == problem.schedule.projection_last else _RESTARTED_STEPS)
        solver.set_ftol_rel(1e-4)
        x, beta = solver.optimize(x), 2 * beta
    at(x)
    state: State = found["state"]
    return state


METHODS = {"moving asymptotes": own_loop, "mmapy": with_mmapy, "nlopt CCSAQ": with_ccsaq}


def main(cell_mm: float = 3.0) -> None:
    """Print a table for each task."""
    for task, scene in tasks(cell_mm).items():
        print(f"\n{task}, cells of {cell_mm:g} mm: steps, seconds, mass, torsion, bending (% of original)")
        methods: dict[str, Callable[[DensityProblem], State]] = dict(METHODS)
        if scene.goal is None:
            methods = {"optimality criteria": own_loop, **methods}
        for name, method in methods.items():
            plain = scene.goal is None and name != "optimality criteria"
            asked = scene.with_optimise(method="moving_asymptotes") if plain else scene
            try:
                row = run(name, asked, method)
            except ModuleNotFoundError as error:
                print(f"{name:22} not installed: {error.name}")
                continue
            print(
                f"{name:22}{row.steps:5}{row.seconds:9.1f}{row.mass:9.2f}{row.torsion:9.2f}{row.bending:9.2f}",
                flush=True,
            )


if __name__ == "__main__":
    main(float(sys.argv[1]) if len(sys.argv) > 1 else 3.0)
