"""Least safety of every part of every web of a shaft at every speed.

Stress at a node is a sum of some ten fields, so a state costs no solve; yet a shaft has a hundred thousand
nodes and as many states. All nodes are looked at in every eighth state at a few speeds and where a load
swings most; those whose safety comes near the least of their part are looked at in every eighth state of all
speeds, both in single precision. At a speed where they still come near it every state counts, in double.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Index, Mask, Single
from cranktopo.base.side_by_side import side_by_side
from cranktopo.numerics.tetrahedra.stress import SurfaceStress
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.rough_ranges import RoughStress, fewer_fields, rough_local, rough_stress, wider
from cranktopo.tasks.fatigue.superposition import signed_von_mises_range
from cranktopo.tasks.throw_fatigue.safety_field import point_safety
from cranktopo.tasks.throw_fatigue.stress_model import StressModel

Part = Literal["pin_fillet", "journal_fillet", "outlets", "elsewhere"]
PARTS: tuple[Part, ...] = get_args(Part)

_SPEEDS = 5
_FEW, _MORE = (16, 8), (8, 4, 2, 1)
"""States from one that is looked at to the next: of all nodes at a few speeds, and of near ones at each."""
_LIMITS = {16: 1.3, 8: 1.17, 4: 1.1, 2: 1.035, 1: 1.001}
"""Safety over the least of its part up to which a node still counts, by that step. The worst nodes of a four
and a six are up to 14, 8.5, 5, 1.5 and 0 % above it: the sign of a nearly shearing stress changes between
two states. In all states single precision alone takes one node for another, by 1e-5 at most."""


@dataclass(frozen=True)
class WebPart:
    """A part of the surface of one web.

    Attributes:
        side: 0 for the web of a throw nearer to the free end, 1 for the other.
        images: of the model, that the web is made of.
        nodes: which surface nodes of the model belong to it.
    """

    side: int
    part: Part
    images: tuple[int, ...]
    nodes: Mask


def web_parts(model: StressModel) -> tuple[WebPart, ...]:
    """Return the parts of both webs whose stress the mesh does not decide; an absent part is left out."""
    rest = model.judged & ~model.on_fillet & ~model.at_outlet
    masks: dict[Part, Mask] = {
        "pin_fillet": model.on_pin,
        "journal_fillet": model.on_journal,
        "outlets": model.judged & model.at_outlet,
        "elsewhere": rest,
    }
    found = []
    for side in (0, 1):
        every = tuple(range(len(model.images)))
        images = every if model.whole else tuple(i for i in every if model.images[i].flip_z == bool(side))
        own = model.on_second == bool(side) if model.whole else np.ones_like(rest)
        found += [WebPart(side, part, images, nodes & own) for part, nodes in masks.items()]
    return tuple(part for part in found if part.nodes.any())


def least_safeties(
    model: StressModel, loads: Sequence[Array], method: str
) -> list[dict[tuple[int, Part], Array]]:
    """Return the least safety of each part of both webs at every speed, (speeds,), for each of equal throws.

    Args:
        loads: of each throw, factor of each field in each state of each speed, (speeds, states, fields).
    """
    parts, speeds = web_parts(model), looked_at(loads)

    def judged(side: int) -> list[dict[tuple[int, Part], Array]]:
        web = _web(model, method, [part for part in parts if part.side == side])
        return [web.least(own, speeds) for own in loads]

    near, far = side_by_side(lambda: judged(0), lambda: judged(1))
    return [one | other for one, other in zip(near, far, strict=True)]


def looked_at(loads: Sequence[Array]) -> NDArray[np.intp]:
    """Return the speeds at which all nodes are looked at: even ones, and where a load swings most, as at a
    resonance."""
    even = np.linspace(0, len(loads[0]) - 1, _SPEEDS).round().astype(np.intp)
    return np.unique(np.concatenate([even, *(np.ptp(own, axis=1).argmax(axis=0) for own in loads)]))


@dataclass(frozen=True)
class _Web:
    """One web of a throw in places: its nodes in one image of the model after the other.

    Attributes:
        parts: of this web alone.
        nodes: of the surface.
        stress: at these.
        signs: of the fields in each image, (images, fields).
    """

    model: StressModel
    method: str
    parts: Sequence[WebPart]
    nodes: Index
    stress: SurfaceStress
    signs: Array

    def least(self, loads: Array, looked_at: Index) -> dict[tuple[int, Part], Array]:
        """Return the least safety of the parts at every speed.

        Args:
            loads: factor of each field in each state of each speed, (speeds, states, fields).
            looked_at: speeds at which all places are looked at.
        """
        size = np.abs(self.stress.stress_MPa).max(axis=(1, 2))
        sums, factors = fewer_fields(loads, size)
        rough = rough_stress(self.stress, sums * self.signs[:, None])
        every = np.arange(len(rough.trace))
        places = every[self._near(every, rough, factors[looked_at], _FEW).any(axis=0)]
        near = self._near(places, rough.at(places), factors, _MORE)
        local = np.empty((3, *near.shape))
        for speed, own in enumerate(near):
            found = signed_von_mises_range(self._stress(places[own]), loads[speed]).local
            local[:, speed, own] = found.amplitude_MPa, found.mean_MPa, found.gradient_per_mm
        safety = self._safety(places, LocalStress(*local[:, near]), near)
        nodes = self._node(places)
        return {(part.side, part.part): safety[:, part.nodes[nodes]].min(axis=1) for part in self.parts}

    def _near(self, places: Index, rough: RoughStress, factors: Array, strides: Sequence[int]) -> Mask:
        """Return where places come near the least of a part, (speeds, places), in ever more of the states.

        Args:
            rough: stress of the places.
            factors: of its fields, (speeds, states, fields).
            strides: from one state that is looked at to the next, each half of the one before.
        """
        first, *others = strides
        found = rough.extremes(list(factors[:, ::first]))
        near = self._close(places, found, np.ones(found.shape[1:], dtype=bool), first)
        for stride in (one for one in others if one < factors.shape[1]):
            for speed, own in enumerate(near):
                added = rough.at(own).extremes([factors[speed, stride :: 2 * stride]])
                found[:, speed, own] = wider(found[:, speed, own], added[:, 0])
            near = self._close(places, found, near, stride)
        return near

    def _close(self, places: Index, extremes: Single, asked: Mask, stride: int) -> Mask:
        """Return where of what is asked for the safety comes near the least of a part."""
        safety = self._safety(places, rough_local(extremes[:, asked]), asked)
        near = asked.copy()
        for part in self.parts:
            own = part.nodes[self._node(places)]
            near[:, own] &= safety[:, own] <= _LIMITS[stride] * safety[:, own].min(axis=1, keepdims=True)
        return near

    def _node(self, places: Index) -> Index:
        """Return the surface node of places."""
        return np.asarray(self.nodes[places % len(self.nodes)])

    def _stress(self, places: Index) -> SurfaceStress:
        """Return the stress of places, in the axes of their images' model."""
        image, node = np.divmod(places, len(self.nodes))
        found, signs = self.stress.at(node), self.signs[image].T
        stress, depth = (one * signs[..., None] for one in (found.stress_MPa, found.depth_MPa_per_mm))
        return SurfaceStress(stress, depth, found.jump_MPa)

    def _safety(self, places: Index, local: LocalStress, asked: Mask) -> Array:
        """Return the safety where it is asked for, else infinity, (speeds, places)."""
        nodes = np.broadcast_to(self._node(places), asked.shape)[asked]
        safety = np.full(asked.shape, np.inf)
        safety[asked] = point_safety(self.model, self.method, local, nodes)
        return safety


def _web(model: StressModel, method: str, parts: Sequence[WebPart]) -> _Web:
    """Return a web of these parts."""
    nodes, images = np.flatnonzero(np.any([part.nodes for part in parts], axis=0)), parts[0].images
    signs = np.stack([model.images[image].signs for image in images])
    return _Web(model, method, parts, nodes, model.stress.at(nodes), signs)
