"""A web of the family is read back from its scene as it was written."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cranktopo.design.loading import load_scene, parse_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.design.writing import toml_text
from cranktopo.tasks.refit.family import Layout, web_of, with_free
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.refit.read_web import read_web
from cranktopo.tasks.web_shape.start import outline_start, scene_start
from cranktopo.throw.bevel import FittedBevel
from cranktopo.throw.fitted import FittedFeature
from cranktopo.throw.fitted_pocket import FittedBox, FittedCylinder
from cranktopo.throw.fitted_slot import FittedSlot
from tests.physics.shape.shape_cases import die_web, full_web, solid_web

PARTS: tuple[FittedFeature, ...] = (
    FittedBevel("journal", hollow=True),
    FittedBevel("pin", hollow=True),
    FittedSlot(),
    FittedSlot(through=True),
    FittedSlot(False, 2.0, 1.0),
    FittedSlot(True, 0.0, 1.0),
    *(FittedBox(face, pair) for face in ("journal", "pin") for pair in (True, False)),
    *(FittedCylinder(face, pair) for face in ("journal", "pin", "through") for pair in (True, False)),
    FittedBox("pin", pair=True),
)


def with_web(scene: Scene, web: dict[str, Any]) -> Scene:
    """The scene with a web that need not be sound."""
    data = scene.model_dump(mode="json", exclude={"web"}, exclude_none=True)
    return Scene.model_validate({**data, "web": web})


def random_web(seed: int, scene: Scene) -> tuple[Layout, np.ndarray]:
    """Any parts in the order of the scene's tables, any values within half of their ranges."""
    random = np.random.default_rng(seed)
    chosen = tuple(part for part in PARTS if random.random() < 0.5)
    layout = Layout(int(random.integers(5, 11)), chosen)
    limits, widths = usual_limits(scene), random.uniform(20.0, 40.0, layout.stations - 2)
    outline = [random.uniform(-50, -20), random.uniform(70, 100), *widths]
    ranges = [pair for part in chosen for pair in part.bounds(scene, limits)]
    values = np.array([*outline, *(random.uniform(*(np.array(pair) / 4)) for pair in ranges)])
    floors = [name.endswith("floor") for name in layout.names]
    return layout, np.where(floors, np.minimum(values, 18.0), values)


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize("name", ["mikron-iiic-plain", "opposed-piston"])
def test_what_was_written_is_read_back(name: str, seed: int) -> None:
    scene = load_scene(name)
    layout, values = random_web(seed, scene)
    written = web_of(layout, values, scene)
    found = read_web(with_web(scene, written), np.zeros(9))
    assert found.left_out == ()
    assert found.layout == layout
    assert np.abs(found.values - values).max() < 0.021  # floors: rounded depth, rounded half-widths
    again = web_of(found.layout, found.values, scene)
    for key in ("stations_mm", "half_widths_mm"):
        assert again[key] == pytest.approx(written[key], abs=1e-6)
    for new, old in zip(again["bevel"] + again["pocket"], written["bevel"] + written["pocket"], strict=True):
        ends = ("y_mm", "length_mm") if new.get("length_mm", 0.0) > 85 else ()  # a groove follows the ends
        assert {k: v for k, v in new.items() if k not in ends} == pytest.approx(
            {k: v for k, v in old.items() if k not in ends}, abs=1e-6
        )


@pytest.mark.parametrize("case", [full_web, solid_web, die_web])
def test_a_file_is_read_back(case: Any) -> None:
    scene, layout, values = case()
    text = toml_text(with_web(scene, web_of(layout, values, scene)), "a web of the family")
    found = scene_start(parse_scene(text), usual_limits(scene))
    assert (found.layout, found.left_out) == (layout, ())
    assert found.values == pytest.approx(values, abs=0.02)


def test_other_webs_are_sampled_and_what_they_lose_is_said() -> None:
    scene = load_scene("mikron-iiic-plain")
    pocket = {"shape": "cylinder", "face": "through", "x_mm": 14.0, "y_mm": 24.0, "diameter_mm": 6.0}
    twin = {**pocket, "x_mm": -14.0}
    single = {**pocket, "x_mm": -9.0}
    web = {**scene.web.model_dump(mode="json"), "pocket": [twin, single, pocket]}
    found = scene_start(with_web(scene, web), usual_limits(scene))
    assert found.layout == Layout(7, (FittedCylinder("through", pair=True),))
    assert found.values == pytest.approx([*outline_start(scene, usual_limits(scene)), 14.0, 24.0, 6.0])
    assert found.left_out == (
        "web.outline = 'obround', sampled at 7 stations",
        "web.pocket[1], which has no mirror image",
    )


def test_a_station_that_was_moved_makes_another_outline() -> None:
    scene, layout, values = full_web()
    web = web_of(layout, values, scene)
    web["stations_mm"][2] += 0.05
    assert scene_start(with_web(scene, web), usual_limits(scene)).left_out == (
        "web.outline = 'profile', sampled at 7 stations",
    )


def test_parts_of_one_kind_have_names_of_their_own() -> None:
    names = Layout(5, (FittedBox("pin"), FittedBox("pin"))).names
    assert names[5:] == tuple(
        f"{label}.{name}" for label in ("box-pin", "box-pin-2") for name in ("y", "size_x", "size_y", "depth")
    )


def test_of_another_throw_only_the_free_dimensions_are_taken_over() -> None:
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True)
    data["shape"] = {"free": {"pin_fillet_mm": [2.0, 5.0], "pin_bore_mm": [0.0, 30.0]}}
    scene = scene_from_dict(data)
    data["throw"]["crankpin"] |= {"fillet_mm": 3.0, "bore_diameter_mm": 0.0}
    data["throw"]["main_journal"]["fillet_mm"] = 3.5
    found = scene_start(scene, usual_limits(scene), scene_from_dict(data))
    assert found.sizes == {"pin_fillet": 3.0, "pin_bore": 0.0}
    assert found.left_out[-1] == "journal_fillet = 3.5 mm, 2.5 mm in the design"
    layout, values = with_free(found.layout, found.values, scene, ("pin_fillet", "pin_bore"), found.sizes)
    assert layout.names[-2:] == ("pin_fillet", "pin_bore")
    assert list(values[-2:]) == [3.0, 24.0]
