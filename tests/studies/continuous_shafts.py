"""Throws alone and on all bearings: `python -m tests.studies.continuous_shafts [ENGINE...]`.

Ratio of the bending range in the middle of the webs, the largest main-bearing force, and the least safety
(local stress analysis, every angle of the cycle) on rigid bearings, on springs, and in oil films where the
design has `[bearings]`.
"""

from __future__ import annotations

import sys

import numpy as np

from cranktopo.base.units import N_PER_KN
from cranktopo.design.loading import load_scene
from cranktopo.tasks.fatigue.least import least_safeties
from cranktopo.tasks.fatigue.shaft_stress import shaft_loads, solve_shaft_stress
from cranktopo.tasks.fatigue.target_safety import fatigue_field
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.shaft.continuous import continuous_shaft
from cranktopo.tasks.shaft.loaded_throw import loaded_throw
from cranktopo.tasks.shaft.on_film import Support

ENGINES = ("mikron-iiic", "car-diesel", "industrial-gas")
SPRINGS_N_PER_MM = (3e6, 1e6, 3e5)
FILLET_FRACTION = 0.3
"""Coarser than the rule's 0.17: both safeties are of the same elements."""


def main(*engines: str) -> None:
    """Print the table as Markdown."""
    print(
        "| engine | bearings N/mm | worst web | of its throw alone | all webs "
        "| largest bearing force kN | of throws alone kN | least safety | of throws alone |"
    )
    print("|" + "---|" * 9)
    for engine in engines or ENGINES:
        scene = load_scene(engine)
        target = Target(engine, scene)
        stress = solve_shaft_stress(target, FILLET_FRACTION)
        throw, count = loaded_throw(stress.body.blocks, scene), len(scene.shaft_angles_deg)
        of_throws = fatigue_field(target, "lsa", "cycle", FILLET_FRACTION).critical.safety
        films: tuple[Support, ...] = ("film",) if scene.bearings else ()
        for support in (None, *SPRINGS_N_PER_MM, *films):
            found = continuous_shaft([(throw, scene)] * count, scene, support)
            web, bearing = found.worst_web, found.worst_bearing
            shares = [one.share for one in found.webs]
            loads = shaft_loads([stress] * count, scene, scene, support)[1]
            least = least_safeties(stress.model, list(loads[:, None]), "lsa")
            safety = min(float(np.min(of_part)) for own in least for of_part in own.values())
            alone = max(one.halves_N for one in found.main_bearings)
            held = f"{support:,.0f}" if isinstance(support, float) else support or "rigid"
            print(
                f"| {engine} | {held} | {web.web} | {web.share:.2f} "
                f"| {min(shares):.2f} to {max(shares):.2f} "
                f"| {bearing.largest_N / N_PER_KN:.1f} (no. {bearing.bearing}) | {alone / N_PER_KN:.1f} "
                f"| {safety:.3f} | {of_throws:.3f} |",
                flush=True,
            )


if __name__ == "__main__":
    main(*sys.argv[1:])
