"""Safety at every depth below the surface of a hardened fillet, and the depth that decides.

Source: IACS UR M53, Appendix V, 3: the working stress must stay below the local strength from the surface to
the core, with local hardness, residual stress and mean stress. The criterion of the method judges the stress
at each depth; the local strength over that of the core comes from `hardened_layer`.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.design.halves import halves
from cranktopo.design.hardening import Fillet
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.criterion import Judge, LocalStress
from cranktopo.tasks.throw_fatigue.hardened_layer import HardenedLayer, layers
from cranktopo.tasks.throw_fatigue.result import HardenedFillet
from cranktopo.tasks.throw_fatigue.stress_below import NotchShape, notch_shape, stress_share
from cranktopo.tasks.throw_fatigue.stress_model import StressModel


@dataclass(frozen=True)
class TreatedFillet:
    """A fillet of one web with its layer.

    Attributes:
        nodes: mask of the surface nodes on it.
    """

    fillet: Fillet
    layer: HardenedLayer
    shape: NotchShape
    nodes: NDArray[np.bool_]


@dataclass(frozen=True)
class SafetyOverDepth:
    """Safety of one point at the depths that are looked at."""

    depth_mm: Array
    safety: Array
    stress_share: Array

    @property
    def deciding(self) -> int:
        """Position of the least safety."""
        return int(self.safety.argmin())

    def below(self, case_mm: float) -> float:
        """Return the least safety below the surface; where that decides, from the treatment's depth on."""
        if self.deciding:
            return float(self.safety[self.deciding])
        return float(self.safety[self.depth_mm >= case_mm].min())


def treated_fillets(model: StressModel) -> tuple[TreatedFillet, ...]:
    """Return the treated fillets of a model, web by web."""
    near, far = halves(model.scene)
    on = {"pin": model.on_pin, "journal": model.on_journal}
    sides = [(near, ~model.on_second), (far, model.on_second)] if model.whole else [(near, model.on_fillet)]
    return tuple(
        treated(half, fillet, layer, on[fillet] & side)
        for half, side in sides
        for fillet, layer in layers(half).items()
    )


def treated(half: Scene, fillet: Fillet, layer: HardenedLayer, nodes: NDArray[np.bool_]) -> TreatedFillet:
    """Return a fillet of half a throw with its layer."""
    return TreatedFillet(fillet, layer, notch_shape(half, fillet), nodes)


def safety_at(judge: Judge, treated: TreatedFillet, local: LocalStress, depth_mm: float) -> Array:
    """Return the safety of points of a fillet at a depth below them, (n,)."""
    share, gradient = stress_share(treated.shape, local.gradient_per_mm, depth_mm)
    there = LocalStress(local.amplitude_MPa * share, local.mean_MPa * share, gradient)
    return judge(there) * treated.layer.relative_strength(np.array(depth_mm), gradient)


def least_safety(judge: Judge, treated: TreatedFillet, local: LocalStress) -> Array:
    """Return the least safety of points of a fillet over all depths, (n,)."""
    least = np.full(len(local.amplitude_MPa), np.inf)
    for depth in treated.layer.depths_mm:
        least = np.minimum(least, safety_at(judge, treated, local, float(depth)))
    return least


def over_depth(judge: Judge, treated: TreatedFillet, local: LocalStress) -> SafetyOverDepth:
    """Return the safety of one point of a fillet at every depth."""
    depths = treated.layer.depths_mm
    safety = [float(safety_at(judge, treated, local, float(depth))[0]) for depth in depths]
    share = [
        float(stress_share(treated.shape, local.gradient_per_mm, float(depth))[0][0]) for depth in depths
    ]
    return SafetyOverDepth(depths, np.array(safety), np.array(share))


def harden(safety: Array, judge: Judge, fillets: tuple[TreatedFillet, ...], local: LocalStress) -> Array:
    """Return safeties of surface nodes with those on treated fillets replaced, (n,)."""
    result = safety.copy()
    for one in fillets:
        result[one.nodes] = least_safety(judge, one, at_nodes(local, one.nodes))
    return result


def at_nodes(local: LocalStress, nodes: NDArray[np.bool_] | NDArray[np.intp]) -> LocalStress:
    """Return the stress of some points."""
    return LocalStress(local.amplitude_MPa[nodes], local.mean_MPa[nodes], local.gradient_per_mm[nodes])


def of_nodes(
    fillets: tuple[TreatedFillet, ...], nodes: NDArray[np.intp] | slice
) -> tuple[TreatedFillet, ...]:
    """Return treated fillets whose masks are of some of the surface nodes."""
    return tuple(replace(one, nodes=one.nodes[nodes]) for one in fillets)


def fillet_result(judge: Judge, treated: TreatedFillet, local: LocalStress) -> HardenedFillet:
    """Return what is told of a treated fillet at its point of least safety."""
    found, layer = over_depth(judge, treated, local), treated.layer
    at = found.deciding
    depth, untreated = found.depth_mm[at], float(judge(local)[0])
    return HardenedFillet(
        process=layer.process,
        case_depth_mm=layer.depth_mm,
        surface_hardness_HV=layer.surface_HV,
        core_hardness_HV=layer.core_HV,
        safety=float(found.safety[at]),
        safety_surface=float(found.safety[0]),
        safety_below=found.below(layer.depth_mm),
        depth_mm=float(depth),
        hardness_HV=float(layer.hardness_HV(depth)),
        residual_stress_MPa=float(layer.residual_MPa(depth)),
        stress_share=float(found.stress_share[at]),
        untreated_safety=untreated,
        gain=float(found.safety[at]) / untreated,
        safety_high=_at_other_end(judge, treated, local),
    )


def _at_other_end(judge: Judge, treated: TreatedFillet, local: LocalStress) -> float | None:
    """Return the least safety of one point with the scatter of the residual stress taken off."""
    scatter = treated.layer.scatter_MPa
    if not scatter:
        return None
    other = replace(treated, layer=replace(treated.layer, scatter_MPa=-scatter))
    return float(least_safety(judge, other, local)[0])
