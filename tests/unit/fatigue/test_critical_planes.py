"""Findley and Dang Van against closed forms, sinusoids on all planes, and invariances."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from cranktopo.base.arrays import Array
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.criteria import PLANE_METHODS, criterion, safety_method
from cranktopo.tasks.fatigue.dang_van import hydrostatic_weight, mesoscopic
from cranktopo.tasks.fatigue.findley import findley, normal_weight
from cranktopo.tasks.fatigue.plane_criterion import PlaneCriterion
from cranktopo.tasks.fatigue.planes import functionals, in_plane, on_planes
from tests.unit.fatigue.stress_paths import (
    bending_torsion,
    every_plane,
    findley_by_phasors,
    random_turn,
    rotated,
    sinusoid,
    tensor,
)

RATIOS = [0.5, 1 / math.sqrt(3), 0.625, 0.9]
METHODS = list(PLANE_METHODS)


def steel(ratio: float | None = None, bending: float = 525.0) -> Scene:
    scene = load_scene("mikron-iiic-plain")
    torsion = None if ratio is None else ratio * bending
    changed = scene.material.model_copy(update={"fatigue_torsion_MPa": torsion})
    return scene.model_copy(update={"material": changed})


def equivalent(method: str, history: Array, ratio: float | None = None) -> Array:
    chosen = safety_method(method)
    assert isinstance(chosen, PlaneCriterion)
    return chosen.severity(steel(ratio), history).equivalent_MPa


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize("method", METHODS)
def test_the_strengths_themselves(method: str, ratio: float) -> None:
    """Fully reversed tension is as severe as its amplitude, torsion as its amplitude over the ratio."""
    assert equivalent(method, bending_torsion(100.0, 0.0), ratio) == pytest.approx(100.0, rel=1e-9)
    assert equivalent(method, bending_torsion(0.0, 100.0), ratio) == pytest.approx(100.0 / ratio, rel=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_without_a_torsional_strength_its_ratio_is_that_of_von_mises(method: str) -> None:
    assert equivalent(method, bending_torsion(0.0, 100.0)) == pytest.approx(100.0 * math.sqrt(3), rel=1e-9)


@pytest.mark.parametrize("ratio", RATIOS)
@pytest.mark.parametrize(("normal", "shear"), [(100.0, 30.0), (60.0, 60.0), (20.0, 90.0)])
def test_proportional_tension_and_torsion(ratio: float, normal: float, shear: float) -> None:
    """In phase k sigma / 2 + sqrt(1 + k^2) tau_max for Findley and tau_max + a sigma / 3 for Dang Van."""
    k, a, tau = normal_weight(ratio), hydrostatic_weight(ratio), math.hypot(normal / 2, shear)
    history = bending_torsion(normal, shear)
    closed = k * normal / 2 + math.sqrt(1 + k * k) * tau
    assert findley(history, k).value == pytest.approx(closed, rel=1e-9)
    grains, hydrostatic = mesoscopic(history)
    assert (grains + a * hydrostatic).max() == pytest.approx(tau + a * normal / 3, rel=1e-12)


def test_the_constants_as_published() -> None:
    """Findley: s / t = 2 / (1 + k / sqrt(1 + k^2)); Dang Van: a = 3 t / s - 3 / 2."""
    for ratio in RATIOS:
        k = normal_weight(ratio)
        assert 2 / (1 + k / math.sqrt(1 + k * k)) == pytest.approx(1 / ratio, rel=1e-12)
    assert hydrostatic_weight(0.625) == pytest.approx(3 * 0.625 - 1.5)


@pytest.mark.parametrize("mean", [0.0, 80.0])
def test_uniaxial_mean_stress_costs_what_the_constants_say(mean: float) -> None:
    """Findley's plane turns with the mean stress; by Dang Van the mean counts by a / 3."""
    ratio, amplitude = 0.625, 100.0
    history = sinusoid([amplitude, 0, 0, 0, 0, 0], [mean, 0, 0, 0, 0, 0])
    k, top = normal_weight(ratio), amplitude + mean
    closed = (k * top + math.hypot(k * top, amplitude)) / 2
    assert findley(history, k).value == pytest.approx(closed, rel=1e-9)
    by_grains = (amplitude / 2 + hydrostatic_weight(ratio) * top / 3) / ratio
    assert equivalent("dang_van", history, ratio) == pytest.approx(by_grains, rel=1e-12)


@pytest.mark.parametrize("lag", [30.0, pytest.param(60.0, marks=pytest.mark.slow), 90.0])
@pytest.mark.parametrize(("normal", "shear"), [(258.0, 129.0), (150.2, 181.7), (304.5, 63.9)])
def test_findley_out_of_phase_is_the_largest_of_all_planes_at_a_quarter_degree(
    normal: float, shear: float, lag: float
) -> None:
    k = normal_weight(0.625)
    phasors = [normal, 0, 0, shear * np.exp(-1j * np.radians(lag)), 0, 0]
    brute = findley_by_phasors(phasors, [0.0] * 6, k, every_plane(0.25)).max()
    found = findley(bending_torsion(normal, shear, lag, step_deg=0.25), k).value[0]
    assert brute * (1 - 1e-5) <= found <= brute * (1 + 1e-4)


def test_findley_of_random_sinusoids_is_the_largest_of_all_planes() -> None:
    """All six components with phases of their own and means, so that several planes come near the worst."""
    rng, planes = np.random.default_rng(3), every_plane(1.0)
    for _ in range(12):
        phasors = rng.normal(size=6) + 1j * rng.normal(size=6)
        mean, k = rng.normal(size=6), float(rng.uniform(0.0, 1.0))
        brute = findley_by_phasors(list(phasors), list(mean), k, planes).max()
        found = findley(sinusoid(list(phasors), list(mean), step_deg=0.5), k)
        assert brute * (1 - 2e-5) <= found.value[0] <= brute * (1 + 1e-3)
        there = findley_by_phasors(list(phasors), list(mean), k, found.normal)[0]
        assert found.value[0] == pytest.approx(there, rel=2e-5)


@pytest.mark.parametrize("lag", [0.0, 30.0, 60.0, 90.0])
def test_dang_van_out_of_phase(lag: float) -> None:
    """Fully reversed, the grains settle about zero: the largest shear stress is that of the stress itself."""
    normal, shear, a = 258.0, 129.0, hydrostatic_weight(0.625)
    grains, hydrostatic = mesoscopic(bending_torsion(normal, shear, lag))
    turn = np.linspace(0.0, 2 * np.pi, 3601)
    s, t = normal * np.cos(turn), shear * np.cos(turn - np.radians(lag))
    closed = (np.hypot(s / 2, t) + a * s / 3).max()
    assert (grains + a * hydrostatic).max() == pytest.approx(closed, rel=2e-4)


def test_mean_shear_counts_by_findley_and_not_by_dang_van() -> None:
    plain, twisted = (sinusoid([0, 0, 0, 100.0, 0, 0], [0, 0, 0, m, 0, 0]) for m in (0.0, 50.0))
    assert equivalent("dang_van", twisted) == pytest.approx(equivalent("dang_van", plain), rel=1e-9)
    assert equivalent("findley", twisted)[0] > 1.01 * equivalent("findley", plain)[0]


def test_stress_on_a_plane_is_the_tensors() -> None:
    rng = np.random.default_rng(1)
    normals = rng.normal(size=(7, 3))
    normals /= np.linalg.norm(normals, axis=1, keepdims=True)
    stress = rng.normal(size=6)
    traction = normals @ tensor(stress)
    first, second = in_plane(normals)
    expected = np.stack([(traction * one).sum(axis=1) for one in (normals, first, second)], axis=1)
    assert functionals(normals) @ stress == pytest.approx(expected, abs=1e-14)
    normal, shear = on_planes(stress[None, None], normals)
    assert normal[0, :, 0] ** 2 + (shear[0, :, 0] ** 2).sum(axis=1) == pytest.approx(
        (traction**2).sum(axis=1)
    )


def histories(count: int = 6) -> Array:
    """Random paths of 40 states of some points."""
    return np.random.default_rng(11).normal(size=(count, 40, 6))


@pytest.mark.parametrize(("method", "close"), [("findley", 1e-6), ("dang_van", 1e-12)])
def test_the_frame_does_not_count(method: str, close: float) -> None:
    """Exact for tensors; the search for a plane stops at steps of 0.00003 degrees."""
    history = histories()
    turned = rotated(history, random_turn(np.random.default_rng(2)))
    assert equivalent(method, turned) == pytest.approx(equivalent(method, history), rel=close)


def test_a_plane_that_turns_with_the_stress_has_the_same_value() -> None:
    history, turn = histories(), random_turn(np.random.default_rng(5))
    worst = findley(history, 0.3)
    normal, shear = on_planes(history, worst.normal[:, None])
    there, sheared = on_planes(rotated(history, turn), worst.normal[:, None] @ turn.T)
    assert there == pytest.approx(normal, abs=1e-12)
    assert (sheared**2).sum(axis=-1) == pytest.approx((shear**2).sum(axis=-1), abs=1e-12)


@pytest.mark.parametrize(
    "changed",
    [lambda h: h[:, ::-1], lambda h: np.concatenate([h, h[:, :7]], axis=1), lambda h: np.roll(h, 9, axis=1)],
    ids=["reversed", "repeated", "begun later"],
)
@pytest.mark.parametrize("method", METHODS)
def test_order_and_repetition_of_states_do_not_count(method: str, changed: Callable[[Array], Array]) -> None:
    history = histories()
    assert equivalent(method, changed(history)) == pytest.approx(equivalent(method, history), rel=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_twice_the_stress_is_twice_as_severe(method: str) -> None:
    history = histories()
    assert equivalent(method, 2 * history) == pytest.approx(2 * equivalent(method, history), rel=1e-9)
    assert equivalent(method, 0 * history) == pytest.approx(0.0, abs=1e-9)


@pytest.mark.parametrize("method", METHODS)
def test_the_diagram_holds_the_severity(method: str) -> None:
    chosen = safety_method(method)
    assert isinstance(chosen, PlaneCriterion)
    (history,), scene = histories(1), steel(0.6)
    (value,), strength = equivalent(method, history[None], 0.6), 3.0
    drawn = chosen.diagram(scene, history, strength)
    at_once = (drawn.shear_MPa + drawn.slope * drawn.normal_MPa).max()
    apart = drawn.shear_MPa.max() + drawn.slope * drawn.normal_MPa.max()
    used = (apart if method == "findley" else at_once) / drawn.limit_MPa
    assert used == pytest.approx(value / strength, rel=1e-9)


@pytest.mark.parametrize("ratio", [0.45, 1.0])
@pytest.mark.parametrize("method", METHODS)
def test_a_ratio_beyond_the_criteria_is_refused(method: str, ratio: float) -> None:
    with pytest.raises(CranktopoError, match=r"fatigue_torsion_MPa = .*262\.5 to 525 MPa"):
        safety_method(method).check(steel(ratio))
    safety_method(method).check(steel(0.5))


@pytest.mark.parametrize("method", [*METHODS, "m53"])
def test_what_needs_a_local_stress_refuses_the_other_methods(method: str) -> None:
    with pytest.raises(CranktopoError, match=f"method '{method}' does not judge amplitude and mean"):
        criterion(method)


@pytest.mark.parametrize("method", METHODS)
def test_fillets_hardened_over_their_depth_are_refused(method: str) -> None:
    hardened = {"process": "nitrided", "case_depth_mm": 0.4, "surface_hardness_HV": 700.0}
    scene = with_values("mikron-iiic", {"fatigue.hardening": hardened})
    with pytest.raises(CranktopoError, match="look at the surface alone"):
        safety_method(method).check(scene)
