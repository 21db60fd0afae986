"""A result that weighs something else says with which volume fraction it would not."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from cranktopo.base.notes import silent
from cranktopo.design.loading import load_scene
from cranktopo.tasks.optimise.stage import optimise_design
from tests.plain_runs import plain_runs
from tests.studies.own_webs import own_volume_fraction

COARSE = {"resolution_mm": 4.5, "max_iterations": 2}


@pytest.mark.slow
@pytest.mark.parametrize("name", ["mikron-iiic", "car-diesel"])
def test_the_volume_fraction_of_the_own_mass_is_that_of_the_own_web(name: str, tmp_path: Path) -> None:
    """Against the share of the design space that the web itself fills, counted cell by cell."""
    scene = load_scene(name).with_optimise(volume_fraction=0.55, **COARSE).with_effect("bound", "off")
    with silent(), plain_runs():
        metrics = optimise_design(scene, tmp_path / "run").metrics
        share = own_volume_fraction(scene)
    (told,) = (one for one in metrics.notices if "--volume-fraction" in one)
    found = re.search(r"--volume-fraction (0\.\d+) the web weighs what the original's does", told)
    assert found
    assert float(found[1]) == pytest.approx(share, abs=2e-3)
