"""The effect `continuous_shaft`: its estimate as a beam, when it is on, and that off it costs nothing."""

from __future__ import annotations

from dataclasses import dataclass, field
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.continuous_beam import PinLoads, Spans, bend_spans, span_bending
from cranktopo.engine.plan.planning import left_off, plan, plan_for_stress
from cranktopo.tasks.compare import judged
from cranktopo.tasks.compare.judged import judge
from cranktopo.tasks.throw_fatigue import stage
from cranktopo.tasks.throw_fatigue.result import FatigueResult, FieldFatigue, JudgedAs
from cranktopo.tasks.throw_fatigue.stage import assess_by_methods
from cranktopo.tasks.throw_fatigue.text import FatigueComparison
from cranktopo.tasks.throw_fea.targets import Target, resolve_target
from tests.engine_arrangements import VEE, arranged

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
    none = np.zeros((2, 1), dtype=complex)
    loads = PinLoads(np.full((2, 1), 1j * FORCE_N), none, none)
    spans = Spans(EI, SPAN_MM, [ARM_MM] * 2)
    moments, reactions = bend_spans(spans, loads, dict.fromkeys((0, 1, 2)))
    outer = 5 / 16 * FORCE_N * ARM_MM
    inner = 11 / 16 * FORCE_N * ARM_MM - 3 / 16 * FORCE_N * SPAN_MM
    assert np.abs(moments[:, :, 0].imag) == pytest.approx(np.abs([[outer, inner], [inner, outer]]), rel=1e-9)
    assert -reactions[:, 0].imag / FORCE_N == pytest.approx([5 / 16, 22 / 16, 5 / 16], rel=1e-9)
    turning = PinLoads(none, none, loads.force_N)  # steady: in the reactions as any other force
    assert bend_spans(spans, turning, dict.fromkeys((0, 1, 2)))[1] == pytest.approx(reactions, rel=1e-9)
    soft = bend_spans(spans, loads, dict.fromkeys((0, 1, 2), 1e-3))[0][:, :, 0].imag
    third = 2 / 3 * FORCE_N * ARM_MM  # a stiff beam on soft springs: a third of both forces each
    assert np.abs(soft[[0, 1], [0, 1]]) == pytest.approx(third, rel=1e-3)


def test_a_couple_on_one_span_by_the_book() -> None:
    """Two rods on a pin with opposite forces: couple over span at both ends, and a step at the pin."""
    none = np.zeros((1, 1), dtype=complex)
    couple_Nmm = 15.0 * FORCE_N
    loads = PinLoads(none, none + 1j * couple_Nmm, none)
    moments, reactions = bend_spans(Spans(EI, SPAN_MM, [ARM_MM] * 2), loads, dict.fromkeys((0, 1)))
    assert np.abs(reactions[:, 0].imag) == pytest.approx([couple_Nmm / SPAN_MM] * 2, rel=1e-9)
    assert reactions.sum() == pytest.approx(0.0, abs=1e-6)
    assert np.abs(moments[0, :, 0].imag) == pytest.approx([couple_Nmm * ARM_MM / SPAN_MM] * 2, rel=1e-9)
    assert moments[0].sum() == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize(
    ("name", "spring", "least", "largest"),
    [
        ("mikron-iiic", None, 0.54, 0.79),
        ("mikron-iiic", 3e5, 0.56, 0.84),
        ("car-diesel", None, 0.56, 0.80),
        ("car-diesel", 3e5, 0.82, 1.03),
        ("industrial-gas", 3e6, 0.42, 0.84),
        ("industrial-gas", 3e5, 0.88, 1.23),
    ],
)
def test_estimate_agrees_with_elements(name: str, spring: float | None, least: float, largest: float) -> None:
    """The table of `python -m tests.studies.continuous_shafts`: condensed throws on the same bearings."""
    found = span_bending(on_springs(name, spring))
    assert found.largest == pytest.approx(largest, abs=0.035)
    assert found.least == pytest.approx(least, abs=0.1)


@pytest.mark.parametrize(
    ("arrangement", "cylinders", "order", "least", "largest"),
    [
        ("layout = 'in-line'", 3, (1, 3, 2), 0.37, 0.80),
        ("layout = 'boxer'", 4, (1, 3, 2, 4), 0.51, 0.78),
        (f"{VEE}throw_angles_deg = [0.0, 90.0, 270.0, 180.0]", 8, (1, 5, 4, 8, 6, 3, 7, 2), 0.42, 0.89),
    ],
)
def test_estimate_agrees_with_elements_in_other_engines(
    arrangement: str, cylinders: int, order: tuple[int, ...], least: float, largest: float
) -> None:
    """Of the same study: two rods on a pin load it aside of its middle, and each throw in its own way."""
    found = span_bending(arranged(arrangement, cylinders, order))
    assert found.largest == pytest.approx(largest, abs=0.045)
    assert found.least == pytest.approx(least, abs=0.06)


def test_two_throws_between_bearings_bend_each_other() -> None:
    """Of the same study: a throw alone is far from the safe side, in its bearings too."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    found = span_bending(scene_from_dict({**data, "crank": {"bearings": [0, 2, 4]}}))
    assert (found.least, found.largest) == pytest.approx((1.61, 2.87), abs=0.02)
    assert (found.bearing, found.bearing_share) == (3, pytest.approx(1.74, abs=0.02))


@pytest.mark.parametrize(
    ("name", "share"), [("mikron-iiic", 1.45), ("car-diesel", 1.50), ("industrial-gas", 1.48)]
)
def test_estimate_of_the_bearing_agrees_with_elements(name: str, share: float) -> None:
    """Largest force of the same study over that of throws alone: 25.5 over 17.6 kN and so on."""
    found = span_bending(on_springs(name, None))
    assert found.bearing == 2
    assert found.bearing_share == pytest.approx(share, rel=0.13)


@pytest.mark.parametrize("name", ["mikron-iiic", "car-diesel", "industrial-gas", "mikron-iiic-crank"])
def test_built_in_engines_stand_on_bearings_where_a_throw_alone_is_safe(name: str) -> None:
    effect = plan(load_scene(name))["continuous_shaft"]
    assert effect.state == "off"
    assert effect.reason.startswith("a throw alone is on the safe side; bending of the webs 0.")
    assert "threshold" not in effect.reason
    assert effect.estimate_percent is not None
    assert -25 < effect.estimate_percent < -10
    assert effect.changes.startswith("bending of the worst web +")
    assert "largest force on a main bearing (no. 2) -" in effect.changes


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


@dataclass(frozen=True)
class ToldField:
    """A field of which the least safety alone is known."""

    safety: float
    method: str = "lsa"
    safety_as: dict[str, float] = field(default_factory=dict)

    @property
    def critical(self) -> SimpleNamespace:
        return SimpleNamespace(safety=self.safety)


ALONE, SHAFT = ToldField(0.9), ToldField(1.1)
BOTH = {"throw_alone": 0.9, "continuous_shaft": 1.1}


@pytest.mark.parametrize(
    ("state", "both_worlds", "told", "safety_as"),
    [
        ("auto", False, 0.9, BOTH),
        ("auto", True, 0.9, BOTH),
        ("on", False, 1.1, {}),
        ("on", True, 1.1, BOTH),
        ("off", True, 0.9, {}),
    ],
)
def test_where_the_plan_switches_it_on_the_lower_safety_is_told(
    state: str, both_worlds: bool, told: float, safety_as: dict[str, float], monkeypatch: pytest.MonkeyPatch
) -> None:
    """The cycle on all bearings may be milder than the extremes of a throw alone; `compare` has both."""
    scene = on_springs("industrial-gas", 3e5, continuous_shaft=state)
    assert ("continuous_shaft" in plan_for_stress(scene).enabled) == (state != "off")
    solved: list[str] = []

    def solve(name: str, found: ToldField) -> Any:
        return lambda *_: solved.append(name) or (found,)

    monkeypatch.setattr(stage, "fatigue_fields", solve("alone", ALONE))
    monkeypatch.setattr(stage, "worst_throw", solve("shaft", SHAFT))
    target = Target(scene.name, scene)
    (found,) = stage._fields(target, ("lsa",), "extremes", 0.25, both_worlds=both_worlds)
    assert found.critical.safety == told
    assert found.safety_as == safety_as
    assert solved == {"off": ["alone"], "auto": ["shaft", "alone"]}.get(
        state, ["shaft", "alone"] if both_worlds else ["shaft"]
    )


def test_compare_asks_for_both_worlds(monkeypatch: pytest.MonkeyPatch) -> None:
    """Off it begins nothing else; on it has the throw alone too."""
    begun: list[str] = []

    def solve(name: str) -> Any:
        def work(*_: Any) -> Any:
            begun.append(name)
            raise CranktopoError(name)

        return work

    monkeypatch.setattr(stage, "fatigue_fields", solve("alone"))
    monkeypatch.setattr(stage, "worst_throw", lambda *_: (begun.append("shaft"), (SHAFT,))[1])
    for choice, expected in (("off", ["alone"]), ("auto", ["alone"]), ("on", ["shaft", "alone"])):
        begun.clear()
        scene = on_springs("mikron-iiic", None, continuous_shaft=choice)
        with pytest.raises(CranktopoError, match="alone"):
            judge([resolve_target(scene, fillets=True)], ["lsa"], 0, "extremes")
        assert begun == expected


@pytest.mark.parametrize(
    ("name", "judged_as", "safety_as", "told"),
    [
        ("mikron-iiic", "throw_alone", None, True),
        ("mikron-iiic", "throw_alone", BOTH, False),
        ("mikron-iiic", "continuous_shaft", None, False),
        ("opposed-piston", "throw_alone", None, False),
    ],
)
def test_compare_says_where_it_knows_a_throw_alone_only(
    name: str,
    judged_as: JudgedAs,
    safety_as: dict[str, float] | None,
    told: bool,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A web that kept its safety as a throw alone had lost 14 % in its shaft."""
    one = FieldFatigue.model_construct(target=name, judged_as=judged_as, safety_as=safety_as)
    result = FatigueResult.model_construct(fatigue=(one,))
    found = FatigueComparison((1.0,), (), result, summaries=(None,))
    assessed = SimpleNamespace(method="lsa", baseline=None, compared=lambda: found)
    monkeypatch.setattr(judged, "assess_by_methods", lambda *_, **__: [assessed])
    (compared,), _ = judge([resolve_target(name, fillets=True)], ["lsa"], 0, "extremes")
    assert [line for line in compared.verdicts if "continuous_shaft = 'on'" in line] == (
        [
            "Safety is that of a throw alone. A web that is as safe there can be less safe in its shaft: "
            "effects.continuous_shaft = 'on' in the designs tells both."
        ]
        if told
        else []
    )
