"""Over the cycle every throw is judged by its own states: no throw passes through those of another one."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
import pytest

from cranktopo.design.loading import load_scene
from cranktopo.design.schema import Scene
from cranktopo.engine.analysis import at_speed
from cranktopo.engine.histories import (
    HistoryKind,
    LoadHistory,
    load_history,
    radial_amplitude_N,
    rated_histories,
)
from cranktopo.engine.judged_histories import histories_of
from cranktopo.tasks.throw_fatigue.needs import load_kinds
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField, safety_field, unit_loads
from cranktopo.tasks.throw_fatigue.target_safety import fatigue_field, least_field
from cranktopo.tasks.throw_fatigue.text import field_remarks
from cranktopo.tasks.throw_fea.targets import Target

SCENE = load_scene("mikron-iiic-plain")
ENABLED = load_kinds(SCENE, "cycle")[0]


@pytest.fixture(scope="module", autouse=True)
def every_ten_degrees() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("cranktopo.engine.histories._STEP_DEG", 10.0)
        yield


@pytest.fixture(scope="module")
def field(every_ten_degrees: None) -> FatigueField:
    return fatigue_field(Target("mikron", SCENE), "lsa", "cycle", fillet_fraction=1.0)


def test_histories_of_the_cycle_are_those_of_the_throws() -> None:
    parts, joined = rated_histories(SCENE, "cycle", ENABLED), load_history(SCENE, "cycle", ENABLED)
    assert len(parts) == 4
    assert [len(part.labels) for part in parts] == [72] * 4
    np.testing.assert_array_equal(np.concatenate([part.torque_Nm for part in parts]), joined.torque_Nm)
    for number, part in enumerate(parts, start=1):
        assert all(label.startswith(f"throw {number}, ") for label in part.labels)
    (extremes,) = rated_histories(SCENE, "extremes", ENABLED)
    assert len(extremes.labels) == 4


@pytest.mark.parametrize("kind", ["extremes", "cycle"])
def test_the_overspeed_is_judged_as_the_speed_of_an_engine_is(kind: HistoryKind) -> None:
    """The same as an engine that runs at 2800 rpm, beside one that runs at 2100, and neither for the rule."""
    rated, fast = (at_speed(_without_overspeed(SCENE), rpm) for rpm in (2100.0, 2800.0))
    expected = [*histories_of(rated, kind, ENABLED), *histories_of(fast, kind, ENABLED)]
    found = histories_of(SCENE, kind, ENABLED)
    assert len(found) == len(expected) == {"extremes": 2, "cycle": 8}[kind]
    for one, other in zip(found, expected, strict=True):
        _same_loads(one, other)
    assert all(label.endswith(", 2800 rpm") for label in found[-1].labels)
    assert len(rated_histories(SCENE, kind, ENABLED)) == len(expected) / 2
    assert radial_amplitude_N(SCENE, kind, ENABLED) == radial_amplitude_N(rated, kind, ENABLED)


def test_the_overspeed_decides_where_masses_pull_more_than_the_gas(field: FatigueField) -> None:
    """At 9000 rpm the Mikron's pistons pull with 55 kN: unit stresses are those of any speed."""
    fast = at_speed(SCENE, 2100.0)
    assert fast.engine is not None
    fast = fast.model_copy(update={"engine": fast.engine.model_copy(update={"overspeed_rpm": 9000.0})})
    parts = [safety_field(field.model, "lsa", one) for one in histories_of(fast, "extremes", ENABLED)]
    assert parts[1].critical.safety < 0.7 * parts[0].critical.safety
    judged = least_field(parts)
    assert judged.critical.safety == parts[1].critical.safety
    told = replace(judged, model=replace(judged.model, scene=fast))
    assert "the least safety is that at the overspeed of 9000 rpm" in " ".join(field_remarks([told]))
    assert not any("overspeed" in line for line in field_remarks([replace(told, critical=parts[0].critical)]))


def _without_overspeed(scene: Scene) -> Scene:
    assert scene.engine is not None
    return scene.model_copy(update={"engine": scene.engine.model_copy(update={"overspeed_rpm": None})})


def _same_loads(one: LoadHistory, other: LoadHistory) -> None:
    for name in ("radial_N", "tangential_N", "torque_Nm", "angular_speed_rad_s"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def signed_MPa(stress: np.ndarray) -> np.ndarray:
    """Signed von Mises stress from all six components, (states, nodes, 6)."""
    x, y, z, yz, xz, xy = np.moveaxis(stress, -1, 0)
    squared = ((x - y) ** 2 + (y - z) ** 2 + (z - x) ** 2) / 2 + 3 * (yz**2 + xz**2 + xy**2)
    return np.copysign(np.sqrt(squared), x + y + z)


def test_amplitudes_are_those_of_one_throw(field: FatigueField) -> None:
    """Of nodes of both fillets, against every state of every throw by the components of the stress."""
    model, nodes = field.model, np.flatnonzero(field.model.on_fillet)[::40]
    ranges = []
    for part in histories_of(SCENE, "cycle", ENABLED):
        loads = unit_loads(part, model.kinds) * model.images[0].signs
        signed = signed_MPa(np.einsum("sf,fnc->snc", loads, model.stress.stress_MPa[:, nodes]))
        ranges.append((np.ptp(signed, axis=0) / 2, (signed.max(axis=0) + signed.min(axis=0)) / 2))
    amplitudes = np.array([amplitude for amplitude, _ in ranges])
    told = field.amplitude_MPa[0, nodes]
    assert np.abs(amplitudes - told).min(axis=0) == pytest.approx(0.0, abs=1e-9 * told.max())
    assert np.ptp(amplitudes, axis=0).max() > 0.02 * told.max(), "throws differ"


def test_the_least_safety_of_every_place_over_the_throws(field: FatigueField) -> None:
    parts = [safety_field(field.model, "lsa", one) for one in histories_of(SCENE, "cycle", ENABLED)]
    np.testing.assert_array_equal(field.safety, np.min([part.safety for part in parts], axis=0))
    assert field.critical == min((part.critical for part in parts), key=lambda point: point.safety)
    for fillet, least in field.fillet_safety.items():
        assert least == min(part.fillet_safety[fillet] for part in parts)
        nodes = {"pin": field.model.on_pin, "journal": field.model.on_journal}[fillet]
        assert least == field.safety[:, nodes].min()
    joined = safety_field(field.model, "lsa", load_history(SCENE, "cycle", ENABLED))
    assert joined.critical.safety < field.critical.safety < 1.1 * joined.critical.safety
    thrown = {label.partition(",")[0] for label in field.critical.states}
    assert len(thrown) == 1, "both ends of the range are of one throw"
