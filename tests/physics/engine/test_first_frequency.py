"""First natural frequency of a shaft and its derivatives: closed forms, differences, `vibration` itself."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.vibration.first_frequency import first_frequency, first_mode
from cranktopo.engine.vibration.shaft_chain import estimated_chain, moving_inertia_kg_mm2
from cranktopo.numerics.disk_chain import DiskChain

NOSE = {"kind": "cylinder", "diameter_mm": 30.0, "length_mm": 60.0, "bore_diameter_mm": 10.0}
CONE = {"kind": "cone", "diameter_mm": 40.0, "outer_end_diameter_mm": 30.0, "length_mm": 50.0}
DAMPER = {
    "kind": "rubber",
    "ring_inertia_kg_m2": 0.004,
    "hub_inertia_kg_m2": 0.002,
    "stiffness_Nm_per_rad": 3e4,
    "loss_factor": 0.2,
}
LINE = {
    "throw_damping_Nms_per_rad": 2.0,
    "cylinder_damping_Nms_per_rad": 0.4,
    "damper": DAMPER,
    "flywheel": {"inertia_kg_m2": 0.09},
    "coupling": {"inertia_kg_m2": 0.01, "stiffness_Nm_per_rad": 3e4, "loss_factor": 0.15},
    "propeller": {"inertia_kg_m2": 0.5, "stiffness_Nm_per_rad": 2e4, "damping_Nms_per_rad": 3.0},
}
JOINED = {"coupling": LINE["coupling"], "throw_loss_factor": 0.05}
"""A coupling right behind the last throw: a spring in series with half a throw, of another loss factor."""
ROTORS = {"flywheel": {"inertia_kg_m2": 0.2}, "pulley": {"inertia_kg_m2": 0.05}}
TORSION, INERTIA = 152.5e3, 4200.0


def mikron(shaft: dict[str, Any] | None = None, crank: dict[str, Any] | None = None) -> Scene:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    tables = {"shaft": shaft, "crank": crank}
    return scene_from_dict(data | {name: table for name, table in tables.items() if table}, "shaft")


def ends(*sides: str) -> dict[str, Any]:
    return {"end": [{"side": side, "step": [NOSE, CONE]} for side in sides]}


def test_two_disks_in_closed_form() -> None:
    """Of f = sqrt(k (1/a + 1/b)) / 2 pi."""
    a, b, k = 0.3, 0.7, 2e4
    chain = DiskChain((a, b), (k,))
    (mode,) = chain.damped_modes()
    by_inertia, by_stiffness = chain.frequency_slopes(mode)
    f = math.sqrt(k * (1 / a + 1 / b)) / (2 * math.pi)
    assert mode.frequency_Hz == pytest.approx(f, rel=1e-12)
    assert by_stiffness.real == pytest.approx([f / (2 * k)], rel=1e-9)
    assert by_inertia == pytest.approx([-f * b / (2 * a * (a + b)), -f * a / (2 * b * (a + b))], rel=1e-9)


def test_a_disk_with_a_dashpot_keeps_its_frequency_whatever_the_dashpot() -> None:
    """The magnitude of the eigenvalue is sqrt(k/J) beside a disk that is as good as held."""
    j, k = 0.3, 2e4
    chain = DiskChain((j, 1e9), (k,), (), (), (60.0, 0.0))
    mode = chain.damped_modes()[0]
    by_inertia, by_stiffness = chain.frequency_slopes(mode)
    assert mode.damping_ratio == pytest.approx(60.0 / (2 * math.sqrt(j * k)), rel=1e-6)
    assert by_inertia[0] == pytest.approx(-mode.frequency_Hz / (2 * j), rel=1e-6)
    assert by_stiffness[0].real == pytest.approx(mode.frequency_Hz / (2 * k), rel=1e-6)


def test_equal_throws_in_closed_form() -> None:
    """n disks in a row: f = sqrt(k / J) sin(pi / 2n) / pi, whose relative slopes are one half."""
    scene = mikron({"throw_loss_factor": 0.0})
    found = first_frequency(scene, TORSION, INERTIA)
    inertia = INERTIA + moving_inertia_kg_mm2(scene)
    expected = math.sqrt(TORSION / (inertia * 1e-6)) * math.sin(math.pi / 8) / math.pi
    assert found.frequency_Hz == pytest.approx(expected, rel=1e-9)
    assert found.by_torsion == pytest.approx(expected / (2 * TORSION), rel=1e-7)
    assert found.by_inertia == pytest.approx(-expected / (2 * inertia), rel=1e-7)


@pytest.mark.parametrize(
    "scene",
    [
        mikron(),
        mikron(LINE),
        mikron(JOINED),
        mikron({"pulley": {"inertia_kg_m2": 0.01, "stiffness_Nm_per_rad": 2e5}}),
        mikron(ROTORS, ends("free", "output")),
        mikron(None, ends("free", "output")),
    ],
    ids=["bare", "line", "joined", "pulley", "rotors at ends", "ends"],
)
def test_slopes_are_those_of_differences(scene: Scene) -> None:
    found = first_frequency(scene, TORSION, INERTIA)
    for step, slope in ((np.array([1e-4, 0.0]), found.by_torsion), (np.array([0.0, 1e-4]), found.by_inertia)):
        ahead, back = (
            first_frequency(scene, TORSION * (1 + s * step[0]), INERTIA * (1 + s * step[1])).frequency_Hz
            for s in (1, -1)
        )
        size = float(step @ [TORSION, INERTIA])
        assert slope == pytest.approx((ahead - back) / (2 * size), rel=1e-5)
    assert found.by_torsion > 0 > found.by_inertia


def test_it_is_the_first_mode_of_the_chain_that_vibration_solves() -> None:
    """Of the same stiffness of a throw, given there as a key."""
    scene = mikron(LINE | {"throw_stiffness_Nm_per_rad": TORSION})
    chain = estimated_chain(scene).chain
    inertia = 1e6 * chain.inertia_kg_m2[2] - moving_inertia_kg_mm2(scene)
    told = chain.damped_modes()[0]
    assert first_frequency(mikron(LINE), TORSION, inertia).frequency_Hz == pytest.approx(
        told.frequency_Hz, rel=1e-9
    )
    assert told.damping_ratio > 1e-3, "the damping counts"


def test_nothing_swings_in_one_disk() -> None:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    data["engine"] |= {"cylinders": 1, "firing_order": [1]}
    alone = scene_from_dict(data)
    with pytest.raises(CranktopoError, match="nothing swings in its shaft"):
        first_mode(alone, estimated_chain(alone))
