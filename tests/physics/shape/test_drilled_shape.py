"""An oil drilling through the web in the shape optimisation: it stands still while the web moves."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.web_shape.mesh_model import MeshModel
from cranktopo.tasks.web_shape.start import scene_start
from cranktopo.throw.drilling.table import drill_bores

DRILLING = {
    "diameter_mm": 8.0,
    "outlet_radius_mm": 1.0,
    "from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": 6.0},
    "to": {"on": "crankpin", "angle_deg": 0.0, "place_mm": 6.0},
}


def drilled() -> Scene:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude={"published"}, exclude_none=True)
    journals = {
        name: data["throw"][name] | {"bore_diameter_mm": 0.0} for name in ("main_journal", "crankpin")
    }
    throw = data["throw"] | journals | {"drilling": [DRILLING]}
    return scene_from_dict({**data, "throw": throw}, "drilled")


@pytest.mark.slow
def test_the_drilling_stands_still(float64: None) -> None:
    """Nodes of its wall are on its face before and after a step; torsion by differences of the same mesh."""
    scene = drilled()
    start = scene_start(scene, usual_limits(scene))
    model = MeshModel(scene, start.layout, start.values, 14.0)
    step = np.zeros(len(start.values))
    step[3] = 0.5
    (bore,) = drill_bores(scene)
    low, high = scene.web_z_mm
    for values in (start.values, start.values + step):
        x, y, z = model.moved.at(values).points_mm
        off = bore.off_axis_mm(x, y, z) - bore.radius_mm
        on = (np.abs(off) < 1e-9) & (z > low) & (z < high)
        assert on.sum() > 20
    found = model.responses(start.values, ("torsion",))
    above, below = (
        model.responses(start.values + sign * step / 50, ("torsion",)).values["torsion"] for sign in (1, -1)
    )
    assert found.gradients["torsion"][3] == pytest.approx((above - below) / 0.02, rel=1e-5)


def test_free_journals_do_not_take_rounded_outlets_along() -> None:
    data = drilled().model_dump(mode="json", exclude_none=True)
    free = {"shape": {"free": {"web_thickness_mm": [17.0, 21.0]}}}
    with pytest.raises(CranktopoError, match=r"throw.drilling\[0\] has rounded outlets"):
        scene_from_dict({**data, **free}, "drilled")
