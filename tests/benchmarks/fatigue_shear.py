"""Why the shear factor of the journal fillet from finite elements misses the polynomial of IACS UR M53.

Run with `python -m tests.benchmarks.fatigue_shear` (`--fraction F` for the element size over the fillet's
radius). Appendix III takes beta_Q as what three-point bending adds over the moment at the web's centre:
(s3 - beta_B sN) / sQ, with sN / sQ = 6 L / W. Columns: that ratio; beta_B; beta_Q with the pin's force spread
over the pin, and with the force in the mid-pin section alone, as the rule loads it; their difference from the
rule; what 1 % of s3 is of the rule's beta_Q; how much shorter than to the web's centre, in web thicknesses,
the lever must be for beta_Q to agree; and s3 / sN, the rule's second method, which needs no difference,
against the rule's beta_B + beta_Q sQ / sN.
"""

from __future__ import annotations

import argparse
from typing import Any

import numpy as np
from numpy.typing import NDArray

from cranktopo.effects.beam import web_lever_mm
from cranktopo.evaluate.condense import RX, condense
from cranktopo.evaluate.elasticity import assemble, mean_displacement
from cranktopo.evaluate.equivalent import von_mises
from cranktopo.evaluate.evaluation import default_element_size_mm
from cranktopo.evaluate.fillets import fillet_nodes
from cranktopo.evaluate.m53 import concentration_factors, nominal_stresses, outside_validity
from cranktopo.evaluate.rule_check import dimensions
from cranktopo.evaluate.stress import nodal_stress
from cranktopo.evaluate.support_stiffness import bending_motion
from cranktopo.meshing.solid_mesh import mesh_throw
from cranktopo.scene import Scene
from cranktopo.units import MPA_PER_GPA
from tests.benchmarks.fatigue_mesh import MARINE, throws
from tests.physics.evaluation_cases import throw_scene

Array = NDArray[np.float64]
SECTION_MM = 2.0
"""Thickness of the slice at the mid-pin plane that takes the force."""


def variants() -> dict[str, Scene]:
    """The throws of the mesh study, and the rule's example with other lengths and widths."""

    def changed(journal_mm: float, pin_mm: float, width_mm: float) -> Scene:
        throw: dict[str, Any] = {
            **MARINE["throw"],
            "main_journal": {**MARINE["throw"]["main_journal"], "length_mm": journal_mm},
            "crankpin": {**MARINE["throw"]["crankpin"], "length_mm": pin_mm},
        }
        return throw_scene(throw, {**MARINE["web"], "width_mm": width_mm})

    return {
        **throws(),
        "journals 120 mm long": changed(120.0, 40.0, 100.0),
        "pin 70 mm long": changed(40.0, 70.0, 100.0),
        "web 80 mm wide": changed(40.0, 40.0, 80.0),
        "web 130 mm wide": changed(40.0, 40.0, 130.0),
    }


def journal_stresses(scene: Scene, fraction: float) -> tuple[float, float, float]:
    """Largest von Mises stress in the journal fillet under a unit moment and under a unit force on the pin,
    spread over the pin and in its mid-section alone."""
    size = min(default_element_size_mm(scene), scene.web.thickness_mm / 6)
    youngs, poisson = scene.material.E_GPa * MPA_PER_GPA, scene.material.poisson
    model = assemble(mesh_throw(scene, size, fillet_fraction=fraction).mesh, youngs, poisson)
    section = -mean_displacement(model, axis=1, z_from_mm=scene.pitch_mm / 2 - SECTION_MM) / 4
    block = condense(model, scene, "symmetric", "even", section[:, None])
    count = len(block.motions)
    moment = np.array([1.0 if motion == RX else 0.0 for motion in block.motions])
    cases: tuple[tuple[Array | float, Array], ...] = (
        (0.0, moment),
        (block.displacement[:, count] / 4, block.load / 2),
        (block.displacement[:, count + 1], block.further[:, 0]),
    )
    fields = [
        fixed + block.displacement[:, :count] @ bending_motion(block, force, "pinned")
        for fixed, force in cases
    ]
    found = nodal_stress(model, np.stack(fields), youngs, poisson).nodal_MPa
    on = fillet_nodes(scene, "journal", model.nodes_mm)
    pure, spread, alone = von_mises(found[:, on]).max(axis=1)
    return float(pure), float(spread), float(alone)


def row(name: str, scene: Scene, fraction: float) -> str:
    """One line of the table."""
    size, lever = dimensions(scene), web_lever_mm(scene)
    assert outside_validity(size) == ()
    rule = concentration_factors(size)
    pure, *three = journal_stresses(scene, fraction)
    unit, nominal = nominal_stresses(size, 1.0, 0.0, 1.0), nominal_stresses(size, lever / 2, 0.5, 0.0)
    beta = pure / unit.bending_MPa
    shear = [(s - beta * nominal.bending_MPa) / nominal.shear_MPa for s in three]
    differences = [f"{q:.2f} ({100 * (q / rule.beta_shear - 1):+.0f})" for q in shear]
    agreeing = (three[1] - rule.beta_shear * nominal.shear_MPa) / beta / unit.bending_MPa * 2
    total = three[1] / nominal.bending_MPa
    expected = rule.beta_bending + rule.beta_shear * nominal.shear_MPa / nominal.bending_MPa
    return (
        f"| {name} | {nominal.bending_MPa / nominal.shear_MPa:.1f} "
        f"| {beta:.3f} ({100 * (beta / rule.beta_bending - 1):+.1f}) | {rule.beta_shear:.2f} "
        f"| {' | '.join(differences)} | {three[1] / nominal.shear_MPa / rule.beta_shear:.0f} "
        f"| {(lever - agreeing) / size.web_thickness:.2f} "
        f"| {total:.3f} ({100 * (total / expected - 1):+.1f}) |"
    )


def main() -> None:
    """Print the table as Markdown."""
    parser = argparse.ArgumentParser()
    parser.add_argument("--fraction", type=float, default=0.35)
    fraction = parser.parse_args().fraction
    print("| throw | 6 L/W | beta_B (%) | rule's beta_Q | force spread (%) | in mid-pin section (%) ", end="")
    print("| % per % of stress | lever shorter by, W | s3/sN (%) |")
    print("|---" * 9 + "|")
    for name, scene in variants().items():
        print(row(name, scene, fraction), flush=True)


if __name__ == "__main__":
    main()
