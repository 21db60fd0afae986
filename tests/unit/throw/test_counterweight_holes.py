"""Plugs and balancing holes of a counterweight: closed forms, solid, cells, shape, drawing, refusals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from scipy.integrate import quad

from cranktopo.base.errors import CranktopoError
from cranktopo.base.units import density_kg_per_mm3
from cranktopo.bodies.cells.domain import build_domain, centres_mm
from cranktopo.bodies.prisms import feature_holes, kept_solid
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.volume import bolted_mass, counterweight_mass, web_moments, web_volume_mm3
from cranktopo.design.halves import envelope_asymmetry, mirror_image, web_asymmetry
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import product_of_inertia_kg_mm2, throw_balance
from cranktopo.tasks.density.manufacturing import open_cells
from cranktopo.tasks.drawing.views import Sheet
from cranktopo.tasks.refit.family import Layout
from cranktopo.tasks.refit.fit import usual_limits
from cranktopo.tasks.web_shape.mesh_model import MeshModel
from cranktopo.tasks.web_shape.start import scene_start
from cranktopo.tasks.web_shape.web_faces import web_faces
from tests.step_volume import step_volume_mm3
from tests.unit.throw.counterweight_cases import PLAIN, THIN, roomy_scene, weighted

TUNGSTEN = 17500.0
AXIAL = {"axis": "axial", "x_mm": 18.0, "y_mm": -45.0, "diameter_mm": 14.0, "length_mm": 12.0}
AXIAL |= {"density_kg_m3": TUNGSTEN}
RADIAL = {**AXIAL, "axis": "radial", "x_mm": -12.0, "diameter_mm": 10.0, "length_mm": 16.0}
HOLE = {"angle_deg": 2.0, "diameter_mm": 9.0, "depth_mm": 14.0}
BOTH = {**PLAIN, "plug": [AXIAL, RADIAL], "hole": [HOLE]}


@pytest.fixture(scope="module")
def roomy(mikron: Scene) -> Scene:
    return roomy_scene(mikron)


def radial_hole(rim: float, radius: float, floor: float) -> tuple[float, float, float]:
    """Volume, first moment along its axis and polar moment of a hole with a flat floor, by slices."""

    def over(value: Any) -> float:
        def across(turn: float) -> float:
            t = radius * math.sin(turn)
            return float(2 * (radius * math.cos(turn)) ** 2 * value(t, math.sqrt(rim**2 - t**2)))

        return float(quad(across, -math.pi / 2, math.pi / 2, epsabs=0, epsrel=1e-13)[0])

    return (
        over(lambda t, end: end - floor),
        over(lambda t, end: (end**2 - floor**2) / 2),
        over(lambda t, end: (end**3 - floor**3) / 3 + t**2 * (end - floor)),
    )


@pytest.mark.parametrize("plug", [AXIAL, {**AXIAL, "length_mm": 19.0}], ids=["blind", "through"])
def test_an_axial_plug_moves_the_throw_by_the_closed_form(roomy: Scene, plug: dict[str, Any]) -> None:
    """A full cylinder of tungsten in place of one of steel, in both webs."""
    plain, found = (throw_balance(weighted(roomy, w)) for w in (PLAIN, {**PLAIN, "plug": [plug]}))
    more = density_kg_per_mm3(TUNGSTEN) - density_kg_per_mm3(roomy.material.density_kg_m3)
    mass = 2 * more * math.pi * 7.0**2 * plug["length_mm"]
    about = 18.0**2 + 45.0**2 + 7.0**2 / 2
    assert found.mass_kg - plain.mass_kg == pytest.approx(mass, rel=1e-9)
    assert found.throw_unbalance_kg_mm - plain.throw_unbalance_kg_mm == pytest.approx(-45.0 * mass, rel=1e-9)
    assert found.lateral_unbalance_kg_mm == pytest.approx(18.0 * mass, rel=1e-9)
    assert found.inertia_kg_mm2 - plain.inertia_kg_mm2 == pytest.approx(about * mass, rel=1e-9)
    gained = found.own_counterweight_kg_mm - plain.own_counterweight_kg_mm
    assert gained == pytest.approx(45.0 * mass, rel=1e-9)


def test_a_radial_plug_and_a_balancing_hole_have_closed_forms(roomy: Scene) -> None:
    """The hole of the plug ends at its inner end; the plug's own cylinder is added."""
    plain = throw_balance(weighted(roomy, PLAIN))
    found = throw_balance(weighted(roomy, {**PLAIN, "plug": [RADIAL], "hole": [HOLE]}))
    steel, heavy = (density_kg_per_mm3(d) for d in (roomy.material.density_kg_m3, TUNGSTEN))
    reach = math.hypot(12.0, 45.0)
    plug = heavy * math.pi * 5.0**2 * 16.0
    volume, along, polar = radial_hole(62.0, 5.0, reach - 8.0)
    drilled, deep, about = radial_hole(62.0, 4.5, 62.0 - 14.0)
    mass = 2 * (plug - steel * (volume + drilled))
    pulled = steel * (along * 45.0 / reach + deep * math.cos(math.radians(2.0))) - 45.0 * plug
    own = plug * (reach**2 + 16.0**2 / 12 + 5.0**2 / 4)
    assert found.mass_kg - plain.mass_kg == pytest.approx(mass, rel=1e-9)
    moved = found.throw_unbalance_kg_mm - plain.throw_unbalance_kg_mm
    assert moved == pytest.approx(2 * pulled, rel=1e-9)
    turned = found.inertia_kg_mm2 - plain.inertia_kg_mm2
    assert turned == pytest.approx(2 * (own - steel * (polar + about)), rel=1e-9)


def test_its_place_along_the_shaft_counts_in_the_couple(roomy: Scene) -> None:
    """One web alone has the plug: flush with the journal face, its middle 6 mm below it."""
    plugged = weighted(roomy, {**PLAIN, "plug": [{**AXIAL, "x_mm": 0.0}]})
    uneven = plugged.model_copy(update={"second_web": weighted(roomy, PLAIN).web})
    more = density_kg_per_mm3(TUNGSTEN) - density_kg_per_mm3(roomy.material.density_kg_m3)
    arm = roomy.pitch_mm / 2 - roomy.web_z_mm[0] - 6.0
    couple = product_of_inertia_kg_mm2(uneven)
    assert couple.real == pytest.approx(45.0 * more * math.pi * 7.0**2 * 12.0 * arm, rel=1e-8)


@pytest.mark.parametrize(
    ("counterweight", "tolerance"),
    [({**PLAIN, "plug": [AXIAL]}, 1e-9), ({**THIN, "plug": [{**AXIAL, "y_mm": -38.0}]}, 1e-9), (BOTH, 2e-5)],
    ids=["axial", "thin", "both"],
)
def test_the_exact_solid_has_the_holes(
    roomy: Scene, counterweight: dict[str, Any], tolerance: float, tmp_path: Any
) -> None:
    """By the kernel and its file; beside a radial hole it integrates to 1e-5."""
    scene = weighted(roomy, counterweight)
    volume = export_solid(scene, "web", tmp_path / "web.step")
    assert volume == pytest.approx(web_volume_mm3(scene), rel=tolerance)
    assert step_volume_mm3(tmp_path / "web.step") == pytest.approx(volume, rel=max(tolerance, 1e-6))


def test_no_optimiser_fills_an_axial_hole(roomy: Scene) -> None:
    """The kept counterweight lacks it, and the design space keeps clear of it."""
    weights = ({**PLAIN, "plug": plug} for plug in ([], [AXIAL]))
    plain, found = (build_domain(weighted(roomy, weight), 6.0, extent="half") for weight in weights)
    gone = (plain.passive_fraction - found.passive_fraction) * plain.volume_mm3
    assert float(gone.sum()) == pytest.approx(math.pi * 7.0**2 * 12.0, rel=1e-6)
    np.testing.assert_allclose(found.design_fraction, plain.design_fraction, atol=1e-6)


@pytest.mark.slow
def test_no_optimiser_fills_or_covers_radial_holes(roomy: Scene) -> None:
    """The kept counterweight lacks them, and so does the design space; cells, prisms and cutter agree."""
    plain, found = (build_domain(weighted(roomy, w), 8.0, extent="half") for w in (PLAIN, BOTH))
    taken = web_moments(weighted(roomy, PLAIN)).volume - web_moments(weighted(roomy, BOTH)).volume
    volumes = plain.volume_mm3
    kept, designed = (
        float(((getattr(plain, kind) - getattr(found, kind)) * volumes).sum())
        for kind in ("passive_fraction", "design_fraction")
    )
    assert kept == pytest.approx(taken, rel=1e-4)
    # Beyond the rim the tools go on to the end of the design space, so that nothing closes their mouths.
    beyond = sum(
        math.pi * r**2 * 75.0 / math.cos(angle) - radial_hole(62.0, r, 0.0)[0]
        for r, angle in ((5.0, math.atan(12 / 45)), (4.5, math.radians(2.0)))
    )
    assert designed == pytest.approx(beyond, rel=1e-4)
    scene = weighted(roomy, BOTH)
    assert (kept_solid(scene) ^ feature_holes(scene)).volume() == pytest.approx(taken, rel=2e-3)


def test_a_die_leaves_what_is_drilled_afterwards(roomy: Scene) -> None:
    """Cells that a hole empties are no obstacle to it; the box of the design space has no others."""
    scene = weighted(roomy, {**PLAIN, "plug": [AXIAL]})
    domain = build_domain(scene, 4.0)
    first, last = domain.web_layers
    empty = (domain.design_fraction + domain.passive_fraction)[:, :, first:last] == 0
    x, y, _ = centres_mm(domain)
    assert (empty & (np.hypot(x[:, None] - 18.0, y + 45.0) < 7.0)[:, :, None]).any()
    held = (np.abs(x) < 75.0)[:, None] & ((y > -75.0) & (y < 82.0))
    assert open_cells(scene, domain)[held].all()


def test_symmetry_follows_the_plugs(roomy: Scene) -> None:
    lonely = weighted(roomy, {**PLAIN, "plug": [AXIAL]})
    pair = weighted(roomy, {**PLAIN, "plug": [AXIAL, {**AXIAL, "x_mm": -18.0}]})
    for asymmetry in (web_asymmetry, envelope_asymmetry):
        assert asymmetry(lonely) == "web.counterweight"
        assert asymmetry(pair) == ""
    turned = throw_balance(mirror_image(lonely))
    assert turned.lateral_unbalance_kg_mm == pytest.approx(-throw_balance(lonely).lateral_unbalance_kg_mm)
    assert build_domain(lonely, 6.0).extent == "half"
    assert build_domain(pair, 6.0).extent == "quarter"


def test_a_bolted_counterweight_has_plugs_too(roomy: Scene) -> None:
    bolted = {**PLAIN, "density_kg_m3": 7850.0}
    plug = {**AXIAL, "y_mm": -50.0}
    plain, found = (bolted_mass(weighted(roomy, w)) for w in (bolted, {**bolted, "plug": [plug]}))
    gained = (TUNGSTEN - 7850.0) * 1e-9 * math.pi * 7.0**2 * 12.0
    assert found.volume - plain.volume == pytest.approx(gained, rel=1e-9)
    scene = weighted(roomy, {**bolted, "plug": [plug]})
    assert web_volume_mm3(scene) == pytest.approx(web_volume_mm3(weighted(roomy, bolted)), rel=1e-12)
    assert counterweight_mass(scene) == found


def test_the_drawing_shows_and_places_them(roomy: Scene) -> None:
    from manifold3d import Manifold

    drawn = Sheet(weighted(roomy, BOTH), Manifold(), placed=True)
    assert (18.0, -45.0) in drawn.places
    lines = "\n".join(drawn.features[-1].lines)
    assert "PLUG, axial, 17500 kg/m³" in lines
    assert "BALANCING HOLE" in lines
    assert len(drawn.features[-1].front) == 3


def test_shape_knows_the_faces_of_the_holes(roomy: Scene) -> None:
    """Walls of three and floors of three more: a point of each is on its face."""
    scene = weighted(roomy, BOTH)
    assert scene.web.counterweight is not None
    layout = Layout(3)
    faces = web_faces(scene, layout, mirrored=False)
    plain = web_faces(weighted(roomy, PLAIN), layout, mirrored=False)
    assert len(faces) - len(plain) == 6
    for hole in scene.web.counterweight.holes(scene):
        at = hole.wall_mm(0.0)
        near = [face.contact(at, np.array([-25.0, 73.0, 25.0])).distance_mm for face in faces[:-1]]
        assert np.abs(near).min(axis=0).max() < 1e-9


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "through the rim": (
        {"plug": [{**AXIAL, "y_mm": -52.0}]},
        r"plug\[0\]: does not lie in web.counterweight",
    ),
    "beyond the flank": ({"plug": [{**AXIAL, "x_mm": 45.0, "y_mm": -30.0}]}, "does not lie in"),
    "longer than thick": ({"plug": [{**AXIAL, "length_mm": 20.0}]}, r"length_mm.*at most .*19 mm"),
    "under the journal": ({"plug": [{**AXIAL, "x_mm": 0.0, "y_mm": -27.0}]}, "opens under a journal"),
    "into each other": ({"plug": [AXIAL, {**AXIAL, "x_mm": 10.0}]}, r"plug\[0\]: meets web.*plug\[1\]"),
    "axial into radial": (
        {"plug": [AXIAL], "hole": [{**HOLE, "angle_deg": 20.0}]},
        r"plug\[0\]: meets web.counterweight.hole\[0\]",
    ),
    "out of the rim": ({"plug": [{**RADIAL, "y_mm": -58.0}]}, r"length_mm.*sticks out"),
    "beside the pin": ({"plug": [{**RADIAL, "y_mm": 45.0}]}, "away from the crankpin"),
    "thicker than the web": ({"hole": [{**HOLE, "diameter_mm": 19.0}]}, "smaller than the counterweight's"),
    "into the bore": ({"hole": [{**HOLE, "depth_mm": 51.0}]}, r"hole\[0\]: meets throw.main_journal.bore"),
    "bolted, into the web": (
        {"density_kg_m3": 7850.0, "plug": [{**AXIAL, "x_mm": 0.0, "y_mm": -31.0}]},
        "reaches into the web",
    ),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str, roomy: Scene) -> None:
    holes, message = REFUSED[name]
    with pytest.raises(CranktopoError, match=message):
        weighted(roomy, {**PLAIN, **holes})


@pytest.mark.slow
def test_a_mesh_with_holes_follows_the_outline(roomy: Scene) -> None:
    """Their walls and floors stand still while the outline moves; the gradients are those of differences."""
    scene = weighted(roomy, BOTH)
    start = scene_start(scene, usual_limits(scene))
    model = MeshModel(scene, start.layout, start.values, 12.0)
    step = 0.1 * np.eye(len(start.values))[3]
    above, below = (model.responses(start.values + side * step, ["torsion"]).values for side in (1, -1))
    found = model.responses(start.values, ["torsion"]).gradients
    for name in ("mass", "torsion"):
        assert found[name][3] == pytest.approx((above[name] - below[name]) / 0.2, rel=0.02)
