"""The volume of a web with a pocket by every model that has it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.volume import web_volume_mm3
from cranktopo.design.schema import Scene
from cranktopo.tasks.refit.fit import scene_with_web
from tests.step_volume import step_volume_mm3
from tests.unit.refit.remodel_cases import table


def check_volumes(mikron: Scene, pocket: dict[str, Any], tmp_path: Path) -> None:
    """The CAD kernel, its STEP file, sections and cells to 1e-6."""
    scene = scene_with_web(mikron, table(pocket=[pocket]))
    volume = export_solid(scene, "web", tmp_path / "web.step")
    assert volume == pytest.approx(web_volume_mm3(scene), rel=1e-6)
    assert step_volume_mm3(tmp_path / "web.step") == pytest.approx(volume, rel=1e-6)
    domain = build_domain(scene, 4.0, "web", extent="half")
    assert float((domain.web * domain.volume_mm3).sum()) == pytest.approx(volume, rel=1e-6)
