"""Bodies cut from densities: the shares of cells that a cut fills, and a body that the bound stays beyond."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.numerics.precision import double_precision
from tests.physics.bound.bound_cases import quantities_of
from tests.studies.bound_proof import Judged, cells_of, stay_above, throw_of
from tests.studies.density_bodies import body, nearest_body


def test_a_plane_cuts_cells_by_their_share() -> None:
    """A field that falls along the first axis, cut through the middle of a cell and a quarter of the next."""
    field = np.broadcast_to(10.0 - np.arange(6.0)[:, None, None], (6, 3, 4)).copy()
    design = np.ones(field.shape)
    for level, filled in ((7.0, [1, 1, 1, 0.5, 0, 0]), (6.75, [1, 1, 1, 0.75, 0, 0])):
        assert body(field, design, level) == pytest.approx(
            np.broadcast_to(np.c_[filled][:, None], field.shape)
        )


def test_a_ball_has_its_volume_and_voids_stay_empty() -> None:
    x, y, z = np.meshgrid(*[np.arange(24) - 11.5] * 3, indexing="ij")
    field, design = -np.sqrt(x**2 + y**2 + z**2), np.where(x > 0, 1.0, 0.0)
    filled = body(field, design, -8.0)
    assert filled.sum() == pytest.approx(2 / 3 * np.pi * 8.0**3, rel=0.02)
    assert not filled[design == 0].any()


@pytest.mark.slow
def test_a_body_comes_within_two_percent_of_the_bound() -> None:
    """The lightest web of an engine: what is proven holds for it, and the table of the page has its gap."""
    with double_precision():
        scene = throw_of("opposed-piston")
        model = cells_of(scene)
        found = nearest_body(scene, model, "mass")
        assert found.body is not None
        assert found.value is not None
        assert found.bound.value is not None
        web = Judged("body", quantities_of(model, found.body))
        assert stay_above(model, found.bound.density, [web])
        assert found.bound.value < found.value
        assert found.gap_percent == pytest.approx(1.4, abs=0.1)
