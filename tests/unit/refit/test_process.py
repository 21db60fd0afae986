"""What a re-model keeps of the process of its design."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cranktopo.design.schema import Scene
from cranktopo.tasks.refit import select
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.refit.process import fit_limits, process_limits
from cranktopo.tasks.refit.search import FitProblem
from cranktopo.throw.manufacturing_limits import Workshop

CAST = {"process": "cast", "parting": "web_faces", "draft_deg": 5.0}
REGION = {"kind": "recess", "volume_mm3": 900.0, "centre_mm": (0.0, 24.0, 36.0), "pair": False, "face": "pin"}
REGION |= {"low_mm": (0.0, 16.0, 33.0), "high_mm": (10.0, 32.0, 39.0)}


def pockets(scene: Scene, monkeypatch: pytest.MonkeyPatch) -> list[Any]:
    """Kinds that the re-model tries where the body has a recess in the pin face."""
    monkeypatch.setattr(select, "model_fill", lambda *_: None)
    monkeypatch.setattr(select, "residual_regions", lambda *_: [select.ResidualRegion(**REGION)])
    unread: Any = None
    problem = FitProblem(unread, np.zeros(0), scene, fit_limits(scene, usual_limits(scene)))
    return [part for part, _ in select._pockets(problem, unread)]


def test_pockets_of_a_mould_have_its_draft_and_radii(mikron: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    tried = pockets(mikron.with_optimise(**CAST), monkeypatch)
    assert [(p.shape, p.draft_deg, p.floor_radius_mm) for p in tried] == [
        ("cylinder", 5.0, 6.0),
        ("box", 5.0, 6.0),
    ]
    assert tried[1].corner_radius_mm == 6.0


def test_a_lateral_die_gets_no_pocket_of_a_face(mikron: Scene, monkeypatch: pytest.MonkeyPatch) -> None:
    assert pockets(mikron.with_optimise(process="forged", parting="lateral"), monkeypatch) == []


def test_limits_are_those_of_shape_and_a_free_process_has_none(mikron: Scene) -> None:
    forged = mikron.with_optimise(process="forged", parting="web_faces", draft_deg=5.0)
    given = {"min_wall_mm": 4.0}
    limits = usual_limits(forged, **given)
    assert fit_limits(forged, limits) == process_limits(forged, limits)
    free = fit_limits(mikron, limits)
    assert free.workshop == Workshop()
    assert free.min_wall_mm == 4.0
