"""The registry of fatigue criteria: its names, and criteria of planes against each other."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from cranktopo import with_values
from cranktopo.base.arrays import Array
from cranktopo.design.schema import Scene
from cranktopo.engine.histories import LoadHistory, load_history
from cranktopo.tasks.fatigue.criteria import METHODS, safety_method
from cranktopo.tasks.fatigue.lsa import lsa_strength, point_strength_MPa
from cranktopo.tasks.fatigue.plane_criterion import HistoryBounds, PlaneCriterion, PlaneDiagram, Severity
from cranktopo.tasks.fatigue.plane_field import histories
from cranktopo.tasks.fatigue.superposition import signed_von_mises_range
from cranktopo.tasks.throw_fatigue.needs import load_kinds
from cranktopo.tasks.throw_fatigue.picture import save_fatigue_picture
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField, safety_field, unit_loads
from cranktopo.tasks.throw_fatigue.spectrum import speed_histories
from cranktopo.tasks.throw_fatigue.stage import assess_by_methods
from cranktopo.tasks.throw_fatigue.target_safety import with_lives
from cranktopo.tasks.throw_fea.targets import resolve_targets


def test_the_registry_names_every_method_as_it_names_itself() -> None:
    assert list(METHODS) == ["lsa", "fkm", "m53", "findley", "dang_van"]
    assert [safety_method(name).name for name in METHODS] == list(METHODS)


def all_tensors(scene: Scene, history: Array) -> Severity:
    range_MPa = np.ptp(history[..., 0], axis=1)
    return Severity(range_MPa / 2, np.ones_like(range_MPa), {"share": 0.4 * np.ones_like(range_MPa)})


def axial_at_most(scene: Scene, bounds: HistoryBounds) -> Array:
    return 3 * bounds.shear_MPa


def axial_path(scene: Scene, history: Array, strength_MPa: float) -> PlaneDiagram:
    return PlaneDiagram("stress along x", history[:, 0], history[:, 0] * 0, 0.0, strength_MPa)


AXIAL = PlaneCriterion(
    "axial",
    ("fatigue_tension_MPa",),
    all_tensors,
    axial_at_most,
    axial_path,
    "normal stress",
    includes="stress along x",
)


@pytest.mark.slow
def test_criteria_of_planes_find_the_least_safety_of_all_points(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    """On one model: a criterion of its own is a line of the registry, and the built-in ones agree."""
    monkeypatch.setitem(METHODS, "axial", f"{__name__}:AXIAL")
    targets = resolve_targets(["mikron-iiic-plain"], fillets=True, whole=True)
    found = assess_by_methods(targets, ["lsa", "findley", "dang_van"], fillet_fraction=0.8)
    lsa, findley, dang_van = (one.fields[0] for one in found)
    model, scene = lsa.model, lsa.model.scene
    history = load_history(scene, "extremes", load_kinds(scene, "extremes")[0])
    own = safety_field(model, "axial", history)
    assert own.critical.factors["share"] == 0.4
    for field in (findley, dang_van):
        critical = field.critical
        assert critical.safety == pytest.approx(min(field.fillet_safety.values()), rel=1e-9)
        assert critical.strength_MPa == pytest.approx(lsa.critical.strength_MPa, rel=0.05)
        assert 1.0 < critical.safety / lsa.critical.safety < 1.15
        assert critical.decided_by == "amplitude"
    _least_of_a_part(findley, history)
    _scatter_follows_the_safety(lsa, history)
    _lives_follow_the_safety(lsa, history)
    save_fatigue_picture(tmp_path / "planes.png", findley)
    assert (tmp_path / "planes.png").stat().st_size > 20_000


def _scatter_follows_the_safety(field: FatigueField, history: LoadHistory) -> None:
    scene = with_values(field.model.scene, {"fatigue.scatter.load_percent": 5.0})
    scatter = safety_field(replace(field.model, scene=scene), field.method, history).scatter
    assert set(scatter) == {"pin", "journal", "elsewhere"}
    by_safety = sorted(field.fillet_safety, key=lambda name: field.fillet_safety[name])
    assert scatter[by_safety[0]].failure_probability > scatter[by_safety[1]].failure_probability > 0
    assert field.scatter == {}


def _lives_follow_the_safety(field: FatigueField, history: LoadHistory) -> None:
    """A throw that does not endure: the fillet of less safety lives shorter."""
    weak = {"fatigue.survival_factor": 0.45, "fatigue.spectrum.step": [{"rpm": 1000.0, "share": 1.0}]}
    scene = with_values(field.model.scene, weak)
    speeds = speed_histories(scene, load_kinds(scene, "extremes")[0])
    found = with_lives(safety_field(replace(field.model, scene=scene), "lsa", history), speeds)
    order = sorted(found.fillet_safety, key=lambda name: found.fillet_safety[name])
    assert found.fillet_safety[order[0]] < 0.9
    shortest = found.lives[order[0]].life_hours
    assert shortest is not None
    assert shortest == min(one.life_hours or shortest for one in found.lives.values())
    assert found.lives[order[0]].damage_shares == {"1000": pytest.approx(1.0)}
    assert field.lives == {}


def _least_of_a_part(field: FatigueField, history: LoadHistory) -> None:
    """Judge by every plane what the bounds had left out: the points of the pin fillet next to the worst."""
    chosen, model = safety_method(field.method), field.model
    assert isinstance(chosen, PlaneCriterion)
    image = int(field.safety[:, model.on_pin].min(axis=1).argmin())
    nodes = np.flatnonzero(model.on_pin)
    nodes = nodes[field.safety[image, nodes].argsort()[:150]]
    loads = unit_loads(history, model.kinds) * model.images[image].signs
    path = histories(model.stress.stress_MPa[:, nodes], loads)
    gradient = signed_von_mises_range(model.stress, loads).local.gradient_per_mm[nodes]
    strength = point_strength_MPa(gradient, lsa_strength(model.scene))[0]
    safety = strength / chosen.severity(model.scene, path).equivalent_MPa
    assert safety.min() == pytest.approx(field.fillet_safety["pin"], rel=1e-9)
    assert (field.safety[image, nodes] <= safety * (1 + 1e-9)).all()
