"""The web table: thickness, and every kind of feature. A new kind is registered here, by one field.

Outlines are tables of their own that extend it; `cranktopo.throw.outline` lists them.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated, Any, ClassVar, Self

import numpy as np
from pydantic import Field
from typing_extensions import override

from cranktopo.base.arrays import Array
from cranktopo.base.errors import invalid
from cranktopo.base.spans import Section, Span, holds, material
from cranktopo.base.table import Length, SceneTable
from cranktopo.throw.bevel import EndBevel, FittedBevel
from cranktopo.throw.counterweight.table import Counterweight
from cranktopo.throw.face_pocket import BoxPocket, CylinderPocket
from cranktopo.throw.feature import Body, Feature, ThrowView
from cranktopo.throw.fitted import FittedFeature, FittedToSections
from cranktopo.throw.fitted_pocket import FittedBox, FittedCylinder, FittedPocket
from cranktopo.throw.fitted_slot import FittedSlot
from cranktopo.throw.hole import bore_holes
from cranktopo.throw.primitives import Curve, Extrusion, Solid
from cranktopo.throw.recess import recesses
from cranktopo.throw.side_pocket import SidePocket

Pocket = Annotated[CylinderPocket | SidePocket | BoxPocket, Field(discriminator="shape")]
FITTED_TO_SECTIONS: tuple[tuple[FittedToSections, ...], ...] = (
    (FittedBevel("journal"),),
    (FittedBevel("pin"),),
    (FittedSlot(), FittedSlot(through=True)),
)
"""Features whose initial values the re-model reads from cross-sections; of each group the best is tried."""
FITTED_TO_REGIONS: tuple[type[FittedPocket], ...] = (FittedCylinder, FittedBox)
"""Features that the re-model places where the body has a hole that the web lacks."""
FITTED: tuple[type[FittedFeature], ...] = (FittedBevel, FittedSlot, *FITTED_TO_REGIONS)
"""Kinds that a table of the web can be read back as."""


_INWARD, _INWARD_OF_FACETS = 1 - 1e-6, 1 - 2e-3
"""Factor on the distance of points that lie on an edge from the middle of what it bounds."""


class WebTable(SceneTable, ABC):
    """Keys of all webs: thickness and features; an outline extends it by its own dimensions."""

    thickness_mm: Length = Field(examples=[19.0])
    """Thickness along the crank axis."""
    bevel: tuple[EndBevel, ...] = Field(default=(), max_length=2)
    pocket: tuple[Pocket, ...] = ()
    """Pockets taken out of the outline's solid; `shape` chooses the kind."""
    counterweight: Counterweight | None = None

    feature_keys: ClassVar[tuple[str, ...]] = ("bevel", "pocket")
    """Keys that hold lists of features."""
    single_keys: ClassVar[tuple[str, ...]] = ("counterweight",)
    """Keys that hold one feature or none; no fit to a body changes it."""

    @abstractmethod
    def half_width_mm(self, throw_radius_mm: float, y_mm: Array) -> Array:
        """Half-width of the outline, without its features, at places along the throw; 0 beyond its ends."""

    @abstractmethod
    def y_range_mm(self, throw_radius_mm: float) -> tuple[float, float]:
        """Range of the outline along the throw."""

    @property
    @abstractmethod
    def largest_half_width_mm(self) -> float:
        """Half of the outline's largest width; side pockets are measured from it."""

    @abstractmethod
    def contour(self, throw_radius_mm: float, z_mm: float) -> tuple[Curve, ...]:
        """Return the exact outline at a height, a closed loop."""

    def kinks_mm(self, throw_radius_mm: float) -> tuple[float, ...]:
        """Positions along the throw between its ends where the half-width is not smooth."""
        return ()

    def check_outline(self, throw_radius_mm: float) -> None:
        """Refuse dimensions that give no outline."""

    @property
    def outline_alone(self) -> Self:
        """The web without its features: what integrals over the outline depend on."""
        if not any(True for _ in self.features()):
            return self
        alone: dict[str, Any] = {**dict.fromkeys(self.feature_keys, ()), **dict.fromkeys(self.single_keys)}
        return self.model_copy(update=alone)

    def features(self) -> Iterator[tuple[str, Feature]]:
        """Yield each feature with its key path in the scene."""
        for key in self.feature_keys:
            for index, feature in enumerate(getattr(self, key)):
                yield f"web.{key}[{index}]", feature
        for key in self.single_keys:
            if getattr(self, key) is not None:
                yield f"web.{key}", getattr(self, key)


@dataclass(frozen=True)
class _OutlineBody(Body):
    """The web before its features: the outline between both faces."""

    web: WebTable
    throw_radius_mm: float
    adds: ClassVar[bool] = True

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        half = self.web.half_width_mm(self.throw_radius_mm, y_mm)
        return [(-half, half)]

    @property
    @override
    def y_range_mm(self) -> tuple[float, float]:
        return self.web.y_range_mm(self.throw_radius_mm)

    @property
    @override
    def y_breaks_mm(self) -> tuple[float, ...]:
        return (*self.y_range_mm, *self.web.kinks_mm(self.throw_radius_mm))

    @property
    @override
    def x_range_mm(self) -> tuple[float, float]:
        half = self.web.largest_half_width_mm
        return -half, half

    @override
    def solids(self) -> tuple[Solid, ...]:
        low, high = self.z_mm
        return (Extrusion(self.web.contour(self.throw_radius_mm, low), (0.0, 0.0, high - low)),)


def web_bodies(scene: ThrowView) -> list[Body]:
    """Return what the web is made of: its outline, the bores through it, recesses of fillets, features."""
    outline = _OutlineBody("web.outline", scene.web_z_mm, scene.web.outline_alone, scene.throw.radius_mm)
    return [outline, *bore_holes(scene), *recesses(scene), *_feature_bodies(scene)]


def _feature_bodies(scene: ThrowView) -> list[Body]:
    return [body for key, feature in scene.web.features() for body in feature.bodies(scene, key)]


def kept_bodies(scene: ThrowView) -> tuple[Body, ...]:
    """Return the bodies of features that no optimiser takes away."""
    return tuple(body for body in _feature_bodies(scene) if body.kept and body.adds)


def kept_holes(scene: ThrowView) -> tuple[Body, ...]:
    """Return the holes of features that no optimiser fills."""
    return tuple(body for body in _feature_bodies(scene) if body.kept and not body.adds)


def check_inside(
    scene: ThrowView, section: Section, z_mm: float | None = None, of_facets: bool = False
) -> None:
    """Check that a section of the design space, at a height or any, holds what no optimiser takes away.

    Args:
        of_facets: the design space is a body of flat facets, which lie inside the round faces they stand for.
    """
    for key, feature in scene.web.features():
        for body in feature.occupied(scene, key):
            if z_mm is None or body.z_mm[0] < z_mm < body.z_mm[1]:
                at_mm = sum(body.z_mm) / 2 if z_mm is None else z_mm
                _check_body_inside(body, section, at_mm, _INWARD_OF_FACETS if of_facets else _INWARD)


def _check_body_inside(body: Body, section: Section, z_mm: float, inward: float) -> None:
    left, right, y = body.ends_mm()
    across, along = (left.min() + right.max()) / 2, (y.min() + y.max()) / 2
    within = along + inward * (y - along)
    spans = section(within, np.full_like(y, z_mm))
    outside = ~np.logical_and(*(holds(spans, across + inward * (ends - across)) for ends in (left, right)))
    if outside.any():
        at = int(np.flatnonzero(outside)[0])
        x, place = right[at], y[at]
        raise invalid(
            *body.outer_dimension,
            f"reaches beyond the design space [envelope] at x = {x:.4g}, y = {place:.4g} mm",
            f"Enlarge the envelope, or make the {body.key.removeprefix('web.')} smaller.",
        )


def web_spans(bodies: Sequence[Body], y_mm: Array, z_mm: Array) -> tuple[Array, Array]:
    """Ends (intervals, ...) of the material that bodies leave at places along the throw and heights."""
    added, removed = (
        [span for body in bodies if body.adds == adds for span in body.spans(y_mm, z_mm)]
        for adds in (True, False)
    )
    return material(added, removed)
