"""Throws alone and on all bearings: `python -m tests.studies.continuous_shafts [ENGINE...]`.

Ratio of the bending range in the middle of the webs, and the largest main-bearing force, on rigid bearings
and on springs.
"""

from __future__ import annotations

import sys

from cranktopo.base.units import MPA_PER_GPA, N_PER_KN
from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.halves import default_element_size_mm
from cranktopo.design.loading import load_scene
from cranktopo.numerics.tetrahedra.elasticity import assemble
from cranktopo.tasks.shaft.continuous import continuous_shaft
from cranktopo.tasks.shaft.loaded_throw import loaded_blocks, loaded_throw

ENGINES = ("mikron-iiic", "car-diesel", "industrial-gas")
SPRINGS_N_PER_MM = (3e6, 1e6, 3e5)


def main(*engines: str) -> None:
    """Print the table as Markdown."""
    print(
        "| engine | bearings N/mm | worst web | of its throw alone | all webs "
        "| largest bearing force kN | of throws alone kN |"
    )
    print("|" + "---|" * 7)
    for engine in engines or ENGINES:
        scene = load_scene(engine)
        mesh = mesh_throw(scene, default_element_size_mm(scene))
        model = assemble(mesh.mesh, scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson)
        throw = loaded_throw(loaded_blocks(model, scene, mesh.mesh.mirrored, whole=mesh.whole), scene)
        for spring in (None, *SPRINGS_N_PER_MM):
            found = continuous_shaft([(throw, scene)] * len(scene.shaft_angles_deg), scene, spring)
            web, bearing = found.worst_web, found.worst_bearing
            shares = [one.share for one in found.webs]
            alone = max(one.halves_N for one in found.main_bearings)
            held = "rigid" if spring is None else f"{spring:,.0f}"
            print(
                f"| {engine} | {held} | {web.web} | {web.share:.2f} "
                f"| {min(shares):.2f} to {max(shares):.2f} "
                f"| {bearing.largest_N / N_PER_KN:.1f} (no. {bearing.bearing}) | {alone / N_PER_KN:.1f} |",
                flush=True,
            )


if __name__ == "__main__":
    main(*sys.argv[1:])
