"""Other values for a scene from Python: checked as those of a file, and written as a design."""

from __future__ import annotations

from pathlib import Path

import pytest

from cranktopo import load_scene, save_scene, with_values
from cranktopo.base.errors import CranktopoError
from cranktopo.design.loading import builtin_designs


def test_values_at_key_paths() -> None:
    scene = load_scene("mikron-iiic")
    wider = with_values(scene, {"name": "wider", "web.width_mm": 56.0, "web.bevel[0].depth_mm": 11.0})
    assert (wider.name, wider.web.width_mm, wider.web.bevel[0].depth_mm) == ("wider", 56.0, 11.0)
    assert scene.web.width_mm != 56.0
    assert with_values(wider, {"name": scene.name, "web": scene.model_dump(mode="json")["web"]}) == scene


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("web.widht_mm", 68.0, "width_mm"),
        ("web.width_mm", -1.0, "web.width_mm"),
        ("web.bevel[7].y_mm", 1.0, "7"),
    ],
)
def test_what_no_file_may_say_is_refused(key: str, value: float, message: str) -> None:
    with pytest.raises(CranktopoError, match=message):
        with_values(load_scene("mikron-iiic"), {key: value})


@pytest.mark.parametrize("name", builtin_designs())
def test_a_saved_scene_is_the_same_design(name: str, tmp_path: Path) -> None:
    scene = load_scene(name, whole=True)
    save_scene(scene, str(tmp_path / "saved.toml"))
    assert load_scene(str(tmp_path / "saved.toml"), whole=True) == scene


def test_a_copy_by_pydantic_refuses_a_name_that_is_none() -> None:
    """`model_copy(update={"widht_mm": 68.0})` was the old web without a word."""
    web = load_scene("mikron-iiic").web
    with pytest.raises(CranktopoError, match=r"has no 'widht_mm'\. Did you mean 'width_mm'"):
        web.model_copy(update={"widht_mm": 68.0})
    assert web.model_copy(update={"width_mm": 68.0}).width_mm == 68.0
