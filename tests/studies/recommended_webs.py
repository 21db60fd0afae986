"""The lightest web where its throw stands alone and in its shaft: `python -m tests.studies.recommended_webs`.

    python -m tests.studies.recommended_webs [ENGINE...]

Of each engine with the effect `continuous_shaft` off and on, every angle of the cycle: the mass that is saved
at the safety of the own web, with 85 % of its stiffness in torsion and bending, and the least safety of all
webs in the shaft, over its range of speeds, of the own web and of the one found.
"""

from __future__ import annotations

import sys
import tempfile
import time
from pathlib import Path

from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.web_shape.each_web.loaded_shaft import ShaftFigures, loaded_shaft
from cranktopo.tasks.web_shape.run import shape_design, shape_settings

ENGINES = ("mikron-iiic", "car-diesel", "industrial-gas")
LIMITS = ("torsion >= 85 %", "bending >= 85 %", "fatigue_safety >= 100 %")
EFFECT = "continuous_shaft"
HEAD = ("engine", "effect", "mass", "safety of the search: own web", "found", "least of the shaft: own web")
MORE = ("found", "web and place", "limits", "s")


def in_shaft(web: Scene, fillet_fraction: float) -> ShaftFigures:
    """Return what a shaft of this web has, whatever its effect is."""
    return loaded_shaft(web.with_effect(EFFECT, "on"), fillet_fraction).figures


def rows(engine: str) -> list[str]:
    """Return the rows of an engine, with the effect off and on."""
    found, own = [], load_scene(engine)
    before: ShaftFigures | None = None
    for effect in ("off", "on"):
        scene = with_goal(own.with_effect(EFFECT, effect), minimise="mass", maximise=None, limits=LIMITS)
        settings = shape_settings(scene, loads="cycle")
        began = time.perf_counter()
        with tempfile.TemporaryDirectory() as folder:
            run = shape_design(scene, settings, out=Path(folder) / "shape")
            seconds = time.perf_counter() - began
            web = load_scene(str(run.folder / run.result.files.design))
            told = run.result.as_json()
        before = before or in_shaft(own, settings.fillet_fraction)
        after = in_shaft(web, settings.fillet_fraction)
        worst = min(after.webs, key=lambda one: one.safety)
        safeties = [told["values"][which]["fatigue_safety"] for which in ("original", "result")]
        cells = [
            engine,
            effect,
            f"{told['change_percent']['mass']:+.1f} %",
            *(f"{safety:.3f}" for safety in (*safeties, before.safety, after.safety)),
            f"{worst.web}, {worst.part.replace('_', ' ')}",
            "kept" if run.result.held else "NOT MET",
            f"{seconds:.0f}",
        ]
        found.append(f"| {' | '.join(cells)} |")
    return found


def main(*engines: str) -> None:
    """Print the table as Markdown."""
    print(f"| {' | '.join((*HEAD, *MORE))} |\n|{'---|' * len((*HEAD, *MORE))}", flush=True)
    for engine in engines or ENGINES:
        print(*rows(engine), sep="\n", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
