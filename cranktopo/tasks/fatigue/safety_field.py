"""Fatigue safety over the whole surface of a throw: unit stresses, load states, a method, the worst place."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError, ExitCode
from cranktopo.base.notes import note
from cranktopo.base.units import NMM_PER_NM
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import HistoryKind, LoadHistory, load_history
from cranktopo.engine.load_case import LoadKind
from cranktopo.engine.plan.planning import plan_for_stress
from cranktopo.tasks.fatigue.criteria import criterion, safety_method
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.fillets import place
from cranktopo.tasks.fatigue.hardening import (
    Judge,
    TreatedFillet,
    at_nodes,
    harden,
    of_nodes,
    told_fillet,
    treated_fillets,
)
from cranktopo.tasks.fatigue.result import CriticalPoint, HardenedFillet
from cranktopo.tasks.fatigue.stress_model import RULE_FRACTION, StressModel, check_fillets, solve_stresses
from cranktopo.tasks.fatigue.superposition import Index, SignedVonMisesRange, signed_von_mises_ranges
from cranktopo.tasks.fea.targets import Target
from cranktopo.tasks.fea.unit_fields import FieldKind

_UNIT_OF: dict[FieldKind, Callable[[LoadHistory], Array]] = {
    "bending": lambda h: h.radial_N,
    "tangential": lambda h: h.tangential_N,
    "torsion": lambda h: -h.torque_Nm * NMM_PER_NM,
    "centrifugal": lambda h: h.angular_speed_rad_s**2,
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
    hardening: dict[str, HardenedFillet] = field(default_factory=dict)


def check_method(scene: Scene, method: str) -> None:
    """Check that material, fillets and packages are what a method needs.

    Raises:
        CranktopoError: a strength or a package is missing, or an elliptical fillet, of which the rule has no
            strength.
    """
    found = safety_method(method)
    found.load_packages()
    for key in found.needs:
        if getattr(scene.material, key) is None:
            raise CranktopoError(
                f"{scene.name}: material.{key}: is missing, method '{method}' needs it "
                f"(material '{scene.material.name}').",
                hint=f"Give material.{key}, or name a material of the library.",
            )
    found.check(scene)


def check_inputs(target: Target, method: str, kind: HistoryKind) -> None:
    """Check everything that a user can get wrong, before the first solve.

    Raises:
        CranktopoError: missing material data or loads, sharp fillets, or for the rule a body from CAD.
    """
    if method == "m53" and target.file is not None:
        raise CranktopoError(
            f"target '{target.name}': method 'm53' needs the width and the outline of the web, which a file "
            "does not name.",
            hint="Take --method lsa or fkm, or give a design.",
            code=ExitCode.USAGE,
        )
    check_method(target.scene, method)
    check_fillets(target)
    load_history(target.scene, kind, load_kinds(target.scene, kind)[0])


def load_kinds(scene: Scene, kind: HistoryKind) -> tuple[frozenset[str], tuple[LoadKind, ...]]:
    """Effects that the plan of a scene switches on for stress, and the loads to be solved.

    The extreme states hold radial force and torque; the tangential force only acts in the cycle.
    """
    enabled = plan_for_stress(scene).enabled
    possible: tuple[LoadKind, ...] = ("bending", "torsion", "centrifugal")
    if kind == "cycle":
        possible = ("bending", "tangential", "torsion", "centrifugal")
    return enabled, tuple(k for k in possible if k in enabled)


def fatigue_field(
    target: Target,
    method: str,
    kind: HistoryKind = "extremes",
    fillet_fraction: float = RULE_FRACTION,
) -> FatigueField:
    """Fatigue safety of a throw by a method of local stresses.

    Raises:
        CranktopoError: missing material data or loads, sharp fillets, or a failed solve.
    """
    return fatigue_fields(target, (method,), kind, fillet_fraction)[0]


def fatigue_fields(
    target: Target, methods: Sequence[str], kind: HistoryKind, fillet_fraction: float
) -> tuple[FatigueField, ...]:
    """Return the safety of a throw by each of several methods; its unit loads are solved once.

    Raises:
        CranktopoError: missing material data or loads, sharp fillets, or a failed solve.
    """
    for method in methods:
        check_method(target.scene, method)
    enabled, kinds = load_kinds(target.scene, kind)
    history = load_history(target.scene, kind, enabled)
    note(f"{target.name}: unit loads {', '.join(kinds)} for {len(history.labels)} load states")
    model = solve_stresses(target, kinds, fillet_fraction)
    return tuple(safety_field(model, method, history) for method in methods)


def safety_field(model: StressModel, method: str, history: LoadHistory) -> FatigueField:
    """Safety at every surface node of every image of the model."""
    return field_of_states(model, method, unit_loads(history, model.kinds), history.labels)


def field_of_states(model: StressModel, method: str, loads: Array, labels: tuple[str, ...]) -> FatigueField:
    """Return the safety at every surface node of every image of the model.

    Args:
        loads: factor of each field in each state, shape (states, fields).
        labels: of the states.
    """
    found = signed_von_mises_ranges(model.stress, [loads * image.signs for image in model.images])
    safety = np.stack([point_safety(model, method, extremes.local) for extremes in found])
    fillet = {
        "journal": float(safety[:, model.on_journal].min()),
        "pin": float(safety[:, model.on_pin].min()),
    }
    sides = {"first": ~model.on_second, "second": model.on_second} if model.whole else {}
    webs = {web: float(safety[:, model.judged & side].min()) for web, side in sides.items()}
    return FatigueField(
        model,
        method,
        labels,
        safety,
        np.stack([e.local.amplitude_MPa for e in found]),
        np.stack([e.local.mean_MPa for e in found]),
        _critical(model, method, labels, found, safety, model.judged),
        None if model.judged.all() else _critical(model, method, labels, found, safety, ~model.judged),
        fillet,
        webs,
        hardening=_hardening(model, method, found, safety),
    )


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
    model: StressModel, method: str, found: list[SignedVonMisesRange], safety: Array
) -> dict[str, HardenedFillet]:
    """Return the treated fillets of a model, each at its point of least safety."""
    told: dict[str, HardenedFillet] = {}
    for one in treated_fillets(model):
        image, node = np.unravel_index(int(np.where(one.nodes, safety, np.inf).argmin()), safety.shape)
        here = told_fillet(judge(model.scene, method), one, at_nodes(found[image].local, np.array([node])))
        told[one.fillet] = min(told.get(one.fillet, here), here, key=lambda fillet: fillet.safety)
    return told


def _treated_at(model: StressModel, node: np.intp) -> TreatedFillet | None:
    """Return the treated fillet that a surface node lies on."""
    return next((one for one in treated_fillets(model) if one.nodes[node]), None)


def _off_the_fillets(scene: Scene) -> Scene:
    """Return the scene with the strength that counts off the fillets; the same object where it is theirs."""
    settings = scene.fatigue
    if settings.factor_off_fillets == settings.surface_treatment_factor:
        return scene
    plain = settings.model_copy(update={"surface_treatment_factor": settings.factor_off_fillets})
    return scene.model_copy(update={"fatigue": plain})


def unit_loads(history: LoadHistory, kinds: Sequence[FieldKind]) -> Array:
    """Factor of each unit field in each load state, shape (states, fields)."""
    return np.stack([_UNIT_OF[kind](history) for kind in kinds], axis=1)


def _critical(
    model: StressModel,
    method: str,
    labels: tuple[str, ...],
    found: list[SignedVonMisesRange],
    safety: Array,
    among: NDArray[np.bool_],
) -> CriticalPoint:
    """Return the point of least safety among some nodes."""
    image, node = np.unravel_index(int(np.where(among, safety, np.inf).argmin()), safety.shape)
    e = found[image]
    local = e.local
    one = LocalStress(*(v[[node]] for v in (local.amplitude_MPa, local.mean_MPa, local.gradient_per_mm)))
    scene = model.scene if model.on_fillet[node] else _off_the_fillets(model.scene)
    made = criterion(method).point_safety(scene, one)
    point = model.images[image].points_mm(model.surface.points_mm[:, [node]], model.scene.pitch_mm)[:, 0]
    at, share = place(model.scene, point), float(made.amplitude_share[0])
    treated = _treated_at(model, node)
    told = None if treated is None else told_fillet(judge(scene, method), treated, one)
    return CriticalPoint(
        place=str(at),
        fillet=at.fillet or None,
        around_deg=at.around_deg if at.fillet else None,
        along_deg=at.along_deg if at.fillet else None,
        web=at.web or None,
        point_mm=at.point_mm,
        safety=float(safety[image, node]),
        amplitude_MPa=float(one.amplitude_MPa[0]),
        mean_MPa=float(one.mean_MPa[0]),
        gradient_per_mm=float(one.gradient_per_mm[0]),
        strength_MPa=float(made.strength_MPa[0]) * (1.0 if told is None else told.gain),
        amplitude_share=share,
        decided_by="amplitude" if share >= 0.5 else "mean stress",
        factors={name: float(value[0]) for name, value in made.factors.items()},
        states=(labels[e.highest[node]], labels[e.lowest[node]]),
        depth_mm=None if told is None else told.depth_mm,
    )
