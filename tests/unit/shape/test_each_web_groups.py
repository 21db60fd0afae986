"""Webs of a shaft that are equal, and the design of a crank whose webs are not."""

from __future__ import annotations

from pathlib import Path

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.halves import halves
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.tasks.refit.fit import scene_with_web
from cranktopo.tasks.web_shape.each_web.crank_files import MAIN, write_crank
from cranktopo.tasks.web_shape.each_web.groups import is_mirrored, web_groups

FOUR = (0.0, 180.0, 180.0, 0.0)
SAFETIES = (1.6, 2.0, 1.60, 1.52, 1.67, 1.63, 1.70, 1.43)


@pytest.mark.parametrize(
    ("angles", "mirrored"),
    [
        (FOUR, True),
        ((0.0, 120.0, 240.0), True),  # turned about an axis across the shaft
        ((0.0, 120.0, 240.0, 240.0, 120.0, 0.0), True),
        ((0.0, 90.0, 270.0, 180.0), True),
        ((0.0, 180.0), True),
        ((0.0, 90.0, 180.0, 200.0, 300.0), False),
    ],
)
def test_shafts_that_are_their_own_image(angles: tuple[float, ...], mirrored: bool) -> None:
    assert is_mirrored(angles) == mirrored


def webs(angles: tuple[float, ...], safeties: tuple[float, ...], same: list[list[int]]) -> list[list[int]]:
    return [list(group.webs) for group in web_groups(angles, safeties, same)]


def test_mirror_pairs_are_equal_and_webs_that_need_the_same_safety() -> None:
    assert webs(FOUR, SAFETIES, []) == [[1, 8], [2, 7], [3, 6], [4, 5]]
    assert webs(FOUR, (*SAFETIES[:3], 1.45, *SAFETIES[4:]), []) == [[1, 4, 5, 8], [2, 7], [3, 6]]


def test_webs_of_one_die_stay_together_and_take_no_others() -> None:
    assert webs(FOUR, SAFETIES, [[5, 1]]) == [[1, 5], [2, 7], [3, 6], [4], [8]]


def test_without_symmetry_every_web_stands_for_itself() -> None:
    lonely = (0.0, 90.0, 180.0, 200.0, 300.0)
    assert webs(lonely, (1.0, 2.0, 3.0, 4.0, 5.0, 6.0, 7.0, 8.0, 9.0, 10.0), []) == [
        [n] for n in range(1, 11)
    ]


def test_the_written_crank_has_each_web_at_its_place(tmp_path: Path) -> None:
    scene = load_scene("mikron-iiic")
    wide = {place: 50.0 + min(place, 9 - place) for place in range(1, 9)}  # mirror pairs
    own = {place: scene.web.model_copy(update={"width_mm": width}) for place, width in wide.items()}
    files = write_crank(scene, own, tmp_path, "Widths.")
    assert files == (MAIN, "throw-2.toml", "throw-3.toml", "throw-4.toml")
    throws = throw_scenes(load_scene(str(tmp_path / MAIN), whole=True))
    found = [half.web for throw in throws for half in halves(throw)]
    assert found == [own[place] for place in range(1, 9)]


def test_one_web_for_all_is_one_file(tmp_path: Path) -> None:
    scene = load_scene("mikron-iiic")
    assert write_crank(scene, dict.fromkeys(range(1, 9), scene.web), tmp_path, "The same.") == (MAIN,)
    assert load_scene(str(tmp_path / MAIN)).web == scene.web


def test_a_crank_of_wider_webs_than_a_free_counterweight_can_be_read(tmp_path: Path) -> None:
    """It was refused when it was written: its webs hold a counterweight of the least radius."""
    scene = load_scene("car-diesel")
    weight = {"outer_radius_mm": 66.0, "half_angle_deg": 65.0}
    wide = {"thickness_mm": 18.0, "outline": "tapered", "main_radius_mm": 48.0, "pin_radius_mm": 35.0}
    web = scene_with_web(scene, {**wide, "counterweight": weight}).web
    write_crank(scene, {place: web if place % 2 else scene.web for place in range(1, 9)}, tmp_path, "Wide.")
    free = load_scene(str(tmp_path / MAIN), whole=True).shape.free
    assert free.counterweight_radius_mm[0] > 48.0
    assert free.counterweight_angle_deg == scene.shape.free.counterweight_angle_deg
    smaller = scene.web.counterweight.model_copy(update={"outer_radius_mm": 46.0})
    narrow = scene.web.model_copy(update={"counterweight": smaller})
    write_crank(scene, {place: web if place % 2 else narrow for place in range(1, 9)}, tmp_path, "No range.")
    assert load_scene(str(tmp_path / MAIN), whole=True).shape.free.counterweight_radius_mm is None


@pytest.mark.parametrize(
    ("given", "line"),
    [
        ([[1, 8], [8, 2]], "a web in two places"),
        ([[1]], "lists of two web numbers or more"),
        ([[0, 1]], "whole numbers from 1 to 96"),
        ("all", "lists of two web numbers or more"),
    ],
)
def test_same_webs_that_make_no_sense_are_refused(given: object, line: str) -> None:
    with pytest.raises(CranktopoError, match=line):
        with_values(load_scene("mikron-iiic"), {"shape.same_webs": given})
