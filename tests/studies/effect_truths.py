"""Computed size of every effect of the plan on four engines, by finite elements.

Load cases are compared by strain energy relative to the larger one of bending and torsion, bearings by
bending stiffness, bores by torsional stiffness and mass, fillets by body-fitted stiffness; the rest is the
scene's own web on 3 mm cells. The inertia effects are forces in closed form: their truth is the load analysis
with and without them. Fatigue is the nominal stress amplitude over the strength, from linearised sections of
the body-fitted model.
"""

from __future__ import annotations

from typing import Any

import jax.numpy as jnp

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.planning import plan
from cranktopo.engine.plan.simulated import strip_features
from cranktopo.engine.states import DEFAULT_EFFECTS, load_cases
from cranktopo.engine.throw_compliance import throw_compliance
from cranktopo.tasks.density.model import build_model, case_forces
from cranktopo.tasks.density.response import compliances, solve, stiffness
from cranktopo.tasks.throw_fea.evaluation import evaluate
from cranktopo.tasks.throw_fea.targets import Target
from tests.studies.example_throws import CAR, INDUSTRIAL
from tests.studies.nominal_stress import nominal_amplitude_MPa

CELL_MM = 3.0
CASES = frozenset({"bending", "torsion", "tangential", "centrifugal"})


def scenes() -> list[Scene]:
    """The engines, each with a bearing spring and every load case wanted."""
    found = []
    for data in (
        load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True),
        load_scene("opposed-piston").model_dump(mode="json", exclude_none=True),
        CAR,
        INDUSTRIAL,
    ):
        data["supports"].setdefault("bearing_spring_N_per_mm", 1e6)
        data.setdefault("optimise", {}).setdefault("weights", {})["centrifugal"] = 0.5
        data["effects"] = {}
        for name, share in (("main_journal", 0.42), ("crankpin", 0.35)):  # bores where the engine has none
            journal = data["throw"][name]
            if not journal.get("bore_diameter_mm"):
                journal["bore_diameter_mm"] = share * journal["outer_diameter_mm"]
        found.append(scene_from_dict(data))
    return found


def solved(scene: Scene) -> tuple[dict[str, float], dict[str, float]]:
    """Strain energies (N mm) of all load cases; stiffnesses of the two main ones and volume, own web."""
    domain = build_domain(scene, CELL_MM, "web")
    cases = load_cases(scene, DEFAULT_EFFECTS | CASES)
    model = build_model(scene, domain, cases)
    solid = jnp.asarray(domain.passive_fraction)
    forces = case_forces(model, solid)
    u = solve(model, solid, forces=forces).displacements
    work = {case.name: float(c) for case, c in zip(cases, compliances(model, u, forces), strict=True)}
    rigid = {name: stiffness(model, work[name], name) for name in ("bending", "torsion")}
    rigid["volume"] = float((domain.passive_fraction * domain.volume_mm3).sum())
    return {name: value / 2 for name, value in work.items()}, rigid


def changed(scene: Scene, **tables: dict[str, Any]) -> Scene:
    """The scene with some values of its tables changed."""
    data = scene.model_dump(mode="json", exclude_none=True)
    for name, values in tables.items():
        data[name] = {**data[name], **values}
    return scene_from_dict(data)


def truths(scene: Scene) -> dict[str, float]:
    """Computed size of each effect, percent."""
    energy, rigid = solved(scene)
    dominant = max(energy["bending"], energy["torsion"])
    result = {name: 100 * value / dominant for name, value in energy.items()}
    _, sprung = solved(changed(scene, supports={"bending": "spring"}))
    result["bearing_compliance"] = 100 * (1 - sprung["bending"] / rigid["bending"])
    if scene.throw.main_journal.bore_diameter_mm or scene.throw.crankpin.bore_diameter_mm:
        _, solid = solved(strip_features(scene, "bores"))
        stiffer, heavier = (100 * (solid[key] / rigid[key] - 1) for key in ("torsion", "volume"))
        result |= {"bores": max(stiffer, heavier), "bores, torsion alone": stiffer}
    result["fillets"] = _stiffening_by_fillets(scene)
    strength = scene.material.fatigue_bending_MPa
    if strength is not None:
        result["fatigue"] = 100 * nominal_amplitude_MPa(scene) / strength
    full = _peak_radial(scene, DEFAULT_EFFECTS)
    for name in ("reciprocating_inertia", "rotating_rod_mass"):
        result[name] = 100 * abs(_peak_radial(scene, DEFAULT_EFFECTS - {name}) / full - 1)
    return result


def estimates(scene: Scene) -> dict[str, float | None]:
    """The plan's estimate of each effect, percent, and that of the bores by stiffness alone."""
    found = {effect.name: effect.estimate_percent for effect in plan(scene).effects}
    hollow, solid = (throw_compliance(s).torsion_rad_per_Nmm for s in (scene, strip_features(scene, "bores")))
    return {**found, "bores, torsion alone": 100 * (hollow / solid - 1)}


def _stiffening_by_fillets(scene: Scene) -> float:
    """What the fillets add to the stiffness by body-fitted elements, percent; the larger of the two cases."""
    sharp, rounded = (evaluate(Target(scene.name, s)) for s in (strip_features(scene, "fillets"), scene))
    bending = rounded.bending_N_per_mm / sharp.bending_N_per_mm
    return 100 * (max(bending, rounded.torsion_Nm_per_rad / sharp.torsion_Nm_per_rad) - 1)


def _peak_radial(scene: Scene, enabled: frozenset[str]) -> float:
    return next(case.radial_N for case in load_cases(scene, enabled) if case.kind == "bending")
