"""A body from CAD and the body of its design over each other: what either of them lacks, and where."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

from cranktopo.numerics.surfaces.mesh import SurfaceMesh, largest_shell, solid_of, unrounded_mesh_of

if TYPE_CHECKING:
    from manifold3d import Manifold

_TOLD, _TOLD_BEYOND = 1e-3, 1e-5
"""Share of the volume in which a difference of both is told, and of what is farther apart than facets."""
_APART_MM, _FACETS = 0.08, 6.0
"""Distance of what is no facet: at least, and over the mean distance of both."""


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

    @property
    def differences_beyond_facets(self) -> Iterator[str]:
        """Parts, in words, by which one reaches out of the other farther than facets do: bosses, small cuts.

        The design's corners move out along their normals, or in, so that facets do not count.
        """
        design = unrounded_mesh_of(self.scene_solid)
        apart = _APART_MM + _FACETS * self.differs_mm3 / design.areas_mm2.sum()
        normals = apart * design.as_trimesh().vertex_normals
        larger, smaller = (
            solid_of(SurfaceMesh(design.vertices_mm + by, design.faces)) for by in (normals, -normals)
        )
        for what, beyond in (("lacks", self.solid - larger), ("adds", smaller - self.solid)):
            if beyond.volume() > _TOLD_BEYOND * self.solid.volume():
                yield f"the design {what} at least {beyond.volume():.4g} mm3, near {_centre(beyond)} mm"

    @staticmethod
    def _words(volume_mm3: float, lacks: bool) -> str:
        return f"the design {'lacks' if lacks else 'adds'} {volume_mm3:.4g} mm3"

    def _place(self, lacks: bool) -> str:
        return _centre(self.solid - self.scene_solid if lacks else self.scene_solid - self.solid)


def _centre(solid: Manifold) -> str:
    """Return the centre of the largest part of a solid, mm: slivers along faces may hang on to it.

    They may be thousands, which the boolean engine parts one by one, each in a copy of all corners; so the
    parts are told by their triangles.
    """
    part = largest_shell(unrounded_mesh_of(solid))
    x, y, z = part.first_moments_mm4 / part.volume_mm3
    return f"({x:.4g}, {y:.4g}, {z:.4g})"
