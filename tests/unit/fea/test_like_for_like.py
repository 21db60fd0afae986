"""A comparison sets bodies with fillets beside bodies with fillets, or none beside none."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

from cranktopo.design.loading import load_scene
from cranktopo.engine.plan.simulated import strip_features
from cranktopo.tasks.compare.stage import _like_for_like
from cranktopo.tasks.throw_fea.targets import Target, unlike_fillet_line


def test_beside_the_surface_of_a_run_designs_have_no_fillets() -> None:
    scene = load_scene("mikron-iiic")
    run = Target("run", scene, Path("web.stl"), Path("run"))
    design, body = _like_for_like([Target("design", scene), run])
    assert design.scene.throw.crankpin.fillet_mm == design.scene.throw.main_journal.fillet_mm == 0
    assert body is run


def test_designs_alone_keep_theirs() -> None:
    target = Target("design", load_scene("mikron-iiic"))
    assert _like_for_like([target, target]) == [target, target]


def test_evaluate_tells_that_the_surface_of_a_run_has_no_fillets() -> None:
    scene = load_scene("mikron-iiic-plain")
    design, surface = Target("design", scene), Target("run4", scene, Path("web.stl"), Path("run4"))
    body = Target("body.step", scene, Path("body.step"))
    assert "run4: the surface of a run has no fillets, which make design stiffer" in unlike_fillet_line(
        [design, surface]
    )
    assert "run4: the surface of a run has no fillets, which make its design stiffer" in unlike_fillet_line(
        [surface]
    )
    assert unlike_fillet_line([replace(surface, scene=strip_features(scene, "fillets"))]) == ""
    for alike in (
        [design, body],
        [surface, body],
        [replace(design, scene=strip_features(scene, "fillets")), surface],
    ):
        assert unlike_fillet_line(alike) == ""
