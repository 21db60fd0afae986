"""Assumptions of a search: of `[fatigue]` only what the method of its safeties takes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cranktopo.design.goal.scene_goal import with_goal
from cranktopo.design.loading import load_scene
from cranktopo.tasks.web_shape import run as module


class _BegunError(Exception):
    """The run would begin here."""


def test_a_run_lists_no_assumption_that_its_method_does_not_take(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    listed: list[str] = []

    def begin(_: Any, assumed: Any, *__: Any) -> None:
        listed.extend(item.key for item in assumed)
        raise _BegunError

    monkeypatch.setattr(module, "new_run", begin)
    monkeypatch.setattr(module, "check_reachable", lambda *_: None)
    scene = with_goal(load_scene("mikron-iiic-plain"), minimise="mass", limits=("fatigue_safety >= 100 %",))
    with pytest.raises(_BegunError):
        module.shape_design(scene, out=tmp_path / "out")
    assert "fatigue.additional_stress_MPa" not in listed
    assert any(key.startswith("fatigue.") for key in listed)
