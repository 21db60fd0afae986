"""Optima that scattered starts of one layout end in: outline, two bevels and a pair of pockets, on cells.

    python -m tests.benchmarks.shape_starts [ENGINE] [GOAL] [STARTS]

Every dimension of the start is moved at random by up to 5 mm; rules and limits may be broken there. One line
per start, the best first, as Markdown: goal in percent of the original, how far the dimensions are from the
best web's, webs solved.
"""

from __future__ import annotations

import sys

import numpy as np

from cranktopo.base.progress import StageMemory
from cranktopo.design.goal.scene_goal import goal_of, with_goal
from cranktopo.design.loading import load_scene
from cranktopo.numerics.optimisers.dimension_search import EVALUATIONS
from cranktopo.numerics.precision import double_precision
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.web_shape.feature_starts import bevel_start
from cranktopo.tasks.web_shape.search import SearchResult, search_on_cells
from cranktopo.tasks.web_shape.search_goal import search_goal_of
from cranktopo.tasks.web_shape.start import outline_start
from cranktopo.tasks.web_shape.web_model import web_model
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted_pocket import FittedBox

CELL_MM, SPREAD_MM = 3.0, 5.0
BEVELS = FittedBevel("journal"), FittedBevel("pin")


def main(engine: str = "mikron-iiic-plain", quantity: str = "torsion_per_mass", starts: int = 10) -> None:
    """Print the table as Markdown."""
    lightest = quantity == "mass"
    asked = (quantity, None) if lightest else (None, quantity)
    scene = with_goal(load_scene(engine), minimise=asked[0], maximise=asked[1], limits=())
    limits, layout = usual_limits(scene), Layout(7, (*BEVELS, FittedBox("pin", pair=True)))
    thick = scene.web.thickness_mm
    pocket = [0.6 * thick, 0.4 * scene.throw.radius_mm, 0.4 * thick, 0.5 * thick, 0.3 * thick]
    bevels = [bevel_start(scene, bevel) for bevel in BEVELS]
    middle = np.concatenate([outline_start(scene, limits), *bevels, pocket])
    found: list[tuple[SearchResult, int]] = []
    with double_precision():
        model = web_model(scene, limits, CELL_MM)
        goal = goal_of(scene)
        assert goal is not None
        stated = search_goal_of(goal, model.original, model.original, model.model.cases)
        for number in range(starts):
            moved = np.random.default_rng(number).uniform(-SPREAD_MM, SPREAD_MM, len(middle))
            one, solved = search_on_cells(
                model, layout, middle + moved, stated, f"{number}", StageMemory(), 2 * EVALUATIONS
            )
            if one is not None:
                found.append((one, solved))
    found.sort(key=lambda item: item[0].objective)
    print("| goal % of original | largest distance from the best, mm | webs solved |\n|---|---|---|")
    for one, solved in found:
        apart = np.abs(one.values - found[0][0].values)
        where = layout.names[int(apart.argmax())]
        print(f"| {100 * abs(one.objective):.2f} | {apart.max():.2f} ({where}) | {solved} |", flush=True)
    print(f"\n{starts - len(found)} of {starts} starts ended without a web that keeps limits and rules")


if __name__ == "__main__":
    main(*(convert(word) for convert, word in zip((str, str, int), sys.argv[1:], strict=False)))
