"""Bodies from CAD that lie elsewhere: refused with the attitude that would fit, or moved there."""

from __future__ import annotations

import re

import numpy as np
import pytest
from manifold3d import Manifold

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.prisms import cylinder, journal_halves, web_bores
from cranktopo.bodies.solid.files import surface_of
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.plan.simulated import strip_features
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.tasks.importing.placement import misfits, placed, ring_at, without_bores_left_out


def turned(axis: str, deg: float) -> np.ndarray:
    """Rotation by Rodrigues' formula, an independent way from the one under test."""
    k = np.zeros((3, 3))
    i, j = {"x": (1, 2), "y": (2, 0), "z": (0, 1)}[axis]
    k[i, j], k[j, i] = -1.0, 1.0
    angle = np.deg2rad(deg)
    return np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k


@pytest.fixture(scope="module")
def mikron() -> Scene:
    """Without fillets, as the body below."""
    return strip_features(load_scene("mikron-iiic-plain"), "fillets")


@pytest.fixture(scope="module")
def body(mikron: Scene) -> Manifold:
    """Half throw with a lopsided web, so that no attitude passes for another."""
    main, pin = journal_halves(mikron)
    start, end = mikron.web_z_mm
    web = sum((cylinder(27.0, y, (start, end)) for y in (0.0, 20.0, mikron.throw.radius_mm)), Manifold())
    ear = Manifold.cube((12.0, 20.0, end - start)).translate((20.0, 10.0, start))
    return main + pin + (web + ear - web_bores(mikron))


def test_a_body_that_lies_right_passes(body: Manifold, mikron: Scene) -> None:
    assert placed(body, mikron, "body", align=False) is None


def test_a_bore_that_the_plan_leaves_out_may_be_missing() -> None:
    """A run's surface has no bore that changes less than the threshold; the body is read with a note."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    for name, bore in (("main_journal", 0.0), ("crankpin", 6.0)):
        data["throw"][name] |= {"bore_diameter_mm": bore, "fillet_mm": 0.0}
    small = scene_from_dict(data)
    bare = strip_features(small, "bores")
    main, pin = journal_halves(bare)
    start, end = bare.web_z_mm
    solid = main + pin + sum((cylinder(27.0, y, (start, end)) for y in (0.0, 24.0, 48.0)), Manifold())
    found, note = without_bores_left_out(solid, small)
    assert found.throw == bare.throw
    assert "the effects plan leaves them out" in note
    kept = small.model_copy(update={"effects": small.effects.model_copy(update={"bores": "on"})})
    assert without_bores_left_out(solid, kept) == (kept, "")
    with pytest.raises(CranktopoError, match=r"bore 0\.00 mm instead of 6"):
        placed(solid, kept, "body", align=False)


HALF_PITCH, RADIUS = 57.0, 48.0
WRONG = {
    "about z": (turned("z", 90), (0, 0, 0), "turned by 90 deg about z"),
    "opposite": (turned("z", 180), (0, 0, 0), "turned by 180 deg about z"),
    "end for end": (turned("y", 180), (0, 0, HALF_PITCH), "turned end for end"),
    "crank axis along x": (turned("y", 90), (0, 0, 0), "turned by 90 deg about y"),
    "a little": (turned("z", 3), (0, 0, 0), "turned by 3 deg about z"),
    "tilted": (turned("x", 2), (0, 0, 0), "turned by 2"),
    "shifted": (np.eye(3), (1.0, 0, 0), "shifted by (1.00, 0.00, 0.00) mm"),
    "pin on the crank axis": (np.eye(3), (0, -RADIUS, 0), "shifted by (0.00, -48.00, 0.00) mm"),
    "all of it": (
        turned("z", -90),
        (3.0, 4.0, 5.0),
        "turned by -90 deg about z and shifted by (3.00, 4.00, 5.00) mm",
    ),
}


@pytest.mark.parametrize("name", WRONG)
def test_a_misplaced_body_is_refused_with_the_attitude_that_fits(
    body: Manifold, mikron: Scene, name: str
) -> None:
    rotation, shift, words = WRONG[name]
    wrong = body.transform(np.column_stack([rotation, shift]))
    with pytest.raises(CranktopoError, match="does not lie where the throw is") as error:
        placed(wrong, mikron, "body.step", align=False)
    assert words in error.value.message
    assert "--align" in error.value.hint


@pytest.mark.parametrize("name", ["end for end", pytest.param("crank axis along x", marks=pytest.mark.slow)])
def test_journals_alike_but_for_their_lengths_are_told_apart(name: str) -> None:
    """The built-in throw itself: with its fillets, each end shows the sections of the other."""
    whole = load_scene("mikron-iiic-plain")
    rotation, shift, words = WRONG[name]
    wrong = solid_of(surface_of(whole, "half", 2.0)).transform(np.column_stack([rotation, shift]))
    with pytest.raises(CranktopoError, match=f"looks {words}"):
        placed(wrong, whole, "body.step", align=False)


ALIGNED = "opposite", "end for end", "crank axis along x", "tilted", "all of it"
"""A turn about each axis, one of them small, and one with a shift."""


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.slow] * (name not in ALIGNED)) for name in WRONG]
)
def test_align_moves_it_back(body: Manifold, mikron: Scene, name: str) -> None:
    rotation, shift, _ = WRONG[name]
    wrong = body.transform(np.column_stack([rotation, shift]))
    motion = placed(wrong, mikron, "body.step", align=True)
    assert motion is not None
    back = wrong.transform(np.column_stack([motion.matrix, motion.shift_mm]))
    assert (back - body).volume() + (body - back).volume() < 2e-3 * body.volume()
    points = np.array([[1.0, 2.0, 3.0], [-4.0, 50.0, 6.0]])
    assert motion.moved(points @ rotation.T + np.array(shift)) == pytest.approx(points, abs=0.05)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({"outer_diameter_mm": 44.0}, "diameter 42.* instead of 44"),
        ({"bore_diameter_mm": 20.0}, "bore 2[34].* instead of 20"),
        ({"length_mm": 44.0}, "reaches from z = 0.000 to 57.000 mm, the half throw from 0 to 59 mm"),
    ],
)
def test_the_wrong_design_is_named(
    body: Manifold, mikron: Scene, change: dict[str, float], words: str
) -> None:
    throw = mikron.throw.model_copy(
        update={"main_journal": mikron.throw.main_journal.model_copy(update=change)}
    )
    with pytest.raises(CranktopoError, match=words) as error:
        placed(body, mikron.model_copy(update={"throw": throw}), "body.step", align=True)
    assert "Is 'mikron-iiic-plain' the design" in error.value.hint


def test_a_ring_is_measured(mikron: Scene) -> None:
    tube = Manifold.cylinder(10, 20, 20, 256) - Manifold.cylinder(10, 5, 5, 128)
    ring = ring_at(tube.translate((3.0, 4.0, 0.0)), 5.0)
    assert ring is not None
    assert tuple(ring.centre_mm) == pytest.approx((3.0, 4.0))
    assert (ring.outer_mm, ring.bore_mm) == pytest.approx((40.0, 10.0), rel=1e-3)
    assert ring.polar_ratio == pytest.approx(1.0, rel=1e-3)


def test_a_square_journal_is_not_round(mikron: Scene) -> None:
    main, pin = journal_halves(mikron)
    side = np.sqrt(np.pi) * 21.0
    square = Manifold.cube((side, side, 20.0)).translate((-side / 2, -side / 2, 0.0))
    bored = square - cylinder(12.0, 0.0, (-1.0, 21.0))
    assert any(
        "not round" in line for line in misfits(bored + pin + cylinder(30.0, 24.0, (20.0, 39.0)), mikron)
    )
    assert main.volume() > 0


@pytest.mark.parametrize(
    ("scale", "words"),
    [
        (1.0, "A whole shaft is read by `cranktopo import`"),
        (
            1e-3,
            r"is 0\.456 long.*in metres it would be 456 mm, a whole shaft, which `cranktopo import` reads",
        ),
        (1 / 25.4, r"in inches it would be 456 mm, a whole shaft"),
    ],
    ids=["mm", "metres", "inches"],
)
def test_a_whole_shaft_is_named_as_one(mikron: Scene, scale: float, words: str) -> None:
    """Four throws of journals and discs, 456 mm, along the crank axis and across it."""
    journals = cylinder(21.0, 0.0, (0.0, 456.0))
    discs = (cylinder(60.0, 10.0, (at, at + 19.0)) for at in range(20, 400, 57))
    shaft = sum(discs, journals).scale((scale,) * 3)
    for lying in (shaft, shaft.rotate((0.0, 90.0, 0.0))):
        with pytest.raises(CranktopoError) as raised:
            placed(lying, mikron, "shaft.step", align=True)
        assert re.search(words, raised.value.hint or ""), raised.value.hint


def test_a_web_alone_is_no_shaft_of_another_unit(mikron: Scene) -> None:
    with pytest.raises(CranktopoError) as raised:
        placed(cylinder(20.0, 0.0, (0.0, 19.0)), mikron, "web.step", align=False)
    assert raised.value.hint == "Is 'mikron-iiic-plain' the design that it was made from?"


@pytest.mark.parametrize(("bore_mm", "off_mm"), [(0.0, 0.0), (0.0, 30.0), (20.0, 30.0)])
def test_a_drilling_that_passes_is_no_bore(bore_mm: float, off_mm: float) -> None:
    """An oil drilling of 10 mm that leans through a solid journal was refused as a bore of 15.6 mm."""
    journal = Manifold.cylinder(60.0, 55.0, circular_segments=256)
    if bore_mm:
        journal -= Manifold.cylinder(60.0, bore_mm / 2, circular_segments=128)
    drilling = Manifold.cylinder(300.0, 5.0, circular_segments=64).translate((0.0, 0.0, -150.0))
    ring = ring_at(journal - drilling.rotate((55.0, 0.0, 0.0)).translate((0.0, off_mm, 30.0)), 30.0)
    assert ring is not None
    assert ring.outer_mm == pytest.approx(110.0, rel=1e-3)
    assert ring.bored == bool(bore_mm)
    assert not bore_mm or ring.bore_mm == pytest.approx(bore_mm, rel=2e-3)
