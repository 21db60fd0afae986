"""OCC solid of a balancer shaft with its grooves and holes, without masses, gear and bearings.

Its volume is checked against the closed form: cylinders, round grooves by Pappus' theorem, and holes across,
each the common volume of two cylinders whose axes cross.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from itertools import groupby
from typing import Any

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.base.quadrature import gauss_legendre
from cranktopo.bodies.solid.checked import ClosedForm, check_body
from cranktopo.bodies.solid.shapes import add_solid, cut
from cranktopo.design.balancer import BalancerPart, ShaftNotch
from cranktopo.design.checks.balancer import balancer_of
from cranktopo.design.schema import Scene
from cranktopo.numerics.gmsh_session import DimTags
from cranktopo.throw.primitives import Arc, Cylinder, LineSegment, Revolution, Solid

_POINTS = 40
"""Gauss points along a hole: its volume is exact to 1e-12."""


def add_balancer(occ: Any, scene: Scene) -> DimTags:
    """Return the shaft, its first end at the origin, its axis along z; holes go across along x."""
    part = _part(scene)
    body, *others = [add_solid(occ, solid) for solid in _outside(part)]
    if others:
        body, _ = occ.fuse(body, [pair for one in others for pair in one])
    bores = (_along(start, end, step.bore_mm) for step, start, end in part.steps if step.bore_mm)
    notches = (_notch(notch, part.section_at(notch.z_mm)[0] / 2) for notch in part.notch)
    body = cut(occ, body, [pair for solid in (*bores, *notches) for pair in add_solid(occ, solid)])
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


def _outside(part: BalancerPart) -> Iterator[Cylinder]:
    """Yield the cylinders, of steps with one diameter as one: no edge is between."""
    for diameter, alike in groupby(part.steps, key=lambda one: one[0].diameter_mm):
        steps = list(alike)
        yield _along(steps[0][1], steps[-1][2], diameter)


def _along(start: float, end: float, diameter: float) -> Cylinder:
    return Cylinder((0.0, 0.0, start), (0.0, 0.0, end - start), diameter / 2)


def _half_width_mm(notch: ShaftNotch, outer_mm: float) -> float:
    """Return half of a notch's width along the shaft; a groove shallower than its radius is narrower."""
    if notch.kind == "hole":
        return notch.diameter_mm / 2
    depth = min(outer_mm - notch.diameter_mm / 2, notch.radius_mm)
    return math.sqrt(depth * (2 * notch.radius_mm - depth))


def _notch(notch: ShaftNotch, outer: float) -> Solid:
    """Return the tool of a notch: a hole along x, or the turned section of a groove with its round bottom."""
    z, half, beyond = notch.z_mm, _half_width_mm(notch, outer), 2 * outer
    if notch.kind == "hole":
        return Cylinder((-beyond, 0.0, z), (2 * beyond, 0.0, 0.0), half)
    r = notch.radius_mm
    centre = notch.diameter_mm / 2 + r
    low = centre - math.sqrt(max(r * r - half * half, 0.0))
    a, b, c, d = (
        (x, 0.0, place)
        for x, place in ((low, z - half), (low, z + half), (beyond, z + half), (beyond, z - half))
    )
    bottom, middle = (centre - r, 0.0, z), (centre, 0.0, z)
    lines = (LineSegment(*ends) for ends in ((b, c), (c, d), (d, a)))
    return Revolution((Arc(a, middle, bottom), Arc(bottom, middle, b), *lines), (0.0, 0.0, 0.0))


def balancer_mm3(part: BalancerPart) -> float:
    """Return the volume of a shaft without its masses by the closed form, mm3."""
    volume = part.unnotched_mm3
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
    at, weights = gauss_legendre(_POINTS)
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
