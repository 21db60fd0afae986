"""STEP files of other programs: another schema of ISO 10303, and lengths in inches."""

from __future__ import annotations

from pathlib import Path

import pytest

from cranktopo import load_scene
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.solid.step import step_solid
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.tasks.importing.faces import exact_faces

MM = "( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )"
INCH = """( CONVERSION_BASED_UNIT('INCH',#90001) LENGTH_UNIT() NAMED_UNIT(#90002) );
#90001 = LENGTH_MEASURE_WITH_UNIT(LENGTH_MEASURE(25.4),#90003);
#90002 = DIMENSIONAL_EXPONENTS(1.,0.,0.,0.,0.,0.,0.);
#90003 = ( LENGTH_UNIT() NAMED_UNIT(*) SI_UNIT(.MILLI.,.METRE.) )"""
SCHEMAS = {
    "AP203": "CONFIG_CONTROL_DESIGN",
    "AP242": "AP242_MANAGED_MODEL_BASED_3D_ENGINEERING_MIM_LF { 1 0 10303 442 1 1 4 }",
}


@pytest.fixture(scope="module")
def half(tmp_path_factory: pytest.TempPathFactory) -> tuple[str, float]:
    """Text and volume of a half throw as this program writes it."""
    file = tmp_path_factory.mktemp("half") / "half.step"
    volume = export_solid(load_scene("mikron-iiic-plain"), "half", file)
    return file.read_text(encoding="ascii"), volume


def measured(text: str, file: Path) -> tuple[float, set[float]]:
    """Volume and radii of the cylinders of a file, mm."""
    file.write_text(text, encoding="ascii")
    with cad_session("dialect") as gmsh:
        body = step_solid(gmsh, file, file.name)
        radii = {round(face.radius_mm, 9) for face in exact_faces(gmsh).cylinders}
        return float(gmsh.model.occ.getMass(*body)), radii


@pytest.mark.parametrize("schema", SCHEMAS)
def test_other_schemas_are_read(schema: str, half: tuple[str, float], tmp_path: Path) -> None:
    head, schema_line, tail = half[0].partition("FILE_SCHEMA")
    assert schema_line
    text = f"{head}FILE_SCHEMA(('{SCHEMAS[schema]}'));{tail[tail.index(';') + 1 :]}"
    assert "AUTOMOTIVE_DESIGN" not in text
    volume, radii = measured(text, tmp_path / "other.step")
    assert volume == pytest.approx(half[1], rel=1e-9)
    assert radii == {25.0, 21.0, 12.0}


def test_inches_are_read_as_such(half: tuple[str, float], tmp_path: Path) -> None:
    assert half[0].count(MM) == 1
    volume, radii = measured(half[0].replace(MM, INCH), tmp_path / "inches.step")
    assert volume == pytest.approx(half[1] * 25.4**3, rel=1e-9)
    assert radii == {635.0, 533.4, 304.8}
