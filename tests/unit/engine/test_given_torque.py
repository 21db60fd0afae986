"""A smallest torque that the scene gives is taken as it is given."""

from __future__ import annotations

from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.engine.histories import load_history

KINDS = frozenset({"bending", "torsion"})


def given(**torques: float) -> Any:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["engine"] = {**data["engine"], "max_gas_force_N": 30e3, **torques}
    return scene_from_dict(data)


@pytest.mark.parametrize("low", [150.0, 0.0, -90.0])
def test_it_may_be_above_zero(low: float) -> None:
    history = load_history(given(max_torque_Nm=400.0, min_torque_Nm=low), "extremes", KINDS)
    assert set(history.torque_Nm) == {400.0, low}


def test_it_is_not_above_the_largest() -> None:
    with pytest.raises(CranktopoError, match=r"must be at most engine\.max_torque_Nm = 400 N m"):
        given(max_torque_Nm=400.0, min_torque_Nm=401.0)
