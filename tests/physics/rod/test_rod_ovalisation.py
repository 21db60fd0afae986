"""Ovalisation of the rod's eyes: rings with known changes of diameter, elements, limits of the search."""

import math
from dataclasses import replace

import numpy as np
import pytest

from cranktopo.design.loading import load_scene
from cranktopo.design.named import with_values
from cranktopo.design.plain_bearings import PlainBearings
from cranktopo.design.rod_body import section, width_mm
from cranktopo.tasks.rod.lighter import ovalisation_um, rod_search
from cranktopo.tasks.rod.ovalisation import eye_ring, eye_shapes_of, permitted_um, pulled_N, pushed_N
from cranktopo.tasks.rod.ring import Ring
from cranktopo.tasks.rod.stage import check_rod_strength, loaded_rod

E_MPA, POISSON, WIDTH_MM = 210e3, 0.3, 4.0
OWN = load_scene("mikron-iiic-rod-h")
BY_ELEMENTS_UM = {
    "mikron-iiic-rod": {"small end": (2707, -10.7, 14.2), "big end": (4596, -26.4, 35.2)},
    "mikron-iiic-rod-i": {"small end": (2767, -13.6, 15.2), "big end": (5236, -23.6, 32.4)},
    "mikron-iiic-rod-h": {"small end": (2753, -17.9, 20.1), "big end": (4935, -28.0, 36.0)},
}
"""Pull, change across and along the rod, by `rod DESIGN --fea --element-size-mm 5`."""


def uniform(inner, outer, points=721):
    one = np.ones(points)
    angle = np.linspace(0.0, math.pi, points)
    area, neutral = WIDTH_MM * (outer - inner), (outer - inner) / math.log(outer / inner)
    return Ring(angle, area * one, (inner + outer) / 2 * one, neutral * one, E_MPA, POISSON)


def pressed(ring, inner, pressure_MPa):
    """Resultants of a pressure over the angle from the crown."""
    angle, each = ring.angle_rad, WIDTH_MM * inner * pressure_MPa
    step = angle[1] - angle[0]

    def summed(values):
        return np.concatenate([[0.0], np.cumsum((values[1:] + values[:-1]) / 2) * step])

    return summed(each * np.sin(angle)), summed(each * np.cos(angle))


def test_a_thin_ring_under_two_opposite_forces():
    """Timoshenko: (pi/4 - 2/pi) P R^3/EI along the forces, (2/pi - 1/2) P R^3/EI less across."""
    ring = uniform(99.0, 101.0)
    across, along = ring.opened_mm(0 * ring.angle_rad, 0 * ring.angle_rad + 0.5)
    soft = 100.0**3 / (E_MPA * WIDTH_MM * 2.0**3 / 12)
    assert along == pytest.approx((math.pi / 4 - 2 / math.pi) * soft, rel=1e-3)
    assert across == pytest.approx(-(2 / math.pi - 0.5) * soft, rel=1e-3)


@pytest.mark.parametrize(("outer", "error"), [(10.5, 0.002), (13.0, 0.01), (20.0, 0.025)])
def test_a_thick_ring_under_a_pressure_of_two_waves(outer, error):
    """Michell's stress function in plane stress: the bore's diameter; 2 % off in a wall as wide as it."""
    ring, inner = uniform(10.0, outer), 10.0
    across, along = ring.opened_mm(*pressed(ring, inner, np.cos(2 * ring.angle_rad)))
    radial = [[-2, 0, -6 / r**4, -4 / r**2] for r in (inner, outer)]
    shear = [[2, 6 * r**2, -6 / r**4, -2 / r**2] for r in (inner, outer)]
    A, B, C, D = np.linalg.solve([*radial, *shear], [-1.0, 0.0, 0.0, 0.0])
    grown = (1 + POISSON) * (2 * C / inner**3 - 2 * A * inner) - 4 * POISSON * B * inner**3 + 4 * D / inner
    assert along == pytest.approx(2 * grown / E_MPA, rel=error)
    assert across == pytest.approx(-along, rel=1e-9)


def test_a_thin_ring_under_even_pressure_stays_round():
    ring = uniform(99.0, 101.0)
    across, along = ring.opened_mm(*pressed(ring, 99.0, np.ones_like(ring.angle_rad)))
    assert across == pytest.approx(along, rel=1e-6)
    assert across == pytest.approx(2 * 99.0 / E_MPA * (101**2 + 99**2) / (101**2 - 99**2), rel=0.01)


@pytest.mark.parametrize(("forces", "side"), [(pulled_N, 1), (pushed_N, -1)])
def test_the_cosine_adds_up(forces, side):
    """Half of 1 N at the end, nothing on the other half, and in between the integral of the pressure."""
    across, along = forces()
    angle = np.linspace(0.0, math.pi, len(along))
    assert along[-1] == pytest.approx(side * 0.5)
    ring = uniform(10.0, 12.0, len(angle))
    share = np.maximum(side * np.cos(angle), 0.0) * 2 / math.pi / (WIDTH_MM * 10.0)
    assert np.stack([across, along]) == pytest.approx(np.stack(pressed(ring, 10.0, share)), abs=1e-4)


@pytest.mark.parametrize("shank", ["I", "H", "plain"])
def test_sections_of_the_ring_are_those_of_the_solid(shank):
    """Each by 20,000 points of the width; the width itself by sections across the rod."""
    scene = with_values(OWN, {"rod.shank": shank})
    rod = scene.rod
    for eye, axis, away, bore in (("small", 166.0, 1.0, 13.0), ("big", 0.0, -1.0, 23.0)):
        ring = eye_ring(scene, eye)
        radius = bore + bore * (np.arange(20000) + 0.5) / 20000
        for place in range(1, len(ring.angle_rad), 12):
            sine, cosine = math.sin(ring.angle_rad[place]), math.cos(ring.angle_rad[place])
            width = width_mm(rod, 166.0, radius * sine, axis + away * radius * cosine) * bore / 20000
            assert ring.area_mm2[place] == pytest.approx(width.sum(), rel=2e-3)
            assert ring.middle_mm[place] == pytest.approx((width * radius).sum() / width.sum(), rel=1e-3)
            assert ring.neutral_mm[place] == pytest.approx(width.sum() / (width / radius).sum(), rel=1e-3)
    across = (np.arange(20000) + 0.5) * 40.0 / 20000
    for y in (83.0, 40.0, 130.0):
        found = 2 * width_mm(rod, 166.0, across, np.full_like(across, y)).sum() * 40.0 / 20000
        assert found == pytest.approx(section(rod, 166.0, np.array([y])).area_mm2[0], rel=1e-3)


@pytest.mark.parametrize("name", BY_ELEMENTS_UM)
def test_under_the_pull_elements_find_the_same(name):
    """Per newton, within 17 %: local pressure and the depth of the shank are not in the ring."""
    found = {(eye.eye, eye.load): eye for eye in check_rod_strength(name).eyes}
    for end, (force, across, along) in BY_ELEMENTS_UM[name].items():
        eye = found[end, "pull"]
        assert eye.across_um / eye.force_N == pytest.approx(across / force, rel=0.17)
        assert eye.along_um / eye.force_N == pytest.approx(along / force, rel=0.17)
        assert eye.ovalisation_um == max(-eye.across_um, eye.along_um)


def test_what_is_permitted():
    """Half of the clearance of the big end, unless the rod says it; no push by the cosine is judged."""
    assert [permitted_um(OWN, eye) for eye in ("small", "big")] == [None, None]
    bearings = OWN.model_copy(update={"bearings": PlainBearings(clearance_mm=0.06)})
    assert permitted_um(bearings, "big") == pytest.approx(30.0)
    own = PlainBearings(clearance_mm=0.06, big_end_clearance_mm=0.04)
    assert permitted_um(bearings.model_copy(update={"bearings": own}), "big") == pytest.approx(20.0)
    told = with_values(bearings, {"rod.big_end_ovalisation_um": 12.0, "rod.small_end_ovalisation_um": 7.0})
    loaded = loaded_rod(told, "lsa")
    limits = [(e.judged, e.permitted_um) for e in eye_shapes_of(loaded.scene, loaded.mass, loaded.motions)]
    assert limits == [(False, None), (True, 7.0), (False, None), (True, 12.0)]


def test_a_lighter_rod_keeps_the_limits():
    """Of three dimensions; without limits the same search makes the big end softer and the rod lighter."""
    free = ("big_end_diameter_mm", "shank_big_mm", "boss_above_mm")
    limits = {"rod.small_end_ovalisation_um": 16.0, "rod.big_end_ovalisation_um": 35.0}
    whole = rod_search(with_values(load_scene("mikron-iiic-rod-i"), limits), "lsa", 3.0)
    at = [whole.names.index(name) for name in free]
    bounds = tuple(bound[at] for bound in whole.bounds)
    search = replace(whole, names=free, start_mm=whole.start_mm[at], bounds=bounds)
    kept = search.rod_at(search.best())
    found = check_rod_strength(kept)
    assert search.is_better(kept, found)
    assert ovalisation_um(found.eyes, "big") == pytest.approx(35.0, rel=2e-3)
    free_rod = check_rod_strength(search.rod_at(replace(search, limited=False).best()))
    assert ovalisation_um(free_rod.eyes, "big") > 36.0
    assert search.unlimited_kg() == pytest.approx(free_rod.masses.total_kg)
    assert free_rod.masses.total_kg < found.masses.total_kg
