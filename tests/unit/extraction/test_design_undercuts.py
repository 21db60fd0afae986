"""Undercuts in a comparison: the web of a half throw with journals, one void at a time."""

from __future__ import annotations

import pytest
from manifold3d import Manifold

from cranktopo.numerics.surfaces.mesh import mesh_of
from cranktopo.tasks.compare.page import undercut_fact
from cranktopo.tasks.compare.stage import design_undercuts
from cranktopo.tasks.extraction.text import DesignUndercuts, undercut_table
from tests.unit.extraction.surface_cases import scene_with

WEB = Manifold.cube((60, 90, 19)).translate((-30, -25, 20))
# A collar outside the web's faces would be an undercut inside of them.
JOURNALS = Manifold.cylinder(20, 21, 21, 64) + Manifold.cylinder(16, 19, 19, 64).translate((0, 40, 39))
SLOT = Manifold.cube((6, 20, 30)).translate((14, 15, 25))
HOLLOW = Manifold.sphere(4.0, 64).translate((20, 30, 30))
COLLAR_SLOT = Manifold.cube((4, 100, 4)).translate((10, -50, 5))


def found_in(name: str, *voids: Manifold) -> DesignUndercuts:
    body = WEB + JOURNALS
    for void in voids:
        body -= void
    return design_undercuts(name, mesh_of(body), scene_with())


def test_an_open_web_has_no_undercuts() -> None:
    found = found_in("plain", COLLAR_SLOT)
    assert (found.hollows, found.undercuts.caught, found.free) == (0, 0, True)


def test_slot_holds_the_die() -> None:
    found = found_in("slotted", SLOT)
    assert not found.free
    assert found.undercuts.volume_mm3 == pytest.approx(6 * 20 * 14, rel=0.02)


def test_hollow_is_counted_once_and_reached_by_nothing() -> None:
    """Also as an undercut: 4/3 pi r^3 of it lies behind solid."""
    found = found_in("hollow", HOLLOW)
    assert (found.hollows, found.free) == (1, False)
    assert found.undercuts.volume_mm3 == pytest.approx(268.1, rel=0.03)


def test_verdict_names_those_that_are_held() -> None:
    plain, slotted = found_in("plain"), found_in("slotted", SLOT)
    fact = undercut_fact([plain, slotted], 3)
    assert (fact.value, fact.status) == ("1 of 3", "bad")
    assert fact.note == "hollows or undercuts in slotted; STEP files were not examined"
    assert undercut_fact([plain], 1).status == "good"
    assert undercut_fact([plain], 2).status == "unknown"


def test_table_has_a_row_for_each() -> None:
    table = undercut_table([found_in("plain"), found_in("slotted", SLOT)])
    assert [list(row.values())[:3] for row in table.rows] == [["plain", "yes", 0.0], ["slotted", "no", 0.0]]
    assert table.cell(1, "deepest_undercut_mm") == "6.0"
