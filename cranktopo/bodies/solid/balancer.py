"""OCC solid of a balancer shaft with its grooves and holes, without masses, gear and bearings.

Its volume is checked against the closed form: cylinders, round grooves by Pappus' theorem, and holes across,
each the common volume of two cylinders whose axes cross.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import pairwise
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.bodies.solid.checked import ClosedForm, check_body
from cranktopo.bodies.solid.shapes import cut
from cranktopo.design.balancer import BalancerPart, ShaftNotch
from cranktopo.design.checks.balancer import balancer_of
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags

_POINTS = 40
"""Gauss points along a hole: its volume is exact to 1e-12."""


def add_balancer(occ: Any, scene: Scene) -> DimTags:
    """Return the shaft, its first end at the origin, its axis along z; holes go across along x."""
    part = _part(scene)
    body: DimTags = [
        (3, occ.addCylinder(0, 0, start, 0, 0, end - start, r)) for start, end, r in _outside(part)
    ]
    if len(body) > 1:
        body, _ = occ.fuse(body[:1], body[1:])
    tools: DimTags = [
        (3, occ.addCylinder(0, 0, start, 0, 0, end - start, step.bore_mm / 2))
        for step, start, end in part.steps
        if step.bore_mm
    ]
    for notch in part.notch:
        outer = part.section_at(notch.z_mm)[0] / 2
        tools += _ring(occ, notch, outer) if notch.kind == "groove" else _hole(occ, notch, outer)
    body = cut(occ, body, tools) if tools else body
    check_body(occ, body, ClosedForm(balancer_mm3(part)), "balancer shaft")
    return list(body)


def _part(scene: Scene) -> BalancerPart:
    """Return the shaft; raises CranktopoError where a groove or a hole reaches beyond its step."""
    part = balancer_of(scene)
    for number, notch in enumerate(part.notch):
        half = _half_width_mm(notch, part.section_at(notch.z_mm)[0] / 2)
        if not any(start <= notch.z_mm - half and notch.z_mm + half <= end for _, start, end in part.steps):
            raise scene.invalid(
                f"balancer.notch[{number}].z_mm", f"must be {half:g} mm from the ends of its step, as a body"
            )
    return part


def _outside(part: BalancerPart) -> Iterator[tuple[float, float, float]]:
    """Yield begin, end and radius of the cylinders, of steps with one diameter as one: no edge is between."""
    steps = [(start, end, step.diameter_mm / 2) for step, start, end in part.steps]
    first, radius = 0.0, steps[0][2]
    for (_, end, _), (_, _, following) in pairwise([*steps, (0.0, 0.0, -1.0)]):
        if following != radius:
            yield first, end, radius
            first, radius = end, following


def _half_width_mm(notch: ShaftNotch, outer_mm: float) -> float:
    """Return half of a notch's width along the shaft; a groove shallower than its radius is narrower."""
    if notch.kind == "hole":
        return notch.diameter_mm / 2
    depth = min(outer_mm - notch.diameter_mm / 2, notch.radius_mm)
    return math.sqrt(depth * (2 * notch.radius_mm - depth))


def _ring(occ: Any, notch: ShaftNotch, outer: float) -> DimTags:
    """The material of a groove: parallel sides and a round bottom, turned about the axis."""
    z, r, half = notch.z_mm, notch.radius_mm, _half_width_mm(notch, outer)
    centre = notch.diameter_mm / 2 + r
    beyond = outer + r  # so that no faces of tool and shaft lie in each other
    low = centre - math.sqrt(max(r * r - half * half, 0.0))
    a, b, c, d = (
        occ.addPoint(x, 0, place)
        for x, place in ((low, z - half), (low, z + half), (beyond, z + half), (beyond, z - half))
    )
    bottom, middle = occ.addPoint(centre - r, 0, z), occ.addPoint(centre, 0, z)
    arcs = [occ.addCircleArc(a, middle, bottom), occ.addCircleArc(bottom, middle, b)]
    lines = [occ.addLine(*ends) for ends in ((b, c), (c, d), (d, a))]
    face = occ.addPlaneSurface([occ.addCurveLoop([*arcs, *lines])])
    turned = occ.revolve([(2, face)], 0, 0, 0, 0, 0, 1, 2 * math.pi)
    return [pair for pair in turned if pair[0] == 3]


def _hole(occ: Any, notch: ShaftNotch, outer: float) -> DimTags:
    length = 4 * outer
    return [(3, occ.addCylinder(-length / 2, 0, notch.z_mm, length, 0, 0, notch.diameter_mm / 2))]


def balancer_mm3(part: BalancerPart) -> float:
    """Return the volume of a shaft without its masses by the closed form, mm3."""
    volume = sum(
        math.pi / 4 * (end - start) * (step.diameter_mm**2 - step.bore_mm**2)
        for step, start, end in part.steps
    )
    for notch in part.notch:
        outer, bore = part.section_at(notch.z_mm)
        removed = _groove_mm3(notch, outer / 2) if notch.kind == "groove" else _hole_mm3(notch, outer, bore)
        volume -= removed
    return volume


def _groove_mm3(notch: ShaftNotch, outer: float) -> float:
    """Return what a round groove removes: its straight part, and the segment of a circle at its bottom."""
    root, r = notch.diameter_mm / 2, notch.radius_mm
    depth, half = min(outer - root, r), _half_width_mm(notch, outer)
    straight = math.pi * (outer**2 - (root + depth) ** 2) * 2 * half
    area = r * r * math.acos(1 - depth / r) - (r - depth) * half
    centre = root + r - 2 / 3 * half**3 / area
    return straight + 2 * math.pi * centre * area


def _hole_mm3(notch: ShaftNotch, outer_mm: float, bore_mm: float) -> float:
    """Return what a hole across removes of a hollow shaft."""
    at, weights = np.polynomial.legendre.leggauss(_POINTS)
    angle, r = math.pi / 2 * at, notch.diameter_mm / 2
    width = r * np.cos(angle)  # substituted along the shaft: z = r sin(angle)
    section = _strip_mm2(outer_mm / 2, width) - _strip_mm2(bore_mm / 2, np.minimum(width, bore_mm / 2))
    return float(math.pi / 2 * weights @ (section * width))


def _strip_mm2(radius: float, half_width: Array) -> Array:
    """Return the area of a disk within strips about its middle."""
    if not radius:
        return np.zeros_like(half_width)
    across = np.sqrt(radius**2 - half_width**2)
    area: Array = 2 * (half_width * across + radius**2 * np.arcsin(half_width / radius))
    return area
