"""A crank that vibrates as one meshed body with all its unknowns beside `shaft --dynamic`."""

from __future__ import annotations

import pytest

from cranktopo.design.loading import load_scene
from cranktopo.engine.analysis import at_speed
from tests.studies.one_body_in_motion import columns


@pytest.mark.slow
def test_a_crank_in_one_piece_vibrates_alike() -> None:
    """Motions within 1 %, the largest stress of every fillet within 2 %; the body's modes suffice."""
    found = columns(at_speed(load_scene("mikron-iiic", whole=True), 2100.0), 20.0)
    ours, rigid, body = (
        found[name] for name in ("shaft, warping sections", "shaft, rigid sections", "body, 20 modes")
    )
    local = {name for name in ours if name.endswith("difference")}
    stress = {name for name in ours if name.endswith("largest stress")}
    motions = ours.keys() - local - stress
    assert max(ours[name] for name in motions) < 1.0
    assert max(abs(ours[name]) for name in stress) < 2.0
    assert max(body[name] for name in motions) < 0.3
    assert max(rigid[name] for name in motions) > 3.0
