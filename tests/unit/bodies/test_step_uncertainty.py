"""What a STEP file tells as its uncertainty: no less than curves end from their points."""

from __future__ import annotations

import re
from dataclasses import replace
from pathlib import Path

import pytest

from cranktopo.bodies.solid.boundaries import apart_mm
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.solid.step import labelled
from cranktopo.numerics.gmsh_session import cad_session, quiet_stdout
from tests.featured_throws import featured_throw
from tests.unit.bodies.test_step_text import LABEL

FILE = (
    "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\nENDSEC;\nDATA;\n"
    "#1 = PRODUCT('','','',(#2));\n#3 = MANIFOLD_SOLID_BREP('',#4);\n"
    "#5 = UNCERTAINTY_MEASURE_WITH_UNIT(LENGTH_MEASURE(5.E-06),#6,'distance_accuracy_value','');\nENDSEC;\n"
)


def told(text: str) -> list[str]:
    return re.findall(r"UNCERTAINTY_MEASURE_WITH_UNIT\(LENGTH_MEASURE\(([^)]*)\)", text)


@pytest.mark.parametrize(
    ("apart_mm", "text"),
    [(0.0, "5.E-06"), (4.9e-6, "5.E-06"), (4.26e-5, "5.0E-05"), (9.7e-5, "10.0E-05"), (1.5e-3, "2.0E-03")],
)
def test_it_is_that_of_the_kernel_or_larger_rounded_up(apart_mm: float, text: str) -> None:
    assert told(labelled(FILE, replace(LABEL, apart_mm=apart_mm))) == [text]


def test_a_file_tells_the_largest_distance_of_its_body(tmp_path: Path) -> None:
    """A rounded floor that just reaches the outline: 6e-7 mm, where 1e-7 mm were told."""
    scene = featured_throw(348)
    path = tmp_path / "half.step"
    export_solid(scene, "half", path)
    (uncertainty,) = map(float, told(path.read_text()))
    with cad_session("read") as gmsh, quiet_stdout():
        gmsh.model.occ.importShapes(str(path))
        gmsh.model.occ.synchronize()
        assert apart_mm(gmsh) < uncertainty
    assert 6e-7 < uncertainty < 1e-6
