"""The examination by a second kernel: random throws are sound, and what is wrong with a body is found.

`python -m tests.studies.second_kernel` examines as many throws as there is time for.
"""

from __future__ import annotations

from itertools import pairwise
from pathlib import Path
from typing import Any

import pytest

from cranktopo.bodies.solid.files import export_solid
from cranktopo.design.schema import Scene
from tests.cad_check.second_kernel import crossing_wires, disguises, examined, ocp, read_shape, sub_shapes
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


@pytest.mark.parametrize(("middle", "crossed"), [((13.0, 5.0), 2), ((5.0, -5.0), 0)])
def test_a_wire_that_crosses_itself_is_found(middle: tuple[float, float], crossed: int) -> None:
    """An arc from (0, 0) to (10, 0) in place of the lower side, across the sides beside it or outside."""
    point, make = ocp("gp").gp_Pnt, ocp("BRepBuilderAPI")
    corners = [point(*at, 0.0) for at in ((0.0, 0.0), (10.0, 0.0), (10.0, 20.0), (0.0, 20.0))]
    arc = ocp("GC").GC_MakeArcOfCircle(corners[0], point(*middle, 0.0), corners[1]).Value()
    sides = [make.BRepBuilderAPI_MakeEdge(*ends).Edge() for ends in pairwise([*corners[1:], corners[0]])]
    wire = make.BRepBuilderAPI_MakeWire()
    for edge in (make.BRepBuilderAPI_MakeEdge(arc).Edge(), *sides):
        wire.Add(edge)
    face = make.BRepBuilderAPI_MakeFace(ocp("gp").gp_Pln(), wire.Wire()).Face()
    assert len(list(crossing_wires([face]))) == crossed
