"""What a search assumes: of `[fatigue]` only what the method of its safeties takes."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cranktopo.design.loading import load_scene
from cranktopo.tasks.shape import run as module


class _Begun(Exception):
    """The run would begin here."""


def test_a_run_lists_no_assumption_that_its_method_does_not_take(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    listed: list[str] = []

    def begin(_: Any, assumed: Any, *__: Any) -> None:
        listed.extend(item.key for item in assumed)
        raise _Begun

    monkeypatch.setattr(module, "new_run", begin)
    monkeypatch.setattr(module, "check_reachable", lambda *_: None)
    scene = load_scene("mikron-iiic-plain")
    with pytest.raises(_Begun):
        module.shape_design(scene, out=tmp_path / "out")
    assert "fatigue.additional_stress_MPa" not in listed
    assert any(key.startswith("fatigue.") for key in listed)
