"""Crank of one throw with a drilling that crosses the middle of a main journal, where its throw ends."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from cranktopo.bodies.crank_drillings import taken_beyond
from cranktopo.bodies.crank_ends import SIDES, crank_end, main_journal_places_mm
from cranktopo.bodies.solid.checked import volume_mm3
from cranktopo.bodies.solid.crankshaft import add_crankshaft
from cranktopo.bodies.solid.throw import add_full_throw, throw_form
from cranktopo.design.crank_throws import throw_scenes
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.crank import JournalMass, drawn_crank_mass
from cranktopo.engine.balance.free_forces import TurningMasses, rotating_force, turning_masses
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.engine.balance.whole_engine import main_bearings
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.tasks.crank_drawing.crank_shape import crank_shape
from cranktopo.tasks.crank_drawing.sheet import finished_mass_kg

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


def drilled_twin(
    place_mm: float, rounding_mm: float, web: str = "second", on_pin: tuple[float, float] = (50.0, 10.5)
) -> Scene:
    """V-twin with ends; its drilling leans to one side. Angle and place of its end on the pin, deg and mm."""
    angle_deg, pin_mm = on_pin
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    drilling = {
        "diameter_mm": 5.0,
        "outlet_radius_mm": rounding_mm,
        "web": web,
        "from": {"on": "main_journal", "angle_deg": 180.0, "place_mm": place_mm},
        "to": {"on": "crankpin", "angle_deg": angle_deg, "place_mm": pin_mm},
    }
    engine = data["engine"] | {"cylinders": 1, "firing_order": [1], "rod_length_mm": 124.0}
    throw = {**THROW, "drilling": [drilling]}
    kept = {"name": "twin", "throw": throw, "web": WEB, "engine": engine, "crank": {"end": ENDS}}
    return scene_from_dict({**kept, "material": data["material"]}, "twin", whole=True)


def test_the_sheet_has_the_mass_of_the_balance() -> None:
    """Less what the drilling takes out of the end beyond its throw; sums of throws and ends had it twice."""
    scene = drilled_twin(0.0, 0.0)
    told = drawn_crank_mass(scene)
    assert finished_mass_kg(scene, crank_shape(scene)) == pytest.approx(told.mass_kg, rel=1e-12)
    whole = throw_balance(scene).mass_kg + told.free_end_kg + told.output_end_kg
    assert whole - told.mass_kg > 1e-4


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


@pytest.mark.parametrize("rounding_mm", [1.0, pytest.param(2.0, marks=pytest.mark.slow)])
def test_a_rounding_that_crosses_the_middle_by_a_sliver(rounding_mm: float) -> None:
    """The hole ends 0.5 mm before the middle of the journal, the rounding of its outlet beyond it."""
    check(drilled_twin(3.0, rounding_mm))


def without_rods(web: str, angles_deg: list[float]) -> Scene:
    """Return throws of the twin side by side, without rods and pistons."""
    data = drilled_twin(0.0, 0.0, web).model_dump(mode="json", exclude_none=True, by_alias=True)
    del data["engine"]["masses"]
    numbers = list(range(1, len(angles_deg) + 1))
    arrangement = {"throw_angles_deg": angles_deg}
    data["engine"] |= {"cylinders": len(numbers), "firing_order": numbers, "arrangement": arrangement}
    return scene_from_dict(data, "without-rods", whole=True)


def body_of(scene: Scene) -> tuple[complex, complex]:
    """Unbalance, kg mm, and product of inertia about the middle, kg mm2, of the exact solid by the kernel."""
    density = scene.material.density_kg_m3 * 1e-9
    with cad_session("crank") as gmsh:
        ((dim, tag),) = add_crankshaft(gmsh.model.occ, scene)
        mass = density * gmsh.model.occ.getMass(dim, tag)
        x, y, z = gmsh.model.occ.getCenterOfMass(dim, tag)
        tensor = density * np.array(gmsh.model.occ.getMatrixOfInertia(dim, tag))
    unbalance, middle = mass * complex(y, x), main_journal_places_mm(scene)[-1] / 2
    return unbalance, complex(-tensor[5], -tensor[2]) + unbalance * (z - middle)


@pytest.mark.parametrize(
    ("web", "angles_deg"),
    [("second", [0.0]), pytest.param("first", [0.0, 90.0], marks=pytest.mark.slow)],
)
def test_free_force_and_moment_are_those_of_the_body(web: str, angles_deg: list[float]) -> None:
    """The rest of a hole in an end, or in the next throw, was missing: 18 % of a free moment."""
    scene = without_rods(web, angles_deg)
    masses, (unbalance, product) = turning_masses(scene), body_of(scene)
    free, plugged = rotating_force(masses), rotating_force(_plugged(masses))
    scale_N = throw_balance(scene).mass_kg * scene.throw.radius_mm * masses.w2 / 1e3
    scale_Nm = scale_N * masses.layout.length_mm / 1e3
    assert free.force.forward == pytest.approx(unbalance * masses.w2 / 1e3, abs=2e-6 * scale_N)
    moment_Nm = product * masses.w2 / 1e6
    assert free.moment.forward == pytest.approx(moment_Nm, abs=1e-6 * scale_Nm)
    change = free.moment.forward - plugged.moment.forward
    assert abs(change) > 1e-5 * scale_Nm, "ten times what the body may differ by"
    loads = (main_bearings(scene, one).load_N[:, 0] for one in (masses, _plugged(masses)))
    drilled, whole = (masses.layout.bearing_z_mm @ load / 1e3 for load in loads)
    assert drilled - whole == pytest.approx(change, rel=1e-6)


def _plugged(masses: TurningMasses) -> TurningMasses:
    """Return the same with nothing taken out beyond the throws: ends of the twin are round."""
    return replace(masses, journals=(JournalMass(0j, 0j),) * len(masses.journals))


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
