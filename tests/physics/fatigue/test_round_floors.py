"""The least safety at the floor of a groove or side pocket: a round edge is judged, a sharp one is named."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.throw_fatigue.safety_field import FatigueField
from cranktopo.tasks.throw_fatigue.target_safety import fatigue_field
from cranktopo.tasks.throw_fea.targets import Target
from tests.unit.refit.remodel_cases import table

FLOOR_MM = 12.0
"""Half-width at the floor of the pockets, which leaves the web thin there."""
SIDE = {"shape": "side", "y_mm": 24.0, "depth_mm": 38.0 - FLOOR_MM, "height_mm": 10.0, "draft_deg": 3.0}
POCKET = {**SIDE, "length_mm": 13.0, "corner_radius_mm": 2.5}


def field_of(pocket: dict[str, Any]) -> FatigueField:
    """The safety of a throw with rolled fillets, a stout crankpin, and a side pocket or groove."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["throw"]["main_journal"]["fillet_mm"] = 4.8
    data["throw"]["crankpin"] |= {"outer_diameter_mm": 48.0, "fillet_mm": 2.9}
    data["fatigue"]["surface_treatment_factor"] = 2.0
    data["web"] = table(pocket=[pocket])
    scene: Scene = scene_from_dict(data)
    return fatigue_field(Target("pocketed", scene), "lsa", fillet_fraction=0.5)


def beside_floor(field: FatigueField, floor_mm: float) -> NDArray[np.bool_]:
    """Mask of the nodes at a floor and within 3 mm above it, in the middle of the throw."""
    x, y, z = field.model.surface.points_mm
    low, high = field.model.scene.web_z_mm
    deep = np.abs(x) - floor_mm
    return (deep > -0.1) & (deep < 3.0) & (np.abs(y - 24.0) < 10.0) & (z > low + 1.0) & (z < high - 1.0)


@pytest.mark.slow
def test_the_radius_of_a_floor_decides_the_safety() -> None:
    """The edge of the floor is the worst place of all with 0.5 mm, and no longer with 2.5 mm."""
    small, large = (field_of({**POCKET, "floor_radius_mm": radius}) for radius in (0.5, 2.5))
    near = [beside_floor(field, FLOOR_MM) for field in (small, large)]
    assert not any((field.model.sharp & on).any() for field, on in zip((small, large), near, strict=True))
    at_floor = [field.safety[:, on].min() for field, on in zip((small, large), near, strict=True)]
    assert small.critical.safety == at_floor[0] == pytest.approx(2.18, rel=0.03)
    assert small.critical.safety < 0.98 * large.critical.safety
    assert large.critical.safety < 0.95 * at_floor[1]


@pytest.mark.slow
def test_a_sharp_floor_is_named_and_a_round_one_is_not_sharp() -> None:
    """The floor of a groove, too, whose edges run out at both ends of the web."""
    groove = {**SIDE, "length_mm": 200.0, "depth_mm": 10.0}
    sharp, rounded = (field_of({**groove, **more}) for more in ({}, {"floor_radius_mm": 3.0}))
    assert (sharp.model.sharp & beside_floor(sharp, 28.0)).any()
    assert not (rounded.model.sharp & beside_floor(rounded, 28.0)).any()
