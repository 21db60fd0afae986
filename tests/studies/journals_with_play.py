"""A shaft with its mass and play in its bearings, without oil, in time: whether its cycle comes to repeat.

`python -m tests.studies.journals_with_play [MAX_STEPS]` prints a table of docs/pages/evaluating.md: the plain
Mikron on coarse elements at 2,100 rpm. A journal lies free in its play, or presses into a wall of
1,000,000 N/mm. Every step is implicit, the walls solved with the shaft by Newton's method. More steps take
less out of what swings fast: a cycle that repeats with few steps alone is one of the method.
"""

from __future__ import annotations

import math
import sys
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from cranktopo.base.frames import about_z_deg
from cranktopo.design.schema import Scene
from cranktopo.numerics.bearing_film.whirl import ShaftSteps
from cranktopo.numerics.harmonic_balance import DampedBody
from cranktopo.numerics.tetrahedra.rigid_motions import RZ, UX, UY, UZ
from cranktopo.tasks.dynamics.assembled import assembled
from cranktopo.tasks.dynamics.moving_shaft import MovingShaft
from cranktopo.tasks.dynamics.on_film import of_unknowns
from cranktopo.tasks.shaft.cycle import CycleForces, load_shares
from tests.physics.dynamics.shafts import forces_at, mikron, shaft_of

Array = NDArray[np.float64]
RPM, WALL_N_PER_MM = 2100.0, 1e6
PLAYS_MM, STEPS, CYCLES = (0.005, 0.01, 0.025), (1, 2, 4, 8), 40
_REPEATS = 1e-4
"""Change of the journals' places from cycle to cycle over the play, below which they repeat."""
_NEWTON, _WITHIN = 30, 1e-10


@dataclass(frozen=True)
class Walls:
    """Rings around journals: forces of journals, x and y of each, and their slopes, (2 n, 2 n)."""

    play_mm: float

    def push(self, place: Array) -> tuple[Array, Array]:
        pairs = place.reshape(-1, 2)
        size = np.maximum(np.linalg.norm(pairs, axis=1), 1e-12)
        way, touched = pairs / size[:, None], size > self.play_mm
        share = np.where(touched, 1 - self.play_mm / size, 0.0)
        slope = np.zeros((len(place), len(place)))
        for one in np.flatnonzero(touched):
            radial = np.outer(way[one], way[one])
            own = slice(2 * one, 2 * one + 2)
            slope[own, own] = WALL_N_PER_MM * (share[one] * (np.eye(2) - radial) + radial)
        return WALL_N_PER_MM * (share[:, None] * pairs).ravel(), slope


class Marching:
    """A shaft between walls, in steps of time."""

    def __init__(
        self, shaft: MovingShaft, scene: Scene, forces: CycleForces, walls: Walls, steps: int
    ) -> None:
        """Take so many steps for each state of the forces."""
        body, load, journals = _held(shaft, scene, forces)
        speed, step_s = forces.angular_speed_rad_s, math.radians(1.0) / forces.angular_speed_rad_s / steps
        self._shaft = ShaftSteps.of(body, about_z_deg(1.0) * speed, journals, step_s)
        self._walls, self._steps = walls, steps
        self._pushed = self._shaft.inverse @ (load * self._shaft.scale[:, None])
        self._moved, self._velocity = np.zeros((2, len(load)))
        self._place = np.zeros(len(journals))

    def cycle(self) -> tuple[Array, Array]:
        """March on by a cycle; places of the journals and forces on the walls, (states, 2 n) each."""
        found = [self._state(number) for number in range(self._pushed.shape[1])]
        return np.array([place for place, _ in found]), np.array([force for _, force in found])

    def _state(self, number: int) -> tuple[Array, Array]:
        now, then = self._pushed[:, number], self._pushed[:, (number + 1) % self._pushed.shape[1]]
        for one in range(self._steps):
            force = self._by(
                now + (one + self._shaft.late_s / self._shaft.step_s) / self._steps * (then - now)
            )
        return self._shaft.joined.T @ self._moved, force

    def _by(self, pushed: Array) -> Array:
        shaft = self._shaft
        free = shaft.free(self._moved, self._velocity) + pushed
        alone, seen = shaft.joined.T @ (self._moved + shaft.late_s * free), shaft.late_s * shaft.seen
        for _ in range(_NEWTON):
            force, slope = self._walls.push(self._place)
            left = self._place + seen @ force - alone
            if np.abs(left).max() < _WITHIN * self._walls.play_mm:
                break
            self._place = self._place - np.linalg.solve(np.eye(len(left)) + seen @ slope, left)
        late = free - shaft.by_load @ force
        self._moved, self._velocity = shaft.after(self._moved, self._velocity, late)
        return force


def _held(
    shaft: MovingShaft, scene: Scene, forces: CycleForces
) -> tuple[DampedBody, Array, NDArray[np.intp]]:
    """Return the body whose last section turns evenly, its loads, and the rows of y and x of each journal."""
    whole, last = assembled(shaft, scene), 6 * len(shaft.throws)
    kept = np.delete(np.arange(len(whole.coordinates)), [last + UZ, last + RZ])
    load = sum(
        whole.own[number].T @ throw.loads @ load_shares(throw.still, forces, number)
        for number, throw in enumerate(shaft.throws)
    )
    body = of_unknowns(whole.damped, kept, np.zeros_like(whole.damped.loss))
    journals = np.searchsorted(kept, [6 * one + motion for one in shaft.borne_by for motion in (UY, UX)])
    return body, np.asarray(load)[kept], journals


def rows(most_steps: int = STEPS[-1]) -> Iterator[str]:
    """Lines of the table."""
    scene = mikron()
    shaft, forces = shaft_of(scene), forces_at(scene, RPM)
    yield "| radial play, µm | steps a degree | cycles | last change over the play | largest forces, kN |"
    yield "| --: | --: | --: | --: | --- |"
    for play in PLAYS_MM:
        for steps in (one for one in STEPS if one <= most_steps):
            march = Marching(shaft, scene, forces, Walls(play), steps)
            before, changes = march.cycle()[0], list[float]()
            while len(changes) < CYCLES and (not changes or changes[-1] > _REPEATS):
                place, force = march.cycle()
                changes.append(float(np.abs(place - before).max()) / play)
                before = place
            most = np.linalg.norm(force.reshape(len(force), -1, 2), axis=2).max(axis=0) / 1e3
            told = f"{changes[-1]:.1g}", ", ".join(f"{one:.1f}" for one in most)
            yield f"| {1e3 * play:.0f} | {steps} | {len(changes) + 1} | {' | '.join(told)} |"


if __name__ == "__main__":
    for line in rows(*map(int, sys.argv[1:])):
        print(line, flush=True)
