"""Random throws whose STEP file a second kernel could not read as a sound body, or that were refused.

`python -m pytest tests/cad_check -m slow`, with the optional extra `cad-check`.
"""

from __future__ import annotations

from pathlib import Path

import pytest

from cranktopo.bodies.solid.files import bolted_bodies, export_solid
from tests.cad_check.second_kernel import examined
from tests.featured_throws import featured_throw
from tests.studies.second_kernel import LARGEST_TOLERANCE_MM, MESH_ERROR

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("seed", [348, 350, 403, 463, 777])
def test_a_second_kernel_reads_it_as_a_sound_body(seed: int, tmp_path: Path) -> None:
    path = tmp_path / "throw.step"
    scene = featured_throw(seed)
    export_solid(scene, "throw", path)
    found = examined(path, 1 + len(bolted_bodies(scene, "throw")))
    assert found.faults == ()
    assert found.tolerance_mm < LARGEST_TOLERANCE_MM
    assert abs(found.mesh_error) < MESH_ERROR
