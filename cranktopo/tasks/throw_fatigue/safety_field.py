"""Fatigue safety over the whole surface of a throw: unit stresses, load states, a method, the worst place."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index
from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import LoadHistory, WebHistory
from cranktopo.tasks.fatigue.criteria import criterion, safety_method
from cranktopo.tasks.fatigue.criterion import Judge, LocalStress, PointSafety
from cranktopo.tasks.fatigue.lsa import lsa_strength, point_strength_MPa
from cranktopo.tasks.fatigue.plane_criterion import PlaneCriterion, PlaneDiagram
from cranktopo.tasks.fatigue.plane_field import histories, least_safety
from cranktopo.tasks.fatigue.superposition import StressRange, signed_von_mises_ranges
from cranktopo.tasks.throw_fatigue.fillets import place
from cranktopo.tasks.throw_fatigue.hardening import (
    TreatedFillet,
    at_nodes,
    fillet_result,
    harden,
    of_nodes,
    treated_fillets,
)
from cranktopo.tasks.throw_fatigue.result import (
    CriticalPoint,
    HardenedFillet,
    JudgedAs,
    PartLife,
    PointScatter,
)
from cranktopo.tasks.throw_fatigue.scatter import counts_scatter, point_scatter
from cranktopo.tasks.throw_fatigue.stress_model import StressModel
from cranktopo.tasks.throw_fea.unit_fields import FieldKind

_UNIT_OF: dict[FieldKind, Callable[[LoadHistory], Array]] = {
    "bending": lambda h: h.radial_N,
    "tangential": lambda h: h.tangential_N,
    "torsion": lambda h: -h.torque_Nm * NMM_PER_NM,
    "centrifugal": lambda h: h.angular_speed_rad_s**2,
    "swing": lambda h: h.own_swing_Nm * NMM_PER_NM,
}
"""Factor of each unit field; a force along +x on the pin turns the shaft about -z, and so does its torque."""
_ALL = slice(None)


@dataclass(frozen=True)
class FatigueField:
    """Safety over the surface of a whole throw.

    Attributes:
        labels: of the load states.
        safety, amplitude_MPa, mean_MPa: at each node of each image, shape (images, n).
        critical: point of least safety of all that has a radius: fillets, outlets, rounded edges, faces.
        at_sharp_edges: point of least safety at inner edges without a radius, where it follows from the mesh.
        fillet_safety: least safety of the journals' and of the pin's fillets.
        web_safety: least safety of the first and of the second web where the halves differ.
        hardening: treated fillets by `[fatigue.hardening]`, each at its point of least safety.
        on_bearings: whether the states are those of the throw in its shaft on all main bearings.
        safety_as: least safety of the throw alone and in its shaft, where both were found.
        lives: by `[fatigue.spectrum]`, of the fillets and elsewhere.
        scatter: probability of failure by `[fatigue.scatter]`, of the fillets and elsewhere.
        diagram: stresses of the critical point in every state, where the method judges these.
        at_outlet: point of least safety at an outlet of an oil bore; None without any.
    """

    model: StressModel
    method: str
    labels: tuple[str, ...]
    safety: Array
    amplitude_MPa: Array
    mean_MPa: Array
    critical: CriticalPoint
    at_sharp_edges: CriticalPoint | None
    fillet_safety: dict[str, float]
    web_safety: dict[str, float]
    on_bearings: bool = False
    safety_as: dict[JudgedAs, float] = field(default_factory=dict)
    hardening: dict[str, HardenedFillet] = field(default_factory=dict)
    lives: dict[str, PartLife] = field(default_factory=dict)
    scatter: dict[str, PointScatter] = field(default_factory=dict)
    diagram: PlaneDiagram | None = None
    at_outlet: CriticalPoint | None = None


def safety_field(model: StressModel, method: str, history: LoadHistory) -> FatigueField:
    """Safety at every surface node of every image of the model."""
    return field_of_states(model, method, unit_loads(history, model.kinds), history.labels)


def field_of_states(model: StressModel, method: str, loads: Array, labels: tuple[str, ...]) -> FatigueField:
    """Return the safety at every surface node of every image of the model.

    Args:
        loads: factor of each field in each state, shape (states, fields).
        labels: of the states.
    """
    cycles = [loads * image.signs for image in model.images]
    found = signed_von_mises_ranges(model.stress, cycles)
    sides = {"first": ~model.on_second, "second": model.on_second} if model.whole else {}
    webs = {web: model.judged & side for web, side in sides.items()}
    safety = _safety(model, method, cycles, found, list(webs.values()))
    fillet = {
        "journal": float(safety[:, model.on_journal].min()),
        "pin": float(safety[:, model.on_pin].min()),
    }
    judged = _Judged(model, method, labels, cycles, found, safety)
    return FatigueField(
        model,
        method,
        labels,
        safety,
        np.stack([e.local.amplitude_MPa for e in found]),
        np.stack([e.local.mean_MPa for e in found]),
        judged.critical(model.judged),
        judged.critical(model.sharp) if model.sharp.any() else None,
        fillet,
        {web: float(safety[:, nodes].min()) for web, nodes in webs.items()},
        hardening=_hardening(model, method, found, safety),
        scatter=judged.scatter(),
        diagram=judged.diagram(),
        at_outlet=judged.critical(model.judged_outlet) if model.judged_outlet.any() else None,
    )


def _safety(
    model: StressModel,
    method: str,
    cycles: list[Array],
    ranges: list[StressRange],
    webs: list[NDArray[np.bool_]],
) -> Array:
    """Return the safety of every node of every image."""
    chosen = safety_method(method)
    if not isinstance(chosen, PlaneCriterion):
        return np.stack([point_safety(model, method, extremes.local) for extremes in ranges])
    parts = [model.judged, model.sharp, model.on_journal, model.on_pin, model.judged_outlet, *webs]
    strength = np.stack([_reversed_strength_MPa(model, extremes.local) for extremes in ranges])
    stress = model.stress.stress_MPa
    return least_safety(stress, cycles, strength, parts, chosen, model.scene)


def point_safety(model: StressModel, method: str, local: LocalStress, nodes: Index | slice = _ALL) -> Array:
    """Return the safety of surface nodes of a model, all by default; on hardened fillets over all depths."""
    judged, plain = criterion(method).point_safety, _off_the_fillets(model.scene)
    safety = judged(model.scene, local).safety
    if model.scene.fatigue.hardened:
        return harden(safety, judge(model.scene, method), of_nodes(treated_fillets(model), nodes), local)
    if plain is model.scene:
        return safety
    return np.where(model.on_fillet[nodes], safety, judged(plain, local).safety)


def judge(scene: Scene, method: str) -> Judge:
    """Return what tells the safety of points of a scene by a method, with the strength of the core."""
    judged = criterion(method).point_safety
    return lambda local: judged(scene, local).safety


def _hardening(
    model: StressModel, method: str, ranges: list[StressRange], safety: Array
) -> dict[str, HardenedFillet]:
    """Return the treated fillets of a model, each at its point of least safety."""
    by_fillet: dict[str, HardenedFillet] = {}
    for one in treated_fillets(model):
        image, node = np.unravel_index(int(np.where(one.nodes, safety, np.inf).argmin()), safety.shape)
        here = fillet_result(judge(model.scene, method), one, at_nodes(ranges[image].local, np.array([node])))
        by_fillet[one.fillet] = min(by_fillet.get(one.fillet, here), here, key=lambda fillet: fillet.safety)
    return by_fillet


def _treated_at(model: StressModel, node: int) -> TreatedFillet | None:
    """Return the treated fillet that a surface node lies on."""
    return next((one for one in treated_fillets(model) if one.nodes[node]), None)


def _reversed_strength_MPa(model: StressModel, local: LocalStress) -> Array:
    """Return the strength of every node in fully reversed tension: that of local stress analysis."""
    gradient, plain = local.gradient_per_mm, _off_the_fillets(model.scene)
    strength = point_strength_MPa(gradient, lsa_strength(model.scene))[0]
    if plain is model.scene:
        return strength
    return np.where(model.on_fillet, strength, point_strength_MPa(gradient, lsa_strength(plain))[0])


def _off_the_fillets(scene: Scene) -> Scene:
    """Return the scene with the strength that counts off the fillets; the same object where it is theirs."""
    settings = scene.fatigue
    if settings.factor_off_fillets == settings.surface_treatment_factor:
        return scene
    plain = settings.model_copy(update={"surface_treatment_factor": settings.factor_off_fillets})
    return scene.model_copy(update={"fatigue": plain})


def unit_loads(history: LoadHistory, kinds: Sequence[FieldKind]) -> Array:
    """Factor of each unit field in each load state, shape (states, fields)."""
    moments: dict[FieldKind, Array] = {}
    if isinstance(history, WebHistory):
        moments = {"moment": history.moment_Nm, "side_moment": history.side_moment_Nm}
    return np.stack(
        [moments[kind] * NMM_PER_NM if kind in moments else _UNIT_OF[kind](history) for kind in kinds], axis=1
    )


@dataclass(frozen=True)
class _Judged:
    """A model whose safety is known at every node of every image."""

    model: StressModel
    method: str
    labels: tuple[str, ...]
    cycles: list[Array]
    ranges: list[StressRange]
    safety: Array

    def critical(self, among: NDArray[np.bool_]) -> CriticalPoint:
        """Return the point of least safety among some nodes."""
        image, node = self._least(among)
        model, e = self.model, self.ranges[image]
        local = e.local
        one = LocalStress(*(v[[node]] for v in (local.amplitude_MPa, local.mean_MPa, local.gradient_per_mm)))
        terms, rest = self._safety_terms(image, node, one)
        point = model.images[image].points_mm(model.surface.points_mm[:, [node]], model.scene.pitch_mm)[:, 0]
        at, share = place(model.scene, point), float(terms.amplitude_share[0])
        hardened = self._hardened_fillet(node, one)
        return CriticalPoint(
            place=str(at),
            fillet=at.fillet or None,
            around_deg=at.around_deg if at.fillet else None,
            along_deg=at.along_deg if at.fillet else None,
            web=at.web or None,
            point_mm=at.point_mm,
            safety=float(self.safety[image, node]),
            amplitude_MPa=float(one.amplitude_MPa[0]),
            mean_MPa=float(one.mean_MPa[0]),
            gradient_per_mm=float(one.gradient_per_mm[0]),
            strength_MPa=float(terms.strength_MPa[0]) * (1.0 if hardened is None else hardened.gain),
            amplitude_share=share,
            decided_by="amplitude" if share >= 0.5 else rest,
            factors={name: float(value[0]) for name, value in terms.factors.items()},
            states=(self.labels[e.highest[node]], self.labels[e.lowest[node]]),
            depth_mm=None if hardened is None else hardened.depth_mm,
        )

    def _hardened_fillet(self, node: int, one: LocalStress) -> HardenedFillet | None:
        """Return what is told of the treated fillet that a node lies on."""
        treated = _treated_at(self.model, node)
        return None if treated is None else fillet_result(judge(self.model.scene, self.method), treated, one)

    def scatter(self) -> dict[str, PointScatter]:
        """Return the probability of failure where each fillet, and all else, is least safe."""
        model = self.model
        if not counts_scatter(model.scene, self.method):
            return {}
        return {name: self._scatter_of(*self._least(nodes)) for name, nodes in model.parts.items()}

    def _scatter_of(self, image: int, node: int) -> PointScatter:
        at = np.array([node])

        def safety_at(scene: Scene, local: LocalStress) -> float:
            return float(point_safety(replace(self.model, scene=scene), self.method, local, at)[0])

        return point_scatter(self.model, node, at_nodes(self.ranges[image].local, at), safety_at)

    def diagram(self) -> PlaneDiagram | None:
        """Return the stresses of the critical point in every state, where the method judges these."""
        chosen = safety_method(self.method)
        if not isinstance(chosen, PlaneCriterion):
            return None
        image, node = self._least(self.model.judged)
        strength = _reversed_strength_MPa(self.model, self.ranges[image].local)[node]
        return chosen.diagram(self.model.scene, self._history(image, node)[0], float(strength))

    def _least(self, among: NDArray[np.bool_]) -> tuple[int, int]:
        image, node = np.unravel_index(int(np.where(among, self.safety, np.inf).argmin()), self.safety.shape)
        return int(image), int(node)

    def _history(self, image: int, node: int) -> Array:
        return histories(self.model.stress.stress_MPa[:, [node]], self.cycles[image])

    def _safety_terms(self, image: int, node: int, one: LocalStress) -> tuple[PointSafety, str]:
        """Return what makes the safety of a node, and the name of what is not of the amplitude."""
        scene = self.model.scene if self.model.on_fillet[node] else _off_the_fillets(self.model.scene)
        chosen = safety_method(self.method)
        if not isinstance(chosen, PlaneCriterion):
            return criterion(self.method).point_safety(scene, one), "mean stress"
        found = chosen.severity(scene, self._history(image, node))
        strength, support, notch = point_strength_MPa(one.gradient_per_mm, lsa_strength(scene))
        factors = {**found.factors, "fG": support, "beta_over_alpha": notch}
        safety = strength / np.maximum(found.equivalent_MPa, 1e-12 * strength)
        return PointSafety(safety, strength, found.shear_share, factors), chosen.remainder
