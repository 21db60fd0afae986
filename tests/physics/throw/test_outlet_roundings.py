"""Roundings of outlets: the closed form beside points that no ball inside reaches, the kernel beside both.

`python -m pytest -m slow tests/physics/throw/test_outlet_roundings.py -s` prints what the documentation says.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
import pytest
from scipy.spatial import cKDTree

from cranktopo.base.arrays import Array
from cranktopo.bodies.solid.checked import volume_mm3
from cranktopo.bodies.solid.drilled import drilled as bored
from cranktopo.bodies.solid.shapes import add_solid, cut
from cranktopo.numerics.gmsh_session import cad_session
from cranktopo.throw.drilling.bore import DrillBore
from cranktopo.throw.drilling.moments import drilled
from cranktopo.throw.drilling.outlet import DrillOutlet, across
from cranktopo.throw.drilling.table import drill_bores
from cranktopo.throw.primitives import RoundedOutlet
from tests.physics.throw.test_drillings import STRAIGHT, mikron

POINTS = 400_000


def bore_with(rounding_mm: float) -> DrillBore:
    (bore,) = drill_bores(mikron({**STRAIGHT, "outlet_radius_mm": rounding_mm}))
    return bore


def rings_mm3(rounding_mm: float) -> float:
    """Both rings of a half throw by the closed form."""
    found, sharp = (drilled(mikron({**STRAIGHT, "outlet_radius_mm": r})).volume for r in (rounding_mm, 0.0))
    return found - sharp


def out_of_reach_mm3(bore: DrillBore, outlet: DrillOutlet) -> tuple[float, float]:
    """Volume at an outlet that no ball of its radius inside the material reaches, and its standard error.

    A point is reached if the nearest possible centre is at most a radius away: one on the cylinder of centres
    about the journal, on that about the bore, or on the curve in which both meet.
    """
    bore_mm, ball, surface = bore.radius_mm, outlet.rounding_mm, outlet.surface_mm
    foot, along, axis = np.array(outlet.point_mm), np.array(outlet.outward), np.array([0.0, outlet.y_mm, 0.0])
    turn = np.linspace(0, 2 * np.pi, 20000, endpoint=False)[:, None]
    one, other = across(along)
    spokes = (bore_mm + ball) * (np.cos(turn) * one + np.sin(turn) * other)
    heights = outlet.height_mm(spokes, surface - ball)
    curve = foot + spokes + heights[:, None] * along
    low, high = curve.min(axis=0) - 2 * ball, curve.max(axis=0) + 2 * ball
    at = np.random.default_rng(4).uniform(low, high, (POINTS, 3))

    def off_bore(points: Array) -> Array:
        return np.linalg.norm(np.cross(points - foot, along), axis=1)

    def off_axis(points: Array) -> Array:
        return np.hypot(*(points - axis)[:, :2].T)

    at = at[(off_axis(at) < surface) & (off_bore(at) > bore_mm)]
    reach, wide = surface - ball, bore_mm + ball
    share = (reach / off_axis(at))[:, None]
    below = np.column_stack([(share * (at - axis) + axis)[:, :2], at[:, 2]])
    middle = foot + ((at - foot) @ along)[:, None] * along
    beside = middle + (wide / off_bore(at))[:, None] * (at - middle)
    centred = (off_axis(at) <= reach) & (off_bore(at) >= wide)
    centred |= (off_axis(at) > reach) & (off_bore(below) >= wide)
    centred |= (off_bore(at) < wide) & (off_axis(beside) <= reach)
    gone = int((cKDTree(curve).query(at[~centred])[0] > ball).sum())
    box = float(np.prod(high - low)) / POINTS
    return box * gone, box * math.sqrt(gone)


def kernel_rings_mm3(bore: DrillBore) -> Iterator[float]:
    """Rings by the kernel's own rounding."""
    for tool in bore.solids():
        if isinstance(tool, RoundedOutlet):
            with cad_session("rounding") as gmsh:
                occ = gmsh.model.occ
                ring = cut(occ, add_solid(occ, tool), add_solid(occ, tool.hole))
                journal = [(3, occ.addCylinder(0, tool.y_mm, -500, 0, 0, 1000, tool.surface_mm))]
                yield sum(occ.getMass(*pair) for pair in occ.intersect(ring, journal)[0])


@pytest.mark.slow
@pytest.mark.parametrize("rounding_mm", [1.0, 2.0, 4.0])
def test_a_rounding_is_what_no_ball_reaches(rounding_mm: float) -> None:
    bore = bore_with(rounding_mm)
    found, errors = zip(*(out_of_reach_mm3(bore, outlet) for outlet in bore.outlets), strict=True)
    assert rings_mm3(rounding_mm) == pytest.approx(sum(found), abs=3 * math.hypot(*errors))


@pytest.mark.slow
@pytest.mark.parametrize(("rounding_mm", "less"), [(1.0, 0.009), (2.0, 0.034), (3.0, 0.074), (4.0, 0.127)])
def test_the_kernels_rounding_is_smaller(rounding_mm: float, less: float) -> None:
    share = 1 - sum(kernel_rings_mm3(bore_with(rounding_mm))) / rings_mm3(rounding_mm)
    print(f"rounding over bore radius {rounding_mm / 2.5:.1f}: {100 * share:.1f} % less than a rolled ball")
    assert share == pytest.approx(less, rel=0.1, abs=2e-3)


@pytest.mark.slow
def test_a_rounding_that_reaches_the_middle() -> None:
    """Of half a crankpin, to 0.5 % of it; the kernel's own rounding of the edge took 8 % too little there."""
    ends = {"on": "crankpin", "angle_deg": 40.0, "place_mm": 3.0}
    drilling = {"diameter_mm": 5.0, "from": ends, "to": ends | {"angle_deg": 220.0}}
    scene, sharp = (mikron({**drilling, "outlet_radius_mm": r}, bore_diameter_mm=0.0) for r in (1.5, 0.0))
    (bore,), pin, middle = drill_bores(scene), scene.throw.crankpin, scene.pitch_mm / 2
    ring_mm3 = drilled(scene, "crankpin").volume - drilled(sharp, "crankpin").volume
    with cad_session("half a crankpin") as gmsh:
        occ, reach = gmsh.model.occ, 9.0
        half = [(3, occ.addCylinder(0, scene.throw.radius_mm, middle - reach, 0, 0, reach, pin.radius_mm))]
        taken = occ.getMass(*half[0]) - volume_mm3(occ, bored(occ, half, [bore]))
    assert taken == pytest.approx(drilled(scene, "crankpin").volume, abs=5e-3 * ring_mm3)
