"""Over the cycle every throw is judged by its own states: no throw passes through those of another one."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest

from cranktopo.design.loading import load_scene
from cranktopo.engine.histories import histories_of, load_history
from cranktopo.tasks.fatigue.needs import load_kinds
from cranktopo.tasks.fatigue.safety_field import FatigueField, safety_field, unit_loads
from cranktopo.tasks.fatigue.target_safety import fatigue_field
from cranktopo.tasks.fea.targets import Target

SCENE = load_scene("mikron-iiic-plain")
ENABLED = load_kinds(SCENE, "cycle")[0]


@pytest.fixture(scope="module", autouse=True)
def every_ten_degrees() -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr("cranktopo.engine.histories._STEP_DEG", 10.0)
        yield


@pytest.fixture(scope="module")
def field(every_ten_degrees: None) -> FatigueField:
    return fatigue_field(Target("mikron", SCENE), "lsa", "cycle", fillet_fraction=0.5)


def test_histories_of_the_cycle_are_those_of_the_throws() -> None:
    parts, joined = histories_of(SCENE, "cycle", ENABLED), load_history(SCENE, "cycle", ENABLED)
    assert len(parts) == 4
    assert [len(part.labels) for part in parts] == [72] * 4
    np.testing.assert_array_equal(np.concatenate([part.torque_Nm for part in parts]), joined.torque_Nm)
    for number, part in enumerate(parts, start=1):
        assert all(label.startswith(f"throw {number}, ") for label in part.labels)
    (extremes,) = histories_of(SCENE, "extremes", ENABLED)
    assert len(extremes.labels) == 4


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
