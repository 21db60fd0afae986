"""Interface of the features of a web, and their view of the scene that holds them.

A feature knows neither meshes nor cells nor pages: rooms above loop over features and ask. Scene and throw
come later, being built from features.
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable, Hashable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar, Literal, Protocol, Self

import numpy as np
from typing_extensions import override

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.errors import CranktopoError
from cranktopo.base.spans import Span, holds
from cranktopo.base.table import SceneTable
from cranktopo.throw.journal import Journal
from cranktopo.throw.primitives import FeatureDrawing, Solid


class JournalsView(Hashable, Protocol):
    """Crank radius, journals and drillings."""

    @property
    def radius_mm(self) -> float:
        """Distance of the crankpin's axis from the crank axis."""

    @property
    def main_journal(self) -> Journal:
        """The main journal."""

    @property
    def crankpin(self) -> Journal:
        """The crankpin."""

    @property
    def journals(self) -> tuple[tuple[Journal, float], tuple[Journal, float]]:
        """Both, each with the place of its axis along the throw."""

    @property
    def drilling(self) -> tuple[Any, ...]:
        """The oil drillings, each a feature."""


class ForgingView(Protocol):
    """The raw part as forged features see it."""

    @property
    def allowance_mm(self) -> float:
        """Allowance on the faces of the web."""

    @property
    def draft_deg(self) -> float:
        """Least draft of every surface."""

    @property
    def draft_slope(self) -> float:
        """Tangent of the draft."""


class ThrowView(Hashable, Protocol):
    """The throw around a web: its journals, the web table (`WebTable`) and where its faces lie."""

    def invalid(self, key: str, allowed: str, hint: str = "") -> CranktopoError:
        """Return the refusal of the value at a key path."""

    @property
    def throw(self) -> JournalsView:
        """Crank radius and journals."""

    @property
    def web(self) -> Any:
        """The web, a `WebTable`: it holds features and so cannot be named here."""

    @property
    def web_z_mm(self) -> tuple[float, float]:
        """Heights of the web's journal face and pin face."""

    @property
    def pitch_mm(self) -> float:
        """Distance between the middles of the main journals."""


Face = Literal["journal", "pin"]
Reach = tuple[str, object, tuple[Array, Array]]
"""A key path, its value, and points (|x|, y) that it reaches to, mm."""
ExactMoments = tuple[float, float, float, float]
"""Volume of a body, mm3, integrals of x and y over it, mm4, and of x2 + y2, mm5."""
_SHOULDER_MM, _SHOULDER_SHARE = 0.1, 1 / 420
"""Least flat web face beyond a fillet, and that over the thinner journal's diameter; the smaller counts."""
SMALLEST, SMALLEST_FILLET = 1 / 500, 1 / 5000
"""Smallest dimension and smallest fillet over the size of the throw."""
_SAMPLES = 2001


def least_shoulder_mm(throw: JournalsView) -> float:
    """Least width of flat web face left beyond a fillet; less gives needle-shaped faces."""
    thinner = min(journal.outer_diameter_mm for journal, _ in throw.journals)
    return min(_SHOULDER_MM, _SHOULDER_SHARE * thinner)


@dataclass(frozen=True)
class Body(ABC):
    """A body that a feature adds to the web or takes from it; z counts from the mid-main-journal plane.

    No optimiser takes away one that is `kept`, a prism with one interval at each place, nor fills such a
    hole, which is round.
    """

    key: str
    z_mm: tuple[float, float]
    adds: ClassVar[bool] = False
    kept: ClassVar[bool] = False
    oblique: ClassVar[bool] = False
    """True of a cut whose edge moves across the web with the height, and so over the edges of other cuts."""
    bore: ClassVar[bool] = False
    """True of the bore of a journal."""

    @abstractmethod
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        """Lateral intervals that the body takes at places along the throw and heights, broadcastable."""

    @property
    @abstractmethod
    def y_range_mm(self) -> tuple[float, float]:
        """Extent along the throw."""

    @property
    def x_range_mm(self) -> tuple[float, float]:
        """Lateral extent of a body that adds material, which the cells must hold."""
        raise NotImplementedError

    def solids(self) -> tuple[Solid, ...]:
        """Return the exact body; it may reach beyond the web, if nothing of the web is there."""
        return self.continued(self.z_mm)

    def in_pieces(self, count: int) -> Self:
        """Return the same body, arcs that a CAD kernel may cut wrong given as so many; itself for most."""
        return self

    @property
    def y_breaks_mm(self) -> tuple[float, ...]:
        """Places along the throw where its section has kinks; its extent by default."""
        return self.y_range_mm

    def z_breaks_mm(self, y_mm: Array, half_width_mm: Array) -> list[Array]:
        """Heights at which its lateral interval has kinks, by place along the throw and the outline there."""
        return [np.full(y_mm.shape, z) for z in self.z_mm]

    def exact_moments(self, before_z_mm: float | None = None) -> ExactMoments | None:
        """Return what a cut takes out of material that holds all of it; None for quadrature by sections.

        With a height, weighted by the distance before it, mm.
        """
        return None

    @property
    def changing_z_mm(self) -> tuple[tuple[float, float], ...]:
        """Ranges of height, its ends among them, in which its section changes; none for a prism."""
        return ()

    def contains(self, x_mm: Array, y_mm: Array, z_mm: float) -> Mask:
        """Tell whether points at a height within its extent lie in the body, its surface included."""
        return holds(self.spans(y_mm, np.asarray(z_mm)), x_mm)

    def distance_mm(self, y_mm: float, z_mm: float) -> float:
        """Distance of its section at a height from the axis (0, y), by samples along the throw."""
        y = np.linspace(*self.y_range_mm, _SAMPLES)
        spans = self.spans(y, np.asarray(z_mm))
        nearest = np.min(
            [np.where(a < b, np.maximum(np.maximum(a, -b), 0), np.inf) for a, b in spans], axis=0
        )
        return float(np.hypot(nearest, y - y_mm).min())

    @property
    def outer_dimension(self) -> tuple[str, object]:
        """Key and value that a message names where it reaches too far."""
        return self.key, [round(y, 3) for y in self.y_range_mm]

    def ends_mm(self) -> tuple[Array, Array, Array]:
        """Left and right end of a prism with one interval at each place, and the places along the throw."""
        y = np.linspace(*self.y_range_mm, _SAMPLES)
        ((left, right),) = self.spans(y, np.asarray(sum(self.z_mm) / 2))
        return left, right, y

    def polygon_mm(self, sides: Callable[[float], int]) -> Array:
        """Corners (n, 2) of the section of such a prism; `sides` gives those of a circle of a radius."""
        left, right, y = self.ends_mm()
        return np.column_stack([np.r_[right, left[::-1]], np.r_[y, y[::-1]]])

    def inside_mm(self, x_mm: Array, y_mm: Array) -> Array:
        """Signed distance of points, broadcastable, from the edge of a prism's section, positive inside."""
        left, right, y = self.ends_mm()
        x, at = np.broadcast_arrays(x_mm, y_mm)
        away = np.full(x.shape, np.inf)
        for corner in np.column_stack([np.r_[left, right], np.r_[y, y]]):
            away = np.minimum(away, np.hypot(x - corner[0], at - corner[1]))
        return np.where(self.contains(x, at, sum(self.z_mm) / 2), away, -away)

    def continued(self, z_mm: tuple[float, float]) -> tuple[Solid, ...]:
        """A prism of its section at the face it opens at, over an axial range from there; none by default."""
        return ()


class DrilledBody(Body):
    """A cut that lies wholly in material and changes along the crank axis: cells are cut with it."""

    @abstractmethod
    def bounds_mm(self, z_mm: tuple[float, float]) -> tuple[Array, Array]:
        """Least and largest x, y and z between two heights."""


@dataclass(frozen=True)
class MirroredPrism(Body):
    """Material between both its heights that is symmetric in x, of one section."""

    adds: ClassVar[bool] = True

    @abstractmethod
    def half_width_mm(self, y_mm: Array) -> Array:
        """Half of its width at places along the throw; 0 beyond its ends."""

    @override
    def spans(self, y_mm: Array, z_mm: Array) -> Sequence[Span]:
        half = np.where((z_mm >= self.z_mm[0]) & (z_mm <= self.z_mm[1]), self.half_width_mm(y_mm), 0.0)
        return [(-half, half)]


class Feature(SceneTable, ABC):
    """A table of the web that adds material or takes it away."""

    @abstractmethod
    def bodies(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        """Its bodies in the web, named by the key path of the table."""

    def occupied(self, scene: ThrowView, key: str) -> tuple[Body, ...]:
        """Bodies that the design space must hold; by default those that no optimiser takes away."""
        return tuple(body for body in self.bodies(scene, key) if body.kept)

    def forged(self, scene: ThrowView, key: str, forging: ForgingView) -> tuple[Body, ...]:
        """Bodies that a die leaves out of the raw part; by default none: what is cut is machined."""
        return ()

    def reach_mm(self, scene: ThrowView, key: str) -> Iterator[Reach]:
        """Outermost points of what the design space must hold."""
        for body in self.occupied(scene, key):
            left, right, y = body.ends_mm()
            yield (*body.outer_dimension, (np.maximum(-left, right), y))

    @abstractmethod
    def check_alone(self, scene: ThrowView, key: str) -> None:
        """Refuse dimensions that no outline makes sound; before any body is asked for."""

    @abstractmethod
    def check_in_web(self, scene: ThrowView, key: str) -> None:
        """Refuse what does not go with the outline, the journals and other features."""

    def dimensions_mm(self, key: str) -> Iterator[tuple[str, float, float]]:
        """Key, value and smallest share of the throw's size of dimensions that are in proportion to it."""
        yield from ()

    @abstractmethod
    def drawing(self, scene: ThrowView) -> FeatureDrawing:
        """Return how it appears in the drawing."""

    def mirrored(self) -> Self:
        """Its mirror image in x = 0; itself for most."""
        return self
