"""Drawings show a bolted counterweight as a part of its own, and tell its mass beside that of the part."""

from __future__ import annotations

import math

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import PathPatch

from cranktopo.bodies.prisms import bolted_counterweight
from cranktopo.bodies.volume import counterweight_mass
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.drawing.sheet import drawing_figures
from cranktopo.tasks.drawing.views import Sheet, cross_body, front_body, lengthwise_body
from tests.unit.bodies.test_seat import HEAVY, WEIGHT, with_weight

ONE_PIECE = {**WEIGHT, "density_kg_m3": None}
HOLED = {**WEIGHT, "hole": [{"diameter_mm": 8.0, "depth_mm": 15.0}]}


def sheet_of(scene: Scene) -> Sheet:
    """A sheet with a block for the half throw, which is not what is looked at."""
    from manifold3d import Manifold

    return Sheet(scene, Manifold.cube((60.0, 100.0, 50.0)).translate((-30.0, -30.0, 0.0)))


def mass_on(scene: Scene) -> str:
    (figure,) = drawing_figures([sheet_of(scene)], throw_balance(scene))
    texts = [text.get_text() for part in figure.axes for text in part.texts]
    return next(text for text in texts if text.startswith("throw "))


def patches(draw: object, scene: Scene, *args: float) -> list[PathPatch]:
    axes = Figure().add_subplot()
    draw(axes, sheet_of(scene), *args)  # type: ignore[operator]
    return [patch for patch in axes.patches if isinstance(patch, PathPatch)]


def test_its_body_is_what_it_adds_to_the_web() -> None:
    scene = with_weight(WEIGHT)
    area = math.pi / 3 * (62.0**2 - 30.0**2)
    assert bolted_counterweight(scene).volume() == pytest.approx(19.0 * area, rel=1e-4)
    assert bolted_counterweight(with_weight(ONE_PIECE)).is_empty()
    assert bolted_counterweight(with_weight(None)).is_empty()


def test_its_holes_are_cut() -> None:
    scene = with_weight(HOLED)
    expected = counterweight_mass(scene).volume / (HEAVY * 1e-9)
    assert bolted_counterweight(scene).volume() == pytest.approx(expected, rel=1e-3)
    assert expected < bolted_counterweight(with_weight(WEIGHT)).volume() - 100.0


def test_the_front_view_has_the_joint_line() -> None:
    """Web and counterweight are two areas; the outline of the web goes all the way round."""
    web, weight = patches(front_body, with_weight(WEIGHT))
    assert web.get_path().get_extents().y0 == pytest.approx(-30.0, abs=0.01)
    ends = weight.get_path().get_extents()
    assert (ends.y0, ends.x1) == pytest.approx((-62.0, 62.0 * math.sin(math.pi / 3)), abs=0.01)
    (whole,) = patches(front_body, with_weight(ONE_PIECE))
    assert whole.get_path().get_extents().y0 == pytest.approx(-62.0, abs=0.01)


def test_both_sections_have_it_hatched_the_other_way() -> None:
    scene = with_weight(WEIGHT)
    start, end = scene.web_z_mm
    for draw, args, wanted in (
        (lengthwise_body, (3.0,), (start, end, -62.0, -30.0)),
        (cross_body, (-50.0,), (-math.sqrt(62**2 - 50**2), math.sqrt(62**2 - 50**2), start, end)),
    ):
        found = [one for one in patches(draw, scene, *args) if "\\" in (one.get_hatch() or "")]
        assert len(found) == 1
        ends = found[0].get_path().get_extents()
        np.testing.assert_allclose([ends.x0, ends.x1, ends.y0, ends.y1], wanted, atol=0.01)
        assert not [one for one in patches(draw, with_weight(None), *args) if "\\" in (one.get_hatch() or "")]


def test_the_title_block_tells_what_the_material_makes_and_what_is_bolted_on() -> None:
    scene, bare = with_weight(WEIGHT), with_weight(None)
    heavy, steel = 2 * 19.0 * math.pi / 3 * (62.0**2 - 30.0**2) * HEAVY * 1e-9, throw_balance(bare)
    assert (
        mass_on(scene)
        == f"throw {steel.mass_kg:.3f} kg, one web {steel.web_kg:.3f} kg; bolted on {heavy:.3f} kg"
    )
    whole = throw_balance(with_weight(ONE_PIECE))
    assert mass_on(with_weight(ONE_PIECE)) == f"throw {whole.mass_kg:.3f} kg, one web {whole.web_kg:.3f} kg"
