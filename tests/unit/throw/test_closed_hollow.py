"""A pocket or hole that the journals cover is a closed hollow: refused when the design is read."""

from __future__ import annotations

import pytest

from cranktopo import load_scene, with_values
from cranktopo.base.errors import CranktopoError

_Pocket = dict[str, str | float]
POCKET: _Pocket = {"shape": "cylinder", "face": "journal", "y_mm": 10.0, "diameter_mm": 12.0}


@pytest.mark.parametrize(
    ("pocket", "under"),
    [
        ({**POCKET, "depth_mm": 8.0}, "throw.main_journal"),
        ({**POCKET, "face": "pin", "y_mm": 50.0, "depth_mm": 8.0}, "throw.crankpin"),
        (
            {**POCKET, "face": "through", "y_mm": 22.0, "diameter_mm": 6.0},
            "throw.main_journal and throw.crankpin",
        ),
    ],
)
def test_a_pocket_under_a_journal_is_refused(pocket: _Pocket, under: str) -> None:
    with pytest.raises(CranktopoError, match=rf"web\.pocket\[0\]: lies under {under}: no tool reaches it"):
        with_values(load_scene("opposed-piston"), {"web.pocket": [pocket]})


@pytest.mark.parametrize(
    "pocket",
    [
        {**POCKET, "y_mm": 31.0, "depth_mm": 4.0},  # its mouth reaches beyond the fillet
        {**POCKET, "face": "pin", "y_mm": 10.0, "depth_mm": 4.0},  # the other journal covers nothing
        {**POCKET, "face": "through", "y_mm": 10.0, "diameter_mm": 8.0},  # open at the pin's face
    ],
)
def test_a_pocket_with_an_open_mouth_is_no_hollow(pocket: _Pocket) -> None:
    assert with_values(load_scene("opposed-piston"), {"web.pocket": [pocket]}).web.pocket
