"""A comparison sets bodies with fillets beside bodies with fillets, or none beside none."""

from __future__ import annotations

from pathlib import Path

from cranktopo.design.loading import load_scene
from cranktopo.tasks.compare.stage import _like_for_like
from cranktopo.tasks.fea.targets import Target


def test_beside_the_surface_of_a_run_designs_have_no_fillets() -> None:
    scene = load_scene("mikron-iiic")
    run = Target("run", scene, Path("web.stl"), Path("run"))
    design, body = _like_for_like([Target("design", scene), run])
    assert design.scene.throw.crankpin.fillet_mm == design.scene.throw.main_journal.fillet_mm == 0
    assert body is run


def test_designs_alone_keep_theirs() -> None:
    target = Target("design", load_scene("mikron-iiic"))
    assert _like_for_like([target, target]) == [target, target]
