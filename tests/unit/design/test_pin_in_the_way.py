"""A counterweight that passes the axis of the piston pin fits no piston, whatever its skirt."""

from __future__ import annotations

from cranktopo.design.clearance import clearance_text, pin_in_the_way
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.schema import Scene
from cranktopo.design.shape import ShapeTable
from cranktopo.tasks.balance.proposal import propose_counterweight


def with_rod(length_mm: float) -> Scene:
    """The car diesel, throw 44 mm, with another rod, and nothing in the way of its counterweights."""
    scene = load_scene("car-diesel")
    engine = scene.engine.model_copy(update={"rod_length_mm": length_mm})
    return scene.model_copy(update={"engine": engine, "envelope": None, "shape": ShapeTable()})


def test_it_is_told_where_the_rod_is_short() -> None:
    near, far = (
        with_values(with_rod(140.0), {"web.counterweight.outer_radius_mm": radius}) for radius in (96.1, 95.9)
    )
    told = pin_in_the_way(near)
    assert "past the axis of the piston pin at 96 mm at bottom dead centre" in told
    assert clearance_text(near) == told
    assert pin_in_the_way(far) == pin_in_the_way(load_scene("mikron-iiic")) == ""


def test_a_proposal_that_reaches_it_is_refused_or_wider() -> None:
    """Of a long rod the own half-angle; of a shorter one a wider one with less radius, or none."""
    long, short, none = (propose_counterweight(with_rod(length), 0.0) for length in (140.0, 122.5, 115.0))
    assert (long.refused, long.half_angle_deg) == (None, 65.0)
    assert long.outer_radius_mm > 122.5 - 44.0
    assert short.refused is None
    assert short.half_angle_deg > 65.0
    assert short.outer_radius_mm < 122.5 - 44.0
    assert none.refused is not None
    assert "past the axis of the piston pin at 71 mm" in none.refused


def test_a_proposal_prefers_flanks_with_the_draft_asked_for() -> None:
    """Of a forging in x = 0: 90 deg less the draft comes before wider ones; what is wider is told."""
    drafted, wider = (
        propose_counterweight(with_rod(122.5).with_optimise(process="forged", draft_deg=asked), 0.0)
        for asked in (12.0, 15.0)
    )
    assert (drafted.half_angle_deg, drafted.draft, drafted.refused) == (78.0, None, None)
    assert (wider.half_angle_deg, wider.refused) == (80.0, None)
    assert wider.draft == "its flanks have 10 deg of draft, optimise.draft_deg asks for 15"
