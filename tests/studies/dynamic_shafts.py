"""The shaft with its mass beside the one without: `python -m tests.studies.dynamic_shafts [ENGINE...]`.

Of each engine, on rigid bearings and with elements of the default size, over its range of speeds: what its
own mass does to the moments in the webs and to the bearings at the engine's own speed, and at its worst
resonance. Built-in engines tell nothing of what they drive: their output turns evenly.
"""

from __future__ import annotations

import sys
from collections.abc import Callable
from typing import Any

import numpy as np

from cranktopo.design.checks.engine import speed_range_rpm
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import engine_of
from cranktopo.tasks.dynamics.result import DynamicSpeed
from cranktopo.tasks.shaft_safety.stage import assess_shaft

_SPEEDS = 5


def mikron(**shaft: Any) -> Scene:
    """Return the Mikron with parts on its shaft."""
    data = load_scene("mikron-iiic").model_dump(mode="json", exclude_none=True, exclude={"published"})
    return scene_from_dict({**data, "shaft": shaft})


PROPELLER = {"inertia_kg_m2": 0.6, "mass_kg": 6.0, "diametral_inertia_kg_m2": 0.31, "overhang_mm": 60.0}
ENGINES: dict[str, Callable[[], Scene]] = {
    "mikron-iiic": lambda: load_scene("mikron-iiic"),
    "mikron-iiic, propeller": lambda: mikron(propeller=PROPELLER),
    "mikron-iiic, flywheel of 20 kg": lambda: mikron(flywheel={"inertia_kg_m2": 0.2, "mass_kg": 20.0}),
    "car-diesel": lambda: load_scene("car-diesel"),
    "industrial-gas": lambda: load_scene("industrial-gas"),
}


def _told(at: DynamicSpeed) -> list[str]:
    web, bearing = at.worst_web, max(at.main_bearings, key=lambda one: one.ratio)
    ratios = [one.ratio for one in at.webs]
    return [
        f"{at.speed_rpm:,.0f}",
        f"{min(ratios):.2f} to {max(ratios):.2f}",
        f"{web.range_Nm.equivalent:,.0f} (web {web.web})",
        f"{bearing.ratio:.2f} (no. {bearing.bearing})",
    ]


def main(*engines: str) -> None:
    """Print a table as Markdown."""
    head = ["engine", "rpm", "moments of webs, of quasi-static", "largest equivalent moment N m"]
    head += ["bearing force, of quasi-static", "meets"]
    print(f"| {' | '.join(head)} |", "|" + "---|" * len(head), sep="\n", flush=True)
    for name in engines or tuple(ENGINES):
        scene = ENGINES[name]()
        own = engine_of(scene).speed_rpm
        speeds = sorted({own, *np.linspace(*speed_range_rpm(scene), _SPEEDS).tolist()})
        found = assess_shaft(scene, speeds_rpm=speeds, dynamic=True).dynamics
        assert found is not None
        at = {one.speed_rpm: one for one in found.speeds}
        met = {one.speed_rpm: f"order {one.order:g}, {one.kind}" for one in found.resonances}
        for speed in (own, found.worst.speed_rpm):
            print(f"| {' | '.join([name, *_told(at[speed]), met.get(speed, '')])} |", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
