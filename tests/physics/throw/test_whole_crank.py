"""The whole crank: its closed form against the exact solid, read back from STEP."""

from __future__ import annotations

import math
from pathlib import Path

import numpy as np
import pytest

from cranktopo.app.main import main
from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.crank_drillings import crossing_words, taken_beyond
from cranktopo.bodies.crank_ends import main_journal_places_mm
from cranktopo.bodies.solid.files import export_solid
from cranktopo.design.loading import design_text, load_scene, parse_scene, scene_from_dict
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.crank import CrankMass, crank_mass
from cranktopo.engine.balance.free_forces import rotating_force, turning_masses
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.tasks.crank_drawing.crank_shape import crank_shape
from tests.random_cranks import random_crank

ONE_THROW = 5
"""Seed of a random engine with one cylinder."""


def found_mass(scene: Scene) -> CrankMass:
    found = crank_mass(scene)
    assert found is not None
    return found


def with_crank(text: str = "mikron-iiic-plain", /, **crank: object) -> Scene:
    data = load_scene(text).model_dump(mode="json", exclude_none=True, exclude={"published"})
    return scene_from_dict({**data, "crank": crank}, "crank")


def end(*steps: dict[str, object], side: str = "free") -> dict[str, object]:
    return {"side": side, "step": list(steps)}


def check_step_file(scene: Scene, path: Path, times: float = 1.0) -> None:
    """Volume to 1e-6, inertia, unbalance and couple to 1e-9 of their scale, from the file's exact faces.

    `times` as much of inertia, unbalance and couple where faces end in curves of intersection.
    """
    mass = found_mass(scene)
    export_solid(scene, "crankshaft", path)
    density = density_kg_per_mm3(scene.material.density_kg_m3)
    with cad_session("crank") as gmsh:
        occ = gmsh.model.occ
        (body,) = occ.importShapes(str(path))
        kg = density * occ.getMass(*body)
        x, y, z = occ.getCenterOfMass(*body)
        tensor = density * np.array(occ.getMatrixOfInertia(*body))
    assert kg == pytest.approx(mass.mass_kg, rel=1e-6)
    assert tensor[8] + kg * (x**2 + y**2) == pytest.approx(mass.inertia_kg_mm2, rel=1e-6 * times)
    length = main_journal_places_mm(scene)[-1]
    unbalance = kg * complex(y, x)
    couple = complex(kg * y * z - tensor[5], kg * x * z - tensor[2]) - unbalance * length / 2
    given = mass.unbalance_kg_mm * np.exp(1j * math.radians(mass.unbalance_deg))
    assert unbalance == pytest.approx(given, abs=1e-7 * times * kg * scene.throw.radius_mm)
    given = mass.couple_kg_mm2 * np.exp(1j * math.radians(mass.couple_deg))
    assert couple == pytest.approx(given, abs=1e-6 * times * kg * scene.throw.radius_mm * length)


def test_mikron_weighs_what_is_printed() -> None:
    scene = load_scene("mikron-iiic-crank")
    assert found_mass(scene).mass_kg == pytest.approx(7.145, rel=0.01)


def test_a_keyway_and_a_single_bolt_hole_unbalance_the_crank() -> None:
    """Box less circle segment by numbers, a hole by hand; the Mikron's throws cancel."""
    key = {"kind": "keyway", "diameter_mm": 30.0, "length_mm": 20.0, "width_mm": 8.0, "depth_mm": 4.0}
    flange = {"kind": "flange", "diameter_mm": 90.0, "length_mm": 10.0, "bolts": 1, "bolt_circle_mm": 60.0}
    scene = with_crank(
        end=[
            end({**key, "angle_deg": 90.0}),
            end({**flange, "bolt_diameter_mm": 9.0, "first_bolt_deg": 0.0}, side="output"),
        ]
    )
    density = density_kg_per_mm3(scene.material.density_kg_m3)
    x = 8.0 * (np.arange(200000) + 0.5) / 200000 - 4.0
    segment = float(((15.0**2 - x**2 - 11.0**2) / 2).sum() * 8.0 / 200000)
    hole = math.pi * 4.5**2 * 10.0 * 30.0
    expected = -density * complex(hole, 20.0 * segment)
    mass = found_mass(scene)
    found = mass.unbalance_kg_mm * np.exp(1j * math.radians(mass.unbalance_deg))
    assert found == pytest.approx(expected, rel=1e-9)
    masses = turning_masses(scene)
    force, w2 = rotating_force(masses), masses.w2
    assert force.force.largest == pytest.approx(abs(expected) * w2 / 1000, rel=1e-9)
    half = main_journal_places_mm(scene)[-1] / 2
    couple = -density * complex((half + 20.0 + 5.0) * hole, -(half + 20.0 + 10.0) * 20.0 * segment)
    assert force.moment.largest == pytest.approx(abs(couple) * w2 / 1e6, rel=1e-9)
    assert mass.couple_kg_mm2 == pytest.approx(abs(couple), rel=1e-9)


def test_an_end_completes_the_outer_journal() -> None:
    """Half a journal of 40 mm, 42 outside and 24 inside, printed with 296 g for the whole."""
    plain, whole = with_crank(), with_crank(end=[end(), end(side="output")])
    half = density_kg_per_mm3(plain.material.density_kg_m3) * math.pi / 4 * (42.0**2 - 24.0**2) * 20.0
    assert found_mass(whole).mass_kg - found_mass(plain).mass_kg == pytest.approx(2 * half, rel=1e-12)
    assert found_mass(whole).mass_kg - found_mass(plain).mass_kg == pytest.approx(0.296, rel=0.015)


def test_a_crank_without_keys_changes_nothing() -> None:
    plain, empty = load_scene("mikron-iiic-plain"), with_crank()
    assert rotating_force(turning_masses(plain)) == rotating_force(turning_masses(empty))
    assert found_mass(empty).mass_kg == 4 * throw_balance(plain).mass_kg


def drilled_crank(web: str, rounding_mm: float = 0.0, **crank: object) -> Scene:
    """Two throws side by side whose drillings cross the middle of the main journal."""
    data = load_scene("mikron-iiic-plain").model_dump(mode="json", exclude_none=True, exclude={"published"})
    data["throw"]["drilling"] = [{**ACROSS, "web": web, "outlet_radius_mm": rounding_mm}]
    data["engine"] |= {
        "cylinders": 2,
        "firing_order": [1, 2],
        "arrangement": {"throw_angles_deg": [0.0, 0.0]},
    }
    return scene_from_dict({**data, "crank": crank}, "crank", whole=True)


ACROSS = {
    "diameter_mm": 5.0,
    "from": {"on": "main_journal", "angle_deg": 160.0, "place_mm": 1.0},
    "to": {"on": "crankpin", "angle_deg": 15.0, "place_mm": 2.0},
}


@pytest.mark.parametrize(
    ("web", "ends"), [pytest.param("first", False, marks=pytest.mark.slow), ("both", True)]
)
def test_a_drilling_across_the_middle_of_a_journal_goes_on_in_the_neighbour(
    web: str, ends: bool, tmp_path: Path
) -> None:
    """Half of its outlet was plugged; those of two throws at one angle meet there, and count once."""
    scene = drilled_crank(web, **({"end": [end(), end(side="output")]} if ends else {}))
    check_step_file(scene, tmp_path / "crank.step", 10.0)
    plugged = 2 * throw_balance(scene).mass_kg
    journal = scene.throw.main_journal
    ring = math.pi * (journal.radius_mm**2 - journal.bore_radius_mm**2) * journal.length_mm
    density = density_kg_per_mm3(scene.material.density_kg_m3)
    taken = plugged + ends * density * ring - found_mass(scene).mass_kg
    assert taken > 5 * density, "more than 5 mm3"


@pytest.mark.slow
def test_the_drawing_has_the_hole_in_the_neighbour_too(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bodies that it draws, by their triangles, with the drillings that go on and without."""
    scene = drilled_crank("first", 1.0)
    drawn = sum(piece.solid.volume() for piece in crank_shape(scene).pieces)
    monkeypatch.setattr("cranktopo.tasks.crank_drawing.crank_shape.crank_crossings", lambda _: ())
    plugged = sum(piece.solid.volume() for piece in crank_shape(scene).pieces)
    assert plugged - drawn == pytest.approx(taken_beyond(scene).volume, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(60))
def test_random_cranks(tmp_path: Path, seed: int) -> None:
    check_step_file(random_crank(seed), tmp_path / "crank.step")


def test_a_random_crank_of_one_throw(tmp_path: Path) -> None:
    check_step_file(random_crank(ONE_THROW), tmp_path / "crank.step")


def test_a_body_from_cad_is_an_end(tmp_path: Path) -> None:
    """A plate off the axis: its mass, unbalance and couple are those of a box."""
    with cad_session("plate") as gmsh:
        gmsh.model.occ.addBox(-30, -20, 0, 60, 60, 10)
        gmsh.model.occ.synchronize()
        gmsh.write(str(tmp_path / "plate.step"))
    body = {"kind": "body", "file": str(tmp_path / "plate.step"), "length_mm": 10.0}
    scene = with_crank(end=[end(body, side="output")])
    bare = found_mass(with_crank(end=[end(side="output")]))
    mass, density = found_mass(scene), density_kg_per_mm3(scene.material.density_kg_m3)
    assert mass.mass_kg - bare.mass_kg == pytest.approx(36000 * density, rel=1e-9)
    assert mass.unbalance_kg_mm == pytest.approx(36000 * 10 * density, rel=1e-9)
    assert mass.unbalance_deg == pytest.approx(0.0, abs=1e-6)
    arm = main_journal_places_mm(scene)[-1] / 2 + 20.0 + 5.0
    assert mass.couple_kg_mm2 == pytest.approx(36000 * 10 * density * arm, rel=1e-9)


@pytest.mark.slow
def test_a_body_from_cad_is_in_the_step_file(tmp_path: Path) -> None:
    with cad_session("pin") as gmsh:
        gmsh.model.occ.addCylinder(0, 5, 0, 0, 0, -12, 8)
        gmsh.model.occ.synchronize()
        gmsh.write(str(tmp_path / "pin.step"))
    body = {"kind": "body", "file": str(tmp_path / "pin.step"), "length_mm": 12.0}
    check_step_file(with_crank(end=[end(body)]), tmp_path / "crank.step")


@pytest.mark.parametrize("face", ["journal", pytest.param("pin", marks=pytest.mark.slow)])
def test_a_hollow_between_the_webs_of_a_flying_web_is_refused(face: str, tmp_path: Path) -> None:
    """A pocket of its journal face lies under the other web, which has it on the other side of the crank."""
    flying = {"bearings": [0, 2, 3, 4], "main_journal": [{"number": 1, "length_mm": 0.0}]}
    data = with_crank(**flying).model_dump(mode="json", exclude_none=True)
    pocket = {
        "shape": "cylinder",
        "face": face,
        "x_mm": 24.0,
        "y_mm": 4.0,
        "diameter_mm": 6.0,
        "depth_mm": 5.0,
    }
    data["web"] |= {"width_mm": 60.0, "pocket": [pocket]}
    scene, path = scene_from_dict(data, "crank"), tmp_path / "crank.step"
    if face == "pin":
        assert export_solid(scene, "crankshaft", path) > 0
        return
    words = r"crankshaft: has 2 closed hollows that no tool reaches, one of them at x = -?24, y = -?4, z = "
    with pytest.raises(CranktopoError, match=words):
        export_solid(scene, "crankshaft", path)


def test_a_throw_alone_tells_that_its_drilling_goes_on(
    capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    text = design_text("mikron-iiic-plain")
    hole = "[[throw.drilling]]\ndiameter_mm = 5.0\n"
    design = tmp_path / "drilled.toml"
    design.write_text(text.replace("[web]\n", f"{hole}\n[web]\n", 1), encoding="utf-8")
    assert main(["export", str(design), str(tmp_path / "throw.step"), "--part", "throw"]) == 0
    assert "throw.drilling[0]: crosses the middle of the main journal" in " ".join(
        capsys.readouterr().err.split()
    )
    inside = text.replace(
        "[web]\n", f'{hole}from = {{ on = "main_journal", angle_deg = 180.0, place_mm = 9.0 }}\n\n[web]\n', 1
    )
    assert crossing_words(parse_scene(inside)) == ""
