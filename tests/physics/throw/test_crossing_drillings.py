"""Crank of one throw with a drilling that crosses the middle of a main journal, where its throw ends."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from cranktopo.bodies.crank_drillings import taken_beyond
from cranktopo.bodies.crank_ends import SIDES, crank_end
from cranktopo.bodies.solid.checked import volume_mm3
from cranktopo.bodies.solid.crankshaft import add_crankshaft
from cranktopo.bodies.solid.throw import add_full_throw, throw_form
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import cad_session

THROW: dict[str, Any] = {
    "radius_mm": 35.75,
    "main_journal": {"outer_diameter_mm": 52.0, "length_mm": 28.0, "fillet_mm": 2.8},
    "crankpin": {"outer_diameter_mm": 45.0, "length_mm": 43.0, "fillet_mm": 2.5},
}
WEB = {"thickness_mm": 24.0, "outline": "tapered", "main_radius_mm": 38.0, "pin_radius_mm": 31.0}
ENDS = [
    {"side": "free", "step": [{"kind": "cylinder", "diameter_mm": 32.0, "length_mm": 40.0}]},
    {"side": "output", "step": [{"kind": "gear_seat", "diameter_mm": 40.0, "length_mm": 26.0}]},
]


def drilled_twin(place_mm: float, rounding_mm: float, web: str = "second") -> Scene:
    """V-twin with ends; its drilling leans to one side."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    drilling = {
        "diameter_mm": 5.0,
        "outlet_radius_mm": rounding_mm,
        "web": web,
        "from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": place_mm},
        "to": {"on": "crankpin", "angle_deg": 50.0, "place_mm": 10.5},
    }
    engine = data["engine"] | {"cylinders": 1, "firing_order": [1], "rod_length_mm": 124.0}
    throw = {**THROW, "drilling": [drilling]}
    kept = {"name": "twin", "throw": throw, "web": WEB, "engine": engine, "crank": {"end": ENDS}}
    return scene_from_dict({**kept, "material": data["material"]}, "twin", whole=True)


def misfit(scene: Scene) -> tuple[float, float]:
    """Volume of the crank's exact solid less the closed form, and what roundings of outlets take, mm3."""
    pieces = [piece for side in SIDES for piece in crank_end(scene, side)]
    form = throw_form(throw_scenes(scene)[0])
    closed = form.volume_mm3 + sum(piece.moments.volume for piece in pieces) - taken_beyond(scene).volume
    with cad_session("crank") as gmsh:
        found = volume_mm3(gmsh.model.occ, add_crankshaft(gmsh.model.occ, scene))
    return found - closed, form.roundings_mm3


def check(scene: Scene) -> None:
    """To 4e-6 of the volume, the kernel's integration, and 3 % of what the roundings take."""
    off, roundings = misfit(scene)
    assert abs(off) < 4e-6 * 8.1e5 + 0.03 * roundings


@pytest.mark.parametrize("rounding_mm", [1.0, 2.0])
def test_a_rounding_that_crosses_the_middle_by_a_sliver(rounding_mm: float) -> None:
    """The hole ends 0.5 mm before the middle of the journal, the rounding of its outlet beyond it."""
    check(drilled_twin(3.0, rounding_mm))


@pytest.mark.slow
@pytest.mark.parametrize("web", ["second", "both"])
@pytest.mark.parametrize(("rounding_mm", "last"), [(0.5, 7.0), (1.0, 6.5), (2.0, 4.0)])
def test_all_places_along_the_journal(rounding_mm: float, last: float, web: str) -> None:
    """From the middle of the main journal to near the place where the outlet meets its fillet."""
    for place in np.arange(0.0, last + 0.1, 0.5):
        check(drilled_twin(float(place), rounding_mm, web))


@pytest.mark.slow
def test_a_throw_that_halves_a_wide_outlet() -> None:
    """The throw alone ends in the middle of the outlet; tools took 24 mm3 too much there."""
    scene = throw_scenes(drilled_twin(0.0, 2.0))[0]
    with cad_session("throw") as gmsh:
        found = volume_mm3(gmsh.model.occ, add_full_throw(gmsh.model.occ, scene))
    form = throw_form(scene)
    assert found == pytest.approx(form.volume_mm3, abs=0.03 * form.roundings_mm3)


@pytest.mark.slow
@pytest.mark.parametrize("rounding_mm", [0.0, 1.0])
@pytest.mark.parametrize("place_mm", [0.0, 3.0])
def test_drillings_across_all_journals_of_a_six(place_mm: float, rounding_mm: float) -> None:
    """Journals of turned throws were made one face, and the kernel lost bodies where it cut holes there."""
    data = drilled_twin(place_mm, rounding_mm, "both").model_dump(
        mode="json", exclude_none=True, by_alias=True
    )
    data["engine"] |= {"cylinders": 6, "firing_order": [1, 5, 3, 6, 2, 4]}
    scene = scene_from_dict(data, "six", whole=True)
    with cad_session("six") as gmsh:
        assert len(add_crankshaft(gmsh.model.occ, scene)) == 1  # checked against the closed form there
