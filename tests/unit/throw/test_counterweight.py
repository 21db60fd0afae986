"""Counterweights: mass by formula, by the CAD kernel and by cells; parts of another density; refusals."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from cranktopo.base.errors import CranktopoError
from cranktopo.bodies.cells.domain import build_domain
from cranktopo.bodies.prisms import kept_solid
from cranktopo.bodies.solid.files import export_solid
from cranktopo.bodies.volume import bolted_mass, web_moments, web_volume_mm3
from cranktopo.bodies.zones import zone_solids
from cranktopo.design.schema import Scene
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.tasks.refit.fit import scene_with_web
from tests.step_volume import step_volume_mm3
from tests.unit.throw.counterweight_cases import DISC, PLAIN, THIN, roomy_scene, weighted

END_MM = 25.0
"""Radius of the obround's end, which is round about the crank axis."""


@pytest.fixture(scope="module")
def roomy(mikron: Scene) -> Scene:
    return roomy_scene(mikron)


@pytest.mark.parametrize("counterweight", [PLAIN, THIN, DISC], ids=["plain", "thin", "disc"])
def test_adds_a_ring_sector(roomy: Scene, counterweight: dict[str, Any]) -> None:
    """Beyond the round end of the web it is a sector of a ring, whose moments have a closed form."""
    before, after = web_moments(roomy), web_moments(weighted(roomy, counterweight))
    outer, angle = counterweight["outer_radius_mm"], math.radians(counterweight["half_angle_deg"])
    thick = counterweight.get("thickness_mm", 19.0)
    area = angle * (outer**2 - END_MM**2)
    assert after.volume - before.volume == pytest.approx(area * thick, rel=1e-9)
    first = -2 / 3 * math.sin(angle) * (outer**3 - END_MM**3)
    assert after.first_y - before.first_y == pytest.approx(first * thick, rel=1e-9)
    polar = angle / 2 * (outer**4 - END_MM**4)
    assert after.polar - before.polar == pytest.approx(polar * thick, rel=1e-9)
    assert after.first_x == pytest.approx(0.0, abs=1e-6)


@pytest.mark.parametrize(
    ("counterweight", "features"),
    [
        (PLAIN, {}),
        (DISC, {}),
        (THIN, {"pocket": [{"shape": "cylinder", "y_mm": -45.0, "diameter_mm": 10.0}]}),
        (PLAIN, {"outline": "tapered", "width_mm": None, "main_radius_mm": 36.0, "pin_radius_mm": 27.0}),
        (THIN, {"bevel": [{"face": "journal", "y_mm": 50.0, "depth_mm": 8.0}]}),
    ],
    ids=["plain", "disc", "bored", "tapered", "bevelled"],
)
def test_solid_cells_and_sections_agree(
    roomy: Scene, counterweight: dict[str, Any], features: dict[str, Any], tmp_path: Any
) -> None:
    """The CAD kernel, its STEP file, sections and cells to 1e-6."""
    web = {key: value for key, value in features.items() if value is not None}
    base = {"thickness_mm": 19.0, "outline": "obround"} | ({} if "outline" in web else {"width_mm": 50.0})
    scene = scene_with_web(roomy, {**base, **web, "counterweight": counterweight})
    volume = export_solid(scene, "web", tmp_path / "web.step")
    assert volume == pytest.approx(web_volume_mm3(scene), rel=1e-6)
    assert step_volume_mm3(tmp_path / "web.step") == pytest.approx(volume, rel=1e-6)
    for cell_mm in (8.0, 3.0):
        domain = build_domain(scene, cell_mm, "web", extent="quarter")
        assert 2 * float((domain.web * domain.volume_mm3).sum()) == pytest.approx(volume, rel=1e-6)


def test_thin_one_lies_on_its_own_face(roomy: Scene) -> None:
    """Cells beyond the outline's end: material near the pin face only, as thick as asked."""
    domain = build_domain(weighted(roomy, THIN), 2.0, "web", extent="half")
    x, y = (
        np.searchsorted(edges, at) - 1 for edges, at in ((domain.grid.x_mm, 9.0), (domain.grid.y_mm, -45.0))
    )
    first, past = domain.web_layers
    column = domain.web[x, y, first:past]
    heights = np.diff(domain.grid.z_mm)[first:past]
    assert column[0] == 0
    assert column[-1] == 1
    assert float((column * heights).sum()) == pytest.approx(12.0, abs=1e-9)


def test_no_optimiser_empties_it(roomy: Scene) -> None:
    """In the design space its sector less the bore is fixed, all the rest is free as before."""
    plain, with_weight = (build_domain(scene, 3.0) for scene in (roomy, weighted(roomy, PLAIN)))
    volumes = plain.volume_mm3 / plain.symmetry_fraction / 2
    np.testing.assert_allclose(
        with_weight.passive_fraction + with_weight.design_fraction,
        plain.passive_fraction + plain.design_fraction,
        atol=1e-5,
    )
    np.testing.assert_array_equal(with_weight.web, plain.web)
    fixed = float(((with_weight.passive_fraction - plain.passive_fraction) * volumes).sum())
    bore = roomy.throw.main_journal.bore_radius_mm
    assert fixed == pytest.approx(math.radians(60) * (62.0**2 - bore**2) * 19.0, rel=1e-6)


def test_surface_has_it_exactly(roomy: Scene) -> None:
    volume = kept_solid(weighted(roomy, THIN)).volume()
    assert volume == pytest.approx(math.radians(75) * 55.0**2 * 12.0, rel=1e-4)
    assert kept_solid(roomy).is_empty()
    bolted = weighted(roomy, {**PLAIN, "density_kg_m3": 9000.0})
    assert kept_solid(bolted).volume() == pytest.approx(zone_solids(bolted)[0].volume(), rel=1e-9)


def test_bolted_part_has_mass_and_nothing_else(roomy: Scene) -> None:
    """Its own density times the ring sector beyond the web; the solid is that of the bare web.

    So are the cells of the web, of which its seat is kept, and those of the envelope without its space.
    """
    one_piece = weighted(roomy, PLAIN)
    bolted = weighted(roomy, {**PLAIN, "density_kg_m3": 17500.0})
    assert web_moments(bolted) == web_moments(roomy)
    bare, kept = (build_domain(scene, 6.0, "web") for scene in (roomy, bolted))
    whole = [cells.passive_fraction + cells.design_fraction for cells in (bare, kept)]
    np.testing.assert_allclose(*whole, atol=1e-6)
    assert (kept.passive_fraction - bare.passive_fraction).min() > -1e-6
    free, taken = (build_domain(scene, 6.0, "envelope") for scene in (roomy, bolted))
    assert (taken.design_fraction - free.design_fraction).max() < 1e-6
    kg = math.radians(60) * (62.0**2 - END_MM**2) * 19.0 * 17500e-9
    assert bolted_mass(bolted).volume == pytest.approx(kg, rel=1e-9)
    bare, light, heavy = (throw_balance(scene) for scene in (roomy, one_piece, bolted))
    share = 17500.0 / roomy.material.density_kg_m3
    for name in ("mass_kg", "web_kg", "throw_unbalance_kg_mm", "inertia_kg_mm2"):
        own, one, two = (getattr(balance, name) for balance in (bare, light, heavy))
        assert two - own == pytest.approx(share * (one - own), rel=1e-9), name
    assert heavy.own_counterweights_kg == pytest.approx([kg, kg], rel=1e-9)
    assert heavy.own_counterweight_kg_mm == pytest.approx(
        bare.throw_unbalance_kg_mm - heavy.throw_unbalance_kg_mm, rel=1e-9
    )
    assert bare.own_counterweights_kg == (0, 0)


REFUSED: dict[str, tuple[dict[str, Any], str]] = {
    "smaller than the journal": (
        {**PLAIN, "outer_radius_mm": 23.0},
        r"outer_radius_mm = 23.*larger than 23.6 mm",
    ),
    "within the web": ({**PLAIN, "outer_radius_mm": 24.9}, r"outer_radius_mm = 24.9.*adds nothing"),
    "outside the envelope": (
        {**PLAIN, "outer_radius_mm": 80.0},
        r"outer_radius_mm = 80.*beyond the design space",
    ),
    "far too large": ({**PLAIN, "outer_radius_mm": 6200.0}, r"outer_radius_mm = 6200.*unit"),
    "angle too small": ({**PLAIN, "half_angle_deg": 2.0}, r"half_angle_deg.*5"),
    "angle too large": ({**PLAIN, "half_angle_deg": 120.0}, r"half_angle_deg.*90"),
    "too thick": ({**PLAIN, "thickness_mm": 19.5}, r"thickness_mm = 19.5.*at most web.thickness_mm = 19 mm"),
    "unknown face": ({**PLAIN, "face": "both"}, r"counterweight.face.*'journal' or 'pin'"),
    "density": ({**PLAIN, "density_kg_m3": 7.85}, r"density_kg_m3.*10"),
    "unknown key": ({**PLAIN, "radius_mm": 60.0}, r"unknown key web.counterweight.radius_mm"),
}


@pytest.mark.parametrize("name", REFUSED)
def test_refused(name: str, roomy: Scene) -> None:
    counterweight, message = REFUSED[name]
    with pytest.raises(CranktopoError, match=message):
        weighted(roomy, counterweight)


@pytest.mark.parametrize(
    ("features", "message"),
    [
        (
            {"bevel": [{"face": "pin", "y_mm": -24.0, "depth_mm": 0.5}]},
            r"bevel\[0\].*where web.counterweight is",
        ),
        (
            {
                "pocket": [
                    {"shape": "side", "y_mm": -15.0, "length_mm": 8.0, "height_mm": 5.0, "depth_mm": 9.0}
                ]
            },
            r"pocket\[0\]: runs into web.counterweight",
        ),
    ],
    ids=["bevel", "side pocket"],
)
def test_features_that_would_leave_a_hollow_are_refused(
    roomy: Scene, features: dict[str, Any], message: str
) -> None:
    with pytest.raises(CranktopoError, match=message):
        weighted(roomy, {**DISC}, **features)
