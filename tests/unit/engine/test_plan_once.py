"""Plan and pressure curve of a scene are computed once, whoever asks, and again where a file has changed."""

from __future__ import annotations

import os

import pytest

from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine import gas
from cranktopo.engine.analysis import at_speed
from cranktopo.engine.balance.whole_engine import engine_balance
from cranktopo.engine.histories import load_history
from cranktopo.engine.plan import planning
from cranktopo.engine.states import load_cases
from cranktopo.tasks.loads.stage import loads_at_speeds


@pytest.fixture
def computed(monkeypatch):
    """Names of what is computed, in order; nothing is remembered before or after."""
    found: list[str] = []

    def counted(module, name):
        function = getattr(module, name)

        def count(*args, **kwargs):
            found.append(name)
            return function(*args, **kwargs)

        monkeypatch.setattr(module, name, count)

    for module, name in ((gas, "fit_combustion"), (gas, "read_indicator"), (planning, "Costing")):
        counted(module, name)
    gas._curve.cache_clear()
    planning._plan.cache_clear()
    yield found
    gas._curve.cache_clear()
    planning._plan.cache_clear()


def test_one_plan_and_one_pressure_curve_serve_a_whole_run(computed):
    scene = load_scene("mikron-iiic-plain")
    enabled = planning.plan(scene).enabled
    load_cases(scene, enabled)
    loads_at_speeds(scene)
    load_history(scene, "cycle", enabled)
    engine_balance(scene)
    planning.plan(load_scene("mikron-iiic-plain"))  # an equal scene
    planning.planned_scene(scene)
    assert sorted(computed) == ["Costing", "fit_combustion"]


def test_another_speed_has_another_plan_but_the_same_pressure(computed):
    scene = load_scene("mikron-iiic-plain")
    slow, fast = (planning.plan(at_speed(scene, rpm)) for rpm in (1000.0, 2700.0))
    assert slow["centrifugal"].reason != fast["centrifugal"].reason
    assert computed.count("Costing") == 2
    assert computed.count("fit_combustion") == 1


def test_shared_curves_cannot_be_changed(computed):
    curve = gas.pressure_curve(load_scene("mikron-iiic-plain"))
    with pytest.raises(ValueError, match="read-only"):
        curve.pressure_MPa[0] = 0.0


def test_a_changed_indicator_file_is_read_again(computed, tmp_path):
    file = tmp_path / "indicator.csv"

    def peak_MPa(scale: float) -> float:
        rows = [f"{deg},{0.1 + scale * max(0.0, 1 - abs(deg - 10) / 60)}" for deg in range(720)]
        file.write_text("\n".join(["crank_angle_deg,pressure_MPa", *rows]))
        os.utime(file, ns=(1, int(scale * 1000)))
        return float(gas.pressure_curve(_with_indicator(str(file))).pressure_MPa.max())

    assert peak_MPa(4.0) == pytest.approx(4.1)
    assert peak_MPa(5.0) == pytest.approx(5.1)
    assert computed.count("read_indicator") == 2


def _with_indicator(path: str) -> Scene:
    scene = load_scene("mikron-iiic-plain")
    engine = scene.engine
    return scene.model_copy(
        update={
            "engine": engine.model_copy(update={"gas": engine.gas.model_copy(update={"indicator_csv": path})})
        }
    )
