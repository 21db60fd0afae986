"""Faces of a body whose parameters change, as zero sets of distances smooth in place and parameters.

A point that stays on a face while a parameter p changes moves by V with gradient.V + d(distance)/dp = 0.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array
from cranktopo.numerics.optimisers.gradient_search import central_difference

STEP = 1e-6
"""Step of central differences, mm or degrees; the distances are smooth and of the size of the body."""


@dataclass(frozen=True)
class Contact:
    """Distance from a face at some points, (n,), and its gradient by the place, (n, 3)."""

    distance_mm: Array
    gradient: Array

    @property
    def steepness(self) -> Array:
        """Length of the gradient, (n, 1)."""
        return np.asarray(np.linalg.norm(self.gradient, axis=1)[:, None])

    @property
    def normal(self) -> Array:
        """Unit normal, (n, 3)."""
        return self.gradient / self.steepness


class MovingFace(ABC):
    """One face of a body, or a seam: a surface that crosses the face before where that leaves a tangent."""

    seam: bool = False

    @abstractmethod
    def contact(self, points_mm: Array, values: Array) -> Contact:
        """Return the face at points (3, n) for some values of the parameters."""

    @abstractmethod
    def gradients(self, points_mm: Array, values: Array) -> Array:
        """Return derivatives of the distance by the parameters, (n, parameters), per mm or degree."""


class LeadingFace(MovingFace):
    """A face that says where its nodes go, in place of leaving them to slide along it."""

    @abstractmethod
    def moved(self, points_mm: Array, start: Array, values: Array) -> Array:
        """Return where points (3, n) of the face come to from some values to others."""

    def velocities(self, points_mm: Array, start: Array, values: Array) -> Array:
        """Return its motion per mm or degree of each parameter, (n, 3, parameters); here of a linear one."""

        def motion(values: Array) -> Array:
            return (self.moved(points_mm, start, values) - points_mm).T

        here = motion(values)
        return np.stack([motion(values + unit) - here for unit in np.eye(len(values))], axis=-1)


def contact_of(distance_mm: Callable[[Array], Array], points_mm: Array) -> Contact:
    """Return a face at points (3, n), whose distance is given."""
    return Contact(distance_mm(points_mm), central_difference(distance_mm, points_mm, STEP))
