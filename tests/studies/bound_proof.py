"""Two hundred webs of every kind on the cells of a bound, and how near the best of them comes to it.

`python -m tests.studies.bound_proof [THROW...]` prints the table and ends with 1 where a web beats its bound;
a number is a random throw.
"""

from __future__ import annotations

import itertools
import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.progress import StageMemory
from cranktopo.bodies.memory import thinnest_wall_mm
from cranktopo.design.goal.limit import Goal
from cranktopo.design.goal.scene_goal import goal_of, with_goal
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.bound.lower_bound import Bound, BoundModel, bound_model, prove
from cranktopo.tasks.refit.family import Layout, with_part
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.web_shape.feature_starts import bevel_start
from cranktopo.tasks.web_shape.search import search_on_cells
from cranktopo.tasks.web_shape.search_goal import search_goal_of
from cranktopo.tasks.web_shape.start import outline_start
from cranktopo.tasks.web_shape.web_model import web_model
from cranktopo.throw.bevel import FittedBevel
from tests.physics.bound.bound_cases import (
    own_body,
    quantities_of,
    quantities_of_body,
    random_blobs,
    random_webs,
    simp_density,
)
from tests.random_engines import random_engine

Array = NDArray[np.float64]
THROWS = ("mikron-iiic-plain", "opposed-piston", "1", "2", "3")
GOALS: dict[str, dict[str, Any]] = {
    "mass": {"minimise": "mass", "limits": ("fatigue_safety none",)},
    "torsion at its mass": {"maximise": "torsion", "limits": ("bending none", "fatigue_safety none")},
    "torsion per mass": {"maximise": "torsion_per_mass", "limits": ("fatigue_safety none",)},
}
_RESERVE = 2e-3
"""Part of the limits that searched webs keep back, so that they keep them in the numbers of the bound."""


@dataclass(frozen=True)
class Judged:
    """A web on the cells of a bound.

    Attributes:
        values: compliances, then mass, inertia and unbalance, over the original's.
    """

    kind: str
    values: Array


@dataclass(frozen=True)
class Proven:
    """A bound and the webs that keep its limits.

    Attributes:
        told: the goal's quantity of each of them.
    """

    goal: str
    bound: Bound
    kinds: tuple[str, ...]
    told: tuple[float, ...]

    @property
    def best(self) -> int:
        """The web that comes nearest to the bound."""
        return int(np.argmin(self._costs))

    @property
    def holds(self) -> bool:
        """Whether no web beats the bound, with no tolerance."""
        value = self.bound.value
        return value is not None and all(self._sign * value <= cost for cost in self._costs)

    @property
    def _sign(self) -> float:
        return 1.0 if self.bound.problem.goal.sense == "minimise" else -1.0

    @property
    def _costs(self) -> list[float]:
        return [self._sign * value for value in self.told]


def throw_of(name: str) -> Scene:
    """A built-in design or a random throw, its web made anyhow."""
    scene = scene_from_dict(random_engine(int(name))) if name.isdecimal() else load_scene(name)
    return scene.with_optimise(process="free", draft_deg=0.0)


def cells_of(scene: Scene) -> BoundModel:
    """Its cells, four through the web and two through the thinnest wall; call inside `double_precision()`."""
    return bound_model(scene, min(scene.web.thickness_mm / 4, thinnest_wall_mm(scene) / 2))


def judged_webs(scene: Scene, model: BoundModel) -> Iterator[Judged]:
    """Two hundred webs of every kind."""
    yield Judged("original", quantities_of_body(model, own_body(model)))
    joined = filter(None, (_joined(model, fill) for fill in random_webs(model, 300, 5)))
    yield from itertools.islice(joined, 100)
    for seed in range(66):
        yield Judged("random blobs", quantities_of(model, random_blobs(model, seed), 1.0 + seed % 3))
    for fill in shaped_webs(scene, model):
        yield Judged("best dimensions", quantities_of(model, fill))
    for power in (2.0, 2.5, 3.0, 4.0):
        for cells in (1.5, 2.5, 4.0):
            for share in (0.35, 0.6):
                settings = {"volume_fraction": share, "filter_radius_mm": cells * _edge_mm(model)}
                density = simp_density(scene, model, power, **settings)
                yield Judged(f"SIMP, power {power:g}", quantities_of(model, density, power))
    for goal in GOALS.values():
        asked = with_goal(scene, **goal)
        density = simp_density(asked, model, 3.0, max_iterations=60)
        yield Judged("SIMP for the goal", quantities_of(model, density, 3.0))


def _joined(model: BoundModel, fill: Array) -> Judged | None:
    """A web of random dimensions; None where it does not join the journals, which no solver can tell."""
    try:
        return Judged("random dimensions", quantities_of(model, fill))
    except CranktopoError as error:
        if error.code != ExitCode.SOLVER:
            raise
        return None


def shaped_webs(scene: Scene, model: BoundModel) -> Iterator[Array]:
    """Fills of what the shape optimisation's search makes of each goal: a plain outline, then with bevels."""
    limits = usual_limits(scene)
    cells = web_model(scene, limits, model.scene.optimise.resolution_mm)
    for name, goal in _goals(scene).items():
        sought = search_goal_of(goal, cells.original, cells.original, cells.model.cases).reserved(_RESERVE)
        layout, start = Layout(7), outline_start(scene, limits)
        for part in (None, FittedBevel("journal"), FittedBevel("pin")):
            if part is not None:
                layout, start = with_part(layout, start, part, bevel_start(scene, part))
            step = f"{name}-{len(layout.parts)}"
            found, _ = search_on_cells(cells, layout, start, sought, step, StageMemory(), nearest=True)
            if found is not None:
                start = found.values
                yield found.responses.fill


def proven(scene: Scene, model: BoundModel, webs: list[Judged]) -> Iterator[Proven]:
    """The bound of each goal beside the webs that keep its limits."""
    for name, goal in _goals(scene).items():
        bound = prove(model, goal)
        kept = [web for web in webs if keeps(model, bound, web)]
        told = tuple(goal_value(model, bound, web) for web in kept)
        yield Proven(name, bound, tuple(web.kind for web in kept), told)


def stay_above(model: BoundModel, density: Array, webs: Sequence[Judged]) -> bool:
    """Whether what the displacements of a web prove holds for all weights of the quantities, exactly."""
    plane = model.underestimator(model.solved(density, None, 1e-3))
    return all(
        plane.minimum(weights)[0] <= weights @ web.values
        for weights in np.random.default_rng(8).exponential(size=(40, 5))
        for web in webs
    )


def _goals(scene: Scene) -> dict[str, Goal]:
    found = {name: goal_of(with_goal(scene, **goal)) for name, goal in GOALS.items()}
    return {name: goal for name, goal in found.items() if goal is not None}


def _edge_mm(model: BoundModel) -> float:
    return model.domain.grid.largest_edge_mm


def _value(model: BoundModel, web: Judged, quantity: str) -> float:
    return float(web.values[(*model.model.case_names, *model.webs.amounts).index(quantity)])


def keeps(model: BoundModel, bound: Bound, web: Judged) -> bool:
    """Whether a web keeps the limits of a bound."""
    return all(c.sign * (_value(model, web, c.quantity) - c.bound) <= 0 for c in bound.problem.constraints)


def goal_value(model: BoundModel, bound: Bound, web: Judged) -> float:
    """The quantity of a bound's goal that a web has."""
    value = _value(model, web, bound.problem.quantity)
    mass = _value(model, web, "mass") if bound.problem.per_mass else 1.0
    return bound.problem.goal_value(value * mass, bound.original)


def print_gaps(name: str) -> bool:
    """A row of the table for each goal; whether every bound holds."""
    with double_precision():
        scene = throw_of(name)
        model = cells_of(scene)
        webs = list(judged_webs(scene, model))
        held = stay_above(model, np.full(model.webs.design.shape, 0.5), webs)
        for found in proven(scene, model, webs):
            bound, best = found.bound, found.told[found.best]
            change, most = (100 * (value / bound.original - 1) for value in (best, bound.value or 0.0))
            gap = 100 * abs(best / (bound.value or 1.0) - 1)
            held &= found.holds and stay_above(model, bound.density, webs)
            print(
                f"| {scene.name} | {found.goal} | {most:+.1f} % | {change:+.1f} % | {gap:.1f} % "
                f"| {found.kinds[found.best]} | {len(found.told)} of {len(webs)} |",
                flush=True,
            )
    return held


if __name__ == "__main__":
    print("| throw | goal | bound | best web | gap | its kind | webs within the limits |")
    print("|---" * 7 + "|")
    held = [print_gaps(throw) for throw in sys.argv[1:] or THROWS]
    sys.exit(not all(held))
