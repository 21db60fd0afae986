"""Sections of an elastic shaft with play in rigid bearings, without friction: where each lies under a load.

A section lies free in its play, or touches the bearing, which pushes it towards the middle: a complementarity
problem for each load. It is the minimum of the elastic energy over discs, a convex problem: alternating
directions (ADMM, Boyd et al. 2011, 3.1) find which sections touch, Newton's method solves what is left.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array, Index, Mask
from cranktopo.base.errors import solver_error

_STEPS, _ROUNDS, _NEWTON = 100, 100, 12
"""Alternating steps before each try by Newton's method, most tries, and its steps."""
_WITHIN = 1e-9
"""Of the play, and of the largest load: the residual that counts as none."""
_TOUCHING = 1e-6
"""Part of the play from the bearing up to which a section that pushes it touches it."""
_SUPPORT = 1e-12
"""Part of the largest stiffness that keeps Newton's matrix regular where too few sections touch."""


def sections_in_rings(stiffness: Array, load: Array, play: Array) -> Array:
    """Return how far each section lies off the middle of its bearing, x and y of each, (2 n, states).

    Args:
        stiffness: by which the shaft resists such offsets, (2 n, 2 n), symmetric.
        load: on bearings that hold every section in the middle, toward where the section pushes,
            (2 n, states).
        play: radial, of each section, (n,).

    Raises:
        CranktopoError: a state without an answer.
    """
    found, left = np.zeros_like(load), np.arange(load.shape[1])
    steps = _Alternating(stiffness, play, load)
    for _ in range(_ROUNDS):
        steps.go(left)
        start = steps.within[:, left], steps.force[:, left]
        own, fits = _newton(stiffness, load[:, left], play, *start)
        found[:, left[fits]] = own[:, fits]
        left = left[~fits]
        if not left.size:
            return found
    raise solver_error(
        f"bearings with play: {left.size} of {load.shape[1]} states of the shaft have no answer.",
        "Take rigid bearings, or report this design.",
    )


class _Alternating:
    """Alternating steps of all states: the shaft as it bends, and its sections as they fit into the rings.

    Attributes:
        within: offsets that fit, (2 n, states).
        force: of the sections on the bearings there, (2 n, states).
    """

    def __init__(self, stiffness: Array, play: Array, load: Array) -> None:
        self._load, self._play = load, play
        sizes, self._axes = np.linalg.eigh((stiffness + stiffness.T) / 2)
        self._sizes = np.maximum(sizes, 0.0)
        pressed = max(float(np.abs(load).max()), 1e-300) / play.min()
        self._weight = math.sqrt(pressed * max(pressed, self._sizes.max()))
        self.within, self.force = np.zeros_like(load), np.zeros_like(load)

    def go(self, states: Index) -> None:
        """Do some steps of a few states."""
        axes, soft, weight = self._axes, 1 / (self._sizes + self._weight)[:, None], self._weight
        load, within, force = self._load[:, states], self.within[:, states], self.force[:, states]
        for _ in range(_STEPS):
            bent = axes @ (soft * (axes.T @ (load - force + weight * within)))
            moved = bent + force / weight
            within = _into_rings(moved, self._play)
            force = weight * (moved - within)
        self.within[:, states], self.force[:, states] = within, force


def _pairs(values: Array) -> Array:
    """Return x and y of every section in states, (states, n, 2) of (2 n, states)."""
    return values.T.reshape(values.shape[1], -1, 2)


def _rows(pairs: Array) -> Array:
    return pairs.reshape(len(pairs), -1).T


def _into_rings(offset: Array, play: Array) -> Array:
    pairs = _pairs(offset)
    size = np.linalg.norm(pairs, axis=2, keepdims=True)
    return _rows(pairs * np.minimum(1.0, play[:, None] / np.maximum(size, 1e-300)))


@dataclass(frozen=True)
class _Touching:
    """Equations of states in which it is known which sections touch: offsets, and force per offset of each.

    Attributes:
        load: (states, n, 2).
        which: sections that touch, (states, n).
    """

    stiffness: Array
    load: Array
    play: Array
    which: Mask

    def residual(self, offset: Array, number: Array) -> tuple[Array, Array]:
        """Return forces out of balance, (states, n, 2), and what keeps touching sections off, (states, n)."""
        bent = (offset.reshape(len(offset), -1) @ self.stiffness).reshape(offset.shape)
        outside = ((offset**2).sum(axis=2) - self.play**2) / 2
        return number[..., None] * offset + bent - self.load, np.where(self.which, outside, number)

    def matrix(self, offset: Array, number: Array) -> Array:
        """Return the derivatives of the residual, (states, 3 n, 3 n)."""
        moved = 2 * len(self.play)
        found = np.zeros((len(offset), moved + len(self.play), moved + len(self.play)))
        support = _SUPPORT * np.abs(self.stiffness).max()
        found[:, :moved, :moved] = self.stiffness + support * np.eye(moved)
        for one, at in enumerate(self.which.T):
            own, row = slice(2 * one, 2 * one + 2), moved + one
            found[:, own, own] += number[:, one, None, None] * np.eye(2)
            found[:, own, row] = offset[:, one]
            found[:, row, own] = np.where(at[:, None], offset[:, one], 0.0)
            found[:, row, row] = np.where(at, 0.0, 1.0)
        return found

    def answers(self, offset: Array, number: Array) -> Mask:
        """Tell of each state whether all conditions hold."""
        unbalanced, outside = self.residual(offset, number)
        scale, squared = np.abs(self.load).max(), self.play**2
        balanced = (np.abs(unbalanced) <= _WITHIN * scale).all(axis=(1, 2))
        held = ~self.which | (np.abs(outside) <= _WITHIN * squared)
        pushed = number * self.play >= -_WITHIN * scale
        inside = (offset**2).sum(axis=2) <= (1 + 2 * _WITHIN) * squared
        return np.asarray(balanced & (held & pushed & inside).all(axis=1))


def _newton(stiffness: Array, load: Array, play: Array, start: Array, force: Array) -> tuple[Array, Mask]:
    """Return offsets of states by Newton's method, and which of them are answers.

    Args:
        start, force: offsets that fit, and forces on the bearings, that tell which sections touch.
    """
    offset = _pairs(start)
    pressed = (_pairs(force) * offset).sum(axis=2) / play**2
    which = (np.linalg.norm(offset, axis=2) > (1 - _TOUCHING) * play) & (pressed > 0)
    number, equations = np.where(which, pressed, 0.0), _Touching(stiffness, _pairs(load), play, which)
    for _ in range(_NEWTON):
        unbalanced, outside = equations.residual(offset, number)
        right = -np.concatenate([unbalanced.reshape(len(offset), -1), outside], axis=1)
        change = np.linalg.solve(equations.matrix(offset, number), right[..., None])[..., 0]
        offset = offset + change[:, : 2 * len(play)].reshape(offset.shape)
        number = number + change[:, 2 * len(play) :]
    return _rows(offset), equations.answers(offset, number)
