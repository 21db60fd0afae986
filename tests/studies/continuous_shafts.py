"""Throws alone and on all bearings: `python -m tests.studies.continuous_shafts [--safety] [ENGINE...]`.

Ratio of the bending range in the middle of the webs and the largest main-bearing force, on rigid bearings, on
springs, and in oil films; then the ratio of every web. Engines are the built-in ones with several throws, and
the Mikron's plain throw in a three in line, a boxer four, a V8 with two rods a pin, and with two throws
between bearings. With `--safety` also the least safety of the shaft, and of every web beside that with the
effect `continuous_shaft` off: a throw alone (local stress analysis, every angle of the cycle).
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from functools import cache

from cranktopo.base.units import N_PER_KN
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.shaft.continuous import continuous_shaft
from cranktopo.tasks.shaft.loaded_throw import LoadedThrow, loaded_throw, throw_body
from cranktopo.tasks.shaft.on_film import Support
from cranktopo.tasks.shaft.result import ContinuousShaft
from cranktopo.tasks.throw_fatigue.least import least_safeties
from cranktopo.tasks.throw_fatigue.shaft_stress import shaft_loads, solve_shaft_stress
from cranktopo.tasks.throw_fatigue.target_safety import fatigue_field
from cranktopo.tasks.throw_fea.targets import Target
from tests.engine_arrangements import VEE, arranged

OIL = {"clearance_mm": 0.05, "oil": "ISO VG 100", "temperature_C": 110.0}
"""Main bearings of the Mikron, which tells none: those of the car engine, whose journals are as thick."""
SPRINGS_N_PER_MM = (3e6, 1e6, 3e5)
TOLD: tuple[Support, ...] = (None, 1e6, "film")
"""Bearings on which every web is told."""
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
def safeties_in(name: str) -> tuple[dict[Support, list[float]], float]:
    """Return the least safety of every web in each kind of bearing, and that of throws alone."""
    scene = in_oil(ENGINES[name]())
    target, count = Target(name, scene), len(scene.shaft_angles_deg)
    stress = solve_shaft_stress(target, FILLET_FRACTION)
    found: dict[Support, list[float]] = {}
    for support in (None, *SPRINGS_N_PER_MM, "film"):
        loads = shaft_loads([stress] * count, scene, scene, support)[1]
        least = least_safeties(stress.model, list(loads[:, None]), "lsa")
        found[support] = [
            min(float(safety[0]) for (side, _), safety in own.items() if side == web)
            for own in least
            for web in (0, 1)
        ]
    return found, fatigue_field(target, "lsa", "cycle", FILLET_FRACTION).critical.safety


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


def _print_by_web(lead: Sequence[str], values: dict[tuple[str, ...], list[float]]) -> None:
    """Print the values of every web, a row for each engine with what leads it."""
    count = max(map(len, values.values()))
    rows = [
        f"| {' | '.join([*first, *(f'{value:.2f}' for value in own), *[''] * (count - len(own))])} |"
        for first, own in values.items()
    ]
    _print_table([*lead, *(f"web {number}" for number in range(1, count + 1))], rows)


def main(*engines: str, safety: bool = False) -> None:
    """Print the tables as Markdown."""
    names = engines or tuple(ENGINES)
    found = {name: found_in(in_oil(ENGINES[name]())) for name in names}
    head = ["engine", "bearings N/mm", "worst web", "of its throw alone", "all webs"]
    head += ["largest bearing force kN", "of throws alone kN"]
    rows = []
    for name, shafts in found.items():
        for support, shaft in shafts.items():
            both = []
            if safety:
                in_shaft, alone = safeties_in(name)
                both = [f"{min(in_shaft[support]):.3f}", f"{alone:.3f}"]
            rows.append(_row(name, support, shaft, both))
    _print_table([*head, *(["least safety", "of throws alone"] if safety else [])], rows)
    moments = {
        (name, held(one)): [web.share for web in shafts[one].webs]
        for name, shafts in found.items()
        for one in TOLD
    }
    _print_by_web(["engine", "bearings"], moments)
    if safety:
        lead = ["engine", "bearings", "off: throw alone", "on: worst web"]
        _print_by_web(lead, {row: values for name in names for row, values in _safeties(name)})


def _safeties(name: str) -> Iterator[tuple[tuple[str, ...], list[float]]]:
    """Yield the safety of a throw alone and of the worst web in bearings, with that of every web."""
    in_shaft, alone = safeties_in(name)
    for one in TOLD:
        webs = in_shaft[one]
        worst = f"{min(webs):.3f} (no. {webs.index(min(webs)) + 1})"
        yield (name, held(one), f"{alone:.3f}", worst), webs


if __name__ == "__main__":
    main(*(one for one in sys.argv[1:] if one != "--safety"), safety="--safety" in sys.argv)
