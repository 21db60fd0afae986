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
from cranktopo.tasks.fatigue.lsa import LSA, lsa_strength, point_strength_MPa
from cranktopo.tasks.throw_fatigue.m53 import concentration_factors, dimensions
from tests.validation.table import lines_of

GRADIENTS_PER_MM = np.array([0.0, 0.75, 2.0, 10.0, 99.9])
"""The Mikron's pin fillet; notches of 1 mm and 0.2 mm (2 / radius); the end of the guideline's formula."""
DESIGN = "mikron-iiic"


def strengths(scene: Scene, gradient_per_mm: Array) -> dict[str, Array]:
    """Fully reversed strength over that without a gradient, by every criterion of local stresses."""
    one = np.ones(len(gradient_per_mm))
    stress, flat = LocalStress(one, 0 * one, gradient_per_mm), LocalStress(one, 0 * one, 0 * one)
    return {
        criterion.name: criterion.point_safety(scene, stress).safety
        / criterion.point_safety(scene, flat).safety
        for criterion in (LSA, FKM)
    } | {"critical planes": _reversed(scene, gradient_per_mm) / _reversed(scene, 0 * gradient_per_mm)}


def _reversed(scene: Scene, gradient_per_mm: Array) -> Array:
    """Return the strength that `findley` and `dang_van` give to a point."""
    return point_strength_MPa(gradient_per_mm, lsa_strength(scene))[0]


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
    rows = zip(GRADIENTS_PER_MM, found["lsa"], found["critical planes"], found["fkm"], strict=True)
    return lines_of(
        ("gradient, 1/mm", "`lsa`", "`findley`, `dang_van`", "`fkm`"),
        [(f"{chi:.4g}", *(f"{value:.3g}" for value in values)) for chi, *values in rows],
    )


def equilibrium_line() -> str:
    factor, wider, lost = lost_by_equilibrium(load_scene(DESIGN))
    return (
        f"The factor {lost:.1f} is the concentration factor {factor:.2f}, times 1.5 for a section that is "
        f"fully plastic, times {wider:.2f} for an envelope that is wider than the web."
    )


if __name__ == "__main__":
    print(gradient_table(), equilibrium_line(), sep="\n\n")
