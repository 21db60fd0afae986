"""STEP files read and written by a second OCC binding, which shares no code with gmsh's.

Needs the optional extra: `pip install -e '.[cad-check]'`, then `python -m pytest tests/cad_check -m slow`.
Skipped without it.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from cranktopo.base.formats import PARTS, SolidPart
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.solid.step import step_surface
from cranktopo.design.loading import builtin_designs, load_scene
from cranktopo.design.schema import Scene
from cranktopo.tasks.importing.imported_body import half_throw_surface
from cranktopo.throw.raw_part.table import Forging
from tests.cad_check.second_kernel import ocp, sub_shapes
from tests.unit.refit.remodel_cases import WHOLE, known_scene

pytestmark = pytest.mark.slow
ONE_SOLID = tuple(part for part in PARTS if part != "plugs")
BOX_MM = 1e-4


def read(path: Path) -> Any:
    """The document of a STEP file, its names kept."""
    reader = ocp("STEPCAFControl").STEPCAFControl_Reader()
    document = ocp("TDocStd").TDocStd_Document(ocp("TCollection").TCollection_ExtendedString("check"))
    reader.SetNameMode(True)
    assert reader.ReadFile(str(path)) == ocp("IFSelect").IFSelect_ReturnStatus.IFSelect_RetDone
    assert reader.Transfer(document)
    return reader, document


def free_shapes(document: Any) -> list[tuple[str, Any]]:
    """Name and shape of each product that no other one holds."""
    tool = ocp("XCAFDoc").XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    labels = ocp("TDF").TDF_ChildIterator(tool.BaseLabel())
    found = []
    while labels.More():
        label = labels.Value()
        name = ocp("TDataStd").TDataStd_Name()
        assert label.FindAttribute(ocp("TDataStd").TDataStd_Name.GetID_s(), name)
        if tool.IsFree_s(label):
            found.append((name.Get().ToExtString(), tool.GetShape_s(label)))
        labels.Next()
    return found


def count(shape: Any, kind: str, outside: str | None = None) -> int:
    return sum(1 for _ in sub_shapes(shape, kind, outside))


def box(shape: Any) -> list[float]:
    bounds = ocp("Bnd").Bnd_Box()
    ocp("BRepBndLib").BRepBndLib.AddOptimal_s(shape, bounds, True, False)
    low, high = bounds.CornerMin(), bounds.CornerMax()
    return [low.X(), low.Y(), low.Z(), high.X(), high.Y(), high.Z()]


def check_part(scene: Scene, part: SolidPart, path: Path) -> None:
    """Write a part and read it: one sound named solid of its volume, nothing beside it, where it belongs."""
    volume = export_solid(scene, part, path)
    _, document = read(path)
    [(name, shape)] = free_shapes(document)
    assert name.startswith(f"{scene.name} ")
    assert (count(shape, "SOLID"), count(shape, "SHELL", "SOLID")) == (1, 0)
    assert [count(shape, kind, holder) for kind, holder in (("FACE", "SHELL"), ("EDGE", "FACE"))] == [0, 0]
    assert count(shape, "VERTEX", "EDGE") == 0
    assert ocp("BRepCheck").BRepCheck_Analyzer(shape).IsValid()
    properties = ocp("GProp").GProp_GProps()
    ocp("BRepGProp").BRepGProp.VolumeProperties_s(shape, properties)
    assert properties.Mass() == pytest.approx(volume, rel=1e-5)
    solid = ocp("TopExp").TopExp_Explorer(shape, ocp("TopAbs").TopAbs_ShapeEnum.TopAbs_SOLID).Current()
    assert box(shape) == pytest.approx(box(solid), abs=BOX_MM)
    ends = {"web": scene.web_z_mm, "half": (0.0, scene.pitch_mm / 2), "throw": (0.0, scene.pitch_mm)}
    ends["raw"] = ends["throw"]
    if part in ends:
        assert (box(shape)[2], box(shape)[5]) == pytest.approx(ends[part], abs=BOX_MM)


def with_all_parts(scene: Scene) -> Scene:
    """The scene with a rod of its own length, a balancer shaft and a forging: every part can be written."""
    rod, engine = load_scene("mikron-iiic-rod"), scene.engine or load_scene("mikron-iiic-rod").engine
    assert engine is not None
    long = engine.model_copy(update={"rod_length_mm": 166.0})
    forging = Forging(allowance_mm=1.0, flash_mm=2.0)
    shaft = load_scene("balancer-shaft").balancer
    return scene.model_copy(update={"rod": rod.rod, "balancer": shaft, "engine": long, "forging": forging})


@pytest.mark.parametrize("part", ONE_SOLID)
@pytest.mark.parametrize("design", sorted(builtin_designs()))
def test_one_named_sound_solid(design: str, part: SolidPart, tmp_path: Path) -> None:
    check_part(with_all_parts(load_scene(design)), part, tmp_path / f"{design}-{part}.step")


@pytest.mark.parametrize("part", ONE_SOLID)
def test_a_re_modelled_web(part: SolidPart, mikron: Scene, tmp_path: Path) -> None:
    """Spline outline, end bevels, side pocket and pair of pockets."""
    check_part(with_all_parts(known_scene(mikron, WHOLE)), part, tmp_path / f"{part}.step")


def written(shape: Any, path: Path) -> Path:
    """A shape as a STEP file of the other binding."""
    writer = ocp("STEPControl").STEPControl_Writer()
    writer.Transfer(shape, ocp("STEPControl").STEPControl_StepModelType.STEPControl_AsIs)
    assert writer.Write(str(path)) == ocp("IFSelect").IFSelect_ReturnStatus.IFSelect_RetDone
    return path


def test_an_envelope_that_it_wrote(mikron: Scene, tmp_path: Path) -> None:
    corners = [ocp("gp").gp_Pnt(*corner) for corner in ((-48.0, -34.0, 20.0), (48.0, 82.0, 39.0))]
    box = ocp("BRepPrimAPI").BRepPrimAPI_MakeBox(*corners).Shape()
    surface = step_surface(written(box, tmp_path / "space.step"), "space.step")
    assert surface.volume_mm3 == pytest.approx(96.0 * 116.0 * 19.0, rel=1e-9)


def test_a_half_throw_that_it_wrote(mikron: Scene, tmp_path: Path) -> None:
    volume = export_solid(mikron, "half", tmp_path / "half.step")
    _, document = read(tmp_path / "half.step")
    [(_, shape)] = free_shapes(document)
    surface = half_throw_surface(written(shape, tmp_path / "again.step"), mikron)
    assert surface.volume_mm3 == pytest.approx(volume, rel=1e-3)
