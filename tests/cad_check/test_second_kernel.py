"""The examination by a second kernel: random throws are sound, and what is wrong with a body is found.

`python -m tests.studies.second_kernel` examines as many throws as there is time for.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cranktopo.bodies.solid.files import export_solid
from cranktopo.design.schema import Scene
from tests.cad_check.second_kernel import disguises, examined, ocp, read_shape, sub_shapes
from tests.cad_check.test_step_second_binding import written
from tests.studies.second_kernel import faults, rows

pytestmark = pytest.mark.slow


@pytest.mark.parametrize("seed", [1, 3])
def test_random_throws_are_sound(seed: int, tmp_path: Path) -> None:
    for row in rows(seed, tmp_path):
        assert faults(row) == [], row


@pytest.fixture
def half(mikron: Scene, tmp_path: Path) -> Any:
    export_solid(mikron, "half", tmp_path / "half.step")
    return read_shape(tmp_path / "half.step")


def test_fillets_as_splines_are_found(half: Any) -> None:
    """The same body with each face a B-spline: planes, cylinders and two tori in disguise."""
    splines = ocp("BRepBuilderAPI").BRepBuilderAPI_NurbsConvert(half, True).Shape()
    assert disguises(half) == {}
    found = disguises(splines)
    assert found["BSplineSurface is a Torus"] == 2
    assert sum(found.values()) == sum(1 for _ in sub_shapes(half, "FACE"))


def test_a_body_that_lacks_a_face_is_found(half: Any, tmp_path: Path) -> None:
    shell = next(sub_shapes(half, "SHELL"))
    face = next(sub_shapes(shell, "FACE"))
    shell.Free(True)
    ocp("BRep").BRep_Builder().Remove(shell, face)
    assert examined(written(half, tmp_path / "open.step")).faults
