"""The frame that every module shares.

Origin on the crank axis in the mid-main-journal plane. Crank axis z, throw direction +y (the crankpin
axis is x = 0, y = throw radius), x lateral. Arrays over a grid are indexed [ix, iy, iz]; vectors carry
the component (x, y, z) as their first axis. The half throw reaches from the mid-main-journal plane
z = 0 to the mid-crankpin plane z = pitch / 2. The crank turns from +y towards +x; angles of throws are in
that sense.
"""

from __future__ import annotations

from typing import Literal

X, Y, Z = 0, 1, 2

Parity = Literal["symmetric", "antisymmetric"]
Span = Literal["symmetric", "antisymmetric", "whole"]
"""Extent of a model: a half throw with motions of one parity about the mid-pin plane, or the whole throw."""


def about_z_deg(crank_angle_deg: float) -> float:
    """Return the right-handed rotation about z, deg, that turns a throw by an angle in the crank's sense."""
    return -crank_angle_deg


def shortest_turn_deg(angle_deg: float) -> float:
    """Return the turn to the same direction as an angle's, from -180 up to 180 deg."""
    return (angle_deg + 180.0) % 360.0 - 180.0
