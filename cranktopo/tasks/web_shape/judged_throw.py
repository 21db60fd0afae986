"""The judged surface of a throw, and its judge: fillets with their treatment, and all else."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.design.schema import Scene
from cranktopo.numerics.tetrahedra.sharp_edges import near_sharp_edges
from cranktopo.numerics.tetrahedra.stress import Surface, SurfaceStress
from cranktopo.tasks.fatigue.criterion import Judge, LocalStress
from cranktopo.tasks.fatigue.lsa import LsaStrength, lsa, lsa_strength
from cranktopo.tasks.fatigue.smooth_extremes import JudgedSurface, JudgeOf, SmoothValue, least_safety
from cranktopo.tasks.fatigue.smooth_extremes import largest_stress as _largest_stress
from cranktopo.tasks.throw_fatigue.fillets import cut_outlet_nodes, fillet_nodes
from cranktopo.tasks.throw_fatigue.hardened_layer import layers
from cranktopo.tasks.throw_fatigue.hardening import harden, of_nodes, treated


@dataclass(frozen=True)
class JudgedThrow:
    """Surface nodes of a half throw that are judged: none at sharp edges or cut outlets.

    Attributes:
        on_fillet: masks of all nodes of the surface, by fillet.
    """

    scene: Scene
    surface: JudgedSurface
    on_fillet: dict[str, NDArray[np.bool_]]


def judged_throw(scene: Scene, surface: Surface, stress: SurfaceStress, states: list[Array]) -> JudgedThrow:
    """Return what is judged of the surface of a half throw."""
    on = {name: fillet_nodes(scene, name, surface.points_mm) for name in ("journal", "pin")}
    mesh_decides = near_sharp_edges(surface) | cut_outlet_nodes(scene, surface.points_mm)
    nodes = np.flatnonzero(on["journal"] | on["pin"] | ~mesh_decides)
    return JudgedThrow(scene, JudgedSurface(stress, tuple(states), nodes), on)


def largest_stress(_: Scene, judged: JudgedThrow) -> SmoothValue:
    """Return the largest von Mises stress of a throw, MPa."""
    return _largest_stress(judged.surface)


def safety_by_lsa(design: Scene, judged: JudgedThrow) -> SmoothValue:
    """Return the least safety of a throw by local stress analysis, of the strength that a design has."""
    return least_safety(judged.surface, _judge_of(design, judged))


def _judge_of(design: Scene, judged: JudgedThrow) -> JudgeOf:
    """Return what tells the safety of nodes; on hardened fillets over all their depths."""
    masks, core = judged.on_fillet, lsa_strength(design)
    hard = tuple(treated(judged.scene, name, layer, masks[name]) for name, layer in layers(design).items())

    def judge_of(nodes: Index) -> Judge:
        here, strength = of_nodes(hard, nodes), _strength(design, (masks["journal"] | masks["pin"])[nodes])

        def safety(local: LocalStress) -> Array:
            found = lsa(local, strength).safety
            return harden(found, lambda below: lsa(below, core).safety, here, local) if here else found

        return safety

    return judge_of


def _strength(design: Scene, on_fillet: NDArray[np.bool_]) -> LsaStrength:
    """Return the strength at nodes; a treatment of the fillets raises it nowhere else."""
    strength = lsa_strength(design)
    factors = strength.treatment_factor, design.fatigue.factor_off_fillets
    return replace(strength, treatment_factor=np.where(on_fillet, *factors))
