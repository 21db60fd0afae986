"""The webs of a whole crank, searched for and joined, on coarse meshes: the crank is what is told of it."""

from __future__ import annotations

from pathlib import Path

import pytest

from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.halves import halves
from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_goal, with_values
from cranktopo.tasks.shaft_safety.stage import assess_shaft
from cranktopo.tasks.shape.each_web.run import shape_each_web
from cranktopo.tasks.shape.stage import ShapeSettings

COARSE = ShapeSettings(cell_mm=9.0, mesh_mm=14.0, rounds=1, element_size_mm=14.0, fillet_fraction=1.0)


@pytest.mark.slow
def test_the_crank_that_is_written_is_the_one_that_is_told(tmp_path: Path) -> None:
    """Inner webs get one shape and outer ones another; `shaft` finds the told mass and safety of each web."""
    scene = with_values(load_scene("mikron-iiic"), {"shape.same_webs": [[1, 4, 5, 8], [2, 3, 6, 7]]})
    scene = with_goal(scene, minimise="mass", limits=["torsion >= 80 %", "bending >= 80 %"])
    found = shape_each_web(scene, COARSE, tmp_path / "run").result
    own = found.each_web
    assert found.required_safety == found.original.safety
    assert [group.webs for group in own.groups] == [(1, 4, 5, 8), (2, 3, 6, 7)]
    crank = load_scene(str(tmp_path / "run" / own.design), whole=True)
    webs = [half.web for throw in throw_scenes(crank) for half in halves(throw)]
    assert webs[0] == webs[3] == webs[4] == webs[7] != webs[1] == webs[2] == webs[5] == webs[6]
    told = assess_shaft(crank, "rigid", method="lsa", fillet_fraction=COARSE.fillet_fraction)
    assert told.safety is not None
    assert told.mass_kg == pytest.approx(own.shaft.mass_kg, rel=1e-6)
    assert [web.safety for web in told.safety.webs] == pytest.approx(own.shaft.safeties, rel=1e-6)
    assert own.shaft.mass_kg < found.original.mass_kg
    for group in own.groups:  # a throw of the web that it is, by its own evaluation
        single = load_scene(str(tmp_path / "run" / group.folder / "web.toml"))
        assert single.web == webs[group.webs[0] - 1]
