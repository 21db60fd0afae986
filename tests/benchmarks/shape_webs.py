"""The best dimensions against the re-model of a density and the bound, for the same limits, on four engines.

    python -m tests.benchmarks.shape_webs [ENGINE:GOAL...]

ENGINE is a built-in design, `wide` (a wide web between solid journals) or `overlapping` (journals that
overlap deeply), GOAL is `mass` or `torsion_per_mass`; on these two once more with the web's thickness free,
which no density on the cells between the web's faces can move. Every web is evaluated with its fillets on the
default mesh against the original web; one line per web as Markdown.
"""

from __future__ import annotations

import sys
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from cranktopo.base.progress import StageMemory
from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.optimise.stage import optimise_design
from cranktopo.tasks.refit.stage import remodel_run
from cranktopo.tasks.web_shape.evaluated_web import evaluated_web
from cranktopo.tasks.web_shape.run import shape_design

OWN: dict[str, dict[str, Any]] = {
    "wide": {
        "throw": {
            "radius_mm": 55.0,
            "main_journal": {"outer_diameter_mm": 56.0, "length_mm": 40.0, "fillet_mm": 3.0},
            "crankpin": {"outer_diameter_mm": 50.0, "length_mm": 38.0, "fillet_mm": 3.0},
        },
        "web": {"thickness_mm": 20.0, "outline": "obround", "width_mm": 96.0},
        "envelope": {"shape": "box", "half_width_mm": 58.0, "y_min_mm": -58.0, "y_max_mm": 112.0},
    },
    "overlapping": {
        "throw": {
            "radius_mm": 40.0,
            "main_journal": {"outer_diameter_mm": 72.0, "length_mm": 36.0, "fillet_mm": 3.5},
            "crankpin": {"outer_diameter_mm": 62.0, "length_mm": 34.0, "fillet_mm": 3.5},
        },
        "web": {"thickness_mm": 17.0, "outline": "obround", "width_mm": 88.0},
        "envelope": {"shape": "box", "half_width_mm": 52.0, "y_min_mm": -54.0, "y_max_mm": 94.0},
    },
}
THICKNESS_MM = {"wide": (16.0, 27.0), "overlapping": (13.5, 23.0)}
"""Range of the web's thickness where it is free: about 0.8 to 1.35 of the engine's own."""
HEAD = ("engine", "goal", "web", "mass %", "torsion %", "bending %", "torsion per mass %", "safety %")
NAMES = ("mass", "torsion", "bending", "torsion_per_mass", "fatigue_safety")
MORE = ("limits", "webs solved", "s")
TASKS = [
    f"{name}:{goal}"
    for name in ("mikron-iiic-plain", "opposed-piston", *OWN)
    for goal in ("mass", "torsion_per_mass")
]


def scene_of(name: str) -> Scene:
    """A built-in design, or one of our own with the engine of the opposed-piston diesel."""
    if name not in OWN:
        return load_scene(name)
    data = load_scene("opposed-piston").model_dump(mode="json", exclude_none=True)
    changes: dict[str, Any] = {"name": name, **OWN[name]}
    return scene_from_dict({key: value for key, value in (data | changes).items() if key != "published"})


def webs(name: str, goal: str) -> Iterator[tuple[str, dict[str, float], str]]:
    """The web by its dimensions, then the re-model of the density: changes in %, what else is told."""
    asked = {"minimise": goal, "maximise": None} if goal == "mass" else {"minimise": None, "maximise": goal}
    scene = with_goal(scene_of(name), limits=(), **asked)
    with tempfile.TemporaryDirectory() as folder:
        shaped = shape_design(scene, out=Path(folder) / "shape").result.as_json()
        yield "dimensions", shaped["change_percent"], _told(shaped)
        if name in THICKNESS_MM:
            freed = shape_design(
                _thickness_free(scene, THICKNESS_MM[name]), out=Path(folder) / "free"
            ).result.as_json()
            yield "dimensions, thickness free", freed["change_percent"], _told(freed)
        began = time.perf_counter()
        run = optimise_design(scene, Path(folder) / "density")
        remodel_run(str(run.folder), evaluated=False)
        seconds = time.perf_counter() - began
        remodel = load_scene(str(run.folder / "remodel" / f"{scene.name}-remodel.toml"))
        found = evaluated_web(remodel, {"fatigue_safety"}, None, "re-model", StageMemory()).values
        before = shaped["values"]["original"]
        change = {key: 100 * (found[key] / before[key] - 1) for key in NAMES}
        yield "re-model of a density", change, f"- | - | {seconds:.0f}"
        bound = shaped["bound"]
        if bound and bound["quantity"] in NAMES:
            yield "bound", {bound["quantity"]: bound["percent_of_original"] - 100}, "- | - | -"


def _thickness_free(scene: Scene, range_mm: tuple[float, float]) -> Scene:
    data = scene.model_dump(mode="json", exclude_none=True)
    return scene_from_dict(data | {"shape": {"free": {"web_thickness_mm": list(range_mm)}}})


def _told(shaped: dict[str, Any]) -> str:
    """Whether the best web keeps the limits, webs solved and seconds."""
    kept = all(limit["holds"] for limit in shaped["goal"]["limits"])
    return f"{'kept' if kept else 'missed'} | {shaped['evaluations']} | {shaped['seconds']['total']:.0f}"


def main() -> None:
    """Print the table as Markdown."""
    print(f"| {' | '.join((*HEAD, *MORE))} |\n|{'---|' * len((*HEAD, *MORE))}", flush=True)
    for task in sys.argv[1:] or TASKS:
        name, goal = task.split(":")
        for web, change, told in webs(name, goal):
            cells = [f"{change[key]:+.2f}" if key in change else "-" for key in NAMES]
            print(f"| {name} | {goal} | {web} | {' | '.join(cells)} | {told} |", flush=True)


if __name__ == "__main__":
    main()
