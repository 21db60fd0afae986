"""No bound of stress bounds a fatigue safety: `python -m tests.studies.fatigue_bound`, as Markdown.

The table has the strength of a point over that of one without a gradient. The line below it compares the
stress in the crankpin's fillet, alpha_B M / (B W^2 / 6) by IACS UR M53, with what equilibrium proves of the
largest normal stress: a section between journals that do not overlap carries the moment M, so that
M <= largest stress * B_e W^2 / 4 with the width B_e of the envelope, whatever material is where in it.
"""

from __future__ import annotations

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.fkm import FKM
from cranktopo.tasks.fatigue.lsa import LSA
from cranktopo.tasks.fatigue.m53 import concentration_factors, dimensions
from tests.validation.table import lines_of

GRADIENTS_PER_MM = np.array([0.0, 0.75, 2.0, 10.0, 99.9])
"""The Mikron's pin fillet; notches of 1 mm and 0.2 mm (2 / radius); the end of the guideline's formula."""
DESIGN = "mikron-iiic"


def strengths(scene: Scene, gradient_per_mm: Array) -> dict[str, Array]:
    """Fully reversed strength by both criteria that know the gradient, over that without one."""
    one = np.ones(len(gradient_per_mm))
    stress, flat = LocalStress(one, 0 * one, gradient_per_mm), LocalStress(one, 0 * one, 0 * one)
    return {
        criterion.name: criterion.point_safety(scene, stress).safety
        / criterion.point_safety(scene, flat).safety
        for criterion in (LSA, FKM)
    }


def lost_by_equilibrium(scene: Scene) -> tuple[float, float, float]:
    """Concentration factor, width of envelope over web, and stress in the fillet over what is proven."""
    size, envelope = dimensions(scene), scene.envelope
    assert envelope is not None
    assert size.overlap <= 0
    middle = np.array([scene.throw.radius_mm / 2])
    low, high = (float(edge[0]) for edge in envelope.spans(middle, np.zeros(1))[0])
    wider = (high - low) / size.web_width
    factor = concentration_factors(size).alpha_bending
    return factor, wider, factor * 1.5 * wider


def gradient_table() -> str:
    found = strengths(load_scene(DESIGN), GRADIENTS_PER_MM)
    rows = zip(GRADIENTS_PER_MM, found["lsa"], found["fkm"], strict=True)
    return lines_of(
        ("gradient, 1/mm", "`lsa`", "`fkm`", "`findley`, `dang_van`"),
        [(f"{chi:.4g}", f"{lsa:.3g}", f"{fkm:.3g}", "1") for chi, lsa, fkm in rows],
    )


def equilibrium_line() -> str:
    factor, wider, lost = lost_by_equilibrium(load_scene(DESIGN))
    return (
        f"Its concentration factor {factor:.2f}, times 1.5 of a section that is plastic, times {wider:.2f} "
        f"of an envelope that is wider than the web: {lost:.1f}."
    )


if __name__ == "__main__":
    print(gradient_table(), equilibrium_line(), sep="\n\n")
