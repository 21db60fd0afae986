"""Least safety of every part of every web of a shaft at every speed.

Stress at a node is a sum of some ten fields, so a state costs no solve; yet a shaft has a hundred thousand
nodes and as many states. All nodes are looked at in every eighth state at a few speeds and where a load
swings most; those whose safety comes near the least of their part are looked at in every state.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.arrays import Array, Mask
from cranktopo.base.side_by_side import side_by_side
from cranktopo.tasks.fatigue.criterion import LocalStress
from cranktopo.tasks.fatigue.superposition import signed_von_mises_ranges
from cranktopo.tasks.throw_fatigue.safety_field import point_safety
from cranktopo.tasks.throw_fatigue.stress_model import StressModel

Part = Literal["pin_fillet", "journal_fillet", "outlets", "elsewhere"]
PARTS: tuple[Part, ...] = get_args(Part)

_STRIDE, _SPEEDS = 8, 5
_NEAR = 1.1
"""Safety over the least of its part up to which a node is looked at in every state; between two of the states
and speeds that are looked at first it falls by some percent at most."""


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
    parts = web_parts(model)
    near = _near_the_least(model, parts, loads, method)
    jobs = [(throw, image) for throw in range(len(loads)) for image in range(len(model.images))]

    def judged(some: Sequence[tuple[int, int]]) -> list[dict[int, Array]]:
        return [
            _by_part(model, parts, image, near[throw][image], loads[throw], method) for throw, image in some
        ]

    one, other = side_by_side(lambda: judged(jobs[::2]), lambda: judged(jobs[1::2]))
    found: list[dict[tuple[int, Part], Array]] = [{} for _ in loads]
    for (throw, _), safeties in zip([*jobs[::2], *jobs[1::2]], [*one, *other], strict=True):
        for index, safety in safeties.items():
            key = parts[index].side, parts[index].part
            found[throw][key] = np.minimum(safety, found[throw].get(key, np.inf))
    return found


def looked_at(loads: Sequence[Array]) -> NDArray[np.intp]:
    """Return the speeds at which all nodes are looked at: even ones, and where a load swings most, as at a
    resonance."""
    even = np.linspace(0, len(loads[0]) - 1, _SPEEDS).round().astype(np.intp)
    return np.unique(np.concatenate([even, *(np.ptp(own, axis=1).argmax(axis=0) for own in loads)]))


def _near_the_least(
    model: StressModel, parts: Sequence[WebPart], loads: Sequence[Array], method: str
) -> list[list[Mask]]:
    """Return which nodes may be the worst of a part, by throw and image."""
    speeds = looked_at(loads)
    cycles = [
        own[speed, ::_STRIDE] * image.signs for own in loads for image in model.images for speed in speeds
    ]
    ranges = signed_von_mises_ranges(model.stress, cycles)
    safety = np.stack([point_safety(model, method, one.local) for one in ranges])
    safety = safety.reshape(len(loads), len(model.images), len(speeds), -1)
    near = np.zeros((len(loads), len(model.images), safety.shape[-1]), dtype=bool)
    for part in parts:
        images = list(part.images)
        own = safety[:, images][..., part.nodes]
        least = own.min(axis=(1, 3), keepdims=True)
        close = (own <= _NEAR * least).any(axis=2)
        for place, image in enumerate(images):
            near[:, image, part.nodes] |= close[:, place]
    return [list(of_throw) for of_throw in near]


def _by_part(
    model: StressModel, parts: Sequence[WebPart], image: int, near: Mask, loads: Array, method: str
) -> dict[int, Array]:
    """Return the least safety over the near nodes of an image at every speed, by the number of their part."""
    nodes = np.flatnonzero(near)
    if not nodes.size:
        return {}
    own = model.stress.at(nodes)
    ranges = signed_von_mises_ranges(own, list(loads * model.images[image].signs))
    local = LocalStress(
        *(
            np.concatenate([getattr(one.local, name) for one in ranges])
            for name in ("amplitude_MPa", "mean_MPa", "gradient_per_mm")
        )
    )
    safety = point_safety(model, method, local, np.tile(nodes, len(loads))).reshape(len(loads), -1)
    return {
        index: safety[:, part.nodes[nodes]].min(axis=1)
        for index, part in enumerate(parts)
        if image in part.images and part.nodes[nodes].any()
    }
