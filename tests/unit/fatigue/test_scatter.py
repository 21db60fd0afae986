"""Probability of failure of a point: by random draws through the method's formula, and in closed form."""

from __future__ import annotations

import math
from typing import Any, cast

import numpy as np
import pytest

from cranktopo import load_scene, with_values
from cranktopo.design.schema import Scene
from cranktopo.tasks.fatigue.criteria import criterion
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.throw_fatigue import stage
from cranktopo.tasks.throw_fatigue.result import PointScatter
from cranktopo.tasks.throw_fatigue.scatter import counts_scatter, lognormal, point_scatter
from cranktopo.tasks.throw_fatigue.stress_model import StressModel
from cranktopo.tasks.throw_fea.targets import Target

AMPLITUDE, MEAN, GRADIENT = 340.0, 90.0, 0.7
LOCAL = LocalStress(*(np.array([value]) for value in (AMPLITUDE, MEAN, GRADIENT)))


class Node:
    """A model of one surface node, on the pin's fillet or off the fillets."""

    whole = False

    def __init__(self, scene: Scene, *, on_pin: bool) -> None:
        self.scene, self.on_pin, self.on_journal = scene, [on_pin], [False]


def scattered(**percent: float) -> Scene:
    return with_values(
        load_scene("mikron-iiic"), {f"fatigue.scatter.{key}": value for key, value in percent.items()}
    )


def safety_at(scene: Scene, local: LocalStress) -> float:
    return float(criterion("lsa").point_safety(scene, local).safety[0])


def scatter_of(scene: Scene, *, on_pin: bool = True) -> PointScatter:
    return point_scatter(cast(StressModel, Node(scene, on_pin=on_pin)), 0, LOCAL, safety_at)


def drawn_probability(scene: Scene, variations: list[float]) -> float:
    """The share of failures of random pins: local stress analysis as the 2011 thesis prints it."""
    draws = np.random.default_rng(7).standard_normal((3, 1_000_000))
    strength, load, radius = (
        np.exp(math.sqrt(math.log1p(v**2)) * u - math.log1p(v**2) / 2)
        for v, u in zip(variations, draws, strict=True)
    )
    material, settings = scene.material, scene.fatigue
    values: dict[str, Any] = material.model_dump()
    gradient, factor = GRADIENT / radius, load * radius**-0.5231
    tension, bending = values["fatigue_tension_MPa"], values["fatigue_bending_MPa"]
    support = 1 + (bending / tension - 1) / (2 / settings.specimen_diameter_mm) * gradient
    notch = 1 + np.sqrt(gradient) * 10 ** -(0.35 + values["yield_MPa"] / 810)
    point = tension * settings.size_factor * strength * support / notch
    return float(np.mean(AMPLITUDE * factor / point + MEAN * factor / values["ultimate_MPa"] > 1))


def test_all_three_by_random_draws() -> None:
    scene = scattered(strength_percent=10.0, load_percent=8.0, fillet_radius_mm=0.3)
    variations = [0.1, 0.08, 0.3 / scene.throw.crankpin.fillet_mm]
    found, drawn = scatter_of(scene), drawn_probability(scene, variations)
    assert 0.001 < drawn < 0.2, "enough failures to count"
    assert found.failure_probability == pytest.approx(drawn, rel=0.06)
    assert sum(found.shares.values()) == pytest.approx(1.0)
    assert min(found.shares.values()) > 0.005


def test_strength_alone_is_the_closed_form() -> None:
    """Without a mean stress the safety at the mean strength is the lognormal distance of failure."""
    scene = scattered(strength_percent=8.0)
    local = LocalStress(LOCAL.amplitude_MPa, np.zeros(1), LOCAL.gradient_per_mm)
    safety_of_mean = safety_at(scene, local) / scene.fatigue.survival_factor
    found = point_scatter(cast(StressModel, Node(scene, on_pin=True)), 0, local, safety_at)
    spread = math.log1p(0.08**2)
    assert found.reliability_index == pytest.approx(
        (math.log(safety_of_mean) - spread / 2) / math.sqrt(spread), rel=1e-6
    )
    assert found.shares == pytest.approx({"strength": 1.0, "load": 0.0, "fillet_radius": 0.0}, abs=1e-9)


def test_off_the_fillets_no_radius_counts() -> None:
    found = scatter_of(scattered(load_percent=5.0, fillet_radius_mm=0.5), on_pin=False)
    assert found.shares["fillet_radius"] == pytest.approx(0.0, abs=1e-12)
    assert found.shares["load"] > 0.1


def test_lognormal_variables_have_their_mean_and_variation() -> None:
    draws = lognormal(np.random.default_rng(2).standard_normal((400_000, 1)), np.array([0.25]))
    assert draws.mean() == pytest.approx(1.0, abs=2e-3)
    assert draws.std() == pytest.approx(0.25, abs=2e-3)


@pytest.mark.parametrize("method", ["fkm", "findley", "m53"])
def test_strengths_of_a_fixed_probability_have_no_scatter(
    method: str, caplog: pytest.LogCaptureFixture
) -> None:
    scene = scattered(load_percent=5.0)
    assert not counts_scatter(scene, method)
    caplog.set_level("INFO")
    stage._note_tables(Target("mikron", scene), method)
    assert f"fatigue.scatter has no part in method '{method}'" in caplog.text
