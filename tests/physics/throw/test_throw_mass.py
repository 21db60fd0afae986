"""Mass properties of the throw against closed forms and against counting points on a fine lattice."""

import math

import numpy as np
import pytest

from cranktopo.bodies.volume import half_throw_volume_mm3, web_moments
from cranktopo.design.loading import load_scene, scene_from_dict
from cranktopo.engine.balance.throw import throw_balance
from cranktopo.throw.moments import body_section_moments
from cranktopo.throw.web import web_bodies

BASE = {
    "name": "t",
    "throw": {
        "radius_mm": 40.0,
        "main_journal": {"outer_diameter_mm": 40.0, "length_mm": 30.0, "bore_diameter_mm": 16.0},
        "crankpin": {"outer_diameter_mm": 36.0, "length_mm": 28.0},
    },
    "material": {"name": "42CrMo4"},
}


def scene(web, **throw):
    return scene_from_dict(
        {**BASE, "throw": {**BASE["throw"], **throw}, "web": {"thickness_mm": 20.0, **web}}
    )


def section_moments(scene, z_mm):
    """Moments of the web's section at a height, per mm of height."""
    return body_section_moments(web_bodies(scene), z_mm)


def test_obround_with_bores_is_exact():
    got = section_moments(load_scene("mikron-iiic-plain"), 30.0)
    area = 50 * 48 + math.pi * 25**2 - 2 * math.pi * 12**2
    end = math.pi * 25**4 / 2 + math.pi * 25**2 * 48**2 / 2 + 2 * 48 * 2 / 3 * 25**3  # two half discs
    bores = 2 * math.pi / 2 * 12**4 + math.pi * 12**2 * 48**2
    polar = 50 * 48**3 / 3 + 48 * 50**3 / 12 + end - bores
    assert got.volume == pytest.approx(area, rel=1e-9)
    assert got.first_y == pytest.approx(area * 24, rel=1e-9)
    assert got.polar == pytest.approx(polar, rel=1e-9)
    assert abs(got.first_x) < 1e-9


WEBS = {
    "tapered": {"outline": "tapered", "main_radius_mm": 38.0, "pin_radius_mm": 24.0},
    "ellipse": {"outline": "ellipse", "semi_axis_throw_mm": 50.0, "semi_axis_lateral_mm": 30.0},
    "rectangle": {"outline": "rectangle", "width_mm": 52.0, "overhang_mm": 26.0, "corner_radius_mm": 9.0},
    "profile": {
        "outline": "profile",
        "stations_mm": [-30.0, -10.0, 20.0, 50.0, 62.0],
        "half_widths_mm": [10.0, 34.0, 26.0, 28.0, 12.0],
    },
}
POCKETS = [
    {"shape": "cylinder", "face": "journal", "x_mm": 9.0, "y_mm": 22.0, "diameter_mm": 14.0, "depth_mm": 6.0},
    {"shape": "cylinder", "x_mm": -24.0, "y_mm": 8.0, "diameter_mm": 12.0},  # across the edge and the bore
    {"shape": "side", "y_mm": 26.0, "length_mm": 18.0, "height_mm": 8.0, "depth_mm": 7.0},
    {
        "shape": "box",
        "face": "pin",
        "x_mm": 6.0,
        "y_mm": 18.0,
        "size_x_mm": 15.0,
        "size_y_mm": 12.0,
        "depth_mm": 9.0,
    },
]


def inside(web, x, y, z):
    """Membership straight from the definitions, for a lattice of points; z above the journal face."""
    a = web["outline"]
    if a == "ellipse":
        solid = (x / 30) ** 2 + ((y - 20) / 50) ** 2 <= 1
        edge = 30.0
    elif a == "rectangle":
        dx, dy = np.abs(x) - 17, np.abs(y - 20) - 37
        solid = np.hypot(np.maximum(dx, 0), np.maximum(dy, 0)) <= 9
        edge = 26.0
    else:  # tapered: union of the discs between both
        t = np.linspace(0, 1, 121)[:, None, None]
        solid = (x**2 + (y - 40 * t) ** 2 <= (38 - 14 * t) ** 2).any(axis=0)
        edge = 38.0
    solid &= x**2 + y**2 > 8**2
    solid &= ~(((x - 9) ** 2 + (y - 22) ** 2 < 7**2) & (z < 6))
    solid &= (x + 24) ** 2 + (y - 8) ** 2 > 6**2
    solid &= ~((np.abs(x) > edge - 7) & (np.abs(y - 26) < 9) & (abs(z - 10) < 4))
    return solid & ~((np.abs(x - 6) < 7.5) & (np.abs(y - 18) < 6) & (z > 11))


@pytest.mark.parametrize("name", ["tapered", "ellipse", "rectangle"])
@pytest.mark.parametrize("z", [3.0, 8.0, 12.5, 18.0])
def test_sections_with_asymmetric_pockets(name, z):
    got = section_moments(scene({**WEBS[name], "pocket": POCKETS}), 15.0 + z)
    step = 0.25
    x, y = np.meshgrid(np.arange(-50, 50, step) + step / 2, np.arange(-60, 100, step) + step / 2)
    hit = inside(WEBS[name], x, y, z) * step**2
    assert got.volume == pytest.approx(hit.sum(), rel=2e-3)
    assert got.first_x == pytest.approx((hit * x).sum(), rel=2e-2)
    assert got.first_y == pytest.approx((hit * y).sum(), rel=2e-3)
    assert got.polar == pytest.approx((hit * (x**2 + y**2)).sum(), rel=2e-3)


def test_web_is_the_sum_of_its_layers():
    s = scene({**WEBS["ellipse"], "pocket": POCKETS})
    heights = np.linspace(15, 35, 41)
    layers = [section_moments(s, z).volume * 0.5 for z in (heights[:-1] + heights[1:]) / 2]
    assert web_moments(s).volume == pytest.approx(sum(layers), rel=1e-9)


def test_profile_runs_through_its_stations_without_overshoot():
    web = scene(WEBS["profile"]).web
    y = np.array(web.stations_mm)
    assert web.half_width_mm(40.0, y) == pytest.approx(web.half_widths_mm)
    assert web.half_width_mm(40.0, np.linspace(-30, 62, 999)).max() <= web.largest_half_width_mm + 1e-12
    assert web.half_width_mm(40.0, np.array([-31.0, 63.0])) == pytest.approx([0, 0])
    assert web.y_range_mm(40.0) == (-30.0, 62.0)


@pytest.mark.parametrize("name", ["tapered", "ellipse", "rectangle"])
def test_half_width_vanishes_only_beyond_the_range(name):
    web = scene(WEBS[name]).web
    low, high = web.y_range_mm(40.0)
    width = web.half_width_mm(40.0, np.array([low - 1e-3, low + 1e-3, high - 1e-3, high + 1e-3]))
    assert (width > 0).tolist() == [False, True, True, False]


def test_one_disc_within_the_other():
    web = scene({"outline": "tapered", "main_radius_mm": 90.0, "pin_radius_mm": 20.0}).web
    assert web.half_width_mm(40.0, np.array([0.0, 54.0])) == pytest.approx([90.0, 72.0])
    assert web.y_range_mm(40.0) == (-90.0, 90.0)


def test_fillets_follow_pappus():
    """Volume of a ring: area of a corner less a quarter disc, times the path of its centroid."""
    web = {"outline": "rectangle", "width_mm": 80.0, "overhang_mm": 40.0}
    pin = {**BASE["throw"]["crankpin"], "fillet_mm": 3.0}
    sharp, rounded = throw_balance(scene(web)), throw_balance(scene(web, crankpin=pin))
    f = 3.0
    centroid = 18.0 + f * (10 - 3 * math.pi) / (12 - 3 * math.pi)
    volume = 2 * (1 - math.pi / 4) * f**2 * 2 * math.pi * centroid
    assert rounded.mass_kg - sharp.mass_kg == pytest.approx(volume * 7.85e-6, rel=1e-9)
    # Second moment of the ring about its own axis, by thin discs.
    z = (np.arange(20000) + 0.5) / 20000 * f
    outer = 18.0 + f - np.sqrt(f**2 - (f - z) ** 2)
    own = 2 * (math.pi / 2 * (outer**4 - 18.0**4)).mean() * f
    gained = (own + volume * 40.0**2) * 7.85e-6
    assert rounded.inertia_kg_mm2 - sharp.inertia_kg_mm2 == pytest.approx(gained, rel=1e-6)
    assert rounded.throw_unbalance_kg_mm - sharp.throw_unbalance_kg_mm == pytest.approx(
        volume * 7.85e-6 * 40.0, rel=1e-9
    )


def test_elliptical_fillets_have_their_closed_form():
    """Moments of the height a (1 - sqrt(1 - s2)) over the radius r = R + b (1 - s), by hand."""
    web = {"outline": "rectangle", "width_mm": 80.0, "overhang_mm": 40.0}
    b, a, r = 3.0, 5.0, 18.0
    pin = {**BASE["throw"]["crankpin"], "fillet_mm": b, "fillet_axial_mm": a}
    sharp, rounded = throw_balance(scene(web)), throw_balance(scene(web, crankpin=pin))
    shares = (1 - math.pi / 4, 5 / 6 - math.pi / 4, 1 - 5 * math.pi / 16, 83 / 60 - 7 * math.pi / 16)
    m0, m1, m2, m3 = (share * a * b ** (n + 1) for n, share in enumerate(shares))
    volume = 4 * math.pi * (r * m0 + m1)
    own = 4 * math.pi * (r**3 * m0 + 3 * r**2 * m1 + 3 * r * m2 + m3)
    gained = rounded.mass_kg - sharp.mass_kg, rounded.inertia_kg_mm2 - sharp.inertia_kg_mm2
    assert gained == pytest.approx((volume * 7.85e-6, (own + volume * 40.0**2) * 7.85e-6), rel=1e-9)
    half = half_throw_volume_mm3(scene(web, crankpin=pin)) - half_throw_volume_mm3(scene(web))
    assert half == pytest.approx(volume / 2, rel=1e-9)


def test_printed_parts_of_the_mikron():
    """Dolezal 2024 prints the crankpin (0.267 kg, 693.8 kg mm2, with its oil bores and radii) and 0.296 kg
    for the journal, which its own dimensions at 7850 kg/m3 make 0.293 kg."""
    s = load_scene("mikron-iiic-plain")
    balance = throw_balance(s)
    assert balance.journal_kg == pytest.approx(0.29298, abs=1e-5)
    assert balance.crankpin_kg == pytest.approx(0.267, rel=0.02)
    own = balance.crankpin_kg / 2 * (21**2 + 12**2)
    assert balance.crankpin_kg * 48**2 + own == pytest.approx(693.8, rel=0.02)


def test_balance_adds_up_and_asymmetry_shows():
    s = scene({**WEBS["rectangle"], "pocket": POCKETS[:1]})
    balance = throw_balance(s)
    assert balance.mass_kg == pytest.approx(balance.journal_kg + balance.crankpin_kg + 2 * balance.web_kg)
    assert balance.lateral_unbalance_kg_mm == pytest.approx(-2 * math.pi * 49 * 6 * 9 * 7.85e-6, rel=1e-4)
    assert balance.counterweight_kg_mm == pytest.approx(balance.throw_unbalance_kg_mm)  # no engine, no rod
