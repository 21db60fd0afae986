"""Tables of roller bearings, wherever a design has them: a reaction for each displacement, both rising."""

from __future__ import annotations

from typing import Any

import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.design.idle_keys import idle_keys
from cranktopo.design.loading import scene_from_dict
from tests.keys.scenes import Data, builtin, changed

PLACES = {
    "supports.roller_bearing": "mikron-iiic-plain",
    "balancer.bearing[0].roller_bearing": "balancer-shaft",
    "balancer.redesign.bearing[0].roller_bearing": "balancer-shaft",
}
TABLES: tuple[tuple[dict[str, Any], str], ...] = (
    ({"reaction_N": [33.0, 172.0, 501.0]}, r"{0}\.reaction_N = .*one value per displacement \(14\)"),
    ({"displacement_mm": [0.001, 0.004, 0.01]}, r"{0}\.reaction_N = .*one value per displacement \(3\)"),
    (
        {"displacement_mm": [0.001, 0.004, 0.004], "reaction_N": [33.0, 172.0, 501.0]},
        r"{0}\.displacement_mm = .*must increase",
    ),
    (
        {"displacement_mm": [0.001, 0.004, 0.01], "reaction_N": [33.0, 172.0, 1.0]},
        r"{0}\.reaction_N = .*must increase",
    ),
)


def design(place: str, table: Data) -> Data:
    return changed(builtin(PLACES[place]), {place: {"name": "HK4520"} | table})


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize(("table", "words"), TABLES)
def test_a_table_that_is_none_is_refused_with_its_key(place: str, table: Data, words: str) -> None:
    """In a balancer shaft it ended in a ValueError of arrays that do not fit."""
    at = place.replace("[", r"\[").replace("]", r"\]").replace(".", r"\.")
    with pytest.raises(CranktopoError, match=words.format(at)):
        scene_from_dict(design(place, table))


@pytest.mark.parametrize("place", PLACES)
def test_a_table_that_rises_is_taken(place: str) -> None:
    table = {"displacement_mm": [0.001, 0.004, 0.01], "reaction_N": [33.0, 172.0, 501.0]}
    scene_from_dict(design(place, table))


@pytest.mark.parametrize(
    ("place", "words"),
    [
        ("supports.roller_bearing", "need all sizes of the rollers"),
        ("balancer.bearing[0].roller_bearing", "is that of main bearings"),
    ],
)
def test_sizes_of_which_no_life_follows_are_told(place: str, words: str) -> None:
    """A diameter without the circle of the rollers, and a bearing whose life is another."""
    data = design(place, {"roller_diameter_mm": 2.5})
    (line,) = idle_keys(scene_from_dict(data), data)
    assert line.startswith(f"{place}.roller_diameter_mm: ")
    assert line.endswith(words)


def test_rollers_that_do_not_fit_beside_each_other_are_refused() -> None:
    """38 rollers on a circle of 47.5 mm are at most 3.927 mm thick."""
    sizes = {"pitch_diameter_mm": 47.5, "roller_diameter_mm": 3.95}
    with pytest.raises(CranktopoError, match=r"38 rollers beside each other: at most 3\.927"):
        scene_from_dict(design("supports.roller_bearing", sizes))
    scene_from_dict(design("supports.roller_bearing", sizes | {"roller_diameter_mm": 2.5}))
