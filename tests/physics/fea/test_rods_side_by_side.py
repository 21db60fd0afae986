"""Two rods on a pin: each web by the lever rule, against the whole throw loaded on one half of its pin.

The half model under the share of the bearing beside the web leaves out that the pin is not loaded alike on
both sides of its middle. Here the whole throw has it.
"""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.bodies.mesh.solid_mesh import mesh_throw
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.elasticity import Elasticity, mean_displacement
from cranktopo.numerics.tetrahedra.stress import nodal_stress, von_mises
from cranktopo.tasks.throw_fea.condense import bending_motion, condense, loaded_mm
from tests.physics.fea.evaluation_cases import elastic

Array = NDArray[np.float64]
SIZE_MM, FRACTION = 8.0, 0.5
LEAST, MOST = 0.96, 1.04


@pytest.mark.slow
@pytest.mark.parametrize("design", ["mikron-iiic-plain", "car-diesel"])
def test_the_lever_rule_has_the_stress_of_each_fillet(design: str) -> None:
    """Largest von Mises stress of every fillet, load on the first half of the pin over load on all of it."""
    scene = load_scene(design)
    meshed = mesh_throw(scene, SIZE_MM, full=True, fillet_fraction=FRACTION)
    model = elastic(meshed.mesh, scene)
    one, both = (peaks(model, scene, meshed.mesh.mirrored, share) for share in (0.5, 1.0))
    start, end = loaded_mm(scene, True)
    off_mm = (end - start) / 4
    near = 1 + 2 * off_mm / scene.pitch_mm
    for name, share in (("near", near), ("far", 2 - near)):
        for fillet in ("journal", "pin"):
            ratio = one[name, fillet] / (share * both[name, fillet])
            print(f"{design}: {fillet} fillet of the {name} web {100 * (ratio - 1):+.1f} %")
            assert LEAST < ratio < MOST, (name, fillet)


def peaks(model: Elasticity, scene: Scene, mirrored: bool, share: float) -> dict[tuple[str, str], float]:
    """Largest stress of every fillet under 1 N along -y on a share of the pin from its first end."""
    start, end = loaded_mm(scene, True)
    models = 2 if mirrored else 1
    load = -mean_displacement(model, 1, start, start + share * (end - start)) / models
    block = condense(model, scene, "whole", "even" if mirrored else "none", load[:, None])
    motion = bending_motion(block, block.extra_loads[:, 0], "pinned")
    field = block.displacement[:, -1] + block.displacement[:, : len(block.motions)] @ motion
    material = scene.material
    found = nodal_stress(model, field[None], 1e3 * material.E_GPa, material.poisson)
    stress = von_mises(found.nodal_MPa[0])
    return {
        (web, fillet): float(stress[on_fillet(model.nodes_mm, scene, web, fillet)].max())
        for web in ("near", "far")
        for fillet in ("journal", "pin")
    }


def on_fillet(nodes_mm: Array, scene: Scene, web: str, name: str) -> NDArray[np.bool_]:
    """Nodes of the surface of a fillet, (n,)."""
    x, y, z = nodes_mm if web == "near" else (*nodes_mm[:2], scene.pitch_mm - nodes_mm[2])
    start, end = scene.web_z_mm
    journal, place, face, out = (
        (scene.throw.main_journal, 0.0, start, -1.0)
        if name == "journal"
        else (scene.throw.crankpin, scene.throw.radius_mm, end, 1.0)
    )
    radius, away = journal.fillet_mm, np.hypot(x, y - place) - journal.radius_mm
    height = out * (z - face)
    inside = (away > -1e-6) & (away < radius) & (height > -1e-6) & (height < radius)
    arc = np.abs(np.hypot(radius - away, radius - height) - radius) < 0.02 * radius
    return np.asarray(inside & arc)
