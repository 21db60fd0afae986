"""Throws alone and on all bearings: `python -m tests.studies.continuous_shafts [--safety] [ENGINE...]`.

Ratio of the bending range in the middle of the webs and the largest main-bearing force, on rigid bearings, on
springs, and in oil films; then the ratio of every web. Engines are the built-in ones with several throws, and
the Mikron's plain throw in a three in line, a boxer four, a V8 with two rods a pin, and with two throws
between bearings. With `--safety` also the least safety (local stress analysis, every angle of the cycle).
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Sequence
from functools import cache

import numpy as np

from cranktopo.base.units import N_PER_KN
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.least import least_safeties
from cranktopo.tasks.fatigue.shaft_stress import shaft_loads, solve_shaft_stress
from cranktopo.tasks.fatigue.target_safety import fatigue_field
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.shaft.continuous import continuous_shaft
from cranktopo.tasks.shaft.loaded_throw import LoadedThrow, loaded_throw, throw_body
from cranktopo.tasks.shaft.on_film import Support
from cranktopo.tasks.shaft.result import ContinuousShaft
from tests.engine_arrangements import VEE, arranged

OIL = {"clearance_mm": 0.05, "oil": "ISO VG 100", "temperature_C": 110.0}
"""Main bearings of the Mikron, which tells none: those of the car engine, whose journals are as thick."""
SPRINGS_N_PER_MM = (3e6, 1e6, 3e5)
FILLET_FRACTION = 0.3
"""Coarser than the rule's 0.17: both safeties are of the same elements."""


def in_oil(scene: Scene) -> Scene:
    """Return a scene with bearings, where it tells none."""
    data = scene.model_dump(mode="json", exclude_none=True, exclude={"published"})
    return scene_from_dict({"bearings": OIL, **data})


def two_throws_between_bearings() -> Scene:
    """Return the Mikron's plain throw four times on three bearings."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    return scene_from_dict({**data, "crank": {"bearings": [0, 2, 4]}})


ENGINES: dict[str, Callable[[], Scene]] = {
    "mikron-iiic": lambda: load_scene("mikron-iiic"),
    "car-diesel": lambda: load_scene("car-diesel"),
    "industrial-gas": lambda: load_scene("industrial-gas"),
    "three in line": lambda: arranged("layout = 'in-line'", 3, (1, 3, 2)),
    "boxer four": lambda: arranged("layout = 'boxer'", 4, (1, 3, 2, 4)),
    "V8, two rods a pin": lambda: arranged(
        f"{VEE}throw_angles_deg = [0.0, 90.0, 270.0, 180.0]", 8, (1, 5, 4, 8, 6, 3, 7, 2)
    ),
    "two throws between bearings": two_throws_between_bearings,
}


def held(support: Support) -> str:
    """Return bearings in words."""
    return f"{support:,.0f}" if isinstance(support, float) else support or "rigid"


def found_in(scene: Scene) -> dict[Support, ContinuousShaft]:
    """Return what the shaft of a scene carries in each kind of bearing."""
    throw = _throw(scene.throw.model_dump_json() + scene.web.model_dump_json(), scene)
    own = [(throw, scene)] * len(scene.shaft_angles_deg)
    return {support: continuous_shaft(own, scene, support) for support in (None, *SPRINGS_N_PER_MM, "film")}


_THROWS: dict[str, LoadedThrow] = {}


def _throw(key: str, scene: Scene) -> LoadedThrow:
    """Return the throw of a scene, meshed and condensed once for all engines that have it."""
    if key not in _THROWS:
        body = throw_body(mesh_throw(scene, default_element_size_mm(scene)), scene)
        _THROWS[key] = loaded_throw(body.blocks, scene)
    return _THROWS[key]


@cache
def safeties_in(name: str) -> dict[Support, float]:
    """Return the least safety in each kind of bearing, and last that of throws alone."""
    scene = in_oil(ENGINES[name]())
    target, count = Target(name, scene), len(scene.shaft_angles_deg)
    stress = solve_shaft_stress(target, FILLET_FRACTION)
    found: dict[Support, float] = {}
    for support in (None, *SPRINGS_N_PER_MM, "film"):
        loads = shaft_loads([stress] * count, scene, scene, support)[1]
        least = least_safeties(stress.model, list(loads[:, None]), "lsa")
        found[support] = min(float(np.min(of_part)) for own in least for of_part in own.values())
    found[np.inf] = fatigue_field(target, "lsa", "cycle", FILLET_FRACTION).critical.safety
    return found


def _row(name: str, support: Support, found: ContinuousShaft, safety: Sequence[str]) -> str:
    web, bearing, shares = found.worst_web, found.worst_bearing, [one.share for one in found.webs]
    alone = max(one.halves_N for one in found.main_bearings)
    cells = [
        name,
        held(support),
        str(web.web),
        f"{web.share:.2f}",
        f"{min(shares):.2f} to {max(shares):.2f}",
        f"{bearing.largest_N / N_PER_KN:.1f} (no. {bearing.bearing})",
        f"{alone / N_PER_KN:.1f}",
        *safety,
    ]
    return f"| {' | '.join(cells)} |"


def _print_table(head: Sequence[str], rows: Sequence[str]) -> None:
    print(f"| {' | '.join(head)} |", "|" + "---|" * len(head), *rows, "", sep="\n", flush=True)


def main(*engines: str, safety: bool = False) -> None:
    """Print both tables as Markdown."""
    names = engines or tuple(ENGINES)
    found = {name: found_in(in_oil(ENGINES[name]())) for name in names}
    head = ["engine", "bearings N/mm", "worst web", "of its throw alone", "all webs"]
    head += ["largest bearing force kN", "of throws alone kN"]
    rows = []
    for name, shafts in found.items():
        for support, shaft in shafts.items():
            both = [f"{safeties_in(name)[one]:.3f}" for one in (support, np.inf)] if safety else []
            rows.append(_row(name, support, shaft, both))
    _print_table([*head, *(["least safety", "of throws alone"] if safety else [])], rows)
    count = max(len(shafts[None].webs) for shafts in found.values())
    each = [
        f"| {name} | {held(support)} | "
        + " | ".join([f"{web.share:.2f}" for web in shaft.webs] + [""] * (count - len(shaft.webs)))
        + " |"
        for name, shafts in found.items()
        for support, shaft in shafts.items()
        if support in (None, "film")
    ]
    _print_table(["engine", "bearings", *(f"web {number}" for number in range(1, count + 1))], each)


if __name__ == "__main__":
    main(*(one for one in sys.argv[1:] if one != "--safety"), safety="--safety" in sys.argv)
