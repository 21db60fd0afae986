"""Plots of what webs carry, and the mesh checks that a shaft tells."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from cranktopo import Target, load_scene
from cranktopo.base.notes import redirected
from cranktopo.tasks.shaft.web_sections import WebSections
from cranktopo.tasks.shaft_safety.judged import JudgedShaft
from cranktopo.tasks.shaft_safety.plots import web_pictures
from cranktopo.tasks.throw_fatigue import stress_mesh
from cranktopo.tasks.throw_fatigue.mesh_quality import MeshCheck, Quality


def test_names_of_axes_lie_within_the_picture_and_no_two_curves_look_alike() -> None:
    """Of twelve webs: "bending moment in the plane of the throw (N" was cut, webs 1 and 11 had one look."""
    curves = np.ones((6, 2, 3)) * np.arange(12.0).reshape(6, 2, 1)
    sections = WebSections(np.array([0.0, 360.0, 720.0]), *[curves] * 7)
    for picture in web_pictures(750.0, sections):
        picture.figure.canvas.draw()
        (axes,) = picture.figure.axes
        box = axes.yaxis.label.get_window_extent()
        high = picture.figure.bbox.height
        assert box.y0 >= 0
        assert box.y1 <= high
        assert len({(line.get_color(), line.get_linestyle()) for line in axes.lines}) == 12


def throw(name: str, normal_percent: float, fitted: bool) -> Any:
    quality = Quality(1.0, 0.24, 10, normal_percent, 1.0, 1.0, 1.0)
    return SimpleNamespace(model=SimpleNamespace(name=name, quality=quality, fitted=fitted))


@pytest.mark.parametrize("fitted", [True, False])
def test_a_mesh_of_any_throw_that_misses_the_checks_is_told(fitted: bool) -> None:
    """Fitted polynomials were taken for proven, and only the worst throw was looked at."""
    target = Target("shaft", load_scene("mikron-iiic-plain"))
    good, bad = throw("good", 1.0, fitted), throw("bad", 3.4, fitted)
    assert JudgedShaft(target, "rigid", [good, good], [900.0], "lsa").missed_checks == ""
    told = JudgedShaft(target, "rigid", [bad], [900.0], "lsa").missed_checks
    assert told.startswith("the mesh misses the checks of IACS UR M53: surface-normal stress 3.4 %")
    both = JudgedShaft(target, "rigid", [good, bad], [900.0], "lsa").missed_checks
    assert both == f"bad: {told}"


@pytest.mark.parametrize(
    ("value", "words"),
    [(3.0312, "3.03 %"), (3.00004, "3.00004 %"), (3.4, "3.4 %"), (2.96, "3.0 %"), (2.4, "2.4 %")],
)
def test_a_check_that_is_missed_has_the_digits_that_show_it(value: float, words: str) -> None:
    """3.0312 was told as "3.0 % (at most 3 %)", a miss that kept its limit."""
    assert str(MeshCheck("stress", value, 3.0)) == f"stress {words} (at most 3 %)"


@pytest.mark.parametrize(("longest", "fractions"), [(0.25005, 2), (0.2499, 1)])
def test_a_default_mesh_with_too_long_an_edge_is_made_anew(
    longest: float, fractions: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before anything is solved, with room to the quarter that UR M53 lets through."""
    asked: list[float] = []

    def made(*_: object, fillet_fraction: float, **__: object) -> SimpleNamespace:
        asked.append(fillet_fraction)
        return SimpleNamespace(mesh=SimpleNamespace(points_mm=np.zeros((3, 1))))

    monkeypatch.setattr(stress_mesh, "mesh_throw", made)
    monkeypatch.setattr(stress_mesh, "longest_edge", lambda *_: longest)
    target = Target("throw", load_scene("mikron-iiic-plain"))
    lines: list[str] = []
    with redirected(lines.append):
        stress_mesh.mesh_for_stress(target, stress_mesh.RULE_FRACTION, by_rule=True)
    assert len(asked) == fractions
    assert asked[-1] * longest / asked[0] <= 0.25
    assert any("longest edge in a fillet over its radius 0.25" in line for line in lines) == (fractions > 1)
    stress_mesh.mesh_for_stress(target, 0.2, by_rule=True)
    assert len(asked) == fractions + 1, "an own size is kept"
