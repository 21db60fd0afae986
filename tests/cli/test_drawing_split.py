"""Drawing of a throw with a split pin: each half with its own half pin up, the other one at its angle."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import Circle

from cranktopo.app.main import main
from cranktopo.base.frames import about_z_deg
from cranktopo.bodies.solid.files import kernel_surface_of
from cranktopo.bodies.volume import half_throw_volume_mm3
from cranktopo.design.crank_throws import straightened, throw_scenes
from cranktopo.design.loading import scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.writing import save_scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.surfaces.mesh import solid_of
from cranktopo.tasks.drawing.sheet import drawing_figures, throw_sheets
from tests.cli.test_drawing import texts
from tests.drawn_texts import beyond_frame, near_leaders, over_each_other, over_edges, over_lines
from tests.physics.engine.test_crank_bearings import FLYING, mikron
from tests.physics.throw.test_split_pin_bodies import SPLAY, split


def one_pocket(splay: float) -> Scene:
    """Both webs have a pocket beside the middle: the second one is the mirror image of the first."""
    data = split(splay).model_dump(mode="json", exclude_none=True, by_alias=True)
    pocket = {"shape": "box", "face": "pin", "x_mm": 12.0, "y_mm": -40.0}
    data["web"]["pocket"] = [pocket | {"size_x_mm": 12.0, "size_y_mm": 10.0, "depth_mm": 4.0}]
    return scene_from_dict(data, "pocket", whole=True)


def dash_dotted(figure: Figure) -> np.ndarray:
    """Centre and radius of the half pin that is cut away before the front view."""
    (found,) = (
        patch
        for patch in figure.axes[0].patches
        if isinstance(patch, Circle) and patch.get_linestyle() in ("-.", "dashdot")
    )
    return np.array([*found.center, found.radius])


@pytest.mark.parametrize("splay", [SPLAY, pytest.param(40.0, marks=pytest.mark.slow)])
def test_the_other_half_pin_is_drawn_where_the_body_has_it(splay: float) -> None:
    """Sections of the exact throw beyond the middle, from the crankpin with the own half pin up."""
    scene = one_pocket(splay)
    whole = solid_of(kernel_surface_of(scene, "throw"), "throw")
    figures = drawing_figures(throw_sheets(scene, throw=whole), throw_balance(scene))
    assert len(figures) == 2
    for figure, off, turn, x_way in zip(figures, (3.0, -3.0), (-splay / 2, splay / 2), (1, -1), strict=True):
        upright = whole.rotate((0.0, 0.0, about_z_deg(-turn)))
        (ring,) = upright.translate((0.0, 0.0, -scene.pitch_mm / 2 - off)).slice(0.0).to_polygons()
        low, high = ring.min(axis=0), ring.max(axis=0)
        expected = [x_way * (low + high)[0] / 2, (low + high)[1] / 2, (high - low)[0] / 2]
        np.testing.assert_allclose(dash_dotted(figure), expected, atol=0.1)


def test_halves_that_half_a_turn_makes_one_of_the_other_have_one_sheet() -> None:
    scene = split(SPLAY)
    (sheet,) = throw_sheets(scene)
    assert sheet.solid.volume() == pytest.approx(half_throw_volume_mm3(straightened(scene)), rel=1e-3)
    (figure,) = drawing_figures([sheet], throw_balance(scene))
    found = " ".join(" ".join(texts(figure)).split())
    for wanted in (
        "30° ±0.2°",
        "half pin 21.5 long",
        "half pin b, toward the output, is 30° behind",
        "one, half a turn",
    ):
        assert wanted in found
    assert "⌀45" in found
    assert "mirror image" not in found


def test_a_pocket_beside_the_middle_is_on_the_other_side_of_the_second_sheet() -> None:
    """Half a turn would bring it to the same side: such halves have a sheet each."""
    sheets = throw_sheets(one_pocket(SPLAY))
    assert [sheet.half for sheet in sheets] == ["first", "second"]
    for sheet, x in zip(sheets, (12.0, -12.0), strict=True):
        floor = sheet.solid.translate((0.0, 0.0, 1.0 - sheet.scene.web_z_mm[1])).slice(0.0)
        middles = [(ring.min(axis=0) + ring.max(axis=0)) / 2 for ring in floor.to_polygons()]
        assert any(np.allclose(middle, (x, -40.0)) for middle in middles)
    assert "one, half a turn" not in " ".join(
        texts(drawing_figures(sheets, throw_balance(sheets[0].scene))[0])
    )


@pytest.mark.slow
@pytest.mark.parametrize(
    "scene",
    [split(SPLAY), split(70.0), split(3.0), split(SPLAY, 6, "second", 1.0)],
    ids=["30 behind", "70 ahead", "3 ahead", "drilled"],
)
def test_no_text_lies_over_another(scene: Scene) -> None:
    for figure in drawing_figures(throw_sheets(scene), throw_balance(scene)):
        for misplaced in (over_each_other, over_edges, over_lines, beyond_frame, near_leaders):
            assert not misplaced(figure), misplaced.__name__


def test_export_draws_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    save_scene(split(SPLAY), tmp_path / "v2.toml")
    assert main(["export", str(tmp_path / "v2.toml"), str(tmp_path / "throw.pdf")]) == 0
    assert "workshop drawing, A3" in capsys.readouterr().out


@pytest.mark.slow
def test_a_half_beside_a_flying_web_has_no_main_journal() -> None:
    """It had a hidden circle of the journal's diameter, and dimensions of that and of its length, 0."""
    scene = throw_scenes(mikron(bearings=[0, 2, 4], main_journal=FLYING))[0]
    first, second = drawing_figures(throw_sheets(scene), throw_balance(scene))
    for figure, journals in ((first, 2), (second, 1)):
        rings = [one for one in figure.axes[0].patches if isinstance(one, Circle) and one.radius == 21.0]
        assert len(rings) == journals
        assert sum(text == "⌀42" for text in texts(figure)) == journals
        assert "0" not in texts(figure)
    assert "are one flying web" in "\n".join(texts(second))
    assert "flying" not in "\n".join(texts(first))
