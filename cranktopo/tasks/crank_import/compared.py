"""A body from CAD and the body of its design over each other: what either of them lacks, and where."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from cranktopo.numerics.surfaces.mesh import largest_shell, unrounded_mesh_of

if TYPE_CHECKING:
    from manifold3d import Manifold

_TOLD = 1e-3
"""Share of the volume in which a difference of both is told."""


@dataclass(frozen=True)
class Compared:
    """Triangles of the half throw of a body, and those of the half throw of its design."""

    solid: Manifold
    scene_solid: Manifold

    @cached_property
    def _common_mm3(self) -> float:
        """Volume that both have: one pass of the boolean engine tells what either lacks."""
        return float((self.solid ^ self.scene_solid).volume())

    @property
    def missing_mm3(self) -> float:
        """Volume that the body has and the design lacks."""
        return max(0.0, float(self.solid.volume()) - self._common_mm3)

    @property
    def extra_mm3(self) -> float:
        """Volume that the design has and the body lacks."""
        return max(0.0, float(self.scene_solid.volume()) - self._common_mm3)

    @property
    def differs_mm3(self) -> float:
        """Volume in which both differ."""
        return self.missing_mm3 + self.extra_mm3

    @property
    def least_mm3(self) -> float:
        """Volume in which both differ at least: the difference of their volumes."""
        return abs(float(self.solid.volume()) - float(self.scene_solid.volume()))

    @property
    def differences(self) -> Iterator[str]:
        """Volumes, in words, that one of both lacks, each with the place of its largest part."""
        for volume, lacks in ((self.missing_mm3, True), (self.extra_mm3, False)):
            if volume > _TOLD * self.solid.volume():
                yield f"{self._words(volume, lacks)}, most of it near {self._place(lacks)} mm"

    def least_difference(self, off_mm3: float) -> str:
        """Tell a volume that the design lacks, or adds where it is negative, with its likely place."""
        lacks = off_mm3 > 0
        return f"{self._words(abs(off_mm3), lacks)}, perhaps near {self._place(lacks)} mm"

    @staticmethod
    def _words(volume_mm3: float, lacks: bool) -> str:
        return f"the design {'lacks' if lacks else 'adds'} {volume_mm3:.4g} mm3"

    def _place(self, lacks: bool) -> str:
        """Return the centre of the largest part of what one of both lacks.

        Slivers along faces may hang on to it. They may be thousands, which the boolean engine parts one by
        one, each in a copy of all corners; so the parts are told by their triangles.
        """
        apart = self.solid - self.scene_solid if lacks else self.scene_solid - self.solid
        part = largest_shell(unrounded_mesh_of(apart))
        x, y, z = part.first_moments_mm4 / part.volume_mm3
        return f"({x:.4g}, {y:.4g}, {z:.4g})"
