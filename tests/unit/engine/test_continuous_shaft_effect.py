"""The effect `continuous_shaft`: its estimate as a beam, when it is on, and that off it costs nothing."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.continuous_beam import _web_moments, span_bending
from cranktopo.engine.plan.planning import left_off, plan, plan_for_stress
from cranktopo.tasks.fatigue import stage
from cranktopo.tasks.fatigue.stage import assess_by_methods
from cranktopo.tasks.fea.targets import Target, resolve_target

EI, SPAN_MM, ARM_MM, FORCE_N = 4e10, 90.0, 20.0, 1e4


def on_springs(name: str, spring: float | None, **effects: Any) -> Scene:
    """A built-in design on other main bearings, rigid ones without a spring."""
    data = load_scene(name).model_dump(mode="json", exclude_none=True)
    for key in ("bearing_spring_N_per_mm", "roller_bearing", "bearing_clearance_mm"):
        data["supports"].pop(key, None)
    if spring is not None:
        data["supports"]["bearing_spring_N_per_mm"] = spring
    else:
        data["supports"] |= {"torsion": "free", "bending": "pinned"}
    data["effects"] |= effects
    return scene_from_dict(data)


def test_two_spans_by_the_book() -> None:
    """Equal forces in the middle of both: 5/16 at the outer bearings, -3/16 of force times span between."""
    force = np.full((2, 1), 1j * FORCE_N)
    found = _web_moments(EI, SPAN_MM, [ARM_MM] * 2, force, None, (0, 1, 2))[:, :, 0].imag
    outer = 5 / 16 * FORCE_N * ARM_MM
    inner = 11 / 16 * FORCE_N * ARM_MM - 3 / 16 * FORCE_N * SPAN_MM
    assert np.abs(found) == pytest.approx(np.abs([[outer, inner], [inner, outer]]), rel=1e-9)
    soft = _web_moments(EI, SPAN_MM, [ARM_MM] * 2, force, 1e-3, (0, 1, 2))[:, :, 0].imag
    third = 2 / 3 * FORCE_N * ARM_MM  # a stiff beam on soft springs: a third of both forces each
    assert np.abs(soft[[0, 1], [0, 1]]) == pytest.approx(third, rel=1e-3)


@pytest.mark.parametrize(
    ("name", "spring", "least", "largest"),
    [
        ("mikron-iiic", None, 0.54, 0.79),
        ("mikron-iiic", 3e5, 0.56, 0.85),
        ("car-diesel", None, 0.56, 0.80),
        ("car-diesel", 3e5, 0.82, 1.03),
        ("industrial-gas", 3e6, 0.42, 0.84),
        ("industrial-gas", 3e5, 0.88, 1.22),
    ],
)
def test_estimate_agrees_with_elements(name: str, spring: float | None, least: float, largest: float) -> None:
    """The table of `python -m tests.studies.continuous_shafts`: condensed throws on the same bearings."""
    found = span_bending(on_springs(name, spring))
    assert found.largest == pytest.approx(largest, abs=0.035)
    assert found.least == pytest.approx(least, abs=0.1)


@pytest.mark.parametrize("name", ["mikron-iiic", "car-diesel", "industrial-gas", "mikron-iiic-crank"])
def test_built_in_engines_stand_on_bearings_where_a_throw_alone_is_safe(name: str) -> None:
    effect = plan(load_scene(name))["continuous_shaft"]
    assert effect.state == "off"
    assert "a throw alone is on the safe side" in effect.reason
    assert effect.estimate_percent is not None
    assert -25 < effect.estimate_percent < -10
    assert effect.changes.startswith("bending of the worst web +")


def test_soft_bearings_switch_it_on() -> None:
    """On them a web bends more than in a throw alone; left out in spite of that, it is told."""
    soft = on_springs("industrial-gas", 3e5)
    effect = plan(soft)["continuous_shaft"]
    assert effect.state == "on"
    assert effect.estimate_percent == pytest.approx(25, abs=3)
    off = on_springs("industrial-gas", 3e5, continuous_shaft="off")
    assert f"continuous_shaft {effect.estimate_percent:.1f} %" in left_off(off, plan(off))


@pytest.mark.parametrize(
    ("name", "why"), [("opposed-piston", r"\[engine.gas\]"), ("one", "one throw between two bearings")]
)
def test_it_needs_a_shaft_and_its_forces(name: str, why: str) -> None:
    data = load_scene("mikron-iiic-plain" if name == "one" else name).model_dump(
        mode="json", exclude_none=True
    )
    if name == "one":
        data["engine"] |= {"cylinders": 1, "firing_order": [1]}
    assert plan(scene_from_dict(data))["continuous_shaft"].state == "off"
    data.setdefault("effects", {})["continuous_shaft"] = "on"
    with pytest.raises(CranktopoError, match=why):
        plan(scene_from_dict(data))


@pytest.mark.parametrize(("choice", "called"), [("auto", "alone"), ("off", "alone"), ("on", "shaft")])
def test_off_costs_nothing(choice: str, called: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Which of both works is begun; the other does nothing."""

    class BegunError(Exception):
        pass

    def begun(which: str) -> Any:
        def work(*_: Any) -> None:
            raise BegunError(which)

        return work

    monkeypatch.setattr(stage, "worst_throw", begun("shaft"))
    monkeypatch.setattr(stage, "fatigue_fields", begun("alone"))
    target = resolve_target(on_springs("mikron-iiic", None, continuous_shaft=choice), fillets=True)
    with pytest.raises(BegunError, match=called):
        assess_by_methods([target], ("lsa",))


@pytest.mark.parametrize(("state", "told"), [("auto", 0.9), ("on", 1.1)])
def test_where_the_plan_switches_it_on_the_lower_safety_is_told(
    state: str, told: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The cycle on all bearings may be milder than the extreme states of a throw alone."""
    scene = on_springs("industrial-gas", 3e5, continuous_shaft=state)
    assert "continuous_shaft" in plan_for_stress(scene).enabled
    alone, shaft = (SimpleNamespace(method="lsa", critical=SimpleNamespace(safety=s)) for s in (0.9, 1.1))
    monkeypatch.setattr(stage, "fatigue_fields", lambda *_: (alone,))
    monkeypatch.setattr(stage, "worst_throw", lambda *_: (shaft,))
    (found,) = stage._fields(Target(scene.name, scene), ("lsa",), "extremes", 0.25)
    assert found.critical.safety == told
