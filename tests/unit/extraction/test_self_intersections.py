"""Sheets that lie near each other: smoothing must not push one through the other."""

from __future__ import annotations

import numpy as np
import pytest

from cranktopo.numerics.surfaces.mesh import mesh_of, self_intersections_mm
from cranktopo.tasks.extraction.isosurface import FineField, iso_solid, unsmoothed_solid

ISO, TOLERANCE_MM = 0.5586, 0.02
PER_MILLE = """
    789732663736806870920735690605620704785856643625587585589683770651638609558529576670681661622584545505563525518501506521520508201228278347421476499
    789732709775836893939735690605665742817883643625587585632721802651638609558529614702681661622584545505593525518501506521520508201228278347421476499
    789732748807862912953735690638709780848906643625587595678760833651638609558569656738681661622584545544629525518501506521520520201228278347421476499
    789732778832884929964735690682748814876926643625587648724798863651638609558623701775681661622584545592671525518501506521520563201228278347421476499
    789758801851901942973735690719780842898943643625626696766832889651638609604676746812681661622584575646716525518501506521541613249248278347421476507
    789778819868915953980735700748807865916956643625671737801860912651638609658725788847681661622584638703763525518501506540608669327326335376444511568
    789798839885929963986735729776831886933967643655710772831886931651638639707769826878681661622634699757810525518501548617678728416415424464530591637
"""
"""7 x 7 x 7 points of a density, from a forged web on cells of 3 mm: a notch that ends in a ridge."""


def notch() -> FineField:
    digits = "".join(PER_MILLE.split())
    values = np.array([int(digits[i : i + 3]) for i in range(0, len(digits), 3)]) / 1000
    return FineField(np.zeros(3), np.array([1.47, 1.48, 1.36]), np.pad(values.reshape(7, 7, 7), 1))


def test_smoothing_is_left_out_where_it_makes_the_surface_cross_itself() -> None:
    """Rounding its corners takes a few percent of so small a body's volume."""
    field = notch()
    raw, smooth = unsmoothed_solid(field, ISO), iso_solid(field, ISO, TOLERANCE_MM)
    places = self_intersections_mm(mesh_of(smooth))
    assert len(places) == 3
    assert not len(self_intersections_mm(mesh_of(raw)))
    sound = iso_solid(field, ISO, TOLERANCE_MM, places)
    assert not len(self_intersections_mm(mesh_of(sound)))
    assert sound.volume() == pytest.approx(raw.volume(), rel=0.05)


def test_nothing_changes_far_from_rough_places() -> None:
    field = notch()
    smooth = mesh_of(iso_solid(field, ISO, TOLERANCE_MM))
    again = mesh_of(iso_solid(field, ISO, TOLERANCE_MM, np.array([[1e3, 0.0, 0.0]])))
    np.testing.assert_array_equal(again.vertices_mm, smooth.vertices_mm)
    rough = mesh_of(iso_solid(field, ISO, TOLERANCE_MM, np.array([[5.0, 5.0, 5.0]])))
    assert len(rough.vertices_mm) != len(smooth.vertices_mm)
