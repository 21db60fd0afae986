"""Readings of two printed forces as those of bearings: `python -m tests.studies.balancer_forces`, tables.

M. Kral (Brno University of Technology, 2014) prints 1981.5 and 1877.4 N beside the forces of both masses, but
not what they belong to, nor where the six printed lengths lie. As forces of two bearings they would follow by
statics from what is printed. All places of bearings, masses and gear that the lengths allow are tried, with
all that may be added, turned or left out. Frame: the first mass pulls along y, the real axis; x is imaginary.
"""

from __future__ import annotations

import cmath
import itertools
import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import numpy as np

from cranktopo.base.arrays import Array

PRINTED_N = 1981.5, 1877.4
MASSES_N = 3004.1, 3003.8
TANGENTIAL_N, RADIAL_N, AXIAL_N = 112.2, 43.4, 40.8
PITCH_RADIUS_MM = 34.586
LENGTHS_MM = 32, 28, 76, 161, 60, 60
PARTS = 5
"""Both bearings, both masses, the gear."""
BUILT = np.array([[161.0, 60.0, 221.0, -32.0]])
"""Layout of the design `balancer-shaft`."""
TOLERANCE = 1e-3
MASSES: dict[str, tuple[complex, complex]] = {
    "on one side": (1, 1),
    "opposed": (1, -1),
    "at right angles": (1, 1j),
    "the first alone": (1, 0),
    "the second alone": (0, 1),
}
GEAR = {  # what counts of tangential, radial and axial force
    "none": (0, 0, 0),
    "all": (1, 1, 1),
    "not axial": (1, 1, 0),
    "tangential": (1, 0, 0),
    "radial": (0, 1, 0),
    "axial": (0, 0, 1),
}
SUMS: dict[str, Callable[[Array, Array], Array]] = {
    "in space": lambda masses, gear: np.abs(masses + gear),
    "both in one direction": lambda masses, gear: np.abs(masses) + np.abs(gear),
    "plane of the masses": lambda masses, gear: np.abs((masses + gear).real),
    "plane across": lambda masses, gear: np.abs((masses + gear).imag),
    "both planes added": lambda masses, gear: np.abs((masses + gear).real) + np.abs((masses + gear).imag),
}
"""One force of what turns and what stands still, of a bearing."""
QUARTERS_DEG = 0.0, 90.0, 180.0, 270.0


def layouts() -> Array:
    """Return span, and places of both masses and of the gear from the first bearing, (layouts, 4), mm.

    The lengths lie in a row, five of its seven points taken; or each of four is the distance of two parts.
    """
    return np.unique(np.concatenate([*_in_a_row(), *_from_part_to_part()]), axis=0)


def _in_a_row() -> Iterator[Array]:
    order = np.array(list(itertools.permutations(range(len(LENGTHS_MM) + 1), PARTS)))
    order = order[order[:, 1] > order[:, 0]]
    for lengths in set(itertools.permutations(LENGTHS_MM)):
        place = np.concatenate([[0], np.cumsum(lengths)])[order]
        yield (place[:, 1:] - place[:, :1]).astype(float)


def _from_part_to_part() -> Iterator[Array]:
    """Yield layouts of each tree of distances between the parts, with every length on every branch."""
    lengths = np.array(sorted(set(itertools.permutations(LENGTHS_MM, PARTS - 1))), dtype=float)
    signs = np.array(list(itertools.product((1, -1), repeat=PARTS - 1)))
    steps = (lengths[:, None] * signs).reshape(-1, PARTS - 1)
    for tree in itertools.combinations(itertools.combinations(range(PARTS), 2), PARTS - 1):
        ends = np.zeros((PARTS - 1, PARTS))
        for branch, (one, other) in enumerate(tree):
            ends[branch, [one, other]] = -1, 1
        if abs(np.linalg.det(ends[:, 1:])) > 0.5:  # no closed loop: 0, else 1
            place = np.round(np.linalg.solve(ends[:, 1:], steps.T).T)
            yield place[place[:, 0] > 0]


def by_statics(span_mm: Array, forces: Array, moments: Array) -> Array:
    """Return forces of both bearings, (2, layouts), from the sum of all forces and of their moments."""
    last = -moments / span_mm
    return np.stack([-forces - last, last])


def of_masses(layout: Array, masses: tuple[complex, complex]) -> Array:
    """Return what the masses make in both bearings."""
    span, *places, _ = layout.T
    pulls = [factor * force for factor, force in zip(masses, MASSES_N, strict=True)]
    return by_statics(
        span, np.full(len(span), sum(pulls)), sum(p * z for p, z in zip(pulls, places, strict=True))
    )


@dataclass(frozen=True)
class Mesh:
    """Share of the gear's forces that counts, and their directions."""

    counts: tuple[int, int, int]
    deg: float
    turn: int
    hand: int

    def bearings(self, layout: Array) -> Array:
        """Return what the gear makes in both bearings."""
        span, *_, gear = layout.T
        around, toward, along = self.counts
        out = cmath.rect(1.0, math.radians(self.deg))
        force = out * (1j * self.turn * around * TANGENTIAL_N - toward * RADIAL_N)
        return by_statics(
            span,
            np.full(len(span), force),
            force * gear + out * self.hand * along * AXIAL_N * PITCH_RADIUS_MM,
        )


def meshes(counts: tuple[int, int, int], directions_deg: Array | tuple[float, ...]) -> Iterator[Mesh]:
    """Yield a gear with both senses of its turn and both hands of its helix."""
    if not any(counts):
        yield Mesh(counts, 0.0, 1, 1)
        return
    for deg, turn, hand in itertools.product(directions_deg, (1, -1), (1, -1)):
        yield Mesh(counts, float(deg), turn, hand)


def missed(found: Array, wanted: tuple[float, float]) -> Array:
    """Return by which share the farther one of two forces (2, n) is off, in the better order of both."""
    return np.min([np.abs(found.T / pair - 1).max(axis=1) for pair in (wanted, wanted[::-1])], axis=0)


def readings(
    layout: Array,
    wanted: tuple[float, float],
    sums: tuple[str, ...] = tuple(SUMS),
    directions_deg: Array | tuple[float, ...] = QUARTERS_DEG,
) -> Iterator[tuple[str, str, str, Mesh, Array]]:
    """Yield masses, gear and sum of each reading, and by which share every layout misses what is wanted."""
    for masses, factors in MASSES.items():
        turning = of_masses(layout, factors)
        for gear, counts in GEAR.items():
            for mesh in meshes(counts, directions_deg):
                still = mesh.bearings(layout)
                for name in sums:
                    yield masses, gear, name, mesh, missed(SUMS[name](turning, still), wanted)


def any_speed(layout: Array, wanted: tuple[float, float]) -> tuple[Array, Array]:
    """Return layouts whose masses alone have the wanted ratio, and the speed over the printed one."""
    turning = np.abs(of_masses(layout, MASSES["on one side"]))
    with np.errstate(divide="ignore"):
        ratio = turning.max(axis=0) / turning.min(axis=0)
    hits = np.abs(ratio * min(wanted) / max(wanted) - 1) < TOLERANCE
    return layout[hits], np.sqrt(max(wanted) / turning.max(axis=0)[hits])


def main() -> None:
    """Print how near each kind of reading comes, and what free inputs give in the reconstruction."""
    layout = layouts()
    print(f"{len(layout):,} layouts\n")
    print("| sum | gear | readings | within 0.1 % | within 1 % | nearest, % |\n|---|---|---:|---:|---:|---:|")
    for name in SUMS:
        found = list(readings(layout, PRINTED_N, (name,)))
        for gear in GEAR:
            off = np.array([share for _, counted, _, _, share in found if counted == gear])
            within = f"{(off < TOLERANCE).sum()} | {(off < 10 * TOLERANCE).sum():,}"
            print(f"| {name} | {gear} | {off.size:,} | {within} | {100 * off.min():.3f} |")
    places, speeds = any_speed(layout, PRINTED_N)
    print(f"\nMasses alone on one side, at another speed: {len(places)} layouts")
    for place, speed in zip(places, 2460 * speeds, strict=True):
        print(place, f"{speed:.0f} rpm")
    print("\n| masses | mesh anywhere: first bearing, N | second bearing, N |\n|---|---:|---:|")
    for masses in MASSES:
        (a, b), (c, d) = any_mesh(masses)
        print(f"| {masses} | {a:.0f} to {b:.0f} | {c:.0f} to {d:.0f} |")


def any_mesh(masses: str) -> Array:
    """Return smallest and largest force of both bearings of the reconstruction, the mesh at any place."""
    turning = of_masses(BUILT, MASSES[masses])
    every = meshes(GEAR["all"], np.arange(0.0, 360.0, 5.0))
    both = np.abs([turning + mesh.bearings(BUILT) for mesh in every])
    return np.stack([both.min(axis=0), both.max(axis=0)], axis=1)[:, :, 0]


if __name__ == "__main__":
    main()
